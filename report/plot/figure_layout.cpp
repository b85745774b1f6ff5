#include "report/plot/figure_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/core.h>

#include "report/plot/legend_place.hpp"

namespace repose::report {

namespace {

constexpr double largest_drawn = 1e300, smallest_drawn = 1e-300;  // rooms and ratios stay doubles
constexpr double bar_width = 14.0;                                // of a colour bar
constexpr double bar_gap = 18.0;                // between the plotting area and the bar
constexpr double tick_gap = 15.0;               // between an upright axis and its numbers
constexpr double tick_line = 27.0;              // what ticks and their numbers take below an axis
constexpr double label_line = 24.0;             // what the label of an axis takes
constexpr double least_height_for_bar = 170.0;  // lower panels get their colour bar below

std::vector<std::string> wrap(std::string_view text, double width, double size) {
  std::vector<std::string> lines;
  std::string line;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string longer = line.empty() ? std::string(word) : line + " " + std::string(word);
    if (!line.empty() && text_width(longer, size) > width) {
      lines.push_back(line);
      line = word;
    } else {
      line = longer;
    }
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

/// The smallest and largest drawable value of one coordinate.
class Extent {
 public:
  explicit Extent(AxisScale scale) : scale_(scale) {}
  void include(std::span<const double> values) {
    for (const double value : values) {
      if (!drawable(value, scale_)) continue;
      lower_ = std::min(lower_, value);
      upper_ = std::max(upper_, value);
    }
  }
  bool empty() const { return lower_ > upper_; }
  double lower() const { return lower_; }
  double upper() const { return upper_; }

 private:
  AxisScale scale_;
  double lower_ = std::numeric_limits<double>::infinity();
  double upper_ = -std::numeric_limits<double>::infinity();
};

void check_range(const AxisView& view) {
  const bool fits = std::isfinite(view.lower) && std::isfinite(view.upper) &&
                    view.lower < view.upper &&
                    (view.scale == AxisScale::linear || view.lower > 0.0);
  if (!fits)
    throw std::logic_error(fmt::format("figure: axis '{}' cannot go from {} to {}", view.label,
                                       view.lower, view.upper));
}

/// padding: room beyond the data, as a part of their extent; 0 for a colour scale.
AxisView view_of(const Axis& axis, const Extent& data, double padding) {
  const bool logarithmic = axis.scale == AxisScale::logarithmic;
  AxisView view;
  view.scale = axis.scale;
  view.label = axis.label;
  double lower = data.empty() ? (logarithmic ? 1.0 : 0.0) : data.lower();
  double upper = data.empty() ? (logarithmic ? 10.0 : 1.0) : data.upper();
  lower = axis.lower.value_or(lower);
  upper = axis.upper.value_or(upper);
  // All data alike but for round-off: a range around them that shows it.
  const double largest = std::max(std::abs(lower), std::abs(upper));
  if (!(upper - lower > 1e-9 * largest) && lower <= upper && !(axis.lower && axis.upper)) {
    const double around = largest < smallest_drawn ? 1.0 : 0.05 * largest;
    if (!axis.lower) lower = logarithmic ? lower / 1.1 : lower - around;
    if (!axis.upper) upper = logarithmic ? upper * 1.1 : upper + around;
  }
  view.lower = lower;
  view.upper = upper;
  if (logarithmic && padding > 0.0) {
    // wide ranges in logarithms: their ratio has no double
    const double ratio = upper / lower;
    const double room = std::isfinite(ratio)
                            ? std::pow(ratio, padding)
                            : std::exp(padding * (std::log(upper) - std::log(lower)));
    if (!axis.lower) view.lower = std::max(lower / room, 1e-305);
    if (!axis.upper) view.upper = std::min(upper * room, 1e305);
  } else if (padding > 0.0) {
    const double room = padding * (upper - lower);
    const bool from_zero = lower >= 0.0 && lower < 0.1 * upper;
    const bool to_zero = upper <= 0.0 && upper > 0.1 * lower;
    if (!axis.lower) view.lower = from_zero ? 0.0 : lower - room;
    if (!axis.upper) view.upper = to_zero ? 0.0 : upper + room;
  }
  check_range(view);
  // gnuplot is given nine digits and compares ranges with constants of its own: what is very large,
  // very small or very narrow is handed to it as places from 0 to 1
  const double size = std::max(std::abs(view.lower), std::abs(view.upper));
  view.by_fraction =
      logarithmic
          ? view.lower < 1e-30 || view.upper > 1e30 || view.upper < view.lower * (1.0 + 1e-6)
          : size > 1e30 || view.upper - view.lower < 1e-30 || view.upper - view.lower < 1e-6 * size;
  return view;
}

void add_ticks(AxisView& view, double pixels, double pixels_per_tick) {
  const int target = std::max(2, static_cast<int>(pixels / pixels_per_tick));
  view.ticks = view.scale == AxisScale::linear ? linear_ticks(view.lower, view.upper, target)
                                               : logarithmic_ticks(view.lower, view.upper, target);
}

double widest_tick(const AxisView& view) {
  double width = 0.0;
  for (const Tick& tick : view.ticks) width = std::max(width, text_width(tick.label, text_px));
  return width;
}

/// Ranges, size and legend of a panel; its place comes later.
PanelView view_of(const Axes& axes, const Figure& figure) {
  Extent xs(axes.x.scale), ys(axes.y.scale);
  Extent values(axes.colours() ? axes.colours()->scale : AxisScale::linear);
  for (const Series& series : axes.series()) {
    xs.include(series.x);
    ys.include(series.y);
    ys.include(series.upper);
    if (series.kind != SeriesKind::shade) values.include(series.value);
  }
  constexpr double room = 0.05;
  PanelView panel;
  panel.x = view_of(axes.x, xs, room);
  panel.y = view_of(axes.y, ys, room);
  panel.area.width = figure.panel_width_px;
  panel.area.height = figure.panel_height_px;
  if (axes.equal_aspect) {
    if (panel.x.scale != AxisScale::linear || panel.y.scale != AxisScale::linear)
      throw std::logic_error("figure: equal aspect needs linear axes");
    const double dx = panel.x.upper - panel.x.lower, dy = panel.y.upper - panel.y.lower;
    const double scale = std::min(panel.area.width / dx, panel.area.height / dy);
    constexpr double least = 4.0;  // of two lengths that differ by more the shorter is a line
    panel.area.width = std::max(least, scale * dx);
    panel.area.height = std::max(least, scale * dy);
  }
  add_ticks(panel.x, panel.area.width, 62.0);
  add_ticks(panel.y, panel.area.height, 46.0);
  if (axes.colours()) {
    panel.colours = view_of(*axes.colours(), values, 0.0);
    panel.bar_below = panel.area.height < least_height_for_bar;
    add_ticks(*panel.colours, panel.bar_below ? panel.area.width : panel.area.height,
              panel.bar_below ? 80.0 : 46.0);
  }

  place_legend(panel, axes);
  return panel;
}

/// Room around a plotting area for numbers, labels, title, colour bar and legend.
struct Margins {
  double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;
};

Margins margins_of(const Axes& axes, const PanelView& panel) {
  Margins m;
  m.left = tick_gap + widest_tick(panel.y) + (axes.y.label.empty() ? 0.0 : label_line);
  m.bottom = tick_line + (axes.x.label.empty() ? 0.0 : label_line) + 6.0;
  m.top = axes.title.empty() ? 10.0 : panel_title_px * line_height + 10.0;
  m.right = 14.0;  // half of the last number
  if (panel.colours && panel.bar_below) {
    m.bottom += bar_gap + bar_width + tick_line + label_line;
  } else if (panel.colours) {
    m.right = bar_gap + bar_width + tick_gap + widest_tick(*panel.colours) + label_line;
  }
  if (panel.legend_beside) m.right += panel.legend->width;
  return m;
}

/// Moves a panel to its place; its area knows it already.
void place_around_area(PanelView& panel, const Axes& axes) {
  const Rect& area = panel.area;
  const double right = area.left + area.width, bottom = area.top + area.height;
  const double middle = area.left + 0.5 * area.width, centre = area.top + 0.5 * area.height;
  panel.x_label = {middle, bottom + tick_line + 0.5 * label_line};
  panel.y_label = {area.left - tick_gap - widest_tick(panel.y) - 0.5 * label_line, centre};
  double beside = 0.0;
  if (panel.colours && panel.bar_below) {
    const double top = bottom + tick_line + (axes.x.label.empty() ? 0.0 : label_line) + bar_gap;
    panel.bar = {area.left, top, area.width, bar_width};
    panel.bar_label = {middle, top + bar_width + tick_line + 0.5 * label_line};
  } else if (panel.colours) {
    panel.bar = {right + bar_gap, area.top, bar_width, area.height};
    beside = bar_gap + bar_width + tick_gap + widest_tick(*panel.colours) + label_line;
    panel.bar_label = {right + beside - 0.5 * label_line, centre};
  }
  if (panel.legend) {
    panel.legend->left += area.left + (panel.legend_beside ? beside : 0.0);
    panel.legend->top += area.top;
  }
}

/// What the rows and columns of the grid need, the largest of each.
struct Grid {
  std::size_t columns = 1;
  std::vector<Margins> column_margins, row_margins;
  std::vector<double> column_widths, row_heights;
};

Grid grid_of(const Figure& figure, const std::vector<PanelView>& panels) {
  Grid grid;
  const std::size_t n = panels.size();
  grid.columns = figure.columns > 0
                     ? std::min(figure.columns, n)
                     : static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(n))));
  const std::size_t rows = (n + grid.columns - 1) / grid.columns;
  grid.column_margins.resize(grid.columns);
  grid.column_widths.resize(grid.columns);
  grid.row_margins.resize(rows);
  grid.row_heights.resize(rows);
  for (std::size_t i = 0; i < n; ++i) {
    const Margins own = margins_of(*figure.panels()[i], panels[i]);
    Margins& column = grid.column_margins[i % grid.columns];
    Margins& row = grid.row_margins[i / grid.columns];
    column.left = std::max(column.left, own.left);
    column.right = std::max(column.right, own.right);
    row.top = std::max(row.top, own.top);
    row.bottom = std::max(row.bottom, own.bottom);
    double& width = grid.column_widths[i % grid.columns];
    double& height = grid.row_heights[i / grid.columns];
    width = std::max(width, panels[i].area.width);
    height = std::max(height, panels[i].area.height);
  }
  return grid;
}

std::string subtitle_with(const std::string& subtitle, const std::vector<std::string>& notes) {
  std::string text = subtitle;
  for (const std::string& note : notes) text += (text.empty() ? "" : "; ") + note;
  return text;
}

}  // namespace

std::size_t letters_in(std::string_view text) {
  std::size_t letters = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool markup = c == '{' || c == '}' ||
                        ((c == '_' || c == '^') && i + 1 < text.size() && text[i + 1] == '{');
    const bool continuation = (static_cast<unsigned char>(c) & 0xc0) == 0x80;
    if (!markup && !continuation) ++letters;
  }
  return letters;
}

double text_width(std::string_view text, double size_px) {
  return 0.53 * size_px * static_cast<double>(letters_in(text));
}

bool drawable(double value, AxisScale scale) {
  return std::abs(value) <= largest_drawn &&
         (scale == AxisScale::linear || value >= smallest_drawn);
}

double AxisView::fraction(double value) const {
  if (scale == AxisScale::logarithmic && by_fraction)
    return (std::log(value) - std::log(lower)) / (std::log(upper) - std::log(lower));
  if (scale == AxisScale::logarithmic) return std::log(value / lower) / std::log(upper / lower);
  return (value - lower) / (upper - lower);
}

FigureView lay_out(const Figure& figure, const std::vector<std::string>& notes) {
  if (figure.panels().empty()) throw std::logic_error("figure: it has no panel");
  FigureView view;
  for (const auto& axes : figure.panels()) view.panels.push_back(view_of(*axes, figure));
  const Grid grid = grid_of(figure, view.panels);

  constexpr double between = 18.0;
  double width = 2.0 * edge + between * static_cast<double>(grid.columns - 1);
  for (std::size_t c = 0; c < grid.columns; ++c)
    width += grid.column_margins[c].left + grid.column_widths[c] + grid.column_margins[c].right;
  constexpr double least_width = 360.0;  // a narrow picture still has room for its title
  view.width = std::ceil(std::max(width, least_width));
  const double shift = 0.5 * (view.width - width);

  view.title_lines = wrap(figure.title, view.width - 2.0 * edge, title_px * 1.08);
  view.subtitle_lines =
      wrap(subtitle_with(figure.subtitle, notes), view.width - 2.0 * edge, text_px);
  double top = edge + title_px * line_height * static_cast<double>(view.title_lines.size()) +
               text_px * line_height * static_cast<double>(view.subtitle_lines.size());
  double left = 0.0;
  for (std::size_t i = 0; i < view.panels.size(); ++i) {
    const std::size_t column = i % grid.columns, row = i / grid.columns;
    if (column == 0) left = edge + shift;
    PanelView& panel = view.panels[i];
    panel.area.left = left + grid.column_margins[column].left;
    panel.area.top = top + grid.row_margins[row].top;
    place_around_area(panel, *figure.panels()[i]);
    left += grid.column_margins[column].left + grid.column_widths[column] +
            grid.column_margins[column].right + between;
    if (column + 1 == grid.columns || i + 1 == view.panels.size())
      top += grid.row_margins[row].top + grid.row_heights[row] + grid.row_margins[row].bottom;
  }
  view.height = std::ceil(top + edge - 4.0);
  return view;
}

}  // namespace repose::report

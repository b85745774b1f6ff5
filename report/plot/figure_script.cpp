#include "report/plot/figure_script.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>

#include <fmt/core.h>

#include "report/plot/figure_layout.hpp"
#include "report/plot/gnuplot.hpp"

namespace repose::report {

namespace {

constexpr std::string_view ink = "#262626", soft_ink = "#555555", frame = "#404040",
                           grid = "#e4e4e4";

constexpr double tick_lift = 0.4;  // of the numbers below an axis, in lines: gnuplot's stand low

// Viridis (Smith & van der Walt 2015, CC0) at 17 even steps; uniform in lightness, safe for every
// kind of colour blindness and in grey.
constexpr std::array<std::string_view, 17> viridis{
    "#440154", "#48186a", "#472d7b", "#424086", "#3b528b", "#33638d",
    "#2c728e", "#26818e", "#21908c", "#1f9f88", "#28ae80", "#3ebc74",
    "#5dc963", "#82d34c", "#abdc32", "#d5e21a", "#fde725"};

std::string_view hex(Colour colour) {
  switch (colour) {
    case Colour::automatic:
      break;
    case Colour::blue:
      return "#0072b2";
    case Colour::vermillion:
      return "#d55e00";
    case Colour::green:
      return "#009e73";
    case Colour::purple:
      return "#cc79a7";
    case Colour::orange:
      return "#e69f00";
    case Colour::sky:
      return "#56b4e9";
    case Colour::black:
      return "#000000";
    case Colour::grey:
      return "#8c8c8c";
  }
  return "#000000";
}

/// gnuplot's number of a marker in its SVG terminal.
int point_type(Marker marker) {
  switch (marker) {
    case Marker::plus:
      return 1;
    case Marker::cross:
      return 2;
    case Marker::open_square:
      return 4;
    case Marker::square:
      return 5;
    case Marker::ring:
      return 6;
    case Marker::circle:
      return 7;
    case Marker::open_triangle:
      return 8;
    case Marker::triangle:
      return 9;
    case Marker::open_diamond:
      return 12;
    case Marker::diamond:
      return 13;
  }
  return 7;
}

/// gnuplot draws size 1 with a radius of 3/8 of the terminal's letters.
double point_size(double diameter_px) { return 0.5 * diameter_px / (0.375 * text_px); }

std::string number(double value) { return fmt::format("{:.9g}", value); }

/// 12345 with a thin space between thousands.
std::string grouped(std::size_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, " ");
  return digits;
}

/// A well-mixed value of an index (splitmix64; Steele, Lea & Flood 2014).
std::uint64_t mixed(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// Which of n points are drawn: all up to the limit; beyond it one from each of `limit` equal
/// stretches, at a place within it that looks random, so that points stored in an order (by cell)
/// leave no pattern.
std::vector<std::size_t> kept_points(std::size_t n, std::size_t limit) {
  const std::size_t count = std::min(n, limit);
  std::vector<std::size_t> kept(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t begin = k * n / count, end = (k + 1) * n / count;
    kept[k] = begin + mixed(k) % (end - begin);
  }
  return kept;
}

/// The lines of a data block and what was left out of it.
struct Block {
  std::string text;
  std::size_t left_out = 0, drawn = 0, thinned_from = 0;
};

/// A value as gnuplot gets it: itself, or its place on the axis.
double handed(double value, const AxisView& axis) {
  return axis.by_fraction ? axis.fraction(value) : value;
}

Block block_of(const Series& series, const Axes& axes, const PanelView& panel) {
  const bool cloud = series.kind == SeriesKind::points || series.kind == SeriesKind::scatter;
  const std::size_t n = series.x.size();
  const std::vector<std::size_t> kept = kept_points(n, cloud ? Figure::point_limit : n);
  Block block;
  if (kept.size() < n) block.thinned_from = n;
  auto out = std::back_inserter(block.text);
  bool broken = true;
  for (const std::size_t i : kept) {
    const bool good = drawable(series.x[i], axes.x.scale) && drawable(series.y[i], axes.y.scale) &&
                      (series.upper.empty() || drawable(series.upper[i], axes.y.scale));
    if (!good) {
      ++block.left_out;
      if (!cloud && !broken) block.text += '\n';  // an empty line breaks a curve
      broken = true;
      continue;
    }
    broken = false;
    ++block.drawn;
    fmt::format_to(out, "{:.9g} {:.9g}", handed(series.x[i], panel.x),
                   handed(series.y[i], panel.y));
    if (!series.upper.empty()) fmt::format_to(out, " {:.9g}", handed(series.upper[i], panel.y));
    if (series.kind == SeriesKind::shade)
      fmt::format_to(out, " {}", series.value[i]);
    else if (!series.value.empty())
      fmt::format_to(out, " {:.9g}", handed(series.value[i], *panel.colours));
    block.text += '\n';
  }
  return block;
}

/// Pixels from the upper left corner as gnuplot's screen coordinates.
class Screen {
 public:
  Screen(double width, double height) : width_(width), height_(height) {}
  std::string x(double px) const { return fmt::format("{:.6f}", px / width_); }
  std::string y(double px) const { return fmt::format("{:.6f}", 1.0 - px / height_); }
  std::string wide(double px) const { return fmt::format("{:.6f}", px / width_); }
  std::string high(double px) const { return fmt::format("{:.6f}", px / height_); }
  std::string at(double px, double py) const {
    return fmt::format("screen {}, screen {}", x(px), y(py));
  }

 private:
  double width_, height_;
};

std::string tick_list(const AxisView& axis) {
  std::string list;
  for (const Tick& tick : axis.ticks) {
    if (!list.empty()) list += ", ";
    list += gnuplot_text(tick.label) + " " + number(handed(tick.value, axis)) +
            (tick.minor ? " 1" : " 0");
  }
  return "(" + list + ")";
}

void write_axis(std::string& out, std::string_view name, const AxisView& axis) {
  if (axis.scale == AxisScale::logarithmic && !axis.by_fraction)
    out += fmt::format("set logscale {}\n", name);
  out += fmt::format("set {}range [{}:{}] noextend\n", name, number(handed(axis.lower, axis)),
                     number(handed(axis.upper, axis)));
  out += fmt::format("set {}tics out nomirror scale 0.5,0.3 offset 0,{} textcolor rgb '{}' {}\n",
                     name, name == "x" ? tick_lift : 0.0, ink, tick_list(axis));
}

void write_colour_bar(std::string& out, const PanelView& panel, const Screen& screen) {
  const AxisView& colours = *panel.colours;
  if (colours.scale == AxisScale::logarithmic && !colours.by_fraction) out += "set logscale cb\n";
  out += fmt::format("set cbrange [{}:{}]\n", number(handed(colours.lower, colours)),
                     number(handed(colours.upper, colours)));
  out += fmt::format("set cbtics out nomirror scale 0.4,0.2 offset 0,{} textcolor rgb '{}' {}\n",
                     panel.bar_below ? tick_lift : 0.0, ink, tick_list(colours));
  out += fmt::format(
      "set colorbox {} user origin screen {}, screen {} size screen {}, screen {} noborder\n",
      panel.bar_below ? "horizontal" : "vertical", screen.x(panel.bar.left),
      screen.y(panel.bar.top + panel.bar.height), screen.wide(panel.bar.width),
      screen.high(panel.bar.height));
}

/// gnuplot takes its letters for wider than they are; this many of them are taken back.
double legend_correction(std::size_t letters) { return -0.2 * static_cast<double>(letters); }

void write_legend(std::string& out, const PanelView& panel, const Screen& screen) {
  if (!panel.legend) {
    out += "unset key\n";
    return;
  }
  out += fmt::format(
      "set key at {} left top Left reverse samplen 2.2 spacing 1.25 width {:.2f} textcolor rgb "
      "'{}' opaque fillcolor rgb '#30ffffff'\n",
      screen.at(panel.legend->left + 6.0, panel.legend->top + 6.0),
      legend_correction(panel.legend_letters), ink);
}

void write_label(std::string& out, const std::string& text, Spot middle, bool upright,
                 const Screen& screen) {
  if (text.empty()) return;
  out += fmt::format("set label {} at {} center {} textcolor rgb '{}'\n", gnuplot_text(text),
                     screen.at(middle.x, middle.y), upright ? "rotate by 90" : "norotate", ink);
}

/// Of a marker, whose size is given in pixels or as a length on the x-axis.
double diameter_px(const Series& series, double px, const std::optional<double>& length,
                   const PanelView& panel) {
  if (!length && series.kind != SeriesKind::scatter) return px;
  const double diameter =
      length ? *length * panel.area.width / (panel.x.upper - panel.x.lower) : px;
  // Fewer points, each covering more: the cloud keeps its density on paper.
  return diameter * std::sqrt(std::max(1.0, static_cast<double>(series.x.size()) /
                                                static_cast<double>(Figure::point_limit)));
}

/// A line of one point is drawn as that point.
std::string drawn_as(const Series& series, const PanelView& panel, std::string_view colour,
                     bool one_point) {
  const Style& style = series.style;
  const auto markers = [&](Marker otherwise) {
    return fmt::format("pt {} ps {:.3f}", point_type(style.marker.value_or(otherwise)),
                       point_size(diameter_px(series, style.marker_px, style.diameter, panel)));
  };
  switch (series.kind) {
    case SeriesKind::band:
      return fmt::format(
          "using 1:2:3 with filledcurves fs transparent solid 0.22 noborder fc rgb '{}'", colour);
    case SeriesKind::area:
      return fmt::format(
          "using 1:2 with filledcurves closed fs transparent solid 0.22 noborder fc rgb '{}'",
          colour);
    case SeriesKind::points:
      return fmt::format("using 1:2 with points {} lc rgb '{}'", markers(Marker::circle), colour);
    case SeriesKind::scatter:
      break;
    case SeriesKind::shade:
      return "using 1:2:3:3:3 with rgbimage";
    case SeriesKind::line:
    case SeriesKind::dashed: {
      const std::string line = fmt::format("lw {:.2f} lc rgb '{}'{}", style.width_px, colour,
                                           series.kind == SeriesKind::dashed ? " dt (7,4)" : "");
      if (one_point)
        return fmt::format("using 1:2 with points {} lc rgb '{}'", markers(Marker::circle), colour);
      return style.marker
                 ? fmt::format("using 1:2 with linespoints {} {}", line, markers(Marker::circle))
                 : "using 1:2 with lines " + line;
    }
  }
  const ScatterStyle& cloud = series.scatter_style;
  return fmt::format("using 1:2:3 with points pt 7 ps {:.3f} lc palette",
                     point_size(diameter_px(series, cloud.marker_px, cloud.diameter, panel)));
}

/// Small dots have a sample in the legend that shows their colour.
std::string legend_sample(const Series& series, const PanelView& panel, std::string_view colour) {
  constexpr double least = 7.0;
  const Style& style = series.style;
  if (series.kind != SeriesKind::points || !style.diameter ||
      diameter_px(series, style.marker_px, style.diameter, panel) >= least)
    return "";
  return fmt::format("NaN with points pt {} ps {:.3f} lc rgb '{}' title {}, ",
                     point_type(style.marker.value_or(Marker::circle)), point_size(least), colour,
                     gnuplot_text(series.name));
}

/// Arrows and the labels at places.
void write_arrows(std::string& out, const Axes& axes, const PanelView& panel) {
  for (const Arrow& arrow : axes.arrows()) {
    const std::string from_x = number(handed(arrow.from_x, panel.x)),
                      from_y = number(handed(arrow.from_y, panel.y)),
                      to_x = number(handed(arrow.to_x, panel.x)),
                      to_y = number(handed(arrow.to_y, panel.y));
    out += fmt::format(
        "set arrow from {}, {} to {}, {} head filled size screen 0.012,18 front lw 1.6 lc rgb "
        "'{}'\n",
        from_x, from_y, to_x, to_y, ink);
    out += fmt::format(
        "set label {} at {}, {} right offset character -0.8,-0.3 front textcolor rgb '{}'\n",
        gnuplot_text(arrow.label), from_x, from_y, ink);
  }
  constexpr double near_the_end = 0.75;
  for (const Label& label : axes.labels()) {
    const bool left = panel.x.fraction(label.x) > near_the_end;
    out += fmt::format(
        "set label {} at {}, {} {} offset character {},0 front boxed textcolor rgb '{}'\n",
        gnuplot_text(label.text), number(handed(label.x, panel.x)),
        number(handed(label.y, panel.y)), left ? "right" : "left", left ? -1.2 : 1.2, ink);
  }
}

/// A panel's data blocks and its plot command. blocks: one for each series.
void write_panel(std::string& out, const Axes& axes, const PanelView& panel,
                 const std::vector<Block>& blocks, const Screen& screen) {
  const Rect& area = panel.area;
  out += fmt::format("set lmargin at screen {}\nset rmargin at screen {}\n", screen.x(area.left),
                     screen.x(area.left + area.width));
  out += fmt::format("set tmargin at screen {}\nset bmargin at screen {}\n", screen.y(area.top),
                     screen.y(area.top + area.height));
  write_axis(out, "x", panel.x);
  write_axis(out, "y", panel.y);
  if (panel.colours) write_colour_bar(out, panel, screen);
  write_legend(out, panel, screen);
  write_arrows(out, axes, panel);
  write_label(out, panel.x.label, panel.x_label, false, screen);
  write_label(out, panel.y.label, panel.y_label, true, screen);
  if (panel.colours)
    write_label(out, panel.colours->label, panel.bar_label, !panel.bar_below, screen);
  if (!axes.title.empty())
    out += fmt::format("set label {} at {} left textcolor rgb '{}' font ',{}'\n",
                       gnuplot_text(axes.title, true), screen.at(area.left, area.top - 16.0), ink,
                       panel_title_px);

  std::array<std::string, 3> layers;  // shades, bands, and everything else upon them
  std::size_t automatic = 0;
  for (std::size_t i = 0; i < axes.series().size(); ++i) {
    const Series& series = axes.series()[i];
    const bool uses_cycle = series.style.colour == Colour::automatic &&
                            series.kind != SeriesKind::scatter && series.kind != SeriesKind::shade;
    const Colour colour = uses_cycle ? cycle_colour(automatic++) : series.style.colour;
    if (blocks[i].drawn == 0) continue;
    out += fmt::format("$d{} << END_OF_DATA\n{}END_OF_DATA\n", i, blocks[i].text);
    std::string& layer =
        layers[series.kind == SeriesKind::shade                                     ? 0
               : series.kind == SeriesKind::band || series.kind == SeriesKind::area ? 1
                                                                                    : 2];
    const std::string sample = series.name.empty() ? "" : legend_sample(series, panel, hex(colour));
    layer += fmt::format(
        "$d{} {} {}, {}", i, drawn_as(series, panel, hex(colour), blocks[i].drawn == 1),
        series.name.empty() || !sample.empty() ? "notitle" : "title " + gnuplot_text(series.name),
        sample);
  }
  const std::string plots = layers[0] + layers[1] + layers[2];
  // A panel without any data still shows its axes.
  out += "plot " + (plots.empty() ? "NaN notitle" : plots.substr(0, plots.size() - 2)) + "\n";
}

void write_head(std::string& out, const FigureView& view) {
  out += "set encoding utf8\n";
  out += fmt::format(
      "set terminal svg size {:.0f},{:.0f} dynamic enhanced font 'sans-serif,{:.0f}' background "
      "'#ffffff'\n",
      view.width, view.height, text_px);
  out += "set palette maxcolors 256\nset palette defined (";
  for (std::size_t i = 0; i < viridis.size(); ++i)
    out += fmt::format("{}{} '{}'", i == 0 ? "" : ", ", i, viridis[i]);
  out += ")\n";
  out += fmt::format("set border 3 lw 1 lc rgb '{}'\n", frame);
  out += fmt::format("set grid xtics ytics back lt 1 lw 1 lc rgb '{}'\n", grid);
  out += "set style textbox opaque noborder margins 0.3,0.3 fillcolor rgb '#ffffff'\n";
  out += "set clip two\nset multiplot\n";
}

/// Title and subtitle, as labels of the panel that is drawn next.
void write_title(std::string& out, const FigureView& view, const Screen& screen) {
  double y = edge - 2.0;
  const auto write = [&](const std::string& line, bool bold, double size, std::string_view colour) {
    out += fmt::format("set label {} at {} left textcolor rgb '{}' font ',{}'\n",
                       gnuplot_text(line, bold), screen.at(edge, y + 0.5 * size * line_height),
                       colour, size);
    y += size * line_height;
  };
  for (const std::string& line : view.title_lines) write(line, true, title_px, ink);
  for (const std::string& line : view.subtitle_lines) write(line, false, text_px, soft_ink);
}

/// What the reader must know about data that are not drawn.
std::vector<std::string> notes_on(const std::vector<std::vector<Block>>& blocks) {
  std::vector<std::string> notes;
  std::size_t left_out = 0;
  for (const auto& panel : blocks)
    for (const Block& block : panel) {
      left_out += block.left_out;
      if (block.thinned_from > 0)
        notes.push_back(fmt::format("{} of {} points shown", grouped(Figure::point_limit),
                                    grouped(block.thinned_from)));
    }
  if (left_out > 0)
    notes.push_back(
        fmt::format("{} {} cannot be drawn (not finite, or not positive on a "
                    "logarithmic axis)",
                    grouped(left_out), left_out == 1 ? "value" : "values"));
  return notes;
}

}  // namespace

std::string figure_script(const Figure& figure) {
  FigureView view = lay_out(figure, {});
  std::vector<std::vector<Block>> blocks;
  for (std::size_t i = 0; i < view.panels.size(); ++i) {
    const Axes& axes = *figure.panels()[i];
    std::vector<Block>& panel = blocks.emplace_back();
    for (const Series& series : axes.series())
      panel.push_back(block_of(series, axes, view.panels[i]));
  }
  if (const auto notes = notes_on(blocks); !notes.empty()) view = lay_out(figure, notes);
  const Screen screen(view.width, view.height);

  std::string out;
  write_head(out, view);
  for (std::size_t i = 0; i < view.panels.size(); ++i) {
    out += "unset logscale\nunset arrow\nunset label\nunset colorbox\n";
    if (i == 0) write_title(out, view, screen);
    write_panel(out, *figure.panels()[i], view.panels[i], blocks[i], screen);
  }
  return out + "unset multiplot\n";
}

}  // namespace repose::report

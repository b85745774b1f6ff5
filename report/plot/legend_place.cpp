#include "report/plot/legend_place.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace repose::report {

namespace {

/// How large a legend is, its distance from the frame included.
struct LegendSize {
  double width = 0.0, height = 0.0;
  std::size_t letters = 0;
};

LegendSize legend_size(const Axes& axes) {
  LegendSize size;
  for (const Series& series : axes.series()) {
    if (series.name.empty()) continue;
    size.letters = std::max(size.letters, letters_in(series.name));
    size.width = std::max(size.width, text_width(series.name, text_px));
    size.height += 1.25 * text_px * line_height;
  }
  if (size.height > 0.0) {
    size.width += 62.0;  // the sample of the line, and white on both sides
    size.height += 14.0;
  }
  return size;
}

/// Finds a place for the legend that covers nothing drawn.
class FreePlace {
 public:
  /// width, height: of the legend, as parts of the plotting area.
  FreePlace(const PanelView& panel, double width, double height)
      : panel_(panel),
        width_(width),
        height_(height) {}

  void add(const Series& series) {
    if (series.kind == SeriesKind::shade) return;
    const bool connected = series.kind != SeriesKind::points && series.kind != SeriesKind::scatter;
    add_curve(series.x, series.y, connected);
    if (series.kind == SeriesKind::band) {
      add_curve(series.x, series.upper, true);
      for (std::size_t i = 0; i < series.x.size(); ++i)  // nor upon the tint in between
        add_curve({series.x[i], series.x[i]}, {series.y[i], series.upper[i]}, true);
    }
  }

  /// The legend's lower left corner; absent if there is no free place. Corners are tried first.
  std::optional<Spot> find() const {
    if (width_ > 1.0 || height_ > 1.0) return std::nullopt;
    for (const double v : {1.0, 0.0, 0.5, 0.75, 0.25})
      for (const double u : {1.0, 0.0, 0.5, 0.75, 0.25}) {
        const Spot corner{u * (1.0 - width_), v * (1.0 - height_)};
        if (free(corner)) return corner;
      }
    return std::nullopt;
  }

 private:
  /// Lines are followed between their points in steps that no legend can slip through.
  void add_curve(const std::vector<double>& xs, const std::vector<double>& ys, bool connected) {
    Spot last{std::nan(""), std::nan("")};
    for (std::size_t i = 0; i < xs.size(); ++i) {
      const Spot next{panel_.x.fraction(xs[i]), panel_.y.fraction(ys[i])};
      const bool drawn = std::isfinite(next.x) && std::isfinite(next.y);
      if (drawn && connected && std::isfinite(last.x)) {
        const double length = std::max(std::abs(next.x - last.x), std::abs(next.y - last.y));
        const int steps = static_cast<int>(std::clamp(length / 0.02, 1.0, 200.0));
        for (int k = 1; k < steps; ++k) {
          const double t = static_cast<double>(k) / steps;
          mark({last.x + t * (next.x - last.x), last.y + t * (next.y - last.y)});
        }
      }
      if (drawn) mark(next);
      last = drawn ? next : Spot{std::nan(""), std::nan("")};
    }
  }

  /// Remembers the cell of a coarse raster, whose size does not grow with the data.
  void mark(Spot spot) {
    if (spot.x < 0.0 || spot.x > 1.0 || spot.y < 0.0 || spot.y > 1.0) return;
    const auto cell = [](double fraction) {
      return std::min(static_cast<std::size_t>(fraction * cells), cells - 1);
    };
    taken_[cell(spot.y) * cells + cell(spot.x)] = true;
  }

  bool free(Spot corner) const {
    const auto from = [](double fraction) {
      return static_cast<std::size_t>(std::floor(std::max(0.0, fraction) * cells));
    };
    const auto to = [](double fraction) {
      return std::min(static_cast<std::size_t>(std::ceil(fraction * cells)), cells);
    };
    for (std::size_t j = from(corner.y); j < to(corner.y + height_); ++j)
      for (std::size_t i = from(corner.x); i < to(corner.x + width_); ++i)
        if (taken_[j * cells + i]) return false;
    return true;
  }

  static constexpr std::size_t cells = 64;
  const PanelView& panel_;
  double width_, height_;
  std::array<bool, cells * cells> taken_{};
};

/// Where in the plotting area the legend goes, lower left corner, as parts of the area; absent for
/// beside it.
std::optional<Spot> legend_corner(const Axes& axes, const PanelView& panel, LegendSize size) {
  const double width = size.width / panel.area.width, height = size.height / panel.area.height;
  switch (axes.legend) {
    case Legend::top_left:
      return Spot{0.0, 1.0 - height};
    case Legend::top_right:
      return Spot{1.0 - width, 1.0 - height};
    case Legend::bottom_left:
      return Spot{0.0, 0.0};
    case Legend::bottom_right:
      return Spot{1.0 - width, 0.0};
    case Legend::right:
    case Legend::none:
      return std::nullopt;
    case Legend::best:
      break;
  }
  FreePlace place(panel, width, height);
  for (const Series& series : axes.series()) place.add(series);
  return place.find();
}

}  // namespace

void place_legend(PanelView& panel, const Axes& axes) {
  const LegendSize size = legend_size(axes);
  if (size.height == 0.0 || axes.legend == Legend::none) return;
  panel.legend_letters = size.letters;
  const Rect& area = panel.area;
  const std::optional<Spot> corner = legend_corner(axes, panel, size);
  panel.legend_beside = !corner;
  panel.legend = corner
                     ? Rect{corner->x * area.width, area.height * (1.0 - corner->y) - size.height,
                            size.width, size.height}
                     : Rect{area.width + 6.0, 0.0, size.width, size.height};
}

}  // namespace repose::report

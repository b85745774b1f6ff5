#include "report/plot/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "io/atomic_file.hpp"
#include "report/plot/figure_script.hpp"
#include "report/plot/gnuplot.hpp"
#include "report/plot/svg_tidy.hpp"

namespace repose::report {

namespace {

std::vector<double> copy(std::span<const double> values) { return {values.begin(), values.end()}; }

void check_sizes(std::size_t expected, std::initializer_list<std::size_t> sizes,
                 std::string_view name) {
  for (const std::size_t size : sizes)
    if (size != expected)
      throw std::invalid_argument(
          fmt::format("figure: series '{}' has arrays of {} and {} values", name, expected, size));
}

}  // namespace

Colour cycle_colour(std::size_t k) {
  constexpr std::array order{Colour::blue,   Colour::vermillion, Colour::green, Colour::purple,
                             Colour::orange, Colour::sky,        Colour::black};
  return order[k % order.size()];
}

Axes& Axes::add(SeriesKind kind, std::string name, std::span<const double> xs,
                std::span<const double> ys, Style style) {
  check_sizes(xs.size(), {ys.size()}, name);
  Series series;
  series.kind = kind;
  series.name = std::move(name);
  series.style = style;
  series.x = copy(xs);
  series.y = copy(ys);
  series_.push_back(std::move(series));
  return *this;
}

Axes& Axes::line(std::string name, std::span<const double> xs, std::span<const double> ys,
                 Style style) {
  return add(SeriesKind::line, std::move(name), xs, ys, style);
}

Axes& Axes::dashed(std::string name, std::span<const double> xs, std::span<const double> ys,
                   Style style) {
  return add(SeriesKind::dashed, std::move(name), xs, ys, style);
}

Axes& Axes::points(std::string name, std::span<const double> xs, std::span<const double> ys,
                   Style style) {
  return add(SeriesKind::points, std::move(name), xs, ys, style);
}

Axes& Axes::band(std::string name, std::span<const double> xs, std::span<const double> lower,
                 std::span<const double> upper, Style style) {
  check_sizes(xs.size(), {lower.size(), upper.size()}, name);
  add(SeriesKind::band, std::move(name), xs, lower, style);
  series_.back().upper = copy(upper);
  return *this;
}

Axes& Axes::area(std::string name, std::span<const double> xs, std::span<const double> ys,
                 Style style) {
  return add(SeriesKind::area, std::move(name), xs, ys, style);
}

Axes& Axes::scatter(std::span<const double> xs, std::span<const double> ys,
                    std::span<const double> values, Axis colours, ScatterStyle style) {
  if (colours_) throw std::logic_error("figure: a panel has one colour scale only");
  check_sizes(xs.size(), {ys.size(), values.size()}, colours.label);
  Series good, bad;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool drawable =
        std::isfinite(values[i]) && (colours.scale == AxisScale::linear || values[i] > 0.0);
    Series& target = drawable ? good : bad;
    target.x.push_back(xs[i]);
    target.y.push_back(ys[i]);
    if (drawable) target.value.push_back(values[i]);
  }
  good.kind = SeriesKind::scatter;
  good.scatter_style = style;
  colours_ = std::move(colours);
  series_.push_back(std::move(good));
  if (bad.x.empty()) return *this;
  Style crosses;
  crosses.colour = Colour::vermillion;
  crosses.marker = Marker::cross;
  return points(fmt::format("without a value: {}", bad.x.size()), bad.x, bad.y, crosses);
}

Axes& Axes::shade(std::span<const double> xs, std::span<const double> ys,
                  std::span<const double> greys) {
  check_sizes(xs.size(), {ys.size(), greys.size()}, "shade");
  add(SeriesKind::shade, "", xs, ys, {});
  for (const double grey : greys)
    series_.back().value.push_back(std::round(255.0 * std::clamp(grey, 0.0, 1.0)));
  return *this;
}

Axes& Axes::arrow(Arrow arrow) {
  arrows_.push_back(std::move(arrow));
  return *this;
}

Axes& Axes::label(Label label) {
  labels_.push_back(std::move(label));
  return *this;
}

Figure::Figure(std::string figure_title, std::string figure_subtitle)
    : title(std::move(figure_title)),
      subtitle(std::move(figure_subtitle)) {}

Axes& Figure::add_axes() { return *panels_.emplace_back(std::make_unique<Axes>()); }

std::string Figure::svg() const { return tidy_svg(run_gnuplot(figure_script(*this)), title); }

void Figure::render_svg(const std::filesystem::path& path) const {
  io::write_atomically(path, svg());
}

}  // namespace repose::report

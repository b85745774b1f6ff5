#include "report/picture/validation_picture.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace repose::report {
namespace {

using input::BenchmarkFigure;
using study::FigureResult;

/// "depth (m)" of "depth_m": the longest end that is a unit.
std::string axis_label(const std::string& column) {
  for (const auto& [end, unit] : {std::pair{"_kg_per_m3", "kg/m³"},
                                  {"_J_per_m", "J/m"},
                                  {"_m_per_s", "m/s"},
                                  {"_per_s", "1/s"},
                                  {"_Pa", "Pa"},
                                  {"_deg", "°"},
                                  {"_m", "m"},
                                  {"_s", "s"}})
    if (column.ends_with(end))
      return fmt::format("{} ({})", column.substr(0, column.size() - std::string(end).size()),
                         unit);
  return column;
}

/// Laws have the same colour in every panel.
Style law_style(std::size_t column) {
  constexpr std::size_t colours = 7;
  Style style{cycle_colour(column % colours)};
  if (column >= colours) style.width_px = 1.0;
  return style;
}

void curve_panel(Axes& axes, const study::CaseResult& result, std::size_t k, bool named) {
  const BenchmarkFigure& figure = result.benchmark.figures[k];
  axes.x.label = axis_label(figure.x);
  axes.y.label = axis_label(figure.y);
  for (std::size_t column = 0; column < result.laws.size(); ++column) {
    const study::PlainCurve& curve = result.laws[column].figures[k].curve;
    if (curve.x.empty()) continue;
    axes.line(named ? std::string(input::benchmark_columns[column]) : "", curve.x, curve.y,
              law_style(column));
  }
  axes.points(named ? "measured" : "", figure.table_x, figure.table_y,
              {Colour::black, 1.0, Marker::ring, 5.0});
}

/// The laws that have a number lie one above the other; the band runs from bottom to top.
void number_panel(Axes& axes, const study::CaseResult& result, std::size_t k, bool named) {
  const BenchmarkFigure& figure = result.benchmark.figures[k];
  std::vector<std::size_t> columns;
  for (std::size_t column = 0; column < result.laws.size(); ++column)
    if (std::isfinite(result.laws[column].figures[k].estimated.value)) columns.push_back(column);
  axes.x.label = fmt::format("{} ({})", figure.name, figure.unit);
  axes.y.label = "laws, the first on top";
  const double top = static_cast<double>(columns.size()) + 1.0;
  axes.y.lower = 0.0;
  axes.y.upper = top;
  const std::vector<double> zero{0.0, 0.0}, full{top, top}, height{0.0, top};
  axes.band(named ? "band" : "", figure.band, zero, full, {Colour::grey});
  const std::vector<double> measured{figure.measured, figure.measured};
  axes.dashed(named ? "measured" : "", measured, height, {Colour::black, 1.2});
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const study::Estimated& found = result.laws[columns[i]].figures[k].estimated;
    const double at = static_cast<double>(columns.size() - i);
    Style style = law_style(columns[i]);
    const double bar = std::isfinite(found.error) ? found.error : 0.0;
    const std::vector<double> ends{found.value - bar, found.value + bar}, level{at, at};
    axes.line("", ends, level, style);
    style.marker = Marker::circle;
    axes.points(named ? std::string(input::benchmark_columns[columns[i]]) : "",
                std::vector<double>{found.value}, std::vector<double>{at}, style);
  }
}

}  // namespace

Figure validation_picture(const study::CaseResult& result) {
  const input::Benchmark& benchmark = result.benchmark;
  std::size_t values = 0;
  for (const study::LawResult& law : result.laws)
    for (const FigureResult& figure : law.figures)
      values += std::isfinite(figure.estimated.value) ? 1 : 0;
  if (values == 0) throw std::logic_error("no law has a figure in this case");
  Figure picture(benchmark.title,
                 benchmark.is_scene()
                     ? "curves at the finest cells that were run; numbers with their error bars"
                     : "");
  picture.columns = benchmark.figures.size() == 1 ? 1 : 2;
  bool curves_are_named = false, numbers_are_named = false;
  for (std::size_t k = 0; k < benchmark.figures.size(); ++k) {
    Axes& axes = picture.add_axes();
    axes.title = benchmark.figures[k].title;
    const bool is_curve = benchmark.figures[k].is_curve();
    bool& named = is_curve ? curves_are_named : numbers_are_named;
    (is_curve ? curve_panel : number_panel)(axes, result, k, !named);
    if (!named) axes.legend = Legend::right;
    named = true;
  }
  return picture;
}

}  // namespace repose::report

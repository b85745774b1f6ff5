#include "study/validation/figure_values.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "study/point/laboratory_record.hpp"
#include "study/run/run_record.hpp"
#include "study/validation/layer_curves.hpp"

namespace repose::study {
namespace {

using input::BenchmarkCurve;
using input::BenchmarkFigure;
using input::BenchmarkTake;

double taken(const std::vector<double>& values, BenchmarkTake take) {
  if (values.empty()) throw NoFigure("the column has no rows");
  switch (take) {
    case BenchmarkTake::largest:
      return *std::max_element(values.begin(), values.end());
    case BenchmarkTake::least:
      return *std::min_element(values.begin(), values.end());
    case BenchmarkTake::last:
      break;
  }
  return values.back();
}

/// Errors: NoFigure with the nearest of the names that there are.
[[noreturn]] void refuse_name(const std::string& name, const std::vector<std::string>& names) {
  const std::string near = input::closest(name, {names.begin(), names.end()});
  throw NoFigure(fmt::format("there is no '{}' in the result{}", name,
                             near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
}

/// Where a profile, followed from its first point, is first less deep than `depth`, on the straight
/// line between its points.
double front_at(const PlainCurve& profile, double depth) {
  for (std::size_t i = 0; i < profile.x.size(); ++i) {
    if (profile.y[i] >= depth) continue;
    if (i == 0) return profile.x[0];
    const double share = (profile.y[i - 1] - depth) / (profile.y[i - 1] - profile.y[i]);
    return profile.x[i - 1] + share * (profile.x[i] - profile.x[i - 1]);
  }
  throw NoFigure(fmt::format("it is at least {:.4g} m deep as far as the wall", depth));
}

double number_of(const BenchmarkFigure& figure, const SweepRun& run) {
  if (figure.value == input::front_at) return front_at({run.x_m, run.depth_m}, figure.depth);
  if (const std::vector<double>& column = run.column(figure.value); !column.empty())
    return taken(column, figure.take);
  if (const double x = run.figure(figure.value); !std::isnan(x)) return x;
  std::vector<std::string> names;
  for (const auto& [name, values] : run.series) names.push_back(name);
  for (const auto& [name, x] : run.summary.figures) names.push_back(name);
  refuse_name(figure.value, names);
}

/// What a number is divided by. column: its own; empty where it is none.
double divisor(const BenchmarkFigure& figure, const std::vector<double>& column) {
  if (!figure.over_start) return figure.over;
  if (column.empty())
    throw NoFigure(
        fmt::format("over = \"start\": '{}' is no column, which has a start", figure.value));
  if (column.front() == 0.0) throw NoFigure(fmt::format("{} starts from 0", figure.value));
  return column.front();
}

std::vector<double> series_column(const SweepRun& run, const std::string& name) {
  if (const std::vector<double>& column = run.column(name); !column.empty()) return column;
  std::vector<std::string> names;
  for (const auto& [known, values] : run.series) names.push_back(known);
  refuse_name(name, names);
}

PlainCurve scene_curve(const BenchmarkFigure& figure, const SweepRun& run,
                       const std::filesystem::path& folder) {
  const mpm::Scene& scene = run.scene();
  const std::filesystem::path frames = folder / "frames" / (scene.name + ".hdf.series");
  switch (*figure.curve) {
    case BenchmarkCurve::series:
      return {series_column(run, figure.x), series_column(run, figure.y)};
    case BenchmarkCurve::rest_line:
      return rest_line(read_run_frames(frames), scene.h, scene.domain[0], figure.threshold);
    case BenchmarkCurve::column:
      return column_means(read_run_frames(frames).last, scene.h, figure.y);
    case BenchmarkCurve::profile:
    case BenchmarkCurve::point:
      break;
  }
  return {run.x_m, run.depth_m};
}

/// The rows of the figure's stage, with the state that it begins from; all of them if it names
/// none.
std::vector<bool> rows_wanted(const BenchmarkFigure& figure, const input::PointTestFile& test,
                              const TestResult& result) {
  const std::vector<point::Path::Place> places = test.test.path.places();
  std::vector<bool> wanted(result.curve.rows.size(), !figure.stage);
  for (std::size_t row = 0; figure.stage && row < wanted.size(); ++row)
    if (places[static_cast<std::size_t>(result.curve.rows[row].leg)].stage == *figure.stage) {
      wanted[row] = true;
      if (row > 0) wanted[row - 1] = true;
    }
  return wanted;
}

std::optional<std::vector<double>> test_column(const std::string& name,
                                               const BenchmarkFigure& figure,
                                               const input::PointTestFile& test,
                                               const TestResult& result) {
  const auto quantity = point::find_quantity(name);
  if (!quantity) return {};
  const std::vector<double> all = columns_of(test, result, {&*quantity, 1}).front();
  const std::vector<bool> wanted = rows_wanted(figure, test, result);
  std::vector<double> values;
  for (std::size_t row = 0; row < all.size(); ++row)
    if (wanted[row]) values.push_back(all[row]);
  if (values.empty()) throw NoFigure("the test has no such stage");
  return values;
}

}  // namespace

double scene_value(const BenchmarkFigure& figure, const SweepRun& run,
                   const std::filesystem::path& folder, PlainCurve& curve) {
  if (!figure.is_curve())
    return (number_of(figure, run) - figure.minus) / divisor(figure, run.column(figure.value));
  curve = scene_curve(figure, run, folder);
  return distance(curve, figure);
}

double test_value(const BenchmarkFigure& figure, const input::PointTestFile& test,
                  const TestResult& result, PlainCurve& curve) {
  if (result.failed() || result.curve.rows.empty()) throw NoFigure(result.reason);
  if (figure.is_curve()) {
    curve = {*test_column(figure.x, figure, test, result),
             *test_column(figure.y, figure, test, result)};
    return distance(curve, figure);
  }
  const auto shown = [&](double x, const std::vector<double>& column) {
    return (x - figure.minus) / divisor(figure, column);
  };
  if (const auto values = test_column(figure.value, figure, test, result))
    return shown(taken(*values, figure.take), *values);
  const io::Json laboratory = laboratory_json(result.figures);
  const io::Json* const found = laboratory.find(figure.value);
  if (found != nullptr && found->is_number()) return shown(found->get<double>(), {});
  std::vector<std::string> names;
  for (std::size_t k = 0; k < point::quantity_count; ++k)
    names.emplace_back(point::column_name(static_cast<point::Quantity>(k)));
  for (const io::Json::Member& member : laboratory.items()) names.push_back(member.key);
  refuse_name(figure.value, names);
}

input::PointTestFile refined(input::PointTestFile test) {
  constexpr double by = 100.0, least = 1e-12;
  constexpr int most_substeps = 1'000'000;
  point::Settings& settings = test.test.settings;
  if (point::method_for(find_law(test.law), settings.method) == point::Method::implicit)
    settings.substeps = std::min(4 * settings.substeps, most_substeps);
  else
    settings.tolerance *= settings.tolerance < by * least ? by : 1.0 / by;
  return test;
}

}  // namespace repose::study

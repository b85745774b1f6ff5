#include "study/point/test_result.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/compile.h>
#include <fmt/format.h>

#include "study/run/run_record.hpp"

namespace repose::study {

TestResult drive(const input::PointTestFile& file) {
  TestResult result;
  result.law = &find_law(file.law);
  result.theta = checked_parameters(file.law);
  const double begun = usage().wall_s;
  point::PointTest test = file.test;
  test.settings.check_tangent = true;
  point::simulate(*result.law, result.theta, test, result.curve);
  result.wall_s = usage().wall_s - begun;
  result.reason = point::explain(*result.law, result.theta, file.test, result.curve);
  result.figures = point::laboratory_figures(*result.law, result.theta, file.test, result.curve,
                                             file.secants_at);
  return result;
}

std::vector<std::string> remarks(const input::PointTestFile& file, const TestResult& result) {
  std::vector<std::string> found;
  if (const point::Counts& counts = result.curve.outcome.counts;
      100 * counts.tangents_off >
      counts.tangents_checked)  // one step across yield is none of its fault
    found.push_back(fmt::format(
        "the tangent that {} returns (DDSDDE) is off by more than 10 % from differences of its "
        "stress in {} of {} steps ({:.3g} %)",
        result.law->name, counts.tangents_off, counts.tangents_checked,
        100.0 * static_cast<double>(counts.tangents_off) /
            static_cast<double>(counts.tangents_checked)));
  if (point::variable_index(*result.law, "I") < 0 || result.curve.rows.empty()) return found;
  const auto columns = columns_of(
      file, result, std::array{point::Quantity::I, point::Quantity::p, point::Quantity::q});
  double fastest = 0.0, steepest = 0.0;
  for (std::size_t row = 0; row < result.curve.rows.size(); ++row) {
    if (std::isfinite(columns[0][row])) fastest = std::max(fastest, columns[0][row]);
    if (columns[1][row] > 0.0)
      steepest = std::max(steepest, std::abs(columns[2][row]) / columns[1][row]);
  }
  // grains have I_v of 0.3 to 1; a smaller one by decades is that of a clay
  const int i = point::parameter_index(result.law->parameters, "I_v");
  const double I_v = i < 0 ? std::nan("") : result.theta[static_cast<std::size_t>(i)];
  if (I_v < 1e-3 && fastest > 0.05 * I_v)
    found.push_back(fmt::format(
        "I reaches {:.2g} of I_v: at constant volume the pressure of so fast a clay grows like the "
        "square of its rate; up to 0.05 the effect is one of some per cent",
        fastest / I_v));
  if (steepest > 3.0)
    found.push_back(fmt::format(
        "q/p reaches {:.3g}: above 3 a principal stress is tension. A jump of the rate at constant "
        "pressure does that, until dilation has caught up",
        steepest));
  return found;
}

StageColumns stage_columns(const point::Path& path) {
  const std::vector<point::Path::Place> places = path.places();
  const bool cycles =
      std::any_of(places.begin(), places.end(), [](const auto& at) { return at.cycle > 0; });
  return {cycles || places.back().stage > 1, cycles};
}

std::vector<std::vector<double>> columns_of(const input::PointTestFile& file,
                                            const TestResult& result,
                                            std::span<const point::Quantity> quantities) {
  std::vector<std::vector<double>> columns;
  for (const point::Quantity q : quantities)
    point::read_column(*result.law, result.theta, file.test, result.curve, q,
                       columns.emplace_back());
  return columns;
}

std::string curve_csv(const input::PointTestFile& file, const TestResult& result) {
  std::string text;
  const std::vector<point::Quantity> quantities = point::columns_of(*result.law, file.test);
  for (const point::Quantity q : quantities)
    text += (text.empty() ? "" : ",") + std::string(point::column_name(q));
  const std::vector<std::vector<double>> columns = columns_of(file, result, quantities);
  const auto [stage, cycle] = stage_columns(file.test.path);
  if (stage) text += ",stage";
  if (cycle) text += ",cycle";
  text += "\n";
  const std::vector<point::Path::Place> places = file.test.path.places();
  const auto out = std::back_inserter(text);
  for (std::size_t row = 0; row < result.curve.rows.size(); ++row) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) text += ',';
      fmt::format_to(out, FMT_COMPILE("{}"), columns[i][row] + 0.0);
    }
    const point::Path::Place at = places[static_cast<std::size_t>(result.curve.rows[row].leg)];
    if (stage) fmt::format_to(out, ",{}", at.stage);
    if (cycle) fmt::format_to(out, ",{}", at.cycle);
    text += '\n';
  }
  return text;
}

}  // namespace repose::study

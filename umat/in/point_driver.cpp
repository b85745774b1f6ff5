#include "umat/in/point_driver.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "pointdriver/integrate/drive.hpp"
#include "pointdriver/integrate/plain_rows.hpp"
#include "umat/in/point_law.hpp"

namespace repose::umat {
namespace {

/// A density for points whose density nobody has asked for and nothing depends on.
constexpr double any_density = 1.0;

}  // namespace

point::Method PointDriver::method_for(point::Method method) const {
  return point::chosen_method<PointLaw>(method);
}

std::vector<double> PointDriver::start(std::span<const double> theta,
                                       const point::PointTest& test) const {
  const InitialPoint point = initial_point(description_, theta, test.initial);
  std::vector<double> numbers(theta.begin(), theta.end());
  numbers.insert(numbers.end(), point.stress.c.begin(), point.stress.c.end());
  numbers.insert(numbers.end(), point.state.begin(), point.state.end());
  numbers.push_back(std::isnan(point.density) ? any_density : point.density);
  return numbers;
}

point::Outcome PointDriver::drive(std::span<const double> numbers, const point::PointTest& test,
                                  point::Curve& curve) const {
  const std::size_t n = info_.parameters.size();
  Session session(description_, numbers, test.settings.check_tangent);
  point::ElementStart<PointLaw, double> start;
  start.parameters = {
      &session, description_.has_grain_density ? numbers[session.layout().rho_p()] : std::nan("")};
  start.plain = start.parameters;
  std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(n), 6 + info_.state.size(),
              start.stress_and_state.begin());
  start.density = numbers.back();
  curve.said.clear();
  point::drive_path<PointLaw, double>(start, test.path, test.settings, curve);
  point::Outcome& outcome = curve.outcome;
  outcome.counts.tangents_checked = session.tangents_checked;
  outcome.counts.tangents_off = session.tangents_off;
  if (outcome.status == point::Status::not_converged && session.wants_less()) {
    outcome.status = point::Status::law_failed;
    curve.said = fmt::format("{}: it asked for ever smaller increments (PNEWDT < 1)",
                             description_.library.file.string());
    outcome.fault = word(Fault::not_converged);
  } else if (outcome.status == point::Status::law_failed && session.failure()) {
    curve.said = session.failure()->what();
    outcome.fault = word(session.failure()->fault());
  }
  return outcome;
}

point::Outcome PointDriver::drive(std::span<const double> numbers, std::span<const double> slopes,
                                  const point::PointTest& test, point::Curve& curve,
                                  std::vector<point::Curve>& slope_curves) const {
  const point::Outcome outcome = drive(numbers, test, curve);
  point::PointTest plain = test;
  plain.settings.check_tangent = false;
  point::slopes_by_differences(
      numbers, slopes, slope_step, curve,
      [&](std::span<const double> there, point::Curve& to) { return drive(there, plain, to); },
      slope_curves);
  return outcome;
}

}  // namespace repose::umat

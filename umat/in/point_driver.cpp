#include "umat/in/point_driver.hpp"

#include <algorithm>
#include <cmath>

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
  if (outcome.status == point::Status::law_failed && session.failure()) {
    curve.said = session.failure()->what();
    outcome.fault = word(session.failure()->fault());
  }
  return outcome;
}

point::Outcome PointDriver::drive(std::span<const double> numbers, std::span<const double> slopes,
                                  const point::PointTest& test, point::Curve& curve,
                                  std::vector<point::Curve>& slope_curves) const {
  const point::Outcome outcome = drive(numbers, test, curve);
  slope_curves.resize(slope_width);
  const std::size_t n = numbers.size();
  point::PointTest plain = test;
  plain.settings.check_tangent = false;
  std::vector<double> moved(n);
  point::Curve above, below;
  for (std::size_t k = 0; k < slope_width; ++k) {
    std::vector<point::Row<double>>& rows = slope_curves[k].rows;
    rows.assign(curve.rows.size(), {});
    const std::span<const double> slope = slopes.subspan(k * n, n);
    // so far along the slope that no number moves by more than slope_step of itself
    double h = std::numeric_limits<double>::infinity();
    bool any = false;
    for (std::size_t i = 0; i < n; ++i) {
      if (slope[i] == 0.0 || !std::isfinite(numbers[i])) continue;
      any = true;
      if (numbers[i] != 0.0) h = std::min(h, slope_step * std::abs(numbers[i] / slope[i]));
    }
    if (!any) continue;
    if (std::isinf(h)) h = slope_step;
    const auto along = [&](double step, point::Curve& to) {
      for (std::size_t i = 0; i < n; ++i)
        moved[i] = slope[i] == 0.0 ? numbers[i] : numbers[i] + step * slope[i];
      drive(moved, plain, to);
      // the last row of a path that broke off is none of the others' rows
      const bool whole = !point::is_failure(to.outcome.status);
      return whole || to.rows.empty() ? to.rows.size() : to.rows.size() - 1;
    };
    const std::size_t reached_above = along(h, above), reached_below = along(-h, below);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const bool has_above = r < reached_above, has_below = r < reached_below;
      if (!has_above && !has_below) break;
      const point::Row<double>& up = has_above ? above.rows[r] : curve.rows[r];
      point::Row<double> down = has_below ? below.rows[r] : curve.rows[r];
      const double width = (has_above && has_below ? 2.0 : 1.0) * h;
      rows[r] = up;
      point::for_each_number(rows[r], down, [&](double& x, double& y) { x = (x - y) / width; });
    }
  }
  return outcome;
}

}  // namespace repose::umat

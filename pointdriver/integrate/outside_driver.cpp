#include "pointdriver/integrate/outside_driver.hpp"

#include <cmath>

#include "pointdriver/integrate/plain_rows.hpp"

namespace repose::point {

OutsideDriver::~OutsideDriver() = default;

void slopes_by_differences(std::span<const double> numbers, std::span<const double> slopes,
                           double step, const Curve& curve,
                           const std::function<Outcome(std::span<const double>, Curve&)>& drive,
                           std::vector<Curve>& slope_curves) {
  const std::size_t n = numbers.size();
  slope_curves.resize(OutsideDriver::slope_width);
  std::vector<double> moved(n);
  Curve above, below;
  for (std::size_t k = 0; k < OutsideDriver::slope_width; ++k) {
    std::vector<Row<double>>& rows = slope_curves[k].rows;
    rows.assign(curve.rows.size(), {});
    const std::span<const double> slope = slopes.subspan(k * n, n);
    double h = HUGE_VAL;
    bool any = false;
    for (std::size_t i = 0; i < n; ++i) {
      if (slope[i] == 0.0 || !std::isfinite(numbers[i])) continue;
      any = true;
      if (numbers[i] != 0.0) h = std::min(h, step * std::abs(numbers[i] / slope[i]));
    }
    if (!any) continue;
    if (h == HUGE_VAL) h = step;
    const auto along = [&](double way, Curve& to) {
      for (std::size_t i = 0; i < n; ++i)
        moved[i] = slope[i] == 0.0 ? numbers[i] : numbers[i] + way * slope[i];
      drive(moved, to);
      // the last row of a path that broke off is none of the others' rows
      const bool whole = !is_failure(to.outcome.status);
      return whole || to.rows.empty() ? to.rows.size() : to.rows.size() - 1;
    };
    const std::size_t reached_above = along(h, above), reached_below = along(-h, below);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const bool has_above = r < reached_above, has_below = r < reached_below;
      if (!has_above && !has_below) break;
      const Row<double>& up = has_above ? above.rows[r] : curve.rows[r];
      Row<double> down = has_below ? below.rows[r] : curve.rows[r];
      const double width = (has_above && has_below ? 2.0 : 1.0) * h;
      rows[r] = up;
      for_each_number(rows[r], down, [&](double& x, double& y) { x = (x - y) / width; });
    }
  }
}

const OutsideDriver& outside_driver(const LawInfo& law) {
  const OutsideLaw* const outside = find_outside(law);
  const auto* const driver =
      outside == nullptr ? nullptr : dynamic_cast<const OutsideDriver*>(outside->point.get());
  if (driver == nullptr)
    throw InputError("name", "the law \"" + std::string(law.name) +
                                 "\" was registered without a point driver: register it with "
                                 "repose::point::register_law (integrate/register_law.hpp)");
  return *driver;
}

}  // namespace repose::point

#pragma once
/// \file
/// The point driver of a law that another program has registered: everything goes through plain
/// numbers, so that the law may be compiled for another instruction set than the library.

#include <functional>

#include "models/registry.hpp"
#include "pointdriver/integrate/simulate.hpp"

namespace repose::point {

/// register_law.hpp makes one of a law's type.
class OutsideDriver : public OutsideExtension {
 public:
  /// Derivatives carried at a time.
  static constexpr std::size_t slope_width = 6;

  ~OutsideDriver() override;

  /// What chosen_method() says of the law (drive.hpp).
  virtual Method method_for(Method method) const = 0;
  /// What a path starts from, in one row: the completed parameters, stress (6) and state, density.
  /// Throws InputError where the law cannot start.
  virtual std::vector<double> start(std::span<const double> theta, const PointTest& test) const = 0;
  /// Drives the path from the numbers that start() gave.
  virtual Outcome drive(std::span<const double> numbers, const PointTest& test,
                        Curve& curve) const = 0;
  /// The same with derivatives: slopes[k * numbers.size() + i] is that of number i, and
  /// slope_curves[k].rows[r] holds those of the fields of curve.rows[r], k < slope_width.
  virtual Outcome drive(std::span<const double> numbers, std::span<const double> slopes,
                        const PointTest& test, Curve& curve,
                        std::vector<Curve>& slope_curves) const = 0;
};

/// The slopes of OutsideDriver::drive() by central differences, for a law that takes no dual
/// numbers: along each of them so far that no number moves by more than `step` of itself. `curve`
/// is what drive(numbers, …) has given. Where one side cannot be driven as far as the other,
/// one-sided; where neither can, 0.
void slopes_by_differences(std::span<const double> numbers, std::span<const double> slopes,
                           double step, const Curve& curve,
                           const std::function<Outcome(std::span<const double>, Curve&)>& drive,
                           std::vector<Curve>& slope_curves);

/// Throws InputError (key "name") for a law that is unknown, or registered without a point driver.
const OutsideDriver& outside_driver(const LawInfo& law);

}  // namespace repose::point

#pragma once
/// \file
/// The point driver of a foreign UMAT: the library's own update under mixed control, Newton's
/// method on its DDSDDE.

#include "pointdriver/integrate/outside_driver.hpp"
#include "umat/in/library_law.hpp"

namespace repose::umat {

class PointDriver final : public point::OutsideDriver {
 public:
  PointDriver(const LawInfo& info, const Description& description)
      : info_(info),
        description_(description) {}

  /// Its own update for `automatic` and `adaptive`: it has no rate form.
  point::Method method_for(point::Method method) const override;
  std::vector<double> start(std::span<const double> theta,
                            const point::PointTest& test) const override;
  point::Outcome drive(std::span<const double> numbers, const point::PointTest& test,
                       point::Curve& curve) const override;
  /// By central differences over slope_step of the numbers, for there are no dual numbers in a
  /// foreign library: two paths for each slope that is not 0. One-sided where a side cannot be
  /// driven.
  point::Outcome drive(std::span<const double> numbers, std::span<const double> slopes,
                       const point::PointTest& test, point::Curve& curve,
                       std::vector<point::Curve>& slope_curves) const override;

  /// Relative. A path is met to 1e-8 at worst (control_enough), so that the noise of a difference
  /// is 1e-5 of the answer and the cut-off error 1e-6 of its third derivative.
  static constexpr double slope_step = 1e-3;

 private:
  const LawInfo& info_;
  const Description& description_;
};

}  // namespace repose::umat

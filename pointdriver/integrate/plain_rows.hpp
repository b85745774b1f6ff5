#pragma once
/// \file
/// Rows of a curve in dual numbers as rows of plain ones: the values, and a curve for each
/// derivative. The memory of a dual number depends on the instruction set, that of these does not.

#include "models/dual.hpp"
#include "pointdriver/path/curve.hpp"

namespace repose::point {

/// Calls f(field of a, field of b) for every field that has derivatives.
template <class A, class B, class F>
void for_each_number(Row<A>& a, Row<B>& b, F&& f) {
  f(a.time, b.time);
  for (std::size_t i = 0; i < 6; ++i) {
    f(a.strain.c[i], b.strain.c[i]);
    f(a.stress.c[i], b.stress.c[i]);
    f(a.strain_rate.c[i], b.strain_rate.c[i]);
  }
  for (std::size_t i = 0; i < max_state; ++i) f(a.state[i], b.state[i]);
  f(a.density, b.density);
  f(a.work, b.work);
  f(a.stored, b.stored);
  f(a.dissipated, b.dissipated);
  f(a.hypoelastic, b.hypoelastic);
}

/// values and slopes[k], k < n, of a curve.
template <int n>
void split(BasicCurve<Dual<n>>& curve, Curve& values, std::vector<Curve>& slopes) {
  const std::size_t rows = curve.rows.size();
  values.rows.assign(rows, {});
  values.outcome = curve.outcome;
  slopes.resize(static_cast<std::size_t>(n));
  for (std::size_t r = 0; r < rows; ++r) {
    for_each_number(curve.rows[r], values.rows[r],
                    [](const Dual<n>& x, double& value) { value = x.a; });
    values.rows[r].residual = curve.rows[r].residual;
    values.rows[r].leg = curve.rows[r].leg;
  }
  for (int k = 0; k < n; ++k) {
    std::vector<Row<double>>& slope = slopes[static_cast<std::size_t>(k)].rows;
    slope.assign(rows, {});
    for (std::size_t r = 0; r < rows; ++r)
      for_each_number(curve.rows[r], slope[r],
                      [k](const Dual<n>& x, double& derivative) { derivative = x.v[k]; });
  }
}

/// The curve again, of which the first n derivatives are taken.
template <int n>
void join(Curve& values, std::vector<Curve>& slopes, BasicCurve<Dual<n>>& curve) {
  const std::size_t rows = values.rows.size();
  curve.rows.assign(rows, {});
  curve.outcome = values.outcome;
  for (std::size_t r = 0; r < rows; ++r) {
    for_each_number(curve.rows[r], values.rows[r],
                    [](Dual<n>& x, const double& value) { x = Dual<n>(value); });
    curve.rows[r].residual = values.rows[r].residual;
    curve.rows[r].leg = values.rows[r].leg;
    for (int k = 0; k < n; ++k)
      for_each_number(curve.rows[r], slopes[static_cast<std::size_t>(k)].rows[r],
                      [k](Dual<n>& x, const double& derivative) { x.v[k] = derivative; });
  }
}

}  // namespace repose::point

#pragma once
/// \file
/// B-spline interpolation functions on a grid whose nodes lie on the walls.
///
/// SIMD along the stencil: the four lanes of a Row are the four nodes of one stencil row, so
/// weights of one point in one direction are a single polynomial evaluated on four coefficient
/// sets. Steffen, Kirby & Berzins (2008); the affine moment D of Jiang et al. (2015).

#include <cmath>

#include <xsimd/xsimd.hpp>

namespace repose::mpm {

/// Four doubles: one row of a stencil.
using Row = xsimd::make_sized_batch<double, 4>::type;

/// Nodes in the widest stencil row; the quadratic kernel leaves the last with weight 0.
constexpr int stencil_width = 4;

/// Weights of one point in one direction: node k of the stencil has weight w[k] and lies at the
/// offset d[k]·h from the point.
struct Weights {
  int base;  ///< index of the stencil's first node
  Row w;
  Row d;  ///< (x_k − x_p)/h
};

namespace detail {
inline Row polynomial(const Row& t, const Row& c0, const Row& c1, const Row& c2, const Row& c3) {
  return xsimd::fma(t, xsimd::fma(t, xsimd::fma(t, c3, c2), c1), c0);
}
inline Row offsets(const Row& t) { return Row({-1.0, 0.0, 1.0, 2.0}) - t; }
}  // namespace detail

/// Cubic B-spline: nodes cell − 1 … cell + 2.
struct CubicKernel {
  static constexpr int rows = 4;
  static constexpr double inverse_moment = 3.0;  ///< Σ w d² = 1/3

  static Weights at(double xi) {
    const double cell = std::floor(xi);
    const Row t(xi - cell);
    const double s = 1.0 / 6.0;
    return {static_cast<int>(cell) - 1,
            detail::polynomial(t, Row({s, 4 * s, s, 0.0}), Row({-3 * s, 0.0, 3 * s, 0.0}),
                               Row({3 * s, -6 * s, 3 * s, 0.0}), Row({-s, 3 * s, -3 * s, s})),
            detail::offsets(t)};
  }
};

/// Quadratic B-spline: the nearest node and its two neighbours.
struct QuadraticKernel {
  static constexpr int rows = 3;
  static constexpr double inverse_moment = 4.0;  ///< Σ w d² = 1/4

  static Weights at(double xi) {
    const double nearest = std::floor(xi + 0.5);
    const Row t(xi - nearest);
    return {static_cast<int>(nearest) - 1,
            detail::polynomial(t, Row({0.125, 0.75, 0.125, 0.0}), Row({-0.5, 0.0, 0.5, 0.0}),
                               Row({0.5, -1.0, 0.5, 0.0}), Row(0.0)),
            detail::offsets(t)};
  }
};

}  // namespace repose::mpm

#pragma once
/// \file
/// B-spline interpolation functions on a grid whose nodes lie on the walls. Steffen, Kirby &
/// Berzins (2008); the affine moment D of Jiang et al. (2015).
///
/// A point at ξ (in units of h) has a stencil of four nodes per direction, of which the second is
/// its anchor; with t = ξ − anchor, node k lies at the offset (k − 1) − t. Weights come in two
/// shapes: of_point(t_x, t_y) gives those of one point, the lanes of a row being the nodes;
/// weights(t) gives those of a whole Pack of points in one direction, one Pack per node.

#include <array>
#include <cmath>

#include "mpm/grid/lanes.hpp"

namespace repose::mpm {

/// Where a velocity gradient comes from, and with it the force, its adjoint: the first moment,
///   D⁻¹ Σ w v_i (x_i − x_p)ᵀ  and  −Σ w V D⁻¹ σ (x_i − x_p),  or the spline's own gradient,
///   Σ v_i (∇w_i)ᵀ             and  −Σ V σ ∇w_i  (SplineGradient below).
/// A kernel says which it is (spline_gradient), and by how much a sum over distances in units of h,
/// or over derivatives in units of 1/h, is scaled (gradient_scale/h).

/// Nodes in the widest stencil row; the quadratic kernel leaves the last with weight 0.
constexpr int stencil_width = 4;

/// Weights of one point: node k of a direction has weight w[k] and lies at the offset d[k]·h.
struct Weights {
  RowPair w;
  RowPair d;  ///< (x_k − x_p)/h
};

namespace detail {
/// Σ c_n tⁿ in every lane.
inline RowPair polynomial(const RowPair& t, const RowPair& c0, const RowPair& c1, const RowPair& c2,
                          const RowPair& c3) {
  return fma(t, fma(t, fma(t, c3, c2), c1), c0);
}
inline RowPair offsets(const RowPair& t) { return RowPair(-1.0, 0.0, 1.0, 2.0) - t; }
}  // namespace detail

/// Cubic B-spline: nodes cell − 1 … cell + 2.
struct CubicKernel {
  static constexpr int rows = 4;
  static constexpr double inverse_moment = 3.0;  ///< Σ w d² = 1/3
  static constexpr bool spline_gradient = false;
  static constexpr double gradient_scale = inverse_moment;
  static constexpr double anchor_offset = 0.0;

  /// The node at or below the point.
  template <class T>
  static T anchor(const T& xi) {
    using std::floor;
    return floor(xi);
  }

  template <class T>
  static std::array<T, 4> weights(const T& t) {
    const T sixth(1.0 / 6.0);
    const T u = T(1.0) - t;
    const T t2 = t * t;
    const T u2 = u * u;
    const T w0 = sixth * u2 * u;
    const T w3 = sixth * t2 * t;
    const T w1 = T(2.0 / 3.0) - t2 + T(3.0) * w3;
    const T w2 = T(2.0 / 3.0) - u2 + T(3.0) * w0;
    return {w0, w1, w2, w3};
  }

  /// dw/dξ.
  template <class T>
  static std::array<T, 4> slopes(const T& t) {
    const T half(0.5), two(2.0), three_halves(1.5);
    const T u = T(1.0) - t;
    return {-half * u * u, t * (three_halves * t - two), u * (two - three_halves * u),
            half * t * t};
  }

  static Weights of_point(double t_x, double t_y) {
    const RowPair t(t_x, t_y);
    const double s = 1.0 / 6.0;
    return {detail::polynomial(t, {s, 4 * s, s, 0.0}, {-3 * s, 0.0, 3 * s, 0.0},
                               {3 * s, -6 * s, 3 * s, 0.0}, {-s, 3 * s, -3 * s, s}),
            detail::offsets(t)};
  }
  static RowPair slopes_of_point(double t_x, double t_y) {
    return detail::polynomial(RowPair(t_x, t_y), {-0.5, 0.0, 0.5, 0.0}, {1.0, -2.0, 1.0, 0.0},
                              {-0.5, 1.5, -1.5, 0.5}, {0.0, 0.0, 0.0, 0.0});
  }
};

/// Quadratic B-spline: the nearest node and its two neighbours.
struct QuadraticKernel {
  static constexpr int rows = 3;
  static constexpr double inverse_moment = 4.0;  ///< Σ w d² = 1/4
  static constexpr bool spline_gradient = false;
  static constexpr double gradient_scale = inverse_moment;
  static constexpr double anchor_offset = 0.5;

  /// The nearest node.
  template <class T>
  static T anchor(const T& xi) {
    using std::floor;
    return floor(xi + T(anchor_offset));
  }

  template <class T>
  static std::array<T, 4> weights(const T& t) {
    const T half(0.5);
    const T before = half - t;
    const T behind = half + t;
    return {half * before * before, T(0.75) - t * t, half * behind * behind, T(0.0)};
  }

  /// dw/dξ.
  template <class T>
  static std::array<T, 4> slopes(const T& t) {
    return {t - T(0.5), T(-2.0) * t, t + T(0.5), T(0.0)};
  }

  static Weights of_point(double t_x, double t_y) {
    const RowPair t(t_x, t_y);
    return {detail::polynomial(t, {0.125, 0.75, 0.125, 0.0}, {-0.5, 0.0, 0.5, 0.0},
                               {0.5, -1.0, 0.5, 0.0}, {0.0, 0.0, 0.0, 0.0}),
            detail::offsets(t)};
  }
  static RowPair slopes_of_point(double t_x, double t_y) {
    return detail::polynomial(RowPair(t_x, t_y), {-0.5, 0.0, 0.5, 0.0}, {1.0, -2.0, 1.0, 0.0},
                              {0.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0});
  }
};

/// The same functions with velocity gradient and force by their own gradient instead of the first
/// moment.
template <class Kernel>
struct SplineGradient : Kernel {
  static constexpr bool spline_gradient = true;
  static constexpr double gradient_scale = 1.0;
};

}  // namespace repose::mpm

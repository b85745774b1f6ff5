#pragma once
/// \file
/// The transfers written as their formulas stand in a paper: one point at a time, nodes in a map,
/// no blocks, tiles or lanes. Slow, and independent of the solver it checks.

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "mpm/scene/scene.hpp"

namespace repose::mpm::reference {

using Vector = std::array<double, 2>;
using Matrix = std::array<std::array<double, 2>, 2>;  ///< [row][column]

/// What a point hands to the grid; L and stress need no symmetry.
struct Particle {
  Vector x{}, v{};
  Matrix L{}, stress{};
  double mass = 0.0, volume = 0.0;
  Vector body_force{};  ///< per mass
};

/// The same seen in a mirror: positions by R, vectors by S (both diagonal, ±1) about `origin`.
inline Particle image(const Particle& p, const Vector& R, const Vector& S, const Vector& origin) {
  Particle q = p;
  for (std::size_t i = 0; i < 2; ++i) {
    q.x[i] = origin[i] + R[i] * (p.x[i] - origin[i]);
    q.v[i] = S[i] * p.v[i];
    q.body_force[i] = S[i] * p.body_force[i];
    for (std::size_t j = 0; j < 2; ++j) {
      q.L[i][j] = S[i] * p.L[i][j] * R[j];
      q.stress[i][j] = S[i] * p.stress[i][j] * R[j];
    }
  }
  return q;
}

struct Node {
  double m = 0.0;
  Vector momentum{}, force{};
  Vector before{}, velocity{};  ///< before and after forces; for gather()
};

class Grid {
 public:
  /// With `spline_gradient`, forces and velocity gradients are by ∇w instead of w D⁻¹ d.
  Grid(double h, Kernel kernel, bool spline_gradient = false)
      : h_(h),
        kernel_(kernel),
        spline_gradient_(spline_gradient) {}

  /// m_i += w m, p_i += w m (v + L d), f_i += w (m b − V D⁻¹ σ d),  d = x_i − x
  void scatter(const Particle& p) {
    for_each_weight(p.x, [&](Node& node, double w, const Vector& d, const Vector& g) {
      node.m += w * p.mass;
      for (std::size_t i = 0; i < 2; ++i) {
        node.momentum[i] += w * p.mass * (p.v[i] + p.L[i][0] * d[0] + p.L[i][1] * d[1]);
        node.force[i] += w * p.mass * p.body_force[i] -
                         p.volume * (p.stress[i][0] * g[0] + p.stress[i][1] * g[1]);
      }
    });
  }

  /// v_i = (p_i + Δt f_i)/m_i
  void advance(double dt) {
    for (auto& [place, node] : nodes)
      for (std::size_t i = 0; i < 2; ++i) {
        node.before[i] = node.m > 0.0 ? node.momentum[i] / node.m : 0.0;
        node.velocity[i] = node.m > 0.0 ? (node.momentum[i] + dt * node.force[i]) / node.m : 0.0;
      }
  }

  /// v = Σ w v_i, L = D⁻¹ Σ w v_i dᵀ
  void gather(const Vector& x, Vector& v, Matrix& L, Vector Node::*field = &Node::velocity) {
    v = {};
    L = {};
    for_each_weight(x, [&](const Node& node, double w, const Vector&, const Vector& g) {
      for (std::size_t i = 0; i < 2; ++i) {
        v[i] += w * (node.*field)[i];
        for (std::size_t j = 0; j < 2; ++j) L[i][j] += (node.*field)[i] * g[j];
      }
    });
  }

  double moment() const { return h_ * h_ / (kernel_ == Kernel::cubic ? 3.0 : 4.0); }

  std::map<std::pair<int, int>, Node> nodes;

 private:
  /// dw/dx times h of a point at −d h from its node.
  double slope(double d) const {
    const double r = std::abs(d);
    double dw_dr = 0.0;
    if (kernel_ == Kernel::cubic)
      dw_dr = r < 1.0 ? (1.5 * r - 2.0) * r : r < 2.0 ? -0.5 * (2.0 - r) * (2.0 - r) : 0.0;
    else
      dw_dr = r < 0.5 ? -2.0 * r : r < 1.5 ? r - 1.5 : 0.0;
    return d > 0.0 ? -dw_dr : dw_dr;
  }

  double weight(double d) const {
    const double r = std::abs(d);
    if (kernel_ == Kernel::cubic) {
      if (r < 1.0) return 2.0 / 3.0 - r * r + 0.5 * r * r * r;
      return r < 2.0 ? (2.0 - r) * (2.0 - r) * (2.0 - r) / 6.0 : 0.0;
    }
    if (r < 0.5) return 0.75 - r * r;
    return r < 1.5 ? 0.5 * (1.5 - r) * (1.5 - r) : 0.0;
  }

  template <class F>
  void for_each_weight(const Vector& x, F&& f) {
    const int i0 = static_cast<int>(std::floor(x[0] / h_));
    const int j0 = static_cast<int>(std::floor(x[1] / h_));
    for (int j = j0 - 1; j <= j0 + 2; ++j)
      for (int i = i0 - 1; i <= i0 + 2; ++i) {
        const double wx = weight(i - x[0] / h_);
        const double wy = weight(j - x[1] / h_);
        const double w = wx * wy;
        if (!(w > 0.0)) continue;
        const Vector d{i * h_ - x[0], j * h_ - x[1]};
        const Vector by_moment{w * d[0] / moment(), w * d[1] / moment()};
        const Vector by_spline{slope(i - x[0] / h_) * wy / h_, wx * slope(j - x[1] / h_) / h_};
        f(nodes[{i, j}], w, d, spline_gradient_ ? by_spline : by_moment);
      }
  }

  double h_;
  Kernel kernel_;
  bool spline_gradient_;
};

}  // namespace repose::mpm::reference

#pragma once
/// \file
/// The generalised vortex (Kamojjala, Brannon, Sadeghirad & Guilkey 2015): every circle of a ring
/// turns as one, by the angle α(R, t) = A sin(πt/T) h(R), h = (1 − 16(R − 1)²)² for 0.75 < R
/// < 1.25, so that its edges neither move nor feel a traction.
///
/// With γ = Rα′ (′ = ∂/∂R) and the basis turned by α, F = I + γ e_θ⊗e_r, J = 1. Neo-Hookean:
/// σ = μ(FFᵀ − I): σ_rθ = μγ, σ_θθ = μγ², σ_rr = 0. The radius stays, r = R, hence in polar
/// coordinates (div σ)_r = −σ_θθ/r, (div σ)_θ = r⁻² ∂(r²σ_rθ)/∂r, and b = a − div σ/ρ is
///   b_r = −Rα̇² + (μ/ρ)Rα′²,   b_θ = Rα̈ − (μ/ρ)(3α′ + Rα″).
/// The moment of the elastic part of b_θ is 0 over the ring, whose edges are free, but not over the
/// points: their lattice meets the edges in steps, where R²α″ jumps from 0 to 128 A R². Nothing
/// holds a ring that turns freely, so that a moment of 0.02 N m/m has turned it by 0.002 rad at t =
/// T, 1 % of A. run() takes that moment off the load, as an angular acceleration.

#include <cmath>
#include <numbers>

#include "mpm/step/simulation.hpp"
#include "tests/mpm/manufactured_block.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {

struct GeneralisedVortex {
  double A = 0.2, T = 1.0, E = 1000.0, nu = 0.3, rho_0 = 1000.0;
  std::array<double, 2> centre{1.5, 1.5};

  double excess = 0.0;  ///< angular acceleration over sin(πt/T) that is taken off the load [1/s²]

  double mu() const { return 0.5 * E / (1.0 + nu); }

  struct Angle {
    double at, rate, second_rate, slope, curvature, slope_rate;
  };
  Angle angle(double R, double t) const {
    const double d = R - 1.0;
    const double inside = std::abs(d) < 0.25 ? 1.0 : 0.0;
    const double q = 1.0 - 16.0 * d * d;
    const double h = inside * q * q, dh = inside * -64.0 * d * q;
    const double d2h = inside * (-64.0 * q + 2048.0 * d * d);
    const double w = std::numbers::pi / T;
    const double g = A * std::sin(w * t), dg = A * w * std::cos(w * t);
    return {g * h, dg * h, -w * w * g * h, g * dh, g * d2h, dg * dh};
  }

  struct Polar {
    double R, e[2];  ///< radius and radial direction of a place at the start
  };
  Polar polar(double X, double Y) const {
    const double x = X - centre[0], y = Y - centre[1], R = std::hypot(x, y);
    return {R, {x / R, y / R}};
  }
  /// Radial and circumferential direction after turning by α.
  static std::array<std::array<double, 2>, 2> turned(const Polar& p, double alpha) {
    const double c = std::cos(alpha), s = std::sin(alpha);
    const std::array<double, 2> r{c * p.e[0] - s * p.e[1], s * p.e[0] + c * p.e[1]};
    return {r, {-r[1], r[0]}};
  }
  std::array<double, 2> place(double X, double Y, double t) const {
    const Polar p = polar(X, Y);
    const auto e = turned(p, angle(p.R, t).at);
    return {centre[0] + p.R * e[0][0], centre[1] + p.R * e[0][1]};
  }
  std::array<double, 2> velocity(double X, double Y, double t) const {
    const Polar p = polar(X, Y);
    const Angle a = angle(p.R, t);
    const auto e = turned(p, a.at);
    return {p.R * a.rate * e[1][0], p.R * a.rate * e[1][1]};
  }
  std::array<double, 2> acceleration(double X, double Y, double t) const {
    const Polar p = polar(X, Y);
    const Angle a = angle(p.R, t);
    const auto e = turned(p, a.at);
    const double b_r = -p.R * a.rate * a.rate + mu() / rho_0 * p.R * a.slope * a.slope;
    const double b_t = p.R * a.second_rate - mu() / rho_0 * (3.0 * a.slope + p.R * a.curvature) -
                       excess * std::sin(std::numbers::pi * t / T) * p.R;
    return {b_r * e[0][0] + b_t * e[1][0], b_r * e[0][1] + b_t * e[1][1]};
  }
  /// σ_xx, σ_yy, σ_xy
  std::array<double, 3> stress(double X, double Y, double t) const {
    const Polar p = polar(X, Y);
    const Angle a = angle(p.R, t);
    const auto e = turned(p, a.at);
    const double rt = mu() * p.R * a.slope, tt = mu() * std::pow(p.R * a.slope, 2);
    const auto component = [&](std::size_t i, std::size_t j) {
      return rt * (e[0][i] * e[1][j] + e[1][i] * e[0][j]) + tt * e[1][i] * e[1][j];
    };
    return {component(0, 0), component(1, 1), component(0, 1)};
  }

  Prescribed prescribed() const {
    Prescribed p;
    p.start = [*this](double X, double Y) {
      const std::array<double, 2> v = velocity(X, Y, 0.0);
      const Polar at = polar(X, Y);
      const Angle a = angle(at.R, 0.0);  // α = 0: the basis is that of the start
      const double x = at.e[0], y = at.e[1], shear = at.R * a.slope_rate;
      // v = ω(R) e_z × (X − centre): ω e_z × I + Rω′ e_θ ⊗ e_r
      return PointMotion{
          v, {-y * x * shear, -a.rate - y * y * shear, a.rate + x * x * shear, x * y * shear}};
    };
    p.acceleration = [*this](double t, std::span<const double> X, std::span<const double> Y,
                             std::span<double> ax, std::span<double> ay) {
      for (std::size_t k = 0; k < X.size(); ++k) {
        const std::array<double, 2> b = acceleration(X[k], Y[k], t);
        ax[k] += b[0];
        ay[k] += b[1];
      }
    };
    return p;
  }

  /// n cells per metre, over the ring of 0.5 m in a box of 3 m.
  Scene scene(int n, Kernel kernel, Transfer transfer) const {
    Scene s = empty_box(3.0, 3.0, 1.0 / n);
    Body ring = block(0, 0, 1, 1, neo_hookean(E, nu, rho_0));
    set_disc(ring, {centre, 1.25, 0.75});
    s.bodies = {ring};
    s.kernel = kernel;
    s.transfer = transfer;
    s.courant = 0.2;
    return s;
  }

  /// The same problem with the load whose moment over these places vanishes as it should.
  GeneralisedVortex balanced(const std::vector<double>& X, const std::vector<double>& Y) const {
    double moment = 0.0, inertia = 0.0;
    for (std::size_t p = 0; p < X.size(); ++p) {
      const double R = polar(X[p], Y[p]).R;
      const Angle a = angle(R, 0.5 * T);
      moment -= R * mu() / rho_0 * (3.0 * a.slope + R * a.curvature);
      inertia += R * R;
    }
    GeneralisedVortex v = *this;
    v.excess = moment / inertia;
    return v;
  }

  /// Relative errors as in ManufacturedBlock::run(): rms over points and `instants` up to `end`.
  ManufacturedBlock::Errors run(const Scene& s, double end, int instants, int threads = 1) const {
    const auto start = Simulation(s, threads).snapshot();
    Simulation simulation(s, balanced(start.x_m, start.y_m).prescribed(), threads);
    std::array<double, 6> all{}, most{};
    for (int k = 1; k <= instants; ++k) {
      const double t = end * k / instants;
      double dt = 0.0;
      while (simulation.time() < t) {
        const double before = simulation.time();
        simulation.step(t);
        dt = simulation.time() - before;
      }
      const auto now = simulation.snapshot();
      std::array<double, 6> sum{};
      for (std::size_t p = 0; p < start.x_m.size(); ++p) {
        const double X = start.x_m[p], Y = start.y_m[p];
        const auto add = [&](std::size_t at, double found, double exact) {
          sum[at] += (found - exact) * (found - exact);
          sum[at + 1] += exact * exact;
        };
        const auto x = place(X, Y, t), v = velocity(X, Y, t - 0.5 * dt);
        add(0, now.x_m[p] - X, x[0] - X);
        add(0, now.y_m[p] - Y, x[1] - Y);
        add(2, now.vx[p], v[0]);
        add(2, now.vy[p], v[1]);
        const auto sigma = stress(X, Y, t);
        add(4, now.sxx[p], sigma[0]);
        add(4, now.syy[p], sigma[1]);
        add(4, now.sxy[p], sigma[2]);
      }
      for (std::size_t q = 0; q < 6; ++q) {
        all[q] += sum[q];
        most[q] = std::max(most[q], sum[q]);
      }
    }
    const auto error = [&](std::size_t q) {
      return ManufacturedBlock::Error{std::sqrt(all[q] / all[q + 1]),
                                      std::sqrt(most[q] / most[q + 1])};
    };
    return {error(0), error(2), error(4), simulation.steps()};
  }
};

}  // namespace repose::mpm

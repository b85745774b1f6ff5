#pragma once
/// \file
/// The manufactured large deformation of an elastic unit square (physics.md, "Exact flows"):
/// u_x = A sin(2πX) sin(Cπt), u_y = A sin(2πY) sin(π + Cπt), neo-Hookean. Each component depends on
/// its own coordinate and is odd about 0 and 1, so that slip walls are the periodic conditions.

#include <cmath>
#include <numbers>

#include "mpm/step/simulation.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {

inline LawSpec neo_hookean(double E, double nu, double rho_0) {
  return {"neo_hookean", {}, {{"E", E}, {"nu", nu}, {"rho_0", rho_0}}};
}

struct ManufacturedBlock {
  double A = 0.05, C = 100.0, E = 1e7, nu = 0.3, rho_0 = 1000.0;

  double lambda() const { return E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)); }
  double mu() const { return 0.5 * E / (1.0 + nu); }

  /// One direction: displacement, velocity, F, dF/dX and velocity gradient dF/dt/F of the place X.
  struct Along {
    double u, v, a, F, dF, L;
  };
  Along along(double X, double t, double phase) const {
    const double pi = std::numbers::pi;
    const double s = std::sin(2 * pi * X), c = std::cos(2 * pi * X);
    const double time = std::sin(phase + C * pi * t), rate = C * pi * std::cos(phase + C * pi * t);
    Along r{};
    r.u = A * s * time;
    r.v = A * s * rate;
    r.a = -C * C * pi * pi * r.u;
    r.F = 1.0 + 2 * pi * A * c * time;
    r.dF = -4 * pi * pi * A * s * time;
    r.L = 2 * pi * A * c * rate / r.F;
    return r;
  }
  Along x(double X, double t) const { return along(X, t, 0.0); }
  Along y(double Y, double t) const { return along(Y, t, std::numbers::pi); }

  /// ρ_0 a = Div P + ρ_0 b with P_xx = J σ_xx/F_xx = (λ ln J − μ)/F_xx + μ F_xx, and F_yy
  /// independent of X: dP_xx/dX = F_xx′ [μ + (λ + μ − λ ln J)/F_xx²].
  double acceleration(const Along& one, const Along& other) const {
    const double ln_J = std::log(one.F * other.F);
    return one.a - one.dF * (mu() + (lambda() + mu() - lambda() * ln_J) / (one.F * one.F)) / rho_0;
  }
  /// The same as physics.md prints it, a second derivation:
  /// b = π²u[4μ/ρ − C² − 4(λ(ln J − 1) − μ)/(ρ F²)].
  double acceleration_as_published(const Along& one, const Along& other) const {
    const double pi = std::numbers::pi, K = std::log(one.F * other.F) - 1.0;
    return pi * pi * one.u *
           (4 * mu() / rho_0 - C * C - 4 * (lambda() * K - mu()) / (rho_0 * one.F * one.F));
  }
  /// σ_xx of a point whose stretches are F_x = one.F and F_y = other.F.
  double stress(const Along& one, const Along& other) const {
    const double J = one.F * other.F;
    return (lambda() * std::log(J) + mu() * (one.F * one.F - 1.0)) / J;
  }

  Prescribed prescribed() const {
    Prescribed p;
    p.start = [*this](double X, double Y) {
      const Along x0 = x(X, 0.0), y0 = y(Y, 0.0);
      return PointMotion{{x0.v, y0.v}, {x0.L, 0.0, 0.0, y0.L}};
    };
    p.acceleration = [*this](double t, std::span<const double> X, std::span<const double> Y,
                             std::span<double> ax, std::span<double> ay) {
      for (std::size_t k = 0; k < X.size(); ++k) {
        const Along xt = x(X[k], t), yt = y(Y[k], t);
        ax[k] += acceleration(xt, yt);
        ay[k] += acceleration(yt, xt);
      }
    };
    return p;
  }

  Scene scene(int n, Kernel kernel, Transfer transfer) const {
    Scene s = empty_box(1.0, 1.0, 1.0 / n);
    s.bodies = {block(0.0, 0.0, 1.0, 1.0, neo_hookean(E, nu, rho_0))};
    s.kernel = kernel;
    s.transfer = transfer;
    s.courant = 0.2;
    return s;
  }

  /// Errors over all points. `rms`: ∫∫|error|² over ∫∫|exact|², points and instants t/`instants`,
  /// 2t/`instants` … t, square root. `largest`: the largest over the instants of the norm over the
  /// points, over the largest norm of the exact solution.
  struct Error {
    double rms = 0.0, largest = 0.0;
  };
  struct Errors {
    Error displacement, velocity, stress;
    std::int64_t steps = 0;
  };
  Errors run(const Scene& s, double end = 0.02, int instants = 40, int threads = 1) const {
    Simulation simulation(s, prescribed(), threads);
    const auto start = simulation.snapshot();
    struct Sums {
      double error = 0.0, exact = 0.0, most_error = 0.0, most_exact = 0.0;
      void add(double e2, double x2) {
        error += e2;
        exact += x2;
        most_error = std::max(most_error, e2);
        most_exact = std::max(most_exact, x2);
      }
      Error result() const {
        return {std::sqrt(error / exact), std::sqrt(most_error / most_exact)};
      }
    } displacement, velocity, stress_sums;
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
        const Along xt = x(X, t), yt = y(Y, t);
        const auto add = [&](std::size_t at, double found, double exact) {
          sum[at] += (found - exact) * (found - exact);
          sum[at + 1] += exact * exact;
        };
        add(0, now.x_m[p] - X, xt.u);
        add(0, now.y_m[p] - Y, yt.u);
        // velocities belong to the middle of a step
        add(2, now.vx[p], x(X, t - 0.5 * dt).v);
        add(2, now.vy[p], y(Y, t - 0.5 * dt).v);
        add(4, now.sxx[p], stress(xt, yt));
        add(4, now.syy[p], stress(yt, xt));
      }
      displacement.add(sum[0], sum[1]);
      velocity.add(sum[2], sum[3]);
      stress_sums.add(sum[4], sum[5]);
    }
    return {displacement.result(), velocity.result(), stress_sums.result(), simulation.steps()};
  }
};

}  // namespace repose::mpm

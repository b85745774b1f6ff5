/// Shear flows with exact solutions. No wall moves and no box is periodic, so they are layers, long
/// enough that the middle does not know of the free ends.
///
/// Errors to expect: second order in h from the forces, and the affine transfer's own damping of a
/// wave number k by 1 − c(kh)⁴ per step. For the cubic spline, whose fourth moment is 2.7D²,
/// D = h²/3, a cycle of P2G and G2P keeps 1 + k⁴(D² − 2.7D²)/4, so c = 0.0472.

#include <gtest/gtest.h>

#include "tests/mpm/layer.hpp"

namespace repose::mpm {
namespace {

constexpr double filter = 0.0472;

// u = V sin(πy/H) e^{−νk²t}, k = π/H, between two fixed walls.
TEST(ShearFlowTest, ASineDecaysAtItsRate) {
  const double H = 0.1, V = 0.1, rho = 1000.0, eta = 10.0;
  const double k = pi / H, rate = eta / rho * k * k;
  for (const int n : {8, 16}) {
    Scene scene = layer(H, n, newtonian(eta, 1e5, 1.0, rho, true),
                        [&](double y) { return V * std::sin(k * y); });
    scene.domain[1] = H;
    scene.top = {Wall::Kind::no_slip};
    Simulation simulation(scene, 1);
    const auto amplitude = [&] {
      double u_sin = 0.0, sin_sin = 0.0;
      for (const PointState& p : middle(simulation, H)) {
        u_sin += p[VX] * std::sin(k * p[Y]);
        sin_sin += std::sin(k * p[Y]) * std::sin(k * p[Y]);
      }
      return u_sin / sin_sin;
    };
    run_until(simulation, 0.02);  // rows start without their affine part; the first step finds it
    const double before = amplitude();
    const auto steps_before = static_cast<double>(simulation.steps());
    run_until(simulation, 0.1);
    const double kh = k * scene.h;
    const double steps = static_cast<double>(simulation.steps()) - steps_before;
    // ln of the decay: νk²t and the filter's share, to second order (kh)² of both
    const double filtered = filter * std::pow(kh, 4) * steps;
    EXPECT_NEAR(std::log(before / amplitude()), rate * 0.08 + filtered,
                kh * kh * (rate * 0.08 + filtered));
  }
}

// A fluid moving at V whose floor stops at once (Stokes' first problem, up to a free surface):
// u = V Σ (4/πm) sin(mπy/2H) e^{−m²t/τ}, τ = 4H²/(π²ν).
TEST(ShearFlowTest, AStoppedWallIsFelt) {
  const double H = 0.1, V = 0.1, rho = 1000.0, eta = 10.0;
  const double tau = 4.0 * H * H / (pi * pi * eta / rho);
  const int n = 16;
  Scene scene = layer(H, n, newtonian(eta, 1e5, 1.0, rho, true), [&](double) { return V; });
  Simulation simulation(scene, 1);
  for (const double t : {0.1, 0.2}) {
    run_until(simulation, t);
    const double error = largest_error(middle(simulation, H, 0.5 * V * t), [&](double y) {
      return V * modes(y, H, t, tau, [](int m) { return 4.0 / (pi * m); });
    });
    EXPECT_LT(error, 2.0 / (n * n) * V) << "second order in h/H";
  }
}

// From rest on an incline to u = (g sinθ/ν)(Hy − y²/2), the difference decaying as
// (16 g sinθ H²/νπ³) Σ m⁻³ sin(mπy/2H) e^{−m²t/τ}.
TEST(ShearFlowTest, ALayerOnAnInclineReachesTheParabola) {
  const double H = 0.05, rho = 1000.0, eta = 50.0, g = 9.8;
  const double nu = eta / rho, tau = 4.0 * H * H / (pi * pi * nu), g_sin = 0.5 * g;
  const double U = g_sin * H * H / (2.0 * nu);
  for (const int n : {8, 16}) {
    Scene scene = layer(H, n, newtonian(eta, 1e5, 1.0, rho), [](double) { return 0.0; });
    scene.bodies = {block(0.2, 0.0, 0.8, H, newtonian(eta, 1e5, 1.0, rho))};
    scene.bodies[0].lithostatic = true;
    scene.gravity = g;
    scene.tilt_deg = 30.0;
    Simulation simulation(scene, 1);
    for (const double t : {0.02, 0.08}) {  // at 4τ the parabola is there to 2 %
      run_until(simulation, t);
      const double error = largest_error(middle(simulation, H), [&](double y) {
        return g_sin / nu * (H * y - 0.5 * y * y) - modes(y, H, t, tau, [&](int m) {
                 return 16.0 * g_sin * H * H / (nu * std::pow(m * pi, 3));
               });
      });
      EXPECT_LT(error, 1.0 / (n * n) * U) << "second order in h/H";
    }
  }
}

// Bagnold flow of μ(I), u = (2I/3d)√(φ g cosθ)[H^{3/2} − (H − y)^{3/2}] with μ(I) = tanθ, is
// steady: started with it, the layer goes on so. (Reaching it from rest takes seconds and metres.)
TEST(ShearFlowTest, BagnoldFlowIsSteady) {
  const double H = 0.05, g = 9.8, angle = 25.0 * pi / 180.0, mu = std::tan(angle);
  const double I = 0.279 * (mu - 0.3819) / (0.5718 - mu);
  const double factor = 2.0 * I / (3.0 * 0.0053) * std::sqrt(0.65 * g * std::cos(angle));
  const auto u = [&](double y) {
    return factor * (std::pow(H, 1.5) - std::pow(std::max(0.0, H - y), 1.5));
  };
  for (const char* form : {"elastoviscoplastic", "regularised"}) {
    LawSpec law = mu_i(254800.0, form);
    if (form[0] == 'r') law.values["r"] = 1.0;  // the flow's own rates are 10 to 20/s
    const int n = 12;
    Scene scene = layer(H, n, law, u);
    scene.gravity = g;
    scene.tilt_deg = 25.0;
    scene.courant = 0.8;
    double mean = 0.0;
    for (Body& body : scene.bodies) {
      const double y = body.origin[1] + 0.5 * body.size[1];
      mean += u(y) / (2 * n);
      body.initial.p = 1300.0 * g * std::cos(angle) * (H - y);
    }
    const double t = 0.05;
    Simulation simulation(scene, 1);
    run_until(simulation, t);
    double found = 0.0, exact = 0.0;
    for (const PointState& p : middle(simulation, H, mean * t)) {
      found += p[VX];
      exact += u(p[Y]);
      if (p[Y] < 0.2 * H || p[Y] > 0.7 * H) continue;
      EXPECT_NEAR(-3.0 * p[SXY] / (p[SXX] + p[SYY] + p[SZZ]), mu, 0.02 * mu) << p[Y];
    }
    // the slope alone would change the mean by 46 %, friction at rest (μ_0) by 8 %
    EXPECT_NEAR(found / exact, 1.0, 0.02) << form;
    // the filter rounds the shape off at the surface, where u has no fourth derivative
    EXPECT_LT(largest_error(middle(simulation, H, mean * t), u), 0.05 * u(H)) << form;
  }
}

}  // namespace
}  // namespace repose::mpm

/// Steady and starting flows of layers in a strip that is periodic along the flow, so that only the
/// way across is resolved: what the scheme makes of one dimension.

#include <gtest/gtest.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

constexpr double pi = std::numbers::pi;

/// A layer H high, n cells over its height, in a strip of five cells; the box ends at its top where
/// `closed`.
Scene strip(double H, int n, const LawSpec& law, bool closed) {
  const double h = H / n;
  Scene scene = empty_box(5 * h, closed ? H : 1.5 * H, h);
  scene.left = scene.right = {Wall::Kind::periodic};
  scene.floor = {Wall::Kind::no_slip};
  if (closed) scene.top = {Wall::Kind::no_slip};
  scene.bodies = {block(0.0, 0.0, 5 * h, H, law)};
  return scene;
}

/// Relative L2 difference of the points' v_x from u(y).
template <class Exact>
double profile_error(const Simulation& simulation, Exact&& u) {
  double error = 0.0, size = 0.0;
  for (const PointState& p : points_of(simulation)) {
    error += p[MASS] * std::pow(p[VX] - u(p[Y]), 2);
    size += p[MASS] * std::pow(u(p[Y]), 2);
  }
  return std::sqrt(error / size);
}

/// A body acceleration g along x.
Prescribed pull(double g) {
  Prescribed p;
  p.acceleration = [g](double, std::span<const double> X, std::span<const double>,
                       std::span<double> ax, std::span<double>) {
    for (std::size_t k = 0; k < X.size(); ++k) ax[k] += g;
  };
  return p;
}

// The lid starts at once: u/V = y/H + Σ (2/mπ)(−1)^m sin(mπy/H) e^{−m²π²νt/H²}. At νt/H² = 0.05 the
// shear has just reached the floor; at 1 only the straight line is left (e^{−π²} = 5e-5).
TEST(LayerFlowTest, CouetteFlowStarts) {
  const double H = 0.1, V = 0.2, rho = 1000.0, eta = 20.0, nu = eta / rho;
  double last = HUGE_VAL;
  for (const int n : {8, 16}) {
    Scene scene = strip(H, n, newtonian(eta, 1e5, 1.0, rho), true);
    scene.top.speed = V;
    // Not flip or aflip: what their points keep of their own never hears of a wall that starts at
    // once.
    scene.transfer = Transfer::relaxed;
    scene.relaxation_time = 1e-3;
    Simulation simulation(scene, 1);
    for (const double stage : {0.05, 1.0}) {
      run_until(simulation, stage * H * H / nu);
      const double error = profile_error(simulation, [&](double y) {
        double u = y / H;
        for (int m = 1; m < 60; ++m)
          u += 2.0 / (m * pi) * (m % 2 ? -1.0 : 1.0) * std::sin(m * pi * y / H) *
               std::exp(-m * m * pi * pi * stage);
        return V * u;
      });
      std::printf("Couette n = %d, nu t/H2 = %.2f: %.2e\n", n, stage, error);
      // second order in h over the width √(νt) of the shear, with the constant 1
      EXPECT_LT(error, 1.0 / (n * n * std::min(stage, 1.0))) << n;
      if (stage == 0.05) {
        EXPECT_LT(error, last / 2.8) << "order 1.5 at least";
        last = error;
      }
    }
  }
}

// u = (g/2ν) y(H − y), from rest; the rest decays at π²ν/H², and at νt/H² = 1 5e-5 of it is left.
TEST(LayerFlowTest, PoiseuilleFlow) {
  const double H = 0.1, g = 1.0, rho = 1000.0, eta = 20.0, nu = eta / rho;
  double last = HUGE_VAL;
  for (const int n : {8, 16}) {
    Scene scene = strip(H, n, newtonian(eta, 1e5, 1.0, rho), true);
    scene.transfer = Transfer::aflip;
    Simulation simulation(scene, pull(g), 1);
    run_until(simulation, H * H / nu);
    const double error =
        profile_error(simulation, [&](double y) { return g / (2.0 * nu) * y * (H - y); });
    std::printf("Poiseuille n = %d: %.2e\n", n, error);
    EXPECT_LT(error, 1.0 / (n * n)) << "second order in h/H";
    EXPECT_LT(error, last / 2.8) << "order 1.5 at least";
    last = error;
  }
}

// A free-surface layer: u = (g sinθ/ν)(Hy − y²/2) at rest across, 4τ after the start.
TEST(LayerFlowTest, FreeSurfaceLayer) {
  const double H = 0.1, g = 9.8, rho = 1000.0, eta = 50.0, nu = eta / rho;
  for (const int n : {8, 16}) {
    Scene scene = strip(H, n, newtonian(eta, 1e6, 1.0, rho), false);
    scene.transfer = Transfer::aflip;
    scene.gravity = g;
    scene.tilt_deg = 10.0;
    scene.bodies[0].lithostatic = true;
    Simulation simulation(scene, 1);
    const double tau = 4.0 * H * H / (pi * pi * nu), t = 8.0 * tau;
    run_until(simulation, t);
    const double slope = g * std::sin(10.0 * pi / 180.0) / nu;
    const double error =
        profile_error(simulation, [&](double y) { return slope * (H * y - 0.5 * y * y); });
    std::printf("free surface n = %d: %.2e\n", n, error);
    // the surface stands h/4 above the last points and is felt within a cell: first order at most
    EXPECT_LT(error, 0.25 / n) << "h/4 of H";
  }
}

// μ(I) down an incline: u = (2I/3d)√(φ g cosθ)[H^{3/2} − (H − y)^{3/2}], μ(I) = tanθ, for slopes
// between atan μ_0 = 20.9° and atan μ_d = 29.8°. Started a tenth too slow, it must find its speed.
class BagnoldTest : public ::testing::TestWithParam<double> {};

TEST_P(BagnoldTest, VelocityProfile) {
  const double H = 0.05, g = 9.8, angle = GetParam() * pi / 180.0, mu = std::tan(angle);
  const double I = 0.279 * (mu - 0.3819) / (0.5718 - mu);
  const double d = 0.053;
  const double factor = 2.0 * I / (3.0 * d) * std::sqrt(0.65 * g * std::cos(angle));
  const auto u = [&](double y) {
    return factor * (std::pow(H, 1.5) - std::pow(std::max(0.0, H - y), 1.5));
  };
  const int n = 16;
  LawSpec law = mu_i(254800.0);
  law.values["d"] = d;  // ten times the paper's: the time to the steady state goes with 1/d
  Scene scene = strip(H, n, law, false);
  scene.gravity = g;
  scene.tilt_deg = GetParam();
  scene.transfer = Transfer::relaxed;
  scene.courant = 0.8;
  scene.bodies[0].lithostatic = true;
  Prescribed start;
  start.start = [&](double, double Y) {
    const double rate = 1.5 * factor * std::sqrt(std::max(0.0, H - Y));
    return PointMotion{{0.9 * u(Y), 0.0}, {0.0, 0.9 * rate}};
  };
  Simulation simulation(scene, start, 1);
  for (const double t : {0.25, 0.5, 1.0}) {
    run_until(simulation, t);
    std::printf("Bagnold %.0f deg, t = %.2f s: %.2e\n", GetParam(), t,
                profile_error(simulation, u));
  }
  EXPECT_LT(profile_error(simulation, u), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Slopes, BagnoldTest, ::testing::Values(23.0, 25.0, 27.0),
                         [](const auto& one) { return std::to_string(int(one.param)); });

// A vertical chute under wall pressure P, gravity along it: τ = ρg|y − H/2|, so that grains within
// μ_0P/(ρg) of the middle move as a plug, and those beyond shear at μ(I) = ρg|y − H/2|/P. From the
// plug's edge on, I = I_0 (μ − μ_0)/(μ_d − μ) and du/dy = I √(P/ρ_p)/d.
TEST(LayerFlowTest, PlugOfAVerticalChute) {
  const double H = 0.1, P = 1300.0, g = 9.8, rho = 1300.0 * (1.0 + P / 254800.0);
  const double mu_0 = 0.3819, mu_d = 0.5718, I_0 = 0.279, d = 0.053, rho_p = 2000.0;
  const double wall = rho * g * 0.5 * H / P;  // friction there
  ASSERT_LT(wall, mu_d);
  const double plug = mu_0 * P / (rho * g);  // half its width
  // ∫ (μ − μ_0)/(μ_d − μ) dμ = −(μ − μ_0) − (μ_d − μ_0) ln[(μ_d − μ)/(μ_d − μ_0)], up to the wall
  const auto integral = [&](double mu) {
    return mu <= mu_0 ? 0.0 : -(mu - mu_0) - (mu_d - mu_0) * std::log((mu_d - mu) / (mu_d - mu_0));
  };
  const double scale = I_0 / d * std::sqrt(P / rho_p) * P / (rho * g);
  const auto u = [&](double y) {
    return scale * (integral(wall) - integral(rho * g * std::abs(y - 0.5 * H) / P));
  };
  LawSpec law = mu_i(254800.0);
  law.values["d"] = d;
  double last = HUGE_VAL;
  for (const int n : {16, 32, 64}) {
    Scene scene = strip(H, n, law, true);
    scene.transfer = Transfer::relaxed;
    scene.relaxation_time = 5e-4;
    scene.courant = 0.8;
    scene.bodies[0].initial.p = P;
    Prescribed prescribed = pull(g);
    prescribed.start = [&](double, double Y) { return PointMotion{{0.9 * u(Y), 0.0}, {}}; };
    Simulation simulation(scene, prescribed, 1);
    run_until(simulation, 0.25);
    const double error = profile_error(simulation, u);
    std::printf("chute n = %d: %.2e\n", n, error);
    EXPECT_LT(error, last / 2.0) << "first order at least";
    if (n == 64) {
      EXPECT_LT(error, 0.01);
    }
    last = error;
    // the plug: no faster shear than 1 % of the mean one
    double widest = 0.0;
    for (const PointState& p : points_of(simulation))
      if (std::abs(p[LXY]) < 0.01 * u(0.5 * H) / (0.5 * H))
        widest = std::max(widest, std::abs(p[Y] - 0.5 * H));
    EXPECT_NEAR(widest, plug, 1.0 * scene.h);
  }
}

}  // namespace
}  // namespace repose::mpm

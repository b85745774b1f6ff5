/// Large deformations with exact solutions, and an elastic disc that spins.

#include <gtest/gtest.h>

#include "tests/mpm/generalised_vortex.hpp"
#include "tests/mpm/saved_state.hpp"

namespace repose::mpm {
namespace {

// Two derivations of the block's body force, and its balance of momentum by finite differences.
TEST(ManufacturedBlockTest, TheBodyForceIsRight) {
  const ManufacturedBlock b;
  for (const double X : {0.05, 0.3, 0.62, 0.9})
    for (const double Y : {0.12, 0.41, 0.77})
      for (const double t : {0.0013, 0.0071, 0.016}) {
        const auto x = b.x(X, t), y = b.y(Y, t);
        const double force = b.acceleration(x, y);
        EXPECT_NEAR(force, b.acceleration_as_published(x, y), 1e-10 * std::abs(force) + 1e-6);
        // P_xx = σ_xx J/F_xx; central differences of h = 1e-4 err by h²/6 of (2π)² times the value
        const double h = 1e-4;
        const auto P = [&](double at) {
          const auto there = b.x(at, t);
          return b.stress(there, y) * y.F;
        };
        const double div = (P(X + h) - P(X - h)) / (2 * h);
        const double size = 2 * std::numbers::pi * b.E;
        EXPECT_NEAR(b.rho_0 * (x.a - force), div, 100.0 * h * h * size);
      }
}

// Momentum balance of the vortex, ρ_0(a − b) = Div P, from its map alone: a second derivation.
// Nested central differences, h = 1e-4 of a field whose scale is 1/8 m: (8h)²/6 ≈ 1e-7 each way,
// and the round-off of the place, 1e-16/h² · μ = 4e-6 Pa/m.
TEST(GeneralisedVortexTest, TheBodyForceIsRight) {
  const GeneralisedVortex v;
  const double h = 1e-4, mu = v.mu();
  for (const double t : {0.2, 0.55, 0.9})
    for (const auto& [X, Y] : {std::pair{2.4, 1.6}, {1.1, 2.3}, {0.55, 1.2}, {1.62, 0.38}}) {
      // first Piola–Kirchhoff stress with J = 1: P = μ(F − F⁻ᵀ)
      const auto P = [&](double x, double y) {
        const auto at = [&](double dx, double dy) { return v.place(x + dx, y + dy, t); };
        const auto right = at(h, 0), left = at(-h, 0), up = at(0, h), down = at(0, -h);
        std::array<std::array<double, 2>, 2> F{}, stress{};
        for (std::size_t i = 0; i < 2; ++i)
          F[i] = {(right[i] - left[i]) / (2 * h), (up[i] - down[i]) / (2 * h)};
        const double J = F[0][0] * F[1][1] - F[0][1] * F[1][0];
        EXPECT_NEAR(J, 1.0, 1e-5);
        stress[0] = {mu * (F[0][0] - F[1][1]), mu * (F[0][1] + F[1][0])};
        stress[1] = {mu * (F[1][0] + F[0][1]), mu * (F[1][1] - F[0][0])};
        return stress;
      };
      const auto right = P(X + h, Y), left = P(X - h, Y), up = P(X, Y + h), down = P(X, Y - h);
      const auto now = v.place(X, Y, t), after = v.place(X, Y, t + h),
                 before = v.place(X, Y, t - h);
      const auto b = v.acceleration(X, Y, t);
      for (std::size_t i = 0; i < 2; ++i) {
        const double div = (right[i][0] - left[i][0]) / (2 * h) + (up[i][1] - down[i][1]) / (2 * h);
        const double a = (after[i] - 2 * now[i] + before[i]) / (h * h);
        // accelerations and div P/ρ of order 10 m/s²; curvature of h(R) up to 2048/m²
        EXPECT_NEAR(a - div / v.rho_0, b[i], 2e-4) << X << ' ' << Y << ' ' << t;
      }
    }
}

// Displacement of the block: second order, measured 2.6 and 2.2 between these grids (cubic, apic)
// and 2.7 and 2.0 (aflip); docs/verification.md. Half an order is left for the coarsest pair's and
// the points' quadrature. The figures to beat are those of physics.md.
TEST(ManufacturedBlockTest, SecondOrderInDisplacement) {
  const ManufacturedBlock b;
  for (const Transfer transfer : {Transfer::apic, Transfer::aflip}) {
    double last = 0.0;
    for (const int n : {8, 16, 32}) {
      const double error = b.run(b.scene(n, Kernel::cubic, transfer)).displacement.rms;
      if (n > 8) {
        EXPECT_GT(std::log2(last / error), 1.7) << n;
      }
      if (n == 32) {
        EXPECT_LT(error, 0.00365) << "the best published figure";
      }
      last = error;
    }
  }
}

// Of the vortex, with shears up to 120 %: measured order 2.2 (docs/verification.md). At n = 8 the
// ring is four cells thick and its error, 0.25, not yet on the way. 0.0224 at n = 32; 0.0235 if the
// moment of the load over the points turns the ring.
TEST(GeneralisedVortexTest, SecondOrderInDisplacement) {
  const GeneralisedVortex v;
  const auto error = [&](int n) {
    return v.run(v.scene(n, Kernel::cubic, Transfer::apic), 1.0, 40).displacement.rms;
  };
  const double coarse = error(16), fine = error(32);
  EXPECT_GT(std::log2(coarse / fine), 1.5);
  EXPECT_LT(fine, 0.023);
}

/// x and y of all points of the block at t, after steps of t/n.
std::vector<double> places(const ManufacturedBlock& b, double t, int n) {
  Scene scene = b.scene(16, Kernel::cubic, Transfer::aflip);
  scene.dt = t / n;
  Simulation simulation(scene, b.prescribed(), 1);
  run_until(simulation, t);
  EXPECT_EQ(simulation.steps(), n);
  auto shot = simulation.snapshot();
  shot.x_m.insert(shot.x_m.end(), shot.y_m.begin(), shot.y_m.end());
  return shot.x_m;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double squares = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) squares += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(squares / static_cast<double>(a.size()));
}

// The order in the step, measured: where three runs on one grid differ by their steps alone, halved
// twice, a method of order p has changes in the ratio 2^p, whatever the grid's own error. A tenth
// of the amplitude (strains of 3 %): 2.2. The next term of the leapfrog is (ωΔt)² beside 1, 0.001
// for the slowest motion and 0.3 for the shortest waves on the grid, which a change may be made of.
TEST(ManufacturedBlockTest, TheStepIsOfSecondOrderInSmallMotions) {
  ManufacturedBlock b;
  b.A = 0.005;
  const double t = 0.008;
  const auto coarse = places(b, t, 80), middle = places(b, t, 160), fine = places(b, t, 320);
  EXPECT_NEAR(std::log2(distance(coarse, middle) / distance(middle, fine)), 2.0, 0.3);
}

// With strains of 30 % a term of first order shows, but a small one: 5e-6 m of 50 mm when steps of
// 0.1 ms are halved. One that forgets −½(ΔtL)², with L up to 2πA Cπ = 99/s and a quarter of its
// square on average, strains by ½ · 99²/4 · 0.008 · Δt = 1e-3 too much, over 1/2π m: 1.5e-4 m.
TEST(ManufacturedBlockTest, InLargeMotionsTheStepHardlyMatters) {
  const ManufacturedBlock b;
  EXPECT_LT(distance(places(b, 0.008, 80), places(b, 0.008, 160)), 1e-5);
}

// Spinning elastic disc, five turns: APIC keeps angular momentum to round-off, in spite of the
// waves that the sudden centrifugal force sends about.
TEST(SpinningDiscTest, AngularMomentumIsKept) {
  Scene scene = empty_box(1.6, 1.6, 0.1);
  Body disc = block(0, 0, 1, 1, neo_hookean(1e5, 0.3, 1000.0));
  set_disc(disc, {{0.8, 0.8}, 0.5, 0.0});
  disc.spin = 4.0;  // rim 2 m/s against a wave speed of 12 m/s: strains of (v/c)² = 3 %
  scene.bodies = {disc};
  Simulation simulation(scene, 2);
  const double start = angular_momentum(points_of(simulation), scene);
  run_until(simulation, 5 * 2 * std::numbers::pi / 4.0);
  double scale = 0.0;
  for (const PointState& p : points_of(simulation))
    scale += p[MASS] * std::hypot(p[X], p[Y]) * std::hypot(p[VX], p[VY]);
  const auto steps = static_cast<double>(simulation.steps());
  EXPECT_NEAR(angular_momentum(points_of(simulation), scene), start, steps * 16 * 2.2e-16 * scale);
}

}  // namespace
}  // namespace repose::mpm

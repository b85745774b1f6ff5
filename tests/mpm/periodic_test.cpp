/// Periodic edges and walls that move along themselves.

#include <gtest/gtest.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

/// A drop of cohesive fluid in the middle of a box 16 cells wide, thrown to the right.
Scene thrown(double x, double speed) {
  Scene scene = empty_box(1.6, 1.6, 0.1);
  scene.left = scene.right = {Wall::Kind::periodic};
  scene.bodies = {block(x, 0.6, 0.4, 0.4, newtonian(5.0, 2e4, 1.0, 1000.0, true))};
  scene.bodies[0].velocity = {speed, 0.0};
  scene.bodies[0].spin = 1.0;
  scene.bodies[0].initial.p = -200.0;
  scene.dt = 1e-3;
  return scene;
}

// A body that crosses the edge does what it does in the middle: the same numbers but for the
// round-off of its places, 16 eps per step, which the flow does not amplify.
TEST(PeriodicTest, NothingIsFeltOfTheEdge) {
  Simulation middle(thrown(0.2, 0.5), 2), across(thrown(1.4 - 0.2, 0.5), 2);  // 1.0 m further on
  const int steps = 1000;                                                     // half a metre
  run_steps(middle, steps);
  run_steps(across, steps);
  const auto a = points_of(middle), b = points_of(across);
  ASSERT_EQ(a.size(), b.size());
  const double round_off = steps * 16 * 2.2e-16;
  bool wrapped = false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double shift = b[k][X] - a[k][X];
    wrapped = wrapped || shift < 0.0;
    EXPECT_NEAR(std::remainder(shift - 1.0, 1.6), 0.0, round_off);
    EXPECT_NEAR(b[k][Y], a[k][Y], round_off);
    EXPECT_NEAR(b[k][VX], a[k][VX], round_off);
    EXPECT_NEAR(b[k][VY], a[k][VY], round_off);
    EXPECT_NEAR(b[k][RHO] / a[k][RHO], 1.0, round_off);
  }
  EXPECT_TRUE(wrapped);
  const SeriesRow row = across.diagnostics(), other = middle.diagnostics();
  EXPECT_NEAR(row.momentum_x / row.mass_kg_per_m, 0.5, round_off);
  // the ledger knows as much of the edge
  EXPECT_NEAR(row.transfer_loss_J_per_m, other.transfer_loss_J_per_m,
              round_off * other.kinetic_J_per_m * steps);
  EXPECT_NEAR(row.energy_residual_J_per_m, other.energy_residual_J_per_m,
              round_off * other.kinetic_J_per_m * steps);
}

// What falls round and round gains g_x × width per turn, and the ledger says where from.
TEST(PeriodicTest, TheLedgerFollowsWhatGoesRound) {
  Scene scene = thrown(1.0, 3.0);
  scene.gravity = 9.8;
  scene.tilt_deg = 89.0;
  scene.bodies[0].spin = 0.0;
  scene.bodies[0].initial.p = 0.0;
  Simulation simulation(scene, 2);
  run_steps(simulation, 600);  // 3.6 m: twice across
  const SeriesRow row = simulation.diagnostics();
  const double gained = row.kinetic_J_per_m - 0.5 * row.mass_kg_per_m * 9.0;
  EXPECT_GT(gained, row.mass_kg_per_m * 9.8 * 3.0);
  // symplectic Euler falls ½g Δt t further than the exact path: that is the residual, and no more
  const double v = 9.8 * std::sin(89.0 * std::numbers::pi / 180.0) * simulation.time();
  EXPECT_LT(std::abs(row.energy_residual_J_per_m), row.mass_kg_per_m * 9.8 * (v + 3.0) * *scene.dt);
}

TEST(PeriodicTest, TheSameBitsForAnyNumberOfThreads) {
  Simulation one(thrown(1.0, 0.5), 1), three(thrown(1.0, 0.5), 3);
  run_steps(one, 300);
  run_steps(three, 300);
  EXPECT_EQ(saved_state(one), saved_state(three));
}

// Between a lid at speed V and a floor at rest a uniform shear is exact for the scheme too: affine
// fields, linear velocities, constant stress. Round-off of the stress, η V/H, over the steps.
TEST(MovingWallTest, UniformShearIsExact) {
  const double H = 0.8, V = 0.4, eta = 50.0;
  Scene scene = empty_box(0.8, H, 0.1);
  scene.left = scene.right = {Wall::Kind::periodic};
  scene.floor = {Wall::Kind::no_slip};
  scene.top = {Wall::Kind::no_slip, 0.0, V};
  scene.bodies = {block(0.0, 0.0, 0.8, H, newtonian(eta, 2e4, 1.0, 1000.0))};
  Prescribed shear;
  shear.start = [&](double, double Y) { return PointMotion{{V * Y / H, 0.0}, {0.0, V / H}}; };
  scene.dt = 2e-3;
  Simulation simulation(scene, shear, 1);
  const int steps = 500;
  run_steps(simulation, steps);
  for (const PointState& p : points_of(simulation)) {
    EXPECT_NEAR(p[VX], V * p[Y] / H, steps * 16 * 2.2e-16 * V);
    EXPECT_NEAR(p[SXY], eta * V / H, steps * 16 * 2.2e-16 * 2e4);
  }
  // it takes ηV²/H per metre of lid, and that is what is dissipated
  const SeriesRow row = simulation.diagnostics();
  const double work = eta * V * V / H * 0.8 * simulation.time();
  EXPECT_NEAR(row.dissipated_J_per_m, work, 1.01 / steps * work) << "the first step starts at 0";
  EXPECT_NEAR(row.wall_loss_J_per_m, -work, 1.01 / steps * work);
}

}  // namespace
}  // namespace repose::mpm

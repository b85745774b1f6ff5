/// Periodic edges and walls that move along themselves.

#include <gtest/gtest.h>

#include "mpm/step/step_size.hpp"
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

// A step of several widths is wrapped by as many, and what crossed is still in the box.
TEST(PeriodicTest, AnyNumberOfWidthsAtOnce) {
  Scene scene = thrown(0.6, 10.0);
  scene.bodies[0].spin = 0.0;
  scene.bodies[0].initial.p = 0.0;
  scene.dt = 0.5;  // 5 m, more than three widths, in uniform motion without stress
  Simulation simulation(scene, 1);
  run_steps(simulation, 2);
  const auto points = points_of(simulation);
  EXPECT_EQ(points.size(), 64u);
  // round-off of the pressure, 16 eps K, on h: Δt 16 eps K/(ρh) = 4e-13 m/s, and at a Courant
  // number of 22 the second step multiplies it by 22² = 500
  for (const PointState& p : points) EXPECT_NEAR(p[VX], 10.0, 500 * 4e-13);
}

// A floor that starts at once: what it drags goes through both its impulses on the nodes, and the
// ledger accounts for all but what is of second order in the step (the first impulse of dt/τ
// relative size: half the energy that the first row of cells, a sixth of the layer, takes at once).
TEST(MovingWallTest, TheLedgerClosesFromRest) {
  for (const Transfer transfer : {Transfer::apic, Transfer::relaxed, Transfer::aflip}) {
    Scene scene = empty_box(0.5, 0.5, 0.05);
    scene.left = scene.right = {Wall::Kind::periodic};
    scene.floor = {Wall::Kind::no_slip, 0.0, 0.5};
    scene.gravity = 9.8;
    scene.tilt_deg = 10.0;
    scene.transfer = transfer;
    if (transfer == Transfer::relaxed) scene.relaxation_time = 1e-3;
    scene.bodies = {block(0.0, 0.0, 0.5, 0.3, mu_i(26e3))};
    scene.bodies[0].lithostatic = true;
    Simulation simulation(scene, 1);
    run_until(simulation, 0.3);
    const SeriesRow row = simulation.diagnostics();
    EXPECT_LT(std::abs(row.energy_residual_J_per_m), 0.01 * row.kinetic_J_per_m);
    EXPECT_GT(std::abs(row.wall_loss_J_per_m), 0.03 * row.kinetic_J_per_m)
        << "or this test sees nothing";
  }
}

TEST(SignalsTest, ANumberThatIsNoneStaysOne) {
  Signals signals;
  signals.include({std::nan(""), 1.0, 0.0});
  signals.include({1.0, 2.0, 0.0});
  EXPECT_TRUE(std::isnan(signals.speed));
  EXPECT_EQ(signals.signal, 2.0);
  EXPECT_TRUE(std::isnan(stable_step({1.0, std::nan(""), 0.0}, 0.4, 0.1)));
  EXPECT_TRUE(std::isnan(stable_step({1.0, 1.0, std::nan("")}, 0.4, 0.1)));
}

}  // namespace
}  // namespace repose::mpm

/// step.sleep_speed: what comes to rest sleeps, what is stirred wakes, and what it costs is
/// bounded.

#include <gtest/gtest.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

constexpr double v_s = 3e-3;  // m/s

/// Grains that fill a box between slip walls, in equilibrium under their weight from the start.
Scene silo(double depth) {
  Scene scene = empty_box(0.2, 0.4, 0.0125);
  scene.gravity = 9.8;
  scene.transfer = Transfer::relaxed;
  scene.floor = {Wall::Kind::no_slip};
  scene.bodies = {block(0.0, 0.0, 0.2, depth, mu_i())};
  scene.bodies[0].lithostatic = true;
  scene.sleep_speed = v_s;
  scene.courant = 0.8;
  return scene;
}

double mean_height(const Simulation& simulation) {
  const Simulation::Snapshot shot = simulation.snapshot();
  double sum = 0.0;
  for (const double y : shot.y_m) sum += y;
  return sum / static_cast<double>(shot.y_m.size());
}

double reach_of(const Simulation& simulation) {
  const Simulation::Snapshot shot = simulation.snapshot();
  double sum = 0.0;
  for (const double x : shot.x_m) sum += x;
  return sum / static_cast<double>(shot.x_m.size());
}

TEST(Sleep, WhatRestsSleepsAndCostsNothing) {
  Simulation simulation(silo(0.2));
  // no sooner than after √(h/g) = 0.036 s
  run_until(simulation, 0.03);
  EXPECT_EQ(simulation.counters().points_asleep, 0);
  run_until(simulation, 0.5);
  EXPECT_EQ(simulation.counters().points_asleep, simulation.point_count());
  const SeriesRow row = simulation.diagnostics();
  EXPECT_EQ(row.kinetic_J_per_m, 0.0);
  const std::int64_t before = simulation.point_steps();
  const double height = mean_height(simulation);
  run_steps(simulation, 50);
  EXPECT_EQ(simulation.point_steps(), before);
  EXPECT_EQ(mean_height(simulation), height);
}

// A second block falls on what sleeps. Missed is motion below v_s: at most v_s t of displacement.
TEST(Sleep, AFallingBlockWakesTheDeposit) {
  const double end = 1.0;
  const auto run = [&](double sleep_speed) {
    Scene scene = silo(0.1);
    scene.sleep_speed = sleep_speed;
    scene.bodies.push_back(block(0.0, 0.25, 0.2, 0.1, mu_i()));
    auto simulation = std::make_unique<Simulation>(scene);
    if (sleep_speed > 0.0) {
      // free fall over 0.15 m lasts √(2·0.15/9.8) = 0.175 s; at 0.14 s, 4 cells are left
      run_until(*simulation, 0.14);
      EXPECT_GE(simulation->counters().points_asleep, simulation->point_count() / 2);
      run_until(*simulation, 0.2);
      EXPECT_EQ(simulation->counters().points_asleep, 0);
    }
    run_until(*simulation, end);
    return simulation;
  };
  const auto asleep = run(v_s);
  const auto awake = run(0.0);
  EXPECT_NEAR(mean_height(*asleep), mean_height(*awake), v_s * end);
}

// A pile that sleeps beside a wall of fluid, which then runs away: the pile must follow. Without
// its support it fails and spreads by far more than v_s t.
TEST(Sleep, APileWakesWhereItsSupportGoes) {
  const double end = 0.6;
  const auto run = [&](double sleep_speed) {
    Scene scene = empty_box(0.8, 0.3, 0.0125);
    scene.gravity = 9.8;
    scene.transfer = Transfer::relaxed;
    scene.floor = {Wall::Kind::slip};
    scene.right = {Wall::Kind::open};
    scene.sleep_speed = sleep_speed;
    // the fluid is as heavy as the grains and presses on them as they on it: equilibrium but for
    // its free side, 0.3 m away; a wave of depression comes back from there after 0.2 s
    scene.bodies = {block(0.0, 0.0, 0.2, 0.1, mu_i()),
                    block(0.2, 0.0, 0.4, 0.1, newtonian(0.01, 254800.0, 1.0, 1300.0))};
    scene.bodies[0].lithostatic = scene.bodies[1].lithostatic = true;
    auto simulation = std::make_unique<Simulation>(scene);
    std::int64_t most = 0;
    while (simulation->time() < end) {
      simulation->step(end);
      most = std::max(most, simulation->counters().points_asleep);
    }
    if (sleep_speed > 0.0) {
      EXPECT_GT(most, 0);
    }
    return simulation;
  };
  const auto asleep = run(v_s);
  const auto awake = run(0.0);
  EXPECT_NEAR(reach_of(*asleep), reach_of(*awake), v_s * end);
}

TEST(Sleep, TheSameBits) {
  Scene scene = column_collapse(mu_i(26e3), 0.025);
  scene.transfer = Transfer::relaxed;
  scene.courant = 0.8;
  scene.domain[1] = 0.575;
  scene.sleep_speed = 2e-2;
  const ScratchFile file;
  Simulation straight(scene, 1);
  Simulation threaded(scene, 3);
  std::vector<std::unique_ptr<Simulation>> resumed;
  std::vector<std::int64_t> asleep;
  for (int k = 1; k <= 9; ++k) {
    run_until(straight, 0.12 * k);
    run_until(threaded, 0.12 * k);
    for (const auto& one : resumed) run_until(*one, 0.12 * k);
    asleep.push_back(straight.counters().points_asleep);
    straight.save(file.path());
    resumed.push_back(std::make_unique<Simulation>(scene, 2));
    resumed.back()->load(file.path());
  }
  // some of them saved with sleepers beside points awake
  EXPECT_TRUE(std::any_of(asleep.begin(), asleep.end(),
                          [&](std::int64_t n) { return n > 0 && n < straight.point_count(); }));
  const SavedState end = saved_state(straight);
  EXPECT_EQ(saved_state(threaded), end);
  for (const auto& one : resumed) EXPECT_EQ(saved_state(*one), end);
}

// The collapse with and without: no motion slower than v_s is missed for longer than the run, so
// that no point is more than v_s t off its way but for what chaos makes of it in the spray.
TEST(Sleep, ACollapseIsTheSameAndCheaper) {
  const double end = 1.2;
  const auto run = [&](double sleep_speed) {
    Scene scene = column_collapse(mu_i(), 0.0125);
    scene.transfer = Transfer::relaxed;
    scene.courant = 0.8;
    scene.sleep_speed = sleep_speed;
    auto simulation = std::make_unique<Simulation>(scene);
    run_until(*simulation, end);
    return simulation;
  };
  const auto asleep = run(v_s);
  const auto awake = run(0.0);
  EXPECT_NEAR(reach_of(*asleep), reach_of(*awake), v_s * end);
  EXPECT_NEAR(mean_height(*asleep), mean_height(*awake), v_s * end);
  EXPECT_LT(static_cast<double>(asleep->point_steps()),
            0.9 * static_cast<double>(awake->point_steps()));
  // the motion that sleepers lose is in the ledger: a block stops with at most ½v_s² per mass, and
  // what the ledger cannot account for stays what it is without sleep, a thousandth of the drop
  const SeriesRow row = asleep->diagnostics();
  const double drop =
      1e-3 * (Simulation(asleep->scene()).diagnostics().potential_J_per_m - row.potential_J_per_m);
  EXPECT_LT(std::abs(row.energy_residual_J_per_m), drop);
  EXPECT_LT(std::abs(awake->diagnostics().energy_residual_J_per_m), drop);
}

void expect_refused(const Scene& scene, const std::string& text) {
  try {
    validate(scene);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "step.sleep_speed");
    EXPECT_EQ(std::string(error.what()), text);
  }
}

TEST(Sleep, WhatItDoesNotGoWith) {
  Scene scene = silo(0.2);
  scene.sleep_speed = -1.0;
  expect_refused(scene, "sleep_speed = -1 is out of range: must be >= 0");
  scene = silo(0.2);
  scene.gravity = 0.0;
  scene.bodies[0].lithostatic = false;
  expect_refused(scene,
                 "sleep_speed > 0 does not go with scene.gravity = 0: nothing comes to rest");
  scene = silo(0.2);
  scene.transfer = Transfer::fmpm;
  expect_refused(scene, "sleep_speed > 0 does not go with step.transfer = \"fmpm\"");
  scene = silo(0.2);
  scene.left = scene.right = {Wall::Kind::periodic};
  expect_refused(scene, "sleep_speed > 0 does not go with periodic edges or walls that move");
}

}  // namespace
}  // namespace repose::mpm

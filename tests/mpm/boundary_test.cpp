/// What a run does at its walls and edges.

#include <gtest/gtest.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

constexpr double g = 9.8;
constexpr double slope = 30.0 * std::numbers::pi / 180.0;

/// A block of unyielding grains on a rough incline.
Scene block_on_incline(const Wall& floor) {
  Scene scene = empty_box(1.5, 0.25, 0.025);
  scene.gravity = g;
  scene.tilt_deg = 30.0;
  scene.floor = floor;
  scene.bodies = {block(0.1, 0.0, 0.3, 0.1, unyielding())};
  return scene;
}

// v = g(sinθ − f cosθ)t. The wall's impulse along is f times that across (walls_test), and that
// across is the weight's less what is left of the bounce: the error is f times that velocity, and
// what nodes that stick for a moment at the start have not felt: a period 4H/c = 6 ms of 0.4 s.
TEST(FrictionWallTest, ABlockSlidesAgainstItsFriction) {
  for (const double f : {0.0, 0.2, 0.4}) {
    Simulation simulation(block_on_incline({Wall::Kind::friction, f}), 1);
    const double start = points_of(simulation)[0][X];
    const double t = 0.4;
    run_until(simulation, t);
    const SeriesRow row = simulation.diagnostics();
    const double m = row.mass_kg_per_m;
    const double a = g * (std::sin(slope) - f * std::cos(slope));
    const double bounce = std::abs(row.momentum_y) / m;
    EXPECT_NEAR(row.momentum_x / m, a * t, f * (bounce + 0.006 * g * std::cos(slope)) + 1e-12);
    const double way = points_of(simulation)[0][X] - start;
    EXPECT_NEAR(way, 0.5 * a * t * t, 0.01 * way);
    // the ledger knows where the energy went; 3 %: the bounce has rubbed as well, and the
    // edges rub a little less
    const double friction_work = f * m * g * std::cos(slope) * way;
    EXPECT_NEAR(row.wall_loss_J_per_m, friction_work, 0.03 * friction_work + 1e-3);
    const double drop = 0.5 * m * a * t * a * t + friction_work;
    EXPECT_LT(std::abs(row.energy_residual_J_per_m), 0.02 * drop);
  }
}

// The same with every transfer: the wall's impulse reaches the points whatever they keep of their
// own velocity (walls.hpp). Only the bounce differs, which some damp and some do not.
TEST(FrictionWallTest, RubsAlikeInEveryTransfer) {
  const double f = 0.4, t = 0.4;
  const double a = g * (std::sin(slope) - f * std::cos(slope));
  for (std::size_t k = 0; k < transfer_names.size(); ++k) {
    Scene scene = block_on_incline({Wall::Kind::friction, f});
    scene.transfer = static_cast<Transfer>(k);
    Simulation simulation(scene, 1);
    run_until(simulation, t);
    const SeriesRow row = simulation.diagnostics();
    const double bounce = std::abs(row.momentum_y) / row.mass_kg_per_m;
    EXPECT_NEAR(row.momentum_x / row.mass_kg_per_m, a * t,
                f * (bounce + 0.006 * g * std::cos(slope)))
        << transfer_names[k];
    const double friction_work = f * row.mass_kg_per_m * g * std::cos(slope) * 0.5 * a * t * t;
    EXPECT_NEAR(row.wall_loss_J_per_m, friction_work, 0.03 * friction_work + 1e-3)
        << transfer_names[k];
    const double drop = friction_work + 0.5 * row.mass_kg_per_m * a * t * a * t;
    EXPECT_LT(std::abs(row.energy_residual_J_per_m), 0.02 * drop) << transfer_names[k];
    std::printf("[ measured ] %s: v - at = %.2g m/s, bounce %.2g m/s, work/exact - 1 = %.2g %%\n",
                transfer_names[k].data(), row.momentum_x / row.mass_kg_per_m - a * t, bounce,
                100.0 * (row.wall_loss_J_per_m / friction_work - 1.0));
  }
}

// With f > tanθ = 0.577 the block stays where it has landed, as it does on a floor without slip.
TEST(FrictionWallTest, ABlockSticksBelowItsFriction) {
  const auto base = [](const Simulation& simulation) {
    double x = 0.0;  // the points of the lowest row
    for (const PointState& p : points_of(simulation)) x += p.id < 24 ? p[X] / 24 : 0.0;
    return x;
  };
  for (const double f : {0.7, 2.0}) {
    Simulation simulation(block_on_incline({Wall::Kind::friction, f}), 1);
    const double start = base(simulation);
    EXPECT_NEAR(start, 0.25, 1e-12);
    run_until(simulation, 0.2);
    // slides freely until its weight presses: a period 4H/c = 6 ms, ½ g sinθ t² = 0.09 mm, and
    // again with every bounce
    const double landed = base(simulation);
    EXPECT_LT(landed - start, 2e-4);
    run_until(simulation, 0.4);
    EXPECT_LT(base(simulation) - landed, 1e-5) << "of 0.4 m without friction";
  }
  // with more friction than can ever be asked for, the wall is one without slip
  Simulation rough(block_on_incline({Wall::Kind::friction, 1e6}), 1);
  Simulation fixed(block_on_incline({Wall::Kind::no_slip}), 1);
  run_until(rough, 0.02);
  run_until(fixed, 0.02);
  EXPECT_NEAR(base(rough), base(fixed), 1e-5);
}

TEST(FrictionWallTest, WhatPartsIsLetGo) {
  Scene scene = block_on_incline({Wall::Kind::friction, 0.5});
  scene.gravity = 0.0;
  scene.domain[1] = 0.5;
  scene.bodies[0].velocity = {0.5, 0.3};
  Simulation simulation(scene, 1);
  run_until(simulation, 0.2);
  const SeriesRow row = simulation.diagnostics();
  const double round_off = static_cast<double>(simulation.steps()) * 16 * 2.2e-16;
  EXPECT_NEAR(row.momentum_x / row.mass_kg_per_m, 0.5, round_off);
  EXPECT_NEAR(row.momentum_y / row.mass_kg_per_m, 0.3, round_off);
  EXPECT_NEAR(row.wall_loss_J_per_m, 0.0, 1e-12);
}

// Opposite walls mirror the nodes next to them; in a box of one or two cells they would share one.
TEST(ClosedBoxTest, IsThreeCellsAcrossAtLeast) {
  for (const int cells : {1, 2, 3}) {
    Scene scene = empty_box(0.025 * cells, 0.6, 0.025);
    scene.gravity = g;
    scene.bodies = {block(0.0, 0.0, 0.025 * cells, 0.4, newtonian(10.0, 26000.0, 1.0, 1300.0))};
    scene.bodies[0].velocity = {0.3, 0.0};
    if (cells < 3) {
      try {
        validate(scene);
        FAIL();
      } catch (const InputError& error) {
        EXPECT_EQ(error.key(), "grid.h");
        EXPECT_EQ(std::string(error.what())
                      .find("the box is " + std::to_string(cells) +
                            " cells across; the walls need at least 3"),
                  0U)
            << error.what();
      }
      continue;
    }
    Simulation simulation(scene, 1);
    const SeriesRow start = simulation.diagnostics();
    run_until(simulation, 0.3);
    EXPECT_EQ(simulation.counters().wall_corrections, 0);
    EXPECT_LT(std::abs(simulation.diagnostics().energy_residual_J_per_m),
              0.01 * start.potential_J_per_m);
  }
}

// Two bodies burst and fly out of an open box, over every edge in turn: nothing is lost unseen.
TEST(OpenEdgeTest, WhatLeavesIsCounted) {
  const std::array<double, 3> ways[] = {{-2, 0.1}, {2, -0.1}, {0.2, -2}, {-0.2, 2}};
  for (const auto& way : ways)
    for (const Kernel kernel : {Kernel::cubic, Kernel::quadratic}) {
      Scene scene = empty_box(1.0, 0.8, 0.025);
      scene.kernel = kernel;
      scene.left = scene.right = scene.floor = scene.top = {Wall::Kind::open};
      scene.bodies = {block(0.4, 0.3, 0.2, 0.2, newtonian(1.0, 2e4, 7.0, 1000.0)),
                      block(0.4, 0.6, 0.1, 0.1, mu_i())};
      scene.bodies[0].initial.p = 30.0;
      for (Body& body : scene.bodies) body.velocity = way;
      Simulation simulation(scene, 2);
      const SeriesRow start = simulation.diagnostics();
      const auto points = simulation.point_count();
      EXPECT_EQ(start.outflow_kg_per_m, 0.0);
      double half_out = 0.0;
      while (simulation.time() < 0.8) {
        simulation.step(0.8);
        const SeriesRow row = simulation.diagnostics();
        ASSERT_NEAR(row.mass_kg_per_m + row.outflow_kg_per_m, start.mass_kg_per_m,
                    1e-12 * start.mass_kg_per_m);
        if (simulation.point_count() < points && simulation.point_count() > 0)
          half_out = row.outflow_kg_per_m;
      }
      EXPECT_GT(half_out, 0.5 * start.mass_kg_per_m) << "one after the other";
      EXPECT_EQ(simulation.point_count(), 0) << "2 m/s × 0.8 s is more than the box";
      const SeriesRow end = simulation.diagnostics();
      EXPECT_EQ(end.mass_kg_per_m, 0.0);
      EXPECT_EQ(end.kinetic_J_per_m, 0.0);
      EXPECT_EQ(simulation.counters().wall_corrections, 0);
      // their energy is booked as outflow
      EXPECT_LT(std::abs(end.energy_residual_J_per_m), 1e-6 * start.kinetic_J_per_m);
      simulation.step(0.9);  // and an empty box goes on
      EXPECT_EQ(simulation.time(), 0.9);
    }
}

// Only what crosses is taken: a closed box next to an open edge keeps its material.
TEST(OpenEdgeTest, WhatStaysInsideStays) {
  Scene scene = column_collapse(newtonian(0.5, 26000.0, 7.0, 1300.0), 0.025);
  scene.domain = {0.3, 0.55};
  scene.right = {Wall::Kind::open};
  Simulation simulation(scene, 2);
  const double mass = simulation.diagnostics().mass_kg_per_m;
  run_until(simulation, 0.5);
  const SeriesRow row = simulation.diagnostics();
  EXPECT_GT(row.outflow_kg_per_m, 0.2 * mass) << "it pours out";
  EXPECT_GT(row.mass_kg_per_m, 0.05 * mass) << "a film is left";
  EXPECT_NEAR(row.mass_kg_per_m + row.outflow_kg_per_m, mass, 1e-12 * mass);
  for (const PointState& p : points_of(simulation)) {
    EXPECT_GE(p[X], 0.0);
    EXPECT_GE(p[Y], 0.0);
    EXPECT_LE(p[Y], 0.55);
  }
}

}  // namespace
}  // namespace repose::mpm

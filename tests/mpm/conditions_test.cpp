/// What may change while a simulation goes on, and the fields that programs look at.

#include <gtest/gtest.h>

#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

Scene falling() {
  Scene scene = empty_box(1.0, 1.0, 0.1);
  scene.bodies = {
      block(0.4, 0.5, 0.2, 0.2, {"neo_hookean", {}, {{"E", 1e4}, {"nu", 0.3}, {"rho_0", 1e3}}})};
  return scene;
}

TEST(Conditions, GravityThatIsSetActs) {
  Simulation simulation(falling(), 1);
  run_until(simulation, 0.01);
  EXPECT_EQ(simulation.diagnostics().momentum_y, 0.0);
  simulation.set_gravity(2.0, 30.0);
  run_until(simulation, 0.11);
  const SeriesRow row = simulation.diagnostics();
  // m g t along both axes, to round-off of some ten steps of 16 points
  const double impulse = 1e3 * 0.04 * 2.0 * 0.1;
  EXPECT_NEAR(row.momentum_x / (impulse * 0.5), 1.0, 1e-12);
  EXPECT_NEAR(row.momentum_y / (-impulse * std::sqrt(0.75)), 1.0, 1e-12);
  // what falls freely loses nothing; the leapfrog's ledger is ½Δt F·u off at a moment, and was
  // exact before: kinetic energy of v Δt/t of itself
  EXPECT_LT(std::abs(row.energy_residual_J_per_m), 1.1 * row.dt_s / 0.1 * row.kinetic_J_per_m);
}

TEST(Conditions, ALedgerStaysClosedWhereGravityChangesBack) {
  const Scene scene = column_collapse(mu_i());
  Simulation plain(scene, 1), changed(scene, 1);
  for (Simulation* const one : {&plain, &changed}) run_until(*one, 0.1);
  changed.set_gravity(3.0, 0.0);
  changed.set_gravity(9.8, 0.0);
  for (Simulation* const one : {&plain, &changed}) run_until(*one, 0.2);
  const SeriesRow a = plain.diagnostics(), b = changed.diagnostics();
  EXPECT_EQ(a.front_99_m, b.front_99_m);
  EXPECT_EQ(a.kinetic_J_per_m, b.kinetic_J_per_m);
  // the changes of potential energy cancel to round-off of sums over 2048 points
  EXPECT_NEAR(a.energy_residual_J_per_m, b.energy_residual_J_per_m, 1e-11 * a.potential_J_per_m);
}

TEST(Conditions, EdgesChange) {
  Scene scene = column_collapse(mu_i());
  scene.bodies.front().origin = {0.9, 0.0};
  scene.right = {Wall::Kind::open};
  Simulation open(scene, 1);
  scene.right = {Wall::Kind::slip};
  Simulation opened(scene, 1);
  opened.set_wall("right", {Wall::Kind::open});
  for (Simulation* const one : {&open, &opened}) run_until(*one, 0.2);
  EXPECT_EQ(open.diagnostics().front_99_m, opened.diagnostics().front_99_m);
  EXPECT_EQ(open.diagnostics().kinetic_J_per_m, opened.diagnostics().kinetic_J_per_m);
}

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.key() + ": " + error.what();
  }
  return "nothing was thrown";
}

TEST(Conditions, WhatCannotChangeIsRefusedAndNothingHasChanged) {
  Simulation simulation(column_collapse(mu_i()), 1);
  EXPECT_NE(refusal([&] { simulation.set_wall("rigt", {}); }).find("did you mean 'right'"),
            std::string::npos);
  EXPECT_NE(refusal([&] { simulation.set_wall("near", {}); }).find("there is no edge 'near'"),
            std::string::npos);
  EXPECT_NE(
      refusal([&] { simulation.set_wall("left", {Wall::Kind::periodic}); }).find("domain.left"),
      std::string::npos);
  EXPECT_NE(refusal([&] {
              simulation.set_wall("floor", {Wall::Kind::friction, -1.0});
            }).find("domain.floor"),
            std::string::npos);
  EXPECT_NE(refusal([&] { simulation.set_gravity(std::nan(""), 0.0); }).find("scene.gravity"),
            std::string::npos);
  EXPECT_NE(refusal([&] { simulation.set_gravity(9.8, 91.0); }).find("scene.tilt_deg"),
            std::string::npos);
  EXPECT_EQ(simulation.scene().gravity, 9.8);
  EXPECT_EQ(simulation.scene().floor.kind, Wall::Kind::no_slip);
}

TEST(Fields, NodesHoldTheMassOfThePoints) {
  Scene periodic = falling();
  periodic.left = periodic.right = {Wall::Kind::periodic};
  periodic.bodies.front().origin = {0.0, 0.0};
  for (const Scene& scene : {column_collapse(mu_i()), falling(), periodic}) {
    Simulation simulation(scene, 1);
    for (const double m : simulation.node_fields().mass) EXPECT_EQ(m, 0.0);
    run_steps(simulation, 3);
    double mass = 0.0;
    for (const double m : simulation.node_fields().mass) mass += m;
    // a partition of unity, to round-off of some hundred points
    EXPECT_NEAR(mass / simulation.diagnostics().mass_kg_per_m, 1.0, 1e-13);
  }
}

TEST(Fields, PointsAreThoseOfTheSnapshot) {
  Simulation simulation(column_collapse(cam_clay()), 1);
  run_steps(simulation, 20);
  const Simulation::PointFields fields = simulation.point_fields();
  const Simulation::Snapshot shot = simulation.snapshot();
  ASSERT_EQ(fields.id.size(), shot.x_m.size());
  ASSERT_EQ(fields.state_width, find_law(cam_clay()).state.size());
  for (std::size_t i = 0; i < fields.id.size(); ++i) {
    EXPECT_EQ(fields.id[i], static_cast<std::int64_t>(i));
    EXPECT_EQ(fields.position[2 * i + 1], shot.y_m[i]);
    EXPECT_EQ(fields.velocity[2 * i], shot.vx[i]);
    EXPECT_EQ(fields.stress[4 * i + 3], shot.sxy[i]);
    EXPECT_EQ(fields.mass[i], shot.mass[i]);
  }
}

}  // namespace
}  // namespace repose::mpm

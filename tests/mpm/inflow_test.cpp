/// Material that comes in through an edge.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

constexpr double U = 2.0, rho = 1000.0;

Inflow through(std::string_view edge, double speed = U) {
  Inflow inflow;
  inflow.edge = static_cast<std::size_t>(std::find(edge_names.begin(), edge_names.end(), edge) -
                                         edge_names.begin());
  inflow.speed = speed;
  return inflow;
}

/// A channel that a fluid fills from the left and leaves on the right, all at one speed.
Scene channel(Kernel kernel, Transfer transfer) {
  Scene scene = empty_box(1.0, 0.25, 0.05);
  scene.kernel = kernel;
  scene.transfer = transfer;
  if (transfer == Transfer::relaxed) scene.relaxation_time = 0.01;
  scene.right = {Wall::Kind::open};
  Body body = block(0.0, 0.0, 0.25, 0.25, newtonian(0.0, 1e4, 1.0, rho));
  body.velocity = {U};
  scene.bodies = {body};
  scene.inflows = {through("left")};
  return scene;
}

class InflowTest : public ::testing::TestWithParam<Kernel> {};

// Nothing acts on it, so that it goes on as it came, and the mass in the channel is that between
// its ends. Velocities are sums of weights times U: some 16 round-offs a step, which an unstressed
// fluid does not add up but through its pressure: c = 3.2 m/s is of the order of U.
TEST_P(InflowTest, APlugKeepsItsSpeed) {
  for (const Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::aflip,
                                  Transfer::relaxed, Transfer::tpic}) {
    const Scene scene = channel(GetParam(), transfer);
    Simulation simulation(scene, 1);
    const double start = simulation.diagnostics().mass_kg_per_m;
    for (const double time : {0.2, 0.7, 1.0}) {
      run_until(simulation, time);
      const SeriesRow row = simulation.diagnostics();
      const double spacing = 0.025;
      const double rows = std::floor(U * time / spacing + 0.5 + 1e-9);
      EXPECT_NEAR(row.inflow_kg_per_m, rho * 0.25 * spacing * rows, 1e-12 * start * rows);
      EXPECT_NEAR(row.mass_kg_per_m + row.outflow_kg_per_m, start + row.inflow_kg_per_m,
                  1e-12 * (start + row.inflow_kg_per_m));
      const Simulation::PointFields points = simulation.point_fields();
      for (std::size_t k = 0; k < points.mass.size(); ++k) {
        EXPECT_NEAR(points.velocity[2 * k], U, 1e-11) << name_of(transfer);
        EXPECT_NEAR(points.velocity[2 * k + 1], 0.0, 1e-11);
        EXPECT_NEAR(points.density[k], rho, 1e-11 * rho);
      }
      EXPECT_NEAR(row.energy_residual_J_per_m, 0.0, 1e-11 * row.kinetic_J_per_m);
    }
    EXPECT_GT(simulation.diagnostics().outflow_kg_per_m, 0.5 * start);
  }
}

// Through every edge, over a part of it: a jet as wide as its stretch, whose points stand in rows.
TEST_P(InflowTest, AJetThroughAStretchOfAnyEdge) {
  for (const std::string_view edge : {"left", "right", "floor", "top"}) {
    Scene scene = empty_box(1.0, 1.0, 0.05);
    scene.kernel = GetParam();
    // once it has ended the edge is what it was, and only an open one lets the tail go
    scene.left = scene.right = scene.floor = scene.top = {Wall::Kind::open};
    Body far_away = block(0.0, 0.0, 0.1, 0.1, newtonian(0.0, 1e4, 1.0, rho));
    scene.bodies = {far_away};
    Inflow inflow = through(edge);
    inflow.speed.reset();
    inflow.rate = rho * U * 0.2;
    inflow.from[0] = 0.4;
    inflow.to[0] = 0.6;
    inflow.starts = 0.1;
    inflow.stops = 0.25;
    scene.inflows = {inflow};
    Simulation simulation(scene, 1);
    run_until(simulation, 0.35);
    const SeriesRow row = simulation.diagnostics();
    const double of_row = rho * 0.2 * 0.025;
    EXPECT_NEAR(row.inflow_kg_per_m, *inflow.rate * 0.15, 0.5001 * of_row);
    const std::size_t axis = inflow.edge / 2;
    const Simulation::PointFields points = simulation.point_fields();
    const auto before = static_cast<std::size_t>(points.mass.size()) -
                        static_cast<std::size_t>(std::lround(row.inflow_kg_per_m / of_row)) * 8;
    EXPECT_EQ(before, 16U);
    for (std::size_t k = before; k < points.mass.size(); ++k) {
      const double across = points.position[2 * k + axis];
      const double way = inflow.edge % 2 == 0 ? across : 1.0 - across;
      const auto n = static_cast<double>((k - before) / 8);
      // a row is made at least a hair of 1e-9 cells inside
      EXPECT_NEAR(way, U * (0.35 - 0.1) - (n + 0.5) * 0.025, 1e-9 * 0.05 + 1e-11) << edge;
      EXPECT_NEAR(points.position[2 * k + 1 - axis],
                  0.4 + (static_cast<double>((k - before) % 8) + 0.5) * 0.025, 1e-11);
    }
  }
}

/// Grains that fall onto a heap from an opening in the top of the box.
Scene heap(Kernel kernel) {
  Scene scene = empty_box(1.0, 0.5, 0.025);
  scene.gravity = 10.0;
  scene.kernel = kernel;
  scene.transfer = Transfer::relaxed;
  scene.courant = 0.6;
  scene.floor = {Wall::Kind::no_slip};
  scene.left = scene.right = {Wall::Kind::open};
  scene.bodies = {block(0.4, 0.0, 0.2, 0.1, mu_i(1e5))};
  Inflow inflow = through("top", 1.0);
  inflow.from[0] = 0.45;
  inflow.to[0] = 0.55;
  inflow.stops = 0.8;
  scene.inflows = {inflow};
  return scene;
}

// What comes in with the stream and what the edge does while it holds its speed is in the ledger.
TEST_P(InflowTest, AHeapFedByAStream) {
  Simulation simulation(heap(GetParam()), 2);
  const SeriesRow start = simulation.diagnostics();
  run_until(simulation, 1.0);
  const SeriesRow row = simulation.diagnostics();
  EXPECT_NEAR(row.inflow_kg_per_m, 1300.0 * 0.1 * 1.0 * 0.8, 0.5001 * 1300.0 * 0.1 * 0.0125);
  EXPECT_NEAR(row.mass_kg_per_m + row.outflow_kg_per_m, start.mass_kg_per_m + row.inflow_kg_per_m,
              1e-12 * row.inflow_kg_per_m);
  EXPECT_GT(row.height_m + simulation.profile().depth_m[20], 0.12);
  // of the fall of all that came in from 0.5 m; as small as in a collapse (README.md)
  EXPECT_LT(std::abs(row.energy_residual_J_per_m), 2e-3 * 10.0 * 0.5 * row.inflow_kg_per_m);
}

TEST_P(InflowTest, TheSameBitsForAnyNumberOfThreadsAndAfterResuming) {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  for (const Storage storage : {Storage::double_precision, Storage::single_precision}) {
    Scene scene = heap(GetParam());
    scene.storage = storage;
    const auto run = [&](int threads) {
      Simulation simulation(scene, threads);
      run_steps(simulation, 600);
      return saved_state(simulation);
    };
    const SavedState one = run(1);
    EXPECT_EQ(run(2), one);
    EXPECT_EQ(run(4), one);
    Simulation first(scene, 2), second(scene, 4);
    run_steps(first, 307);
    EXPECT_GT(first.diagnostics().inflow_kg_per_m, 1.0);
    const ScratchFile file;
    first.save(file.path());
    second.load(file.path());
    run_steps(second, 293);
    EXPECT_EQ(saved_state(second), one);
  }
}

// In space, from above through a square: the exact free flight of a jet without gravity.
TEST_P(InflowTest, AJetInSpace) {
  Scene scene = empty_box(0.5, 0.5, 0.05);
  scene.domain[2] = 0.5;
  scene.points_per_cell = 8;
  scene.kernel = GetParam();
  Body body = block(0.0, 0.0, 0.1, 0.1, newtonian(0.0, 1e4, 1.0, rho));
  body.size[2] = 0.1;
  scene.bodies = {body};
  Inflow inflow = through("top");
  inflow.from = {0.2, 0.25};
  inflow.to = {0.4, 0.4};
  scene.inflows = {inflow};
  Simulation simulation(scene, 2);
  run_until(simulation, 0.15);
  const SeriesRow row = simulation.diagnostics();
  EXPECT_NEAR(row.inflow_kg_per_m, rho * 0.2 * 0.15 * U * 0.15, 0.5001 * rho * 0.2 * 0.15 * 0.025);
  const Simulation::PointFields points = simulation.point_fields();
  for (std::size_t k = 64; k < points.mass.size(); ++k) {
    EXPECT_NEAR(points.velocity[3 * k + 1], -U, 1e-11);
    EXPECT_NEAR(points.velocity[3 * k], 0.0, 1e-11);
    EXPECT_NEAR(points.velocity[3 * k + 2], 0.0, 1e-11);
  }
}

TEST(Inflow, WhatIsRefused) {
  const auto refused = [](const auto& change) -> std::string {
    Scene scene = heap(Kernel::cubic);
    change(scene);
    try {
      validate(scene);
    } catch (const InputError& e) {
      return e.key();
    }
    return "";
  };
  EXPECT_EQ(refused([](Scene&) {}), "");
  EXPECT_EQ(refused([](Scene& s) { s.inflows[0].rate = 1.0; }), "inflow[0].rate");
  EXPECT_EQ(refused([](Scene& s) { s.inflows[0].speed.reset(); }), "inflow[0].speed");
  EXPECT_EQ(refused([](Scene& s) { s.inflows[0].speed = -1.0; }), "inflow[0].speed");
  EXPECT_EQ(refused([](Scene& s) { s.inflows[0].speed = 1e12; }), "inflow[0].speed");
  EXPECT_EQ(refused([](Scene& s) { s.inflows[0].edge = 5; }), "inflow[0].edge");
  EXPECT_EQ(refused([](Scene& s) { s.inflows[0].body = 1; }), "inflow[0].body");
  EXPECT_EQ(refused([](Scene& s) { s.inflows[0].from[0] = 0.46; }), "inflow[0].from");
  EXPECT_EQ(refused([](Scene& s) { s.inflows[0].to[0] = 0.4; }), "inflow[0].from");
  EXPECT_EQ(refused([](Scene& s) { s.inflows[0].to[1] = 0.4; }), "inflow[0].from");
  EXPECT_EQ(refused([](Scene& s) { s.inflows[0].stops = 0.0; }), "inflow[0].stops");
  EXPECT_EQ(refused([](Scene& s) { s.bodies[0].lithostatic = true; }), "inflow[0].body");
  EXPECT_EQ(refused([](Scene& s) { s.inflows.push_back(s.inflows[0]); }), "inflow[1].from");
  EXPECT_EQ(refused([](Scene& s) { s.transfer = Transfer::fmpm; }), "step.transfer");
  EXPECT_EQ(refused([](Scene& s) { s.left = s.right = {Wall::Kind::periodic}; }), "inflow[0].edge");
}

INSTANTIATE_TEST_SUITE_P(BothKernels, InflowTest,
                         ::testing::Values(Kernel::quadratic, Kernel::cubic),
                         [](const auto& of) { return std::string(name_of(of.param)); });

}  // namespace
}  // namespace repose::mpm

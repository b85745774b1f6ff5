/// Edges of the box in parts.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

Wall::Part part(Wall::Kind kind, double from = -HUGE_VAL, double to = HUGE_VAL) {
  Wall::Part made{kind};
  made.from[0] = from;
  made.to[0] = to;
  return made;
}

Wall in_parts(std::vector<Wall::Part> parts) {
  Wall wall{Wall::Kind::parts};
  wall.parts = std::move(parts);
  return wall;
}

Wall with_opening(double from, double to, Wall::Kind rest = Wall::Kind::no_slip) {
  return in_parts({part(Wall::Kind::open, from, to), part(rest)});
}

/// A box of grains 1 m wide, an opening in the middle of its floor.
Scene silo(double opening, Kernel kernel = Kernel::cubic, double h = 0.025) {
  Scene scene = empty_box(1.0, 0.75, h);
  scene.gravity = 10.0;
  scene.kernel = kernel;
  scene.transfer = Transfer::relaxed;
  scene.courant = 0.8;
  scene.floor = with_opening(0.5 - 0.5 * opening, 0.5 + 0.5 * opening);
  LawSpec grains = mu_i(2e5);
  scene.bodies = {block(0.0, 0.0, 1.0, 0.5, grains)};
  return scene;
}

class EdgePartsTest : public ::testing::TestWithParam<Kernel> {};

// One part that is the whole edge is that edge: the same nodes, the same arithmetic, the same bits.
TEST_P(EdgePartsTest, OnePartIsTheWholeEdge) {
  const Wall kinds[] = {{Wall::Kind::no_slip},
                        {Wall::Kind::slip},
                        {Wall::Kind::open},
                        {Wall::Kind::friction, 0.3},
                        {Wall::Kind::no_slip, 0.0, 0.5}};
  for (const Wall& wall : kinds) {
    const auto run = [&](const Wall& edge) {
      Scene scene = silo(0.2, GetParam(), 0.05);
      scene.floor = scene.right = edge;
      scene.bodies[0].velocity = {1.0, -1.0};
      Simulation simulation(scene, 1);
      run_steps(simulation, 60);
      return saved_state(simulation);
    };
    Wall::Part whole = part(wall.kind);
    whole.friction = wall.friction;
    whole.speed = wall.speed;
    EXPECT_EQ(run(in_parts({whole})), run(wall)) << static_cast<int>(wall.kind);
    Wall::Part half = whole;
    half.to[0] = 0.4;
    EXPECT_EQ(run(in_parts({half, whole})), run(wall)) << static_cast<int>(wall.kind);
  }
}

// It empties down to two heaps at rest: what has left and what is there are what was there.
TEST_P(EdgePartsTest, ASiloEmptiesDownToItsHeaps) {
  const Scene scene = silo(0.2, GetParam());
  Simulation simulation(scene, 2);
  const std::int64_t points = simulation.point_count();
  const double start = simulation.diagnostics().mass_kg_per_m;
  const double mass = start / static_cast<double>(points);
  for (const double time : {0.1, 0.3, 1.0, 2.0, 4.0}) {
    run_until(simulation, time);
    const SeriesRow row = simulation.diagnostics();
    // sums of 3200 equal terms: n ε at the most
    EXPECT_NEAR(row.mass_kg_per_m + row.outflow_kg_per_m, start, 1e-12 * start) << time;
    EXPECT_NEAR(row.outflow_kg_per_m / mass, static_cast<double>(points - simulation.point_count()),
                1e-6);
  }
  const SeriesRow end = simulation.diagnostics();
  // what stands beside the opening slopes by the angle of repose, between atan μ_0 = 20.9° and that
  // of the liquefied: heaps 0.4 m long and at most 0.4 tan 30° high, mass 2 · ½ · 0.4² tan 20.9° at
  // most ½ of the start
  EXPECT_LT(end.mass_kg_per_m, 0.5 * start);
  EXPECT_GT(end.mass_kg_per_m, 0.02 * start);
  EXPECT_LT(end.kinetic_J_per_m, 1e-3 * end.potential_J_per_m);
}

// The mirror image of a flow is a flow, and here the scene is its own image. Sums over points and
// nodes go from left to right in both, so that the bits may differ, and what differs grows with the
// chaos of yielding grains; in the first steps it has not had the time.
TEST_P(EdgePartsTest, AnOpeningInTheMiddleGivesASymmetricFlow) {
  for (const double opening : {0.2, 0.23}) {
    Simulation simulation(silo(opening, GetParam()), 1);
    run_steps(simulation, 25);
    const std::vector<PointState> points = points_of(simulation);
    const std::size_t columns = 80;
    ASSERT_EQ(points.size(), columns * 40);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const PointState& one = points[k];
      const PointState& other = points[k / columns * columns + columns - 1 - k % columns];
      // 25 steps that each add some ten round-offs of positions of 1 m
      EXPECT_NEAR(one[X] + other[X], 1.0, 25 * 10 * 2.3e-16);
      EXPECT_NEAR(one[Y], other[Y], 25 * 10 * 2.3e-16);
    }
  }
}

TEST_P(EdgePartsTest, TheSameBitsForAnyNumberOfThreadsAndAfterResuming) {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  for (const Storage storage : {Storage::double_precision, Storage::single_precision}) {
    Scene scene = silo(0.22, GetParam());
    scene.storage = storage;
    scene.left = in_parts({part(Wall::Kind::open, 0.2, 0.4), part(Wall::Kind::friction)});
    scene.left.parts[1].friction = 0.3;
    const auto run = [&](int threads) {
      Simulation simulation(scene, threads);
      run_steps(simulation, 500);
      return saved_state(simulation);
    };
    const SavedState one = run(1);
    EXPECT_EQ(run(2), one);
    EXPECT_EQ(run(4), one);
    Simulation first(scene, 2), second(scene, 4);
    run_steps(first, 251);
    const ScratchFile file;
    first.save(file.path());
    second.load(file.path());
    run_steps(second, 249);
    EXPECT_GT(second.diagnostics().outflow_kg_per_m, 0.1);
    EXPECT_EQ(saved_state(second), one);
  }
}

// A square opening in the floor of a box in space: nothing is lost, and what has left comes from
// over it.
TEST_P(EdgePartsTest, ASquareOrificeInSpace) {
  Scene scene = empty_box(0.6, 0.4, 0.05);
  scene.domain[2] = 0.6;
  scene.points_per_cell = 8;
  scene.courant = 0.65;
  scene.gravity = 10.0;
  scene.kernel = GetParam();
  Wall::Part hole = part(Wall::Kind::open);
  hole.from = {0.19, 0.19};
  hole.to = {0.41, 0.41};
  scene.floor = in_parts({hole, part(Wall::Kind::no_slip)});
  Body body = block(0.0, 0.0, 0.6, 0.3, mu_i(2e5));
  body.size[2] = 0.6;
  scene.bodies = {body};
  Simulation simulation(scene, 2);
  const double start = simulation.diagnostics().mass_kg_per_m;
  run_until(simulation, 0.5);
  const SeriesRow row = simulation.diagnostics();
  EXPECT_NEAR(row.mass_kg_per_m + row.outflow_kg_per_m, start, 1e-12 * start);
  // more than the lowest of the 12 layers over the hole, less than all of what stood over it
  const double over = 1300.0 * 0.22 * 0.22 * 0.3;
  EXPECT_GT(row.outflow_kg_per_m, over / 12.0);
  EXPECT_LT(row.outflow_kg_per_m, over);
  // as much from all four sides, to the chaos of the grains: their mean has the box's middle
  const Simulation::PointFields points = simulation.point_fields();
  double x = 0.0, z = 0.0, mass = 0.0;
  for (std::size_t k = 0; k < points.mass.size(); ++k) {
    mass += points.mass[k];
    x += points.mass[k] * points.position[3 * k];
    z += points.mass[k] * points.position[3 * k + 2];
  }
  EXPECT_NEAR(x / mass, 0.3, 1e-3);
  EXPECT_NEAR(z / mass, 0.3, 1e-3);
}

// The discharge rises with the width, whatever the width is in cells: bound nodes make of the steps
// from one number of cells to the next a slope.
TEST(EdgeParts, TheDischargeGrowsWithTheWidthBelowACell) {
  double before = 0.0;
  for (const double opening : {0.2, 0.2125, 0.225, 0.2375, 0.25}) {
    Simulation simulation(silo(opening), 2);
    run_until(simulation, 0.6);
    const double out = simulation.diagnostics().outflow_kg_per_m;
    EXPECT_GT(out, before) << opening;
    before = out;
  }
}

std::string refusal(const Scene& scene) {
  try {
    validate(scene);
  } catch (const InputError& e) {
    return e.key() + ": " + e.what();
  }
  return "";
}

TEST(EdgeParts, WhatIsRefused) {
  const auto floor = [](std::vector<Wall::Part> parts) {
    Scene scene = silo(0.2);
    scene.floor = in_parts(std::move(parts));
    return refusal(scene);
  };
  constexpr auto open = Wall::Kind::open;
  constexpr auto slip = Wall::Kind::slip;
  EXPECT_EQ(floor({part(slip, -HUGE_VAL, 0.4), part(open, 0.5)}),
            "domain.floor: no part of the edge holds in x = [0.4, 0.5] m");
  EXPECT_EQ(floor({part(open, 0.2, 0.5), part(slip, -HUGE_VAL, 0.4), part(slip, 0.4)}), "")
      << "an overlap: the first holds";
  EXPECT_EQ(floor({part(slip), part(open, 0.2, 0.5)}),
            "domain.floor[1]: this part never holds: it lies beyond the edge, or parts before it "
            "hold wherever it is");
  EXPECT_NE(floor({part(open, 1.2, 1.5), part(slip)}).find("domain.floor[0]: this part never"),
            std::string::npos);
  EXPECT_EQ(floor({part(open, 0.5, 0.4), part(slip)}),
            "domain.floor[0]: it would begin at 0.5 m and end at 0.4 m");
  EXPECT_EQ(floor({part(Wall::Kind::periodic, 0.2, 0.5), part(slip)}),
            "domain.floor[0].kind: a part of an edge cannot be periodic");
  EXPECT_EQ(floor({part(open, 0.4, 0.45), part(slip)}),
            "domain.floor: the opening [0.4, 0.45] m is 2 cells wide; it must be at least 3 (h = "
            "0.025 m)");
  EXPECT_EQ(floor({part(slip, 0.4, 0.41), part(open)}),
            "domain.floor: the closed part [0.4, 0.41] m is 0.4 cells wide; it must be at least 1 "
            "(h = 0.025 m)");
  Wall::Part pair = part(open, 0.2, 0.5);
  pair.to[1] = 0.3;
  EXPECT_EQ(floor({pair, part(slip)}),
            "domain.floor[0]: in the plane an edge has one direction: a number, not a pair");
  EXPECT_EQ(floor({}), "domain.floor: an edge in parts has at least one");
  Scene scene = silo(0.2);
  scene.transfer = Transfer::xpic;
  EXPECT_EQ(refusal(scene),
            "step.transfer: an edge in parts does not go with transfer = \"xpic\" yet; any other "
            "transfer does");
  scene = silo(0.2);
  scene.left = scene.right = {Wall::Kind::periodic};
  EXPECT_EQ(refusal(scene), "domain.floor: an edge in parts does not go with periodic edges yet");
  scene = silo(0.2);
  scene.viscosity = Viscosity::implicit_solve;
  EXPECT_EQ(refusal(scene),
            "step.viscosity: an edge in parts does not go with viscosity = \"implicit\" yet");
}

INSTANTIATE_TEST_SUITE_P(BothKernels, EdgePartsTest,
                         ::testing::Values(Kernel::quadratic, Kernel::cubic),
                         [](const auto& of) { return std::string(name_of(of.param)); });

}  // namespace
}  // namespace repose::mpm

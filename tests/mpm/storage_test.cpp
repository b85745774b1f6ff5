/// step.storage = "float": what rounding between the steps costs, and what it must not cost.

#include <gtest/gtest.h>

#include "models/scalar.hpp"
#include "tests/mpm/point_cloud.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

PointSet in_single(const PointSet& wide) {
  PointSet narrow = no_points();
  narrow.single = true;
  narrow.id = wide.id;
  narrow.count = wide.count;
  for (std::size_t f = 0; f < wide.fields; ++f) narrow.assign(f, wide.values(f));
  return narrow;
}

constexpr double half_ulp = 0x1p-24;  // of a float, relative

TEST(Storage, RoundsFieldsToAFloatAndPositionsToTwo) {
  const PointSet wide = random_points(100, {0.0, 0.0}, {1.0, 1.0}, 7);
  const PointSet narrow = in_single(wide);
  bool any_rounded = false;
  for (std::size_t s = 0; s < wide.slots(); ++s)
    for (std::size_t f = 0; f < wide.fields; ++f) {
      const double exact = wide[f][s];
      const double error = std::abs(narrow[f][s] - exact);
      // the second float rounds what the first leaves, at most 2^-24 of the position
      EXPECT_LE(error, std::abs(exact) * (f <= Y ? half_ulp * half_ulp : half_ulp)) << f;
      any_rounded = any_rounded || error > 0.0;
    }
  EXPECT_TRUE(any_rounded);
  // there and back again changes nothing more
  const PointSet again = in_single(narrow);
  for (std::size_t s = 0; s < wide.slots(); ++s)
    for (std::size_t f = 0; f < wide.fields; ++f) EXPECT_EQ(again[f][s], narrow[f][s]);
}

TEST(Storage, ReadLeavesThePointsAndUpdateRoundsThem) {
  PointSet points = in_single(random_points(64, {0.0, 0.0}, {1.0, 1.0}, 3));
  const SlotRange middle{Pack::size, 7};
  const double before = points[VX][middle.begin];
  const auto triple = [](PointSet& part, const SlotRange& range) {
    for (std::size_t k = 0; k < range.count; ++k) part.data(VX)[range.begin + k] *= 3.0;
  };
  points.read(middle, triple);
  EXPECT_EQ(points[VX][middle.begin], before);
  const double beside = points[VX][middle.begin - 1];
  points.update(middle, triple);
  EXPECT_EQ(points[VX][middle.begin], static_cast<double>(static_cast<float>(3.0 * before)));
  EXPECT_EQ(points[VX][middle.begin - 1], beside);
}

// Steps of 2^-30 m, a hundredth of what one float of a position near 1 m can tell apart (2^-24 m):
// it would stand still.
TEST(Storage, SmallStepsStillMoveAPoint) {
  Scene scene = empty_box(2.0, 2.0, 0.125);
  scene.bodies = {block(0.75, 0.75, 0.5, 0.5, mu_i())};
  scene.bodies[0].velocity = {0x1p-10, 0.0};
  scene.storage = Storage::single_precision;
  scene.dt = 0x1p-20;
  Simulation simulation(scene, 1);
  const std::vector<double> start = simulation.snapshot().x_m;
  const int steps = 500;
  run_steps(simulation, steps);
  const std::vector<double> end = simulation.snapshot().x_m;
  // a rounding of at most 2^-48 of a position below 2 m in every step; the weights' sum is 1 to
  // 2^-50, which is far below the velocity's rounding, so that it stays what it is
  for (std::size_t k = 0; k < start.size(); ++k)
    EXPECT_NEAR(end[k] - start[k], steps * 0x1p-30, steps * 0x1p-47);
}

// While a column falls, the energies in float are those in double but for the rounding: at most
// 2^-24 of every velocity and stress in a step, as if all of N steps went the same way, twice that
// in an energy; and two for the stress that such a velocity brings.
TEST(Storage, AFallIsTheSameToRounding) {
  Scene scene = empty_box(1.0, 0.5, 0.0125);
  scene.gravity = 9.8;
  scene.transfer = Transfer::relaxed;
  scene.floor = {Wall::Kind::no_slip};
  scene.bodies = {block(0.0, 0.0, 0.2, 0.4, mu_i())};
  scene.courant = 0.8;
  const auto run = [&](Storage storage) {
    scene.storage = storage;
    Simulation simulation(scene, 1);
    run_until(simulation, 0.1);
    return std::pair(simulation.diagnostics(), simulation.counters().memory_MB);
  };
  const auto [wide, wide_MB] = run(Storage::double_precision);
  const auto [narrow, narrow_MB] = run(Storage::single_precision);
  EXPECT_NE(narrow.kinetic_J_per_m, wide.kinetic_J_per_m) << "float has no effect";
  const double bound = 4.0 * static_cast<double>(wide.step) * half_ulp;
  EXPECT_LT(bound, 2e-4);
  EXPECT_NEAR(narrow.kinetic_J_per_m, wide.kinetic_J_per_m, bound * wide.kinetic_J_per_m);
  EXPECT_NEAR(narrow.potential_J_per_m, wide.potential_J_per_m, bound * wide.potential_J_per_m);
  EXPECT_NEAR(narrow.front_99_m, wide.front_99_m, bound * wide.front_99_m);
  // 18 fields (14, the density included, and 4 of the affine velocity): 8 against 4 bytes, and 4
  // for each of the two remainders of the position
  const double slots = 2048.0;  // every block of the lattice is full
  EXPECT_NEAR(wide_MB - narrow_MB, slots * (18 * 4 - 2 * 4) / 1e6, 0.1 * wide_MB);
  EXPECT_LT(narrow_MB, wide_MB);
}

// Every transfer, implicit viscosity, averaging and periodic edges work on points stored so.
TEST(Storage, GoesWithEveryPartOfTheMethod) {
  const auto kinetic = [](Scene scene, Storage storage) {
    scene.storage = storage;
    Simulation simulation(scene, 2);
    run_steps(simulation, 40);
    return simulation.diagnostics().kinetic_J_per_m;
  };
  const auto compare = [&](const Scene& scene, const std::string& what) {
    const double wide = kinetic(scene, Storage::double_precision);
    // 40 steps as above; an implicit solve may add its tolerance
    const double solve =
        scene.viscosity == Viscosity::implicit_solve ? scene.viscosity_tolerance : 0;
    EXPECT_NEAR(kinetic(scene, Storage::single_precision), wide,
                (4.0 * 40.0 * half_ulp + solve) * wide)
        << what;
  };
  Scene scene = empty_box(0.5, 0.5, 0.025);
  scene.gravity = 9.8;
  scene.floor = {Wall::Kind::no_slip};
  scene.bodies = {block(0.0, 0.0, 0.2, 0.3, mu_i(26000.0))};
  for (std::size_t k = 0; k < transfer_names.size(); ++k) {
    scene.transfer = static_cast<Transfer>(k);
    compare(scene, std::string(transfer_names[k]));
  }
  scene.transfer = Transfer::relaxed;
  Scene averaging = scene;
  averaging.pressure_averaging = 10.0;
  compare(averaging, "averaging");
  Scene viscous = scene;
  viscous.bodies[0].law = newtonian(10.0, 26000.0, 1.0, 1300.0);
  viscous.viscosity = Viscosity::implicit_solve;
  compare(viscous, "implicit");
  viscous.bodies[0].law = mu_i(26000.0, "regularised");  // asks for the stress as well
  viscous.bodies[0].law.values["r"] = 1.0;
  compare(viscous, "implicit, regularised");
  Scene periodic = scene;
  periodic.left = periodic.right = {Wall::Kind::periodic};
  periodic.tilt_deg = 20.0;
  compare(periodic, "periodic");
  Scene cam = scene;
  cam.bodies = {block(0.0, 0.0, 0.2, 0.3, cam_clay())};
  compare(cam, "Cam-Clay");
}

}  // namespace
}  // namespace repose::mpm

/// Collapses of cylinders, coarse, against the experiments of Lube et al. (2004).

#include <gtest/gtest.h>

#include "tests/mpm/granular_cylinder.hpp"

namespace repose::mpm {
namespace {

class LubeTest : public ::testing::TestWithParam<double> {};

// The experiments scatter by some 10 % about their fits, and a front at 2 % of the height is known
// to a cell, 10 % of the radius at this resolution: run-outs agree to 20 %. The height does not:
// μ(I) has no more than the slope of its friction, and its deposits are flatter than those of the
// experiments, the more so the taller the column (docs/three_dimensions.md). What is asked of it is
// that it lies between half of theirs and 10 % above.
TEST_P(LubeTest, RunOutAndHeight) {
  const double a = GetParam();
  const Scene scene = granular_cylinder(a, 10);
  Simulation simulation(scene, 0);
  const double start = simulation.diagnostics().potential_J_per_m;
  run_until(simulation, scene.end_time);
  const SeriesRow end = simulation.diagnostics();
  EXPECT_LT(end.kinetic_J_per_m, 1e-3 * (start - end.potential_J_per_m)) << "not at rest";
  EXPECT_LT(std::abs(end.energy_residual_J_per_m), 1e-3 * (start - end.potential_J_per_m));
  EXPECT_NEAR(end.front_m / 0.1 - 1.0, lube(a).run_out, 0.2 * lube(a).run_out);
  EXPECT_GT(end.height_m / 0.1, 0.45 * lube(a).height);
  EXPECT_LT(end.height_m / 0.1, 1.1 * lube(a).height);
}

INSTANTIATE_TEST_SUITE_P(AspectRatios, LubeTest, ::testing::Values(0.5, 1.0, 2.0));

}  // namespace
}  // namespace repose::mpm

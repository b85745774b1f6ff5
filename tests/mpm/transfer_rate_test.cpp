/// Damping per step against damping per unit of time: what a smaller step does to a collapse.

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

struct Heap {
  double run_out;  ///< how far 99 % of the mass has come, from where the column stood [m]
  double centre;   ///< x of the centre of mass [m]
  double height;   ///< at the wall [m]
  double kinetic, residual, drop;
};

Heap heap_of(Transfer transfer, double courant) {
  Scene scene = column_collapse(mu_i(26000.0), 0.025);
  scene.domain[1] = 0.55;
  scene.transfer = transfer;
  scene.courant = courant;
  Simulation simulation(scene, 1);
  const double start = simulation.diagnostics().potential_J_per_m;
  run_until(simulation, 1.2);
  Heap heap{};
  double mass = 0.0;
  for (const PointState& p : points_of(simulation)) {
    heap.centre += p[MASS] * p[X];
    mass += p[MASS];
  }
  heap.centre /= mass;
  const SeriesRow row = simulation.diagnostics();
  heap.height = row.height_m;
  heap.run_out = row.front_99_m - 0.2;
  heap.kinetic = row.kinetic_J_per_m;
  heap.residual = row.energy_residual_J_per_m;
  heap.drop = start - row.potential_J_per_m;
  return heap;
}

double change(double a, double b) { return std::abs(a / b - 1.0); }

// The step halved three times. Where the damping is a rate, what is left is the step's own error;
// APIC loses a share per step, eight times as much. 1 %: what a run-out is wanted to.
TEST(TransferRateTest, ARunOutThatDoesNotDependOnTheStep) {
  const Heap relaxed = heap_of(Transfer::relaxed, 0.4);
  const Heap finer = heap_of(Transfer::relaxed, 0.05);
  // a run-out is read off the fifth and sixth point from the front, half a cell apart: a cell's
  // worth
  const double cell = 0.025;
  EXPECT_NEAR(relaxed.run_out, finer.run_out, cell);
  EXPECT_LT(change(relaxed.centre, finer.centre), 0.01);
  EXPECT_LT(change(relaxed.height, finer.height), 0.01);
  const Heap apic = heap_of(Transfer::apic, 0.4);
  const Heap apic_finer = heap_of(Transfer::apic, 0.05);
  EXPECT_GT(apic.run_out - apic_finer.run_out, 4.0 * cell) << "or this test sees nothing";
  EXPECT_GT(change(apic.centre, apic_finer.centre), 0.05) << "or this test sees nothing";
}

// What the fronts mean, from the points and from the depth of the heap. All points weigh the same,
// 512 of them: 99 % of the mass is between the 506th and the 508th.
TEST(TransferRateTest, TheFrontsAreWhereTheySayTheyAre) {
  Scene scene = column_collapse(mu_i(26000.0), 0.025);
  scene.domain[1] = 0.55;
  Simulation simulation(scene, 1);
  run_until(simulation, 0.5);
  const SeriesRow row = simulation.diagnostics();
  std::vector<double> x = simulation.snapshot().x_m;
  ASSERT_EQ(x.size(), 512u);
  std::sort(x.begin(), x.end());
  EXPECT_GE(row.front_99_m, x[505]);
  EXPECT_LE(row.front_99_m, x[507]);
  EXPECT_EQ(row.front_max_m, x[511]);
  const Simulation::Profile profile = simulation.profile();
  const double threshold = 0.02 * 0.4;
  std::size_t last = profile.x_m.size() - 1;
  while (last > 0 && profile.depth_m[last] < threshold) --last;
  ASSERT_LT(last + 1, profile.x_m.size()) << "the far wall is not reached";
  const double share =
      (profile.depth_m[last] - threshold) / (profile.depth_m[last] - profile.depth_m[last + 1]);
  EXPECT_NEAR(row.front_m, profile.x_m[last] + share * scene.h, 1e-12);
}

// A heap that rests, and an account that closes to second order in the step (ledger.hpp).
TEST(TransferRateTest, RelaxedComesToRestAndItsLedgerCloses) {
  const Heap heap = heap_of(Transfer::relaxed, 0.4);
  EXPECT_LT(heap.kinetic, 1e-4 * heap.drop);
  EXPECT_LT(std::abs(heap.residual), 0.01 * heap.drop);
}

}  // namespace
}  // namespace repose::mpm

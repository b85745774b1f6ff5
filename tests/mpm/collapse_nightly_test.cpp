/// The paper's flat column at its full resolution, minutes long.

#include <gtest/gtest.h>

#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

// At the same step of 3e-5 s, MUI-4 is at rest at 1.2 s: below 2e-5 J/m and falling, and at least
// ten times below the regularised form, which creeps (physics.md, MUI-7).
TEST(FullCollapseTest, TheElastoviscoplasticFormComesToRest) {
  double at_end[2] = {0.0, 0.0};
  for (const bool regularised : {false, true}) {
    Scene scene = column_collapse(
        mu_i(254800.0, regularised ? "regularised" : "elastoviscoplastic"), 0.00625);
    scene.dt = 3e-5;
    Simulation simulation(scene);
    const std::int64_t points = simulation.point_count();
    run_until(simulation, 1.1);
    const double before = simulation.diagnostics().kinetic_J_per_m;
    run_until(simulation, 1.2);
    at_end[regularised] = simulation.diagnostics().kinetic_J_per_m;
    if (!regularised) {
      EXPECT_LT(at_end[0], 2e-5);
      EXPECT_LT(at_end[0], before);
    }
    EXPECT_EQ(simulation.point_count(), points);
  }
  EXPECT_GT(at_end[1], 10.0 * at_end[0]);
}

// The ledger at full resolution, all three laws: 1 % of the drop.
TEST(FullCollapseTest, TheLedgerCloses) {
  for (const LawSpec& law : {cam_clay(), mu_i(), newtonian(0.002, 26000.0, 7.0, 1300.0)}) {
    Simulation simulation(column_collapse(law, 0.00625));
    const SeriesRow start = simulation.diagnostics();
    run_until(simulation, 1.2);
    const SeriesRow end = simulation.diagnostics();
    EXPECT_LT(std::abs(end.energy_residual_J_per_m),
              0.01 * (start.potential_J_per_m - end.potential_J_per_m))
        << law.name;
    EXPECT_NEAR(end.mass_kg_per_m / start.mass_kg_per_m, 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace repose::mpm

/// The paper's column collapse on coarse grids: what holds for any of its laws.

#include <gtest/gtest.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

struct Case {
  const char* name;
  LawSpec law;
  Kernel kernel;
  double tilt_deg;
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

class CollapseTest : public ::testing::TestWithParam<Case> {};

// Mass to the last digit, and every joule of the way down found again: kinetic, potential, elastic,
// dissipated by the law, lost in transfers, taken by walls. What remains is of second order in Δt.
TEST_P(CollapseTest, LedgerAndMassClose) {
  Scene scene = column_collapse(GetParam().law, 0.025);
  scene.domain[1] = 0.55;
  scene.kernel = GetParam().kernel;
  scene.tilt_deg = GetParam().tilt_deg;
  Simulation simulation(scene, 2);
  const SeriesRow start = simulation.diagnostics();
  const std::int64_t points = simulation.point_count();
  double lowest = start.potential_J_per_m;
  double residual = 0.0, kinetic_peak = 0.0, transfer = 0.0;
  for (int k = 1; k <= 60; ++k) {
    run_until(simulation, k * 0.02);
    const SeriesRow row = simulation.diagnostics();
    lowest = std::min(lowest, row.potential_J_per_m);
    residual = std::max(residual, std::abs(row.energy_residual_J_per_m));
    kinetic_peak = std::max(kinetic_peak, row.kinetic_J_per_m);
    EXPECT_GE(row.transfer_loss_J_per_m, transfer - 1e-3 * start.potential_J_per_m)
        << "a transfer filters, it gives nothing back";
    transfer = row.transfer_loss_J_per_m;
    EXPECT_NEAR(row.mass_kg_per_m / start.mass_kg_per_m, 1.0, 1e-12);
    EXPECT_NEAR(row.kinetic_J_per_m + row.potential_J_per_m + row.elastic_J_per_m +
                    row.dissipated_J_per_m + row.hypoelastic_J_per_m + row.separation_J_per_m +
                    row.averaging_loss_J_per_m + row.density_floor_J_per_m +
                    row.transfer_loss_J_per_m + row.wall_loss_J_per_m + row.energy_residual_J_per_m,
                start.kinetic_J_per_m + start.potential_J_per_m + start.elastic_J_per_m, 1e-9);
  }
  const double drop = start.potential_J_per_m - lowest;
  EXPECT_LT(residual, 0.01 * drop);
  EXPECT_GT(kinetic_peak, 0.1 * drop) << "it did collapse";
  EXPECT_EQ(simulation.point_count(), points);
  EXPECT_EQ(simulation.counters().wall_corrections, 0);
}

const LawSpec fluid = newtonian(0.002, 26000.0, 7.0, 1300.0);
const Case cases[] = {
    {"cam_clay", cam_clay(), Kernel::cubic, 0.0},
    {"mu_i", mu_i(), Kernel::cubic, 0.0},
    {"newtonian", fluid, Kernel::cubic, 0.0},
    {"cam_clay_tilted", cam_clay("v-ln_p"), Kernel::quadratic, 35.0},
    {"mu_i_tilted", mu_i(26000.0), Kernel::quadratic, 35.0},
    {"newtonian_tilted", fluid, Kernel::quadratic, 35.0},
    {"critical_state", critical_state(), Kernel::cubic, 0.0},
    {"critical_state_tilted", critical_state(), Kernel::quadratic, 35.0},
};
INSTANTIATE_TEST_SUITE_P(Laws, CollapseTest, ::testing::ValuesIn(cases),
                         [](const auto& one) { return std::string(one.param.name); });

// The fluid leads, reaches the far wall and lies flat; the grains keep a heap (at most atan μ_0 =
// 20.9° steep: μ(I) at rest).
TEST(HeapTest, GrainsKeepOneAFluidDoesNot) {
  struct Outcome {
    double at_half_second, height, slope;
  };
  const auto collapse = [](const LawSpec& law) {
    Scene scene = column_collapse(law, 0.025);
    scene.domain[1] = 0.55;
    Simulation simulation(scene, 2);
    run_until(simulation, 0.5);
    const double front = simulation.diagnostics().front_m;
    run_until(simulation, 1.2);
    const Simulation::Profile profile = simulation.profile();
    double slope = 0.0;  // over 0.2 m, clear of the left wall and of the edge
    for (std::size_t i = 2; i + 8 < profile.depth_m.size() && profile.depth_m[i + 8] > 0.0; ++i)
      slope = std::max(slope, (profile.depth_m[i] - profile.depth_m[i + 8]) / 0.2);
    return Outcome{front, profile.depth_m.front(), slope};
  };
  const Outcome grains = collapse(mu_i()), clay = collapse(cam_clay()), water = collapse(fluid);
  for (const Outcome& heap : {grains, clay}) {
    EXPECT_GT(water.at_half_second, heap.at_half_second + 0.2);
    EXPECT_GT(heap.height, 3.0 * water.height);
    EXPECT_GT(heap.slope, 0.2);
  }
  EXPECT_LT(grains.slope, 0.3819 + 0.0625) << "half a cell of 0.2 m";
}

// MUI-4 comes to rest, the regularised form chatters, at the same step. Counted where the grains
// bear stress: a few that have rolled off the toe creep without any in both forms.
TEST(HeapTest, TheElastoviscoplasticFormComesToRest) {
  double at_end[2] = {0.0, 0.0};
  for (const bool regularised : {false, true}) {
    Scene scene =
        column_collapse(mu_i(254800.0, regularised ? "regularised" : "elastoviscoplastic"));
    scene.dt = 3e-5;
    Simulation simulation(scene, 2);
    double total = HUGE_VAL;
    for (const double t : {0.9, 1.0, 1.1, 1.2}) {
      run_until(simulation, t);
      const double kinetic = simulation.diagnostics().kinetic_J_per_m;
      EXPECT_LT(kinetic, total) << "falls and keeps falling, t = " << t;
      total = kinetic;
    }
    EXPECT_LT(total, 5e-4);
    for (const PointState& p : points_of(simulation))
      if (p[SYY] != 0.0) at_end[regularised] += 0.5 * p[MASS] * (p[VX] * p[VX] + p[VY] * p[VY]);
    const bool told = !simulation.warnings().empty() &&
                      simulation.warnings()[0].find("viscous limit") != std::string::npos;
    EXPECT_EQ(told, regularised) << "running above the viscous limit is said";
  }
  EXPECT_LT(at_end[0], 2e-5);
  EXPECT_GT(at_end[1], 10.0 * at_end[0]);
}

}  // namespace
}  // namespace repose::mpm

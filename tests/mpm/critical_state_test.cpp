/// \file
/// A whole collapse of critical-state μ(I) (physics.md, CSM): every point on the law's own lines
/// all the time, rest on a flat floor, flow that goes on where the slope is above its friction.

#include <gtest/gtest.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

Scene collapse(double I_v, double tilt_deg) {
  Scene scene = column_collapse(critical_state(I_v), 0.0125);
  scene.transfer = Transfer::relaxed;
  scene.courant = 1.2;
  scene.tilt_deg = tilt_deg;
  return scene;
}

/// The largest |v/v(p, p_c0) − 1| of CSM-2 at I = 0 over the points that bear, and how many do.
double off_the_lines(const Simulation& simulation, const LawSpec& law, int& bearing) {
  const auto value = [&](const char* name) { return law.values.at(name); };
  double worst = 0.0;
  bearing = 0;
  for (const PointState& at : points_of(simulation)) {
    const double p = -(at[SXX] + at[SYY] + at[SZZ]) / 3.0;
    if (!(p > 0.0)) continue;
    const double ln_v = std::log(value("rho_p") / at[RHO]);
    const double ln_p_s = at[STATE] - std::log(2.0);
    const double on_lines = std::log(value("Gamma")) - value("lambda") * ln_p_s +
                            value("kappa") * (ln_p_s - std::log(p));
    worst = std::max(worst, std::abs(std::expm1(ln_v - on_lines)));
    ++bearing;
  }
  return worst;
}

// Each step rounds ln ρ and ln p_c0 by some ε; over the 4000 steps here 1e-12 of v at most.
TEST(CriticalStateCollapse, EveryPointKeepsTheStateRelationAndComesToRest) {
  const Scene scene = collapse(0.5, 0.0);
  Simulation simulation(scene, 2);
  const std::int64_t points = simulation.point_count();
  const double start = simulation.diagnostics().potential_J_per_m;
  for (const double time : {0.1, 0.3, 0.6, 1.2, 2.5}) {
    run_until(simulation, time);
    int bearing = 0;
    EXPECT_LT(off_the_lines(simulation, scene.bodies[0].law, bearing), 1e-12) << time;
    EXPECT_GT(bearing, points / 2) << time;
  }
  EXPECT_EQ(simulation.point_count(), points);
  const SeriesRow end = simulation.diagnostics();
  EXPECT_LT(end.kinetic_J_per_m, 1e-6 * start);
  EXPECT_GT(end.front_m, 0.6) << "it did collapse";
  EXPECT_GT(end.height_m, 0.1) << "and keeps a heap";
}

// Spray so loose that the grid cannot tell is held at the density floor; its state is held with it.
// (It was not: p_c0 went on falling to e^-377 of a pascal, for which the way back was 760 times the
// density.)
TEST(CriticalStateCollapse, PointsHeldAtTheDensityFloorKeepTheStateRelation) {
  Scene scene = collapse(0.5, 35.0);
  scene.domain[0] = 2.4;
  Simulation simulation(scene, 2);
  for (const double time : {0.5, 0.8, 1.1}) {
    run_until(simulation, time);
    int bearing = 0;
    EXPECT_LT(off_the_lines(simulation, scene.bodies[0].law, bearing), 1e-12) << time;
    for (const PointState& at : points_of(simulation)) EXPECT_LT(at[RHO], 2000.0) << time;
  }
  EXPECT_GT(simulation.counters().point_steps_held, 100);
}

// tan 35° = 0.70 is above μ_d = 0.57: what reaches the far wall is still in motion, and so is the
// rest.
TEST(CriticalStateCollapse, KeepsFlowingDownASteepSlope) {
  const Scene scene = collapse(0.5, 35.0);
  Simulation simulation(scene, 2);
  double last = 0.0;
  for (const double time : {0.2, 0.3, 0.4}) {
    run_until(simulation, time);
    const SeriesRow row = simulation.diagnostics();
    EXPECT_GT(row.kinetic_J_per_m, last) << time;
    last = row.kinetic_J_per_m;
  }
  EXPECT_GT(last, 50.0);
}

// Without I_v the volume does not know the rate: the collapse is that of grains with the same
// friction, and no denser or looser than Cam-Clay's.
TEST(CriticalStateCollapse, WithoutRateInTheVolume) {
  Scene scene = collapse(0.5, 0.0);
  scene.bodies[0].law.values.erase("I_v");
  Simulation simulation(scene, 2);
  run_until(simulation, 1.2);
  Scene clay = collapse(0.5, 0.0);
  clay.bodies[0].law = cam_clay();
  Simulation slow(clay, 2);
  run_until(slow, 1.2);
  const SeriesRow a = simulation.diagnostics(), b = slow.diagnostics();
  // friction grows with the rate: it runs out less far than its law at rest
  EXPECT_LT(a.front_99_m, b.front_99_m);
  EXPECT_GT(a.front_99_m, 0.6 * b.front_99_m);
  EXPECT_NEAR(a.density_max / b.density_max, 1.0, 0.01);
}

}  // namespace
}  // namespace repose::mpm

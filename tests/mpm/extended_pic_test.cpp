/// What XPIC and FMPM promise beyond agreeing with the plain method (reference_step_test.cpp).

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

class ExtendedPicTest : public ::testing::TestWithParam<Transfer> {
 protected:
  /// Two bodies that meet in a box with every kind of wall.
  static Scene meeting() {
    Scene scene = empty_box(0.6, 0.3, 0.025);
    scene.gravity = 9.8;
    scene.tilt_deg = 20.0;
    scene.left = {Wall::Kind::friction, 0.3};
    scene.floor = {Wall::Kind::friction, 0.5};
    scene.right = {Wall::Kind::slip};
    scene.top = {Wall::Kind::no_slip};
    scene.bodies = {block(0.0, 0.0, 0.2, 0.2, mu_i(26000.0)),
                    block(0.3, 0.05, 0.2, 0.2, newtonian(0.1, 2e4, 7, 1000))};
    scene.bodies[0].velocity = {1.0, -0.5};
    scene.bodies[1].velocity = {-2.0, 1.0};
    scene.bodies[1].spin = 3.0;
    return scene;
  }
  static SavedState end_of(const Scene& scene, int threads, int steps = 150) {
    Simulation simulation(scene, threads);
    run_steps(simulation, steps);
    EXPECT_GT(simulation.counters().sorts, 2);
    return saved_state(simulation);
  }
};

TEST_P(ExtendedPicTest, OfFirstOrderIsPicToTheLastBit) {
  Scene scene = meeting();
  scene.transfer = Transfer::pic;
  const SavedState pic = end_of(scene, 1);
  scene.transfer = GetParam();
  scene.order = 1;
  EXPECT_EQ(end_of(scene, 1), pic);
  scene.order = 2;
  EXPECT_FALSE(end_of(scene, 1) == pic);
}

TEST_P(ExtendedPicTest, AnyNumberOfThreads) {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  Scene scene = meeting();
  scene.transfer = GetParam();
  scene.order = 3;
  const SavedState one = end_of(scene, 1);
  EXPECT_EQ(end_of(scene, 2), one);
  EXPECT_EQ(end_of(scene, 4), one);
}

// A turning body without stress, one step: V ← P_m V, the filter alone. With the eigenvalues λ of P
// and the shares c² that V has in them (Σ c² = 1),
//   angular momentum (V is itself ω × x):  l_m = <V, P_m V> = Σ c² (1 − (1 − λ)^m)
//   kinetic energy:                        |P_m V|² = Σ c² (1 − (1 − λ)^m)² = 2 l_m − l_2m.
// Both grow with m towards 1: the grid can turn rigidly. Any other filter breaks the identity.
TEST_P(ExtendedPicTest, AFilterThatConverges) {
  Scene scene = empty_box(1.0, 1.0, 0.05);
  scene.bodies = {block(0.31, 0.28, 0.4, 0.3, newtonian(0.0, 1e3, 1.0, 1000.0))};
  scene.bodies[0].spin = 1.0;
  scene.dt = 1e-6;
  scene.transfer = GetParam();
  std::map<int, double> spin, energy;
  for (const int order : {1, 2, 4, 8, 16, 32, 64}) {
    scene.order = order;
    Simulation simulation(scene, 1);
    const double kinetic = simulation.diagnostics().kinetic_J_per_m;
    const auto turning = [&](const std::vector<PointState>& points) {
      double sum = 0.0;  // about the centre, which rests
      for (const PointState& p : points)
        sum += p[MASS] * ((p[X] - 0.51) * p[VY] - (p[Y] - 0.43) * p[VX]);
      return sum;
    };
    const double start = turning(points_of(simulation));
    simulation.step(HUGE_VAL);
    spin[order] = turning(points_of(simulation)) / start;
    energy[order] = simulation.diagnostics().kinetic_J_per_m / kinetic;
  }
  for (int m = 1; m < 64; m *= 2) {
    EXPECT_LT(spin[m], spin[2 * m]);
    EXPECT_LT(spin[m], 1.0);
    EXPECT_LT(energy[m], energy[2 * m]);
    // The points moved by ω Δt = 1e-6 of a radian before they were looked at: second order in it
    // for a rotation. Sums over 192 points and m passes of round-off: 64 × 192 eps.
    EXPECT_NEAR(energy[m], 2.0 * spin[m] - spin[2 * m], 3e-12) << "m = " << m;
  }
  EXPECT_LT(1.0 - spin[64], 0.1 * (1.0 - spin[1]));
}

// Σ m_i (A v)_i = Σ m_i v_i: a burst changes no momentum, sums of 256 points over 500 steps.
TEST_P(ExtendedPicTest, MomentumIsKept) {
  Scene scene = empty_box(2.0, 1.5, 0.025);
  Body body = block(0.8, 0.6, 0.2, 0.2, mu_i());
  body.velocity = {0.6, 0.3};
  body.spin = 6.0;
  body.initial.p = 50.0;
  scene.bodies = {body};
  scene.transfer = GetParam();
  scene.order = 4;
  scene.dt = 1e-4;
  Simulation simulation(scene, 2);
  run_steps(simulation, 500);
  const SeriesRow row = simulation.diagnostics();
  EXPECT_NEAR(row.momentum_x / row.mass_kg_per_m, 0.6, 500 * 16 * 2.2e-16);
  EXPECT_NEAR(row.momentum_y / row.mass_kg_per_m, 0.3, 500 * 16 * 2.2e-16);
}

// The account closes to second order in the step, as with the other transfers (collapse_test.cpp).
TEST_P(ExtendedPicTest, TheLedgerCloses) {
  for (const bool tilted : {false, true}) {
    Scene scene = column_collapse(mu_i(26000.0), 0.025);
    scene.domain[1] = 0.55;
    scene.tilt_deg = tilted ? 35.0 : 0.0;
    scene.transfer = GetParam();
    scene.order = 3;
    Simulation simulation(scene, 1);
    const double start = simulation.diagnostics().potential_J_per_m;
    double residual = 0.0, drop = 0.0;
    for (int k = 1; k <= 30; ++k) {
      run_until(simulation, k * 0.02);
      const SeriesRow row = simulation.diagnostics();
      residual = std::max(residual, std::abs(row.energy_residual_J_per_m));
      drop = std::max(drop, start - row.potential_J_per_m);
    }
    EXPECT_GT(drop, 10.0);
    EXPECT_LT(residual, 0.01 * drop);
  }
}

INSTANTIATE_TEST_SUITE_P(Transfers, ExtendedPicTest,
                         ::testing::Values(Transfer::xpic, Transfer::fmpm), [](const auto& one) {
                           return std::string(transfer_names[static_cast<std::size_t>(one.param)]);
                         });

}  // namespace
}  // namespace repose::mpm

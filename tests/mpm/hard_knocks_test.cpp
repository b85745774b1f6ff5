/// Scenes that no one should run, and what the solver promises for them all the same.

#include <random>

#include <gtest/gtest.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

/// Six bodies at random velocities of up to `speed` and as much spin, each starting at a wall.
Scene riot(unsigned seed, double speed, const std::vector<LawSpec>& laws) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> sign(-1.0, 1.0);
  Scene scene = empty_box(0.9, 0.5, 0.025);
  scene.gravity = 9.8;
  scene.tilt_deg = 30.0 * sign(random);
  const Wall walls[] = {{Wall::Kind::slip}, {Wall::Kind::no_slip}, {Wall::Kind::friction, 0.4}};
  for (Wall* wall : {&scene.left, &scene.right, &scene.floor, &scene.top})
    *wall = walls[random() % 3];
  scene.kernel = random() % 2 == 0 ? Kernel::cubic : Kernel::quadratic;
  for (std::size_t b = 0; b < 6; ++b) {
    Body body = block(0.35 * static_cast<double>(b % 3), b < 3 ? 0.0 : 0.3, 0.2, 0.2,
                      laws[b % laws.size()]);
    body.velocity = {speed * sign(random), speed * sign(random)};
    body.spin = speed * sign(random);
    scene.bodies.push_back(body);
  }
  return scene;
}

void expect_all_inside(const Simulation& simulation, std::int64_t points) {
  const auto found = points_of(simulation);
  EXPECT_EQ(static_cast<std::int64_t>(found.size()), points);
  for (const PointState& p : found) {
    EXPECT_TRUE(p[X] >= 0.0 && p[X] <= simulation.scene().domain[0]) << p[X];
    EXPECT_TRUE(p[Y] >= 0.0 && p[Y] <= simulation.scene().domain[1]) << p[Y];
    for (const double value : p.field) EXPECT_TRUE(std::isfinite(value));
  }
}

// Impacts at Mach 4 and more, every kind of wall: nothing passes, and the interpolated velocity
// alone sees to it (no point has ever to be put back).
TEST(ClosedBoxTest, NothingLeaves) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Simulation simulation(riot(seed, 20.0,
                               {newtonian(0.1, 2e4, 7.0, 1000.0), mu_i(2e4), cam_clay(),
                                newtonian(0.01, 2e4, 1.0, 1000.0, true), cam_clay("v-ln_p")}),
                          2);
    const std::int64_t points = simulation.point_count();
    const double mass = simulation.diagnostics().mass_kg_per_m;
    run_steps(simulation, 700);
    expect_all_inside(simulation, points);
    EXPECT_NEAR(simulation.diagnostics().mass_kg_per_m / mass, 1.0, 1e-12);
    EXPECT_EQ(simulation.counters().wall_corrections, 0);
    EXPECT_GT(simulation.counters().sorts, 1);
  }
}

// Pressures of a law that dilates with its rate grow like the square of the speed, and steps shrink
// accordingly: a slower riot.
TEST(ClosedBoxTest, NorDoesWhatDilatesWithItsRate) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Simulation simulation(riot(seed, 4.0, {critical_state(), mu_i(2e4), critical_state(0.1)}), 2);
    const std::int64_t points = simulation.point_count();
    const double mass = simulation.diagnostics().mass_kg_per_m;
    run_steps(simulation, 700);
    expect_all_inside(simulation, points);
    EXPECT_NEAR(simulation.diagnostics().mass_kg_per_m / mass, 1.0, 1e-12);
    EXPECT_EQ(simulation.counters().wall_corrections, 0);
  }
}

// Steps in which points leap over several cells and into the walls: never beyond them, nor beyond
// the memory of their tiles.
TEST(ClosedBoxTest, NothingLeavesInLeaps) {
  std::int64_t corrections = 0;
  for (const double cells_per_step : {0.97, 3.0, 100.0})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      Scene scene = riot(seed, 20.0, {mu_i(20.0), newtonian(1e-3, 1.0, 1.0, 1000.0)});
      scene.dt = cells_per_step * scene.h / 20.0;
      Simulation simulation(scene, 2);
      const std::int64_t points = simulation.point_count();
      try {
        run_steps(simulation, 200);
      } catch (const NumericalFailure&) {  // as it may; but not with points elsewhere
      }
      expect_all_inside(simulation, points);
      corrections += simulation.counters().wall_corrections;
    }
  EXPECT_GT(corrections, 1000) << "it was a test";
}

std::string failure_of(Simulation& simulation, double end, int most_steps = 5000) {
  try {
    while (simulation.time() < end && simulation.steps() < most_steps) simulation.step(end);
  } catch (const NumericalFailure& failure) {
    return failure.what();
  }
  return "";
}

Scene small_collapse(const LawSpec& law) {
  Scene scene = column_collapse(law, 0.025);
  scene.domain[1] = 0.55;
  scene.bodies[0].lithostatic = true;
  scene.bodies[0].initial = {};
  return scene;
}

// Ten times the step for which the waves allow: a failure within some steps of the first impact
// that names step, dt and the input as cause.
TEST(DivergenceTest, AStepBeyondTheWaveLimitIsTheInputsFault) {
  for (const LawSpec& law :
       {newtonian(0.002, 26000.0, 7.0, 1300.0), mu_i(), cam_clay(), critical_state()})
    for (const double factor : {10.0, 1000.0}) {
      Scene scene = small_collapse(law);
      scene.dt = factor * Simulation(scene, 1).next_dt() / scene.courant;
      Simulation simulation(scene, 2);
      const std::string what = failure_of(simulation, 1e9);
      EXPECT_NE(what.find("too large for the wave speed (input); try a smaller dt"),
                std::string::npos)
          << law.name << ": " << what;
      EXPECT_EQ(what.find("step " + std::to_string(simulation.steps()) + " at t = "), 0U) << what;
      EXPECT_LT(simulation.steps(), 20);
      ASSERT_FALSE(simulation.warnings().empty());
      EXPECT_NE(simulation.warnings()[0].find("Courant number"), std::string::npos);
    }
}

TEST(DivergenceTest, AStepBeyondTheViscousLimitIsTheInputsFault) {
  Scene scene = small_collapse(newtonian(500.0, 26000.0, 1.0, 1300.0));
  const double limit = 1300.0 * scene.h * scene.h / (4.0 * 500.0);
  scene.dt = 3.0 * limit;  // Courant 0.22
  Simulation simulation(scene, 2);
  const std::string what = failure_of(simulation, 10.0);
  EXPECT_NE(what.find("(input); try a smaller dt"), std::string::npos) << what;
  scene.dt.reset();
  Simulation sound(scene, 2);
  EXPECT_LT(sound.next_dt(), limit);
  EXPECT_EQ(failure_of(sound, 0.1), "");
}

// The failing step is the first that is not sound: one step before, the energy was still possible.
TEST(DivergenceTest, IsSeenWhereItStarts) {
  Scene scene = small_collapse(mu_i());
  scene.dt = 10.0 * Simulation(scene, 1).next_dt() / scene.courant;
  Simulation simulation(scene, 2);
  const SeriesRow start = simulation.diagnostics();
  double before = 0.0;
  bool failed = false;
  while (!failed) {
    try {
      simulation.step(1e9);
      before = simulation.diagnostics().kinetic_J_per_m;
    } catch (const NumericalFailure&) {
      failed = true;
    }
    ASSERT_LT(simulation.steps(), 100);
  }
  EXPECT_LE(before, 2.0 * (start.potential_J_per_m + start.elastic_J_per_m) * (1.0 + 1e-6));
}

// A failed state can be written, read and stepped without harm: it fails again, or goes on.
TEST(DivergenceTest, AFailedStateCanBeSaved) {
  for (const LawSpec& law :
       {newtonian(0.002, 26000.0, 7.0, 1300.0), mu_i(), cam_clay(), critical_state()})
    for (const double factor : {10.0, 1e3, 1e12}) {
      Scene scene = small_collapse(law);
      scene.dt = factor * Simulation(scene, 1).next_dt() / scene.courant;
      Simulation simulation(scene, 2);
      ASSERT_NE(failure_of(simulation, 1e99), "");
      const ScratchFile file;
      simulation.save(file.path());
      Simulation other(scene, 2);
      other.load(file.path());
      EXPECT_EQ(other.steps(), simulation.steps());
      failure_of(other, 1e99, 20 + static_cast<int>(other.steps()));
      EXPECT_EQ(other.point_count(), simulation.point_count());
    }
}

// The last step before a stop may be as short as it likes.
TEST(DivergenceTest, AShortLastStepIsNoFailure) {
  Scene scene = small_collapse(mu_i());
  Simulation simulation(scene, 1);
  simulation.step(HUGE_VAL);
  const double close = std::nextafter(simulation.time(), 1.0);
  EXPECT_NO_THROW(simulation.step(close));
  EXPECT_EQ(simulation.time(), close);
  const SavedState here = saved_state(simulation);
  simulation.step(close);  // already there
  simulation.step(0.0);    // and never backwards
  EXPECT_EQ(saved_state(simulation), here);
  EXPECT_NO_THROW(simulation.step(HUGE_VAL));
}

}  // namespace
}  // namespace repose::mpm

/// What probes see and tracers follow, against what is known of the scene.

#include <gtest/gtest.h>

#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

/// A layer under its own weight, 0.4 m deep.
Scene layer(Kernel kernel = Kernel::cubic) {
  Scene scene = empty_box(0.4, 0.6, 0.025);
  scene.gravity = 10.0;
  scene.kernel = kernel;
  Body body = block(0.0, 0.0, 0.4, 0.4, mu_i(1e6));
  body.lithostatic = true;
  scene.bodies = {body};
  return scene;
}

TEST(Probes, PressureAndDepthOfALayerAtRest) {
  Simulation simulation(layer(), 1);
  const double h = 0.025, gradient = 1300.0 * 10.0;
  for (const double y : {0.1, 0.2, 0.21, 0.3}) {
    for (const double x : {0.0, 0.01, 0.2, 0.4}) {
      const Simulation::Sight sight = simulation.look_at({x, y});
      // K/(ρ g H) = 190: the density, and with it the weight, is that at rest to 0.6 %; K0 = 1. The
      // points within a cell lie symmetrically to a place on the lattice, and elsewhere their mean
      // is within half a spacing, h/4, of it
      const double p = gradient * (0.4 - y);
      EXPECT_NEAR(sight.pressure, p, 0.006 * p + gradient * h / 4) << x << ", " << y;
      EXPECT_NEAR(sight.q, 0.0, 1e-9 * p);
      EXPECT_NEAR(sight.density, 1300.0, 0.006 * 1300.0);
      // the lattice sums a hat over a spacing of h/2: exact at its nodes, and elsewhere within
      // (Δ/h)²/4 = 1/16; the mass of the column is 0.6 % more than that at ρ_0
      EXPECT_NEAR(sight.depth, 0.4, 0.4 * (1.0 / 16.0 + 0.006)) << x;
      EXPECT_EQ(sight.velocity, (std::array<double, 3>{}));
    }
    // half of the lattice is a node of hats: Σ 1 − |d| over d = ±1/4, ±3/4 is 2, the whole
    EXPECT_NEAR(simulation.look_at({0.2, y}).depth, 0.4, 0.4 * 0.006);
  }
  const Simulation::Sight above = simulation.look_at({0.2, 0.55});
  EXPECT_EQ(above.mass, 0.0);
  EXPECT_NEAR(above.depth, 0.4, 0.4 * 0.006);
}

// p of a layer in motion is the mean over what moves with it; here all of it falls.
TEST(Probes, VelocityOfAFall) {
  for (const Kernel kernel : {Kernel::quadratic, Kernel::cubic}) {
    Scene scene = layer(kernel);
    scene.floor = {Wall::Kind::open};
    scene.bodies[0] = block(0.1, 0.2, 0.2, 0.2, newtonian(0.0, 1e4, 1.0, 1000.0));
    scene.bodies[0].velocity = {0.5, 0.0};
    scene.tracers = {{"low", {0.1, 0.2, 0.0}}, {"high", {0.21, 0.39, 0.0}}};
    Simulation simulation(scene, 1);
    const std::array low = simulation.tracer(0).position, high = simulation.tracer(1).position;
    EXPECT_NEAR(low[0], 0.10625, 1e-12);  // half a spacing from the corner
    EXPECT_NEAR(low[1], 0.20625, 1e-12);
    EXPECT_NEAR(high[0], 0.20625, 1e-12);
    EXPECT_NEAR(high[1], 0.39375, 1e-12);
    const double t = 0.1;
    run_until(simulation, t);
    const Simulation::Sight now = simulation.tracer(1);
    EXPECT_NEAR(now.position[0], high[0] + 0.5 * t, 1e-11);
    // positions take the velocity at the end of a step: the fall is ½ g t (t + Δt)
    const double dt = simulation.diagnostics().dt_s;
    EXPECT_NEAR(now.position[1], high[1] - 0.5 * 10.0 * t * t, 0.5 * 10.0 * t * 1.5 * dt);
    EXPECT_NEAR(now.velocity[1], -10.0 * t, 1e-11);
    EXPECT_NEAR(now.density, 1000.0, 1e-8);
    const Simulation::Sight seen = simulation.look_at({0.25, 0.25});
    EXPECT_NEAR(seen.velocity[0], 0.5, 1e-11);
    EXPECT_NEAR(seen.velocity[1], -10.0 * t, 1e-11);
    run_until(simulation, 0.4);  // it leaves through the floor
    EXPECT_EQ(simulation.tracer(0).mass, 0.0);
  }
}

TEST(Probes, InSpace) {
  Scene scene = empty_box(0.4, 0.4, 0.05);
  scene.domain[2] = 0.3;
  scene.points_per_cell = 8;
  Body body = block(0.0, 0.0, 0.4, 0.2, newtonian(0.0, 1e4, 1.0, 1000.0));
  body.size[2] = 0.3;
  body.velocity = {0.1, 0.0, 0.2};
  scene.bodies = {body};
  scene.tracers = {{"one", {0.2, 0.1, 0.2}}};
  const Simulation simulation(scene, 1);
  const Simulation::Sight sight = simulation.look_at({0.2, 0.1, 0.15});
  EXPECT_NEAR(sight.depth, 0.2, 1e-12);
  EXPECT_NEAR(sight.velocity[0], 0.1, 1e-13);
  EXPECT_NEAR(sight.velocity[2], 0.2, 1e-13);
  EXPECT_NEAR(sight.density, 1000.0, 1e-9);
  EXPECT_NEAR(simulation.look_at({0.0, 0.1, 0.3}).depth, 0.2, 1e-12);
  EXPECT_NEAR(simulation.tracer(0).position[2], 0.2, 0.0126);  // half a spacing
  EXPECT_EQ(simulation.look_at({0.2, 0.35, 0.15}).mass, 0.0);
}

TEST(Probes, PlacesInTheBoxWithNamesOfTheirOwn) {
  const auto refused = [](const auto& change) -> std::string {
    Scene scene = layer();
    scene.probes = {{"a", {0.1, 0.1, 0.0}}, {"b", {0.2, 0.1, 0.0}}};
    scene.tracers = {{"a", {0.1, 0.1, 0.0}}};
    change(scene);
    try {
      validate(scene);
    } catch (const InputError& e) {
      return e.key();
    }
    return "";
  };
  EXPECT_EQ(refused([](Scene&) {}), "");
  EXPECT_EQ(refused([](Scene& s) { s.probes[1].name = "a"; }), "probe[1].name");
  EXPECT_EQ(refused([](Scene& s) { s.probes[1].place[0] = 0.5; }), "probe[1].place");
  EXPECT_EQ(refused([](Scene& s) { s.tracers[0].place[1] = -0.1; }), "tracer[0].place");
}

}  // namespace
}  // namespace repose::mpm

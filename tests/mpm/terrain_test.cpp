/// Flows over ground that a map tells.

#include <functional>

#include <gtest/gtest.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double g = 10.0;

io::Raster raster(double width, double height, double cell,
                  const std::function<double(double, double)>& value) {
  io::Raster map;
  map.columns = static_cast<std::size_t>(std::lround(width / cell));
  map.rows = static_cast<std::size_t>(std::lround(height / cell));
  map.west = 1000.0;
  map.south = 2000.0;
  map.cell = cell;
  for (std::size_t row = 0; row < map.rows; ++row)
    for (std::size_t column = 0; column < map.columns; ++column)
      map.values.push_back(value(cell * (static_cast<double>(column) + 0.5),
                                 cell * (static_cast<double>(row) + 0.5)));
  return map;
}

/// Ground y(x, z) in a box of cells h, and depths of what is released on it, in the scene's axes.
Scene scene_of(double width, double depth, double h, double cell,
               const std::function<double(double, double)>& ground,
               const std::function<double(double, double)>& release, const LawSpec& law) {
  Scene scene;
  scene.name = "test";
  scene.h = h;
  scene.points_per_cell = 8;
  scene.gravity = g;
  scene.courant = 0.4;
  scene.end_time = 1.0;
  scene.left = scene.right = scene.near = scene.far = scene.top = {Wall::Kind::open};
  Terrain terrain;
  terrain.ground_map = raster(width, depth, cell, ground);
  terrain.release_map = raster(width, depth, cell, release);
  scene.terrain = std::move(terrain);
  Body body;
  body.release = true;
  body.law = law;
  scene.bodies = {body};
  fit_to_terrain(scene);
  return scene;
}

std::function<double(double, double)> patch(double from_x, double to_x, double from_z, double to_z,
                                            double depth) {
  return [=](double x, double z) {
    return x > from_x && x < to_x && z > from_z && z < to_z ? depth : 0.0;
  };
}

struct Centre {
  Position x{};
  double mass = 0.0;
};
/// Of the mass where `counts` (x, z).
Centre centre(
    const Simulation& simulation,
    const std::function<bool(double, double)>& counts = [](double, double) { return true; }) {
  const auto fields = simulation.point_fields();
  Centre c;
  for (std::size_t n = 0; n < fields.mass.size(); ++n) {
    if (!counts(fields.position[3 * n], fields.position[3 * n + 2])) continue;
    c.mass += fields.mass[n];
    for (std::size_t a = 0; a < 3; ++a) c.x[a] += fields.mass[n] * fields.position[3 * n + a];
  }
  for (double& x : c.x) x /= c.mass;
  return c;
}

/// Grains of which nothing yields, c = 28 m/s.
LawSpec stiff() { return unyielding(1e6); }

// A stiff sheet slides down a plane at ½g(sinθ − μ cosθ)t², however thin it is. Until its weight
// has come to press it slides freely, for about its period 4d/c: a share of 2·4d/ct of the way that
// friction takes, μ/(tanθ − μ) of it; and as much again is left to the cells.
TEST(TerrainTest, ASheetSlidesDownAPlaneAsAPointWould) {
  const double slope = std::tan(30.0 * degree), friction = 0.3, t = 1.5;
  for (const double depth : {1.0, 2.0, 4.0}) {
    Scene scene = scene_of(
        60.0, 16.0, 1.0, 2.0, [&](double x, double) { return slope * (60.0 - x); },
        patch(8.0, 24.0, 4.0, 12.0, depth / std::cos(30.0 * degree)), stiff());
    scene.terrain->contact = Surface::Contact::friction;
    scene.terrain->friction = friction;
    Simulation simulation(scene, 1);
    const Centre start = centre(simulation);
    run_until(simulation, t);
    const Centre end = centre(simulation);
    const double way = (end.x[0] - start.x[0]) / std::cos(30.0 * degree);
    const double exact =
        0.5 * g * (std::sin(30.0 * degree) - friction * std::cos(30.0 * degree)) * t * t;
    const double landing = 8.0 * depth / (28.0 * t) * friction / (slope - friction);
    std::printf("[ measured ] sheet of %g cells: way %.3f m, exact %.3f, %+.2f %%\n", depth, way,
                exact, 100.0 * (way / exact - 1.0));
    EXPECT_NEAR(way, exact, 2.0 * landing * exact) << depth;
    EXPECT_NEAR(end.mass, start.mass, 1e-12 * start.mass);
    EXPECT_NEAR(end.x[2], start.x[2], 1e-9);  // not sideways
  }
}

// Huygens: on a cycloid without friction the way to its lowest point takes as long from everywhere,
// s = s_0 cos(t √(g/4a)). The block's middle runs half a cell above a curve of radius 4a cos(φ/2):
// its own is shorter by that share, 0.5/139; the block is let go from rest on an incline and is
// stretched by gravity's change along it, both of less.
TEST(TerrainTest, ABlockOnACycloidKeepsHuygensTime) {
  constexpr double a = 40.0, width = 200.0, h = 1.0;
  const auto angle_at = [&](double x) {  // x = a(φ + sin φ), by Newton's steps
    double phi = x / (2.0 * a);
    for (int k = 0; k < 20; ++k)
      phi -= (a * (phi + std::sin(phi)) - x) / (a * (1.0 + std::cos(phi)));
    return phi;
  };
  const auto ground = [&](double x, double) {
    return a * (1.0 - std::cos(angle_at(x - 0.5 * width)));
  };
  const auto way_of = [&](double x) { return 4.0 * a * std::sin(0.5 * angle_at(x - 0.5 * width)); };
  for (const double start : {30.0, 70.0}) {
    LawSpec elastic{"neo_hookean", {}, {{"E", 2e6}, {"nu", 0.3}, {"rho_0", 1300.0}}};
    Scene scene = scene_of(
        width, 8.0, h, 1.0, ground,
        patch(0.5 * width - start - 2.0, 0.5 * width - start + 2.0, 2.0, 6.0, 1.0), elastic);
    scene.terrain->contact = Surface::Contact::slip;
    Simulation simulation(scene, 1);
    const double s_0 = way_of(centre(simulation).x[0]);
    double worst = 0.0;
    for (const double share : {0.5, 1.0, 1.5}) {  // of a quarter of the period
      const double t = share * std::numbers::pi * std::sqrt(a / g);
      run_until(simulation, t);
      const double s = way_of(centre(simulation).x[0]);
      worst = std::max(worst, std::abs(s - s_0 * std::cos(t * std::sqrt(g / (4.0 * a)))));
    }
    std::printf("[ measured ] cycloid from s = %.1f m: off by %.3f m, %.2f %%\n", s_0, worst,
                100.0 * worst / std::abs(s_0));
    EXPECT_LT(worst, 2.0 * 0.5 / 139.0 * std::abs(s_0));
  }
}

// Friction from place to place: two blocks on one plane, each with its own.
TEST(TerrainTest, FrictionIsThatOfThePlace) {
  const double slope = std::tan(35.0 * degree), t = 1.5;
  const auto two = [](double x, double z) {
    return x > 8.0 && x < 16.0 && ((z > 4.0 && z < 10.0) || (z > 22.0 && z < 28.0)) ? 2.0 : 0.0;
  };
  Scene scene = scene_of(
      48.0, 32.0, 1.0, 2.0, [&](double x, double) { return slope * (48.0 - x); }, two, stiff());
  scene.terrain->contact = Surface::Contact::friction;
  scene.terrain->friction_raster =
      raster(48.0, 32.0, 2.0, [](double, double z) { return z < 16.0 ? 0.2 : 0.5; });
  scene.terrain->place();
  Simulation simulation(scene, 1);
  for (const bool north : {true, false}) {
    const auto side = [&](double, double z) { return (z < 16.0) == north; };
    Simulation run(scene, 1);
    const Centre start = centre(run, side);
    run_until(run, t);
    const double way = (centre(run, side).x[0] - start.x[0]) / std::cos(35.0 * degree);
    const double friction = north ? 0.2 : 0.5;
    const double exact =
        0.5 * g * (std::sin(35.0 * degree) - friction * std::cos(35.0 * degree)) * t * t;
    const double landing = 8.0 * 2.0 / (28.0 * t) * friction / (slope - friction);
    std::printf("[ measured ] friction %.1f: way %.3f m, exact %.3f, %+.2f %%\n", friction, way,
                exact, 100.0 * (way / exact - 1.0));
    EXPECT_NEAR(way, exact, 2.0 * landing * exact) << friction;
  }
}

TEST(TerrainTest, WhatIsReleasedHasItsVolume) {
  const auto ground = [](double x, double z) { return 0.2 * x + 0.05 * std::sin(z); };
  const auto depths = [](double x, double z) {
    return std::max(0.0, 3.0 - 0.01 * (x - 20.0) * (x - 20.0) - 0.03 * (z - 12.0) * (z - 12.0));
  };
  LawSpec law = stiff();
  Scene scene = scene_of(40.0, 24.0, 1.0, 1.7, ground, depths, law);
  for (const double h : {1.0, 0.5}) {
    scene.h = h;
    scene.domain = {};
    fit_to_terrain(scene);
    const Simulation simulation(scene, 1);
    const double mass = 1300.0 * scene.terrain->release->volume();
    EXPECT_NEAR(centre(simulation).mass, mass, 1e-12 * mass);
    EXPECT_NEAR(static_cast<double>(simulation.point_count()),
                expected_points(scene, scene.bodies[0]),
                0.15 * static_cast<double>(simulation.point_count()));  // whole points per column
  }
  scene.terrain->release_map =
      std::vector<io::Region>{{{{1004.3, 2005.1}, {1030.7, 2004.2}, {1020.0, 2019.9}},
                               {{{1015, 2008}, {1020, 2008}, {1018, 2012}}},
                               {}}};
  scene.terrain->release_depth = 1.3;
  scene.terrain->place();
  set_release(scene.bodies[0], *scene.terrain);
  const Simulation simulation(scene, 1);
  const double mass = 1300.0 * scene.terrain->release->volume();
  EXPECT_NEAR(centre(simulation).mass, mass, 1e-12 * mass);
}

// A sheet that glides over level ground at u without weight: it is u fast everywhere and keeps its
// depth of whole cells; a node is reached when a quarter of it has come (a hat that is half a cell
// wide on either side has a quarter of its mass in within a cell of the edge), to the half cell
// that passes between two looks.
TEST(TerrainTest, MapsTellDepthSpeedAndArrival) {
  constexpr double u = 3.0, h = 1.0;
  Scene scene = scene_of(
      40.0, 12.0, h, 2.0, [](double, double) { return 0.0; }, patch(4.0, 12.0, 4.0, 8.0, 2.0),
      stiff());
  scene.gravity = 0.0;
  scene.transfer = Transfer::apic;
  scene.terrain->contact = Surface::Contact::slip;
  scene.bodies[0].velocity = {u, 0.0, 0.0};
  Simulation simulation(scene, 1);
  run_until(simulation, 5.0);
  const Simulation::PlanMaps maps = simulation.plan_maps();
  const auto node = [&](std::size_t i, std::size_t k) { return k * maps.columns + i; };
  for (std::size_t i = 14; i < 26; ++i) {
    EXPECT_NEAR(maps.depth_max_m[node(i, 6)], 2.0, 0.01) << i;
    EXPECT_NEAR(maps.speed_max[node(i, 6)], u, 1e-9) << i;
    const double first = (h * static_cast<double>(i) - 12.0 - h) / u,
                 last = first + (h + 0.5 * h) / u;
    EXPECT_GE(maps.arrival_s[node(i, 6)], first) << i;
    EXPECT_LE(maps.arrival_s[node(i, 6)], last) << i;
    EXPECT_EQ(maps.arrival_s[node(i, 1)], HUGE_VAL);
    EXPECT_EQ(maps.speed_max[node(i, 1)], 0.0);
  }
  EXPECT_EQ(maps.arrival_s[node(8, 6)], 0.0);
  // now it lies from 19 to 27
  EXPECT_NEAR(maps.depth_m[node(23, 6)], 2.0, 0.01);
  EXPECT_EQ(maps.depth_m[node(10, 6)], 0.0);
}

Scene small_valley() {
  Scene scene = scene_of(
      40.0, 24.0, 1.0, 2.0,
      [](double x, double z) {
        return 12.0 * std::exp(-x / 15.0) + 0.03 * (z - 12.0) * (z - 12.0) + 0.2 * std::sin(x);
      },
      [](double x, double z) {
        return std::max(0.0, 3.0 - 0.08 * (x - 8.0) * (x - 8.0) - 0.1 * (z - 11.0) * (z - 11.0));
      },
      mu_i(1e6));
  scene.terrain->contact = Surface::Contact::friction;
  scene.terrain->friction = 0.3;
  return scene;
}

TEST(TerrainTest, SameBitsForAnyThreadsAndAfterResuming) {
  const Scene scene = small_valley();
  const ScratchFile file;
  const auto state_of = [&](Simulation& simulation) {
    simulation.save(file.path());
    return read_state(file.path());
  };
  std::vector<SavedState> states;
  for (const int threads : {1, 2, 4}) {
    Simulation simulation(scene, threads);
    run_until(simulation, 0.8);
    run_until(simulation, 1.6);
    states.push_back(state_of(simulation));
  }
  EXPECT_EQ(states[0], states[1]);
  EXPECT_EQ(states[0], states[2]);
  EXPECT_EQ(states[0].reals.at("maps_depth_max").size(), 41U * 25U);
  Simulation first(scene, 2);
  run_until(first, 0.8);
  first.save(file.path());
  Simulation second(scene, 2);
  second.load(file.path());
  run_until(second, 1.6);
  EXPECT_EQ(states[0], state_of(second));
}

// The ledger of a flow over uneven ground: the half kick of the moment and what is of second order,
// for which as much is allowed (rigid_surface_test.cpp), over the energy that the fall has set
// free.
TEST(TerrainTest, TheLedgerClosesOverUnevenGround) {
  Simulation simulation(small_valley(), 1);
  const auto scene_ground = simulation.scene().terrain->ground;
  const SeriesRow start = simulation.diagnostics();
  run_until(simulation, 2.0);
  const SeriesRow row = simulation.diagnostics();
  const double fall = start.potential_J_per_m - row.potential_J_per_m;
  std::printf("[ measured ] uneven ground: residual/fall %.2g\n",
              row.energy_residual_J_per_m / fall);
  EXPECT_GT(fall, 0.0);
  EXPECT_LT(std::abs(row.energy_residual_J_per_m), 2.0 * row.dt_s / 2.0 * fall);
  EXPECT_NEAR(row.mass_kg_per_m + row.outflow_kg_per_m, start.mass_kg_per_m,
              1e-12 * start.mass_kg_per_m);
  const auto points = simulation.point_fields();
  for (std::size_t n = 0; n < points.mass.size(); ++n)
    EXPECT_GE(points.position[3 * n + 1],
              scene_ground->height(points.position[3 * n], points.position[3 * n + 2]) - 1e-12);
}

// What is thrown at the ground, at more than its speed of sound, stays above it.
TEST(TerrainTest, NothingGetsBelowTheGround) {
  Scene scene = small_valley();
  scene.bodies[0].velocity = {10.0, -60.0, 5.0};
  Simulation simulation(scene, 1);
  for (int k = 0; k < 40; ++k) {
    simulation.step(HUGE_VAL);
    const auto points = simulation.point_fields();
    for (std::size_t n = 0; n < points.mass.size(); ++n)
      ASSERT_GE(
          points.position[3 * n + 1],
          scene.terrain->ground->height(points.position[3 * n], points.position[3 * n + 2]) - 1e-12)
          << "step " << k;
  }
}

std::string complaint(const std::function<void(Scene&)>& spoil) {
  Scene scene = small_valley();
  spoil(scene);
  try {
    validate(scene);
  } catch (const InputError& error) {
    return error.key() + ": " + error.what();
  }
  return "";
}

TEST(TerrainTest, SaysWhatCannotBe) {
  EXPECT_EQ(complaint([](Scene&) {}), "");
  EXPECT_NE(complaint([](Scene& s) { s.tilt_deg = 5.0; }).find("scene.tilt_deg: on a terrain"),
            std::string::npos);
  EXPECT_NE(complaint([](Scene& s) { s.domain[0] = 80.0; }).find("domain.size: the box is 80 m"),
            std::string::npos);
  EXPECT_NE(complaint([](Scene& s) {
              s.terrain->base = 20.0;
              s.terrain->place();
            }).find("terrain.base: the ground is"),
            std::string::npos);
  EXPECT_NE(complaint([](Scene& s) { s.bodies.push_back(s.bodies[0]); }).find("one body only"),
            std::string::npos);
  EXPECT_NE(complaint([](Scene& s) {
              s.terrain->release_map = std::monostate{};
              s.terrain->release.reset();
            }).find("body[0].shape: shape = \"release\" needs terrain.release"),
            std::string::npos);
  EXPECT_NE(complaint([](Scene& s) {
              std::get<io::Raster>(s.terrain->release_map).west += 500.0;
              s.terrain->place();
            }).find("are both maps in the same coordinates?"),
            std::string::npos);
  EXPECT_NE(complaint([](Scene& s) { s.terrain->friction = -0.1; }).find("terrain.friction"),
            std::string::npos);
  EXPECT_NE(complaint([](Scene& s) { s.viscosity = Viscosity::implicit_solve; }), "");
}

}  // namespace
}  // namespace repose::mpm

/// Scenes in three dimensions.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

/// An empty box in space without gravity, slip walls all around.
Scene empty_space(double width, double height, double depth, double h) {
  Scene scene = empty_box(width, height, h);
  scene.domain[2] = depth;
  scene.points_per_cell = 8;
  return scene;
}

Body block_in_space(const std::array<double, 3>& origin, const std::array<double, 3>& size,
                    const LawSpec& law) {
  Body body = block(0.0, 0.0, 0.0, 0.0, law);
  body.origin = origin;
  body.size = size;
  return body;
}

LawSpec rubber(double E, double rho_0) {
  return {"neo_hookean", {}, {{"E", E}, {"nu", 0.3}, {"rho_0", rho_0}}};
}

/// A collapse between slip walls in z, `cells` thick, or in plane strain.
Scene collapse(const LawSpec& law, int cells, Transfer transfer) {
  const double h = 0.025;
  Scene scene = empty_box(0.8, 0.5, h);
  scene.gravity = 9.8;
  scene.floor = {Wall::Kind::no_slip};
  scene.transfer = transfer;
  scene.dt = 2e-4;
  scene.bodies = {block(0.0, 0.0, 0.2, 0.4, law)};
  if (cells == 0) return scene;
  scene.domain[2] = scene.bodies[0].size[2] = cells * h;
  scene.points_per_cell = 8;
  return scene;
}

struct SlabCase {
  const char* name;
  LawSpec law;
  Transfer transfer;
};
class SlabTest : public ::testing::TestWithParam<SlabCase> {};

// Rows of points half a cell apart between mirrors: the weights of each row sum to 2 at any node,
// the moments Σ w dz to 0. So nothing pushes along z, the fields do not depend on it, and each
// plane of points moves as plane strain does: what differs is the order of the sums. Round-off
// grows with the flow; in 500 steps here from 1e-16 to 1e-12 of the column's height (free fall:
// 0.05 m).
TEST_P(SlabTest, IsPlaneStrain) {
  const auto& [name, law, transfer] = GetParam();
  Simulation plane(collapse(law, 0, transfer), 1);
  Simulation slab(collapse(law, 4, transfer), 1);
  run_steps(plane, 500);
  run_steps(slab, 500);
  const auto p = plane.snapshot(), s = slab.snapshot();
  const std::size_t columns = 16, layers = 8;
  ASSERT_EQ(s.x_m.size(), p.x_m.size() * layers);
  double fastest = 0.0, off = 0.0, off_z = 0.0, stress = 0.0, off_stress = 0.0;
  for (std::size_t k = 0; k < s.x_m.size(); ++k) {
    // in the order of filling: y, z, x
    const std::size_t twin = k / (columns * layers) * columns + k % columns;
    fastest = std::max(fastest, std::abs(p.vy[twin]));
    off = std::max({off, std::abs(s.x_m[k] - p.x_m[twin]), std::abs(s.y_m[k] - p.y_m[twin])});
    const double z = (0.25 + 0.5 * static_cast<double>(k / columns % layers)) * 0.025;
    off_z = std::max({off_z, std::abs(s.z_m[k] - z), std::abs(s.vz[k])});
    stress = std::max(stress, p.pressure_Pa[twin]);
    off_stress = std::max({off_stress, std::abs(s.pressure_Pa[k] - p.pressure_Pa[twin]),
                           std::abs(s.szz[k] - p.szz[twin]), std::abs(s.syz[k])});
  }
  EXPECT_GT(fastest, 0.2) << "nothing has moved";
  EXPECT_LT(off, 1e-9);
  EXPECT_LT(off_z, 1e-9);
  EXPECT_LT(off_stress, 1e-6 * stress);
  // whole energies against those per metre of depth; the same deposit
  const SeriesRow a = plane.diagnostics(), b = slab.diagnostics();
  const double depth = 0.1;
  EXPECT_NEAR(b.mass_kg_per_m, depth * a.mass_kg_per_m, 1e-12 * a.mass_kg_per_m);
  EXPECT_NEAR(b.kinetic_J_per_m, depth * a.kinetic_J_per_m, 1e-8 * a.kinetic_J_per_m);
  EXPECT_NEAR(b.potential_J_per_m, depth * a.potential_J_per_m, 1e-8 * a.potential_J_per_m);
  EXPECT_NEAR(b.dissipated_J_per_m, depth * a.dissipated_J_per_m, 1e-7 * a.dissipated_J_per_m);
  // of all that is lost: an elastic body dissipates nothing itself
  const double lost = a.dissipated_J_per_m + a.transfer_loss_J_per_m;
  EXPECT_NEAR(b.transfer_loss_J_per_m, depth * a.transfer_loss_J_per_m, 1e-7 * lost);
  EXPECT_NEAR(b.wall_loss_J_per_m, depth * a.wall_loss_J_per_m, 1e-7 * lost);
  EXPECT_NEAR(b.front_m, a.front_m, 1e-8);
  // about the mark, the mean over a slice as heavy as a point, which here is an eighth of a row
  EXPECT_NEAR(b.front_99_m, a.front_99_m, 0.5 * 0.025);
  EXPECT_NEAR(b.height_m, a.height_m, 1e-8);
}

INSTANTIATE_TEST_SUITE_P(
    Laws, SlabTest,
    ::testing::Values(SlabCase{"mu_i", mu_i(26000.0), Transfer::relaxed},
                      SlabCase{"cam_clay", cam_clay(), Transfer::apic},
                      SlabCase{"critical_state", critical_state(), Transfer::relaxed},
                      SlabCase{"newtonian", newtonian(0.1, 26000.0, 7.0, 1300.0), Transfer::tpic},
                      SlabCase{"neo_hookean", rubber(1e5, 1300.0), Transfer::aflip}),
    [](const auto& c) { return c.param.name; });

// A body in free flight through many blocks: momentum and angular momentum to round-off, no stress.
TEST(SpaceTest, FreeFlightKeepsItsMomenta) {
  Scene scene = empty_space(1.0, 1.0, 1.0, 0.05);
  scene.bodies = {block_in_space({0.2, 0.3, 0.2}, {0.2, 0.3, 0.2}, rubber(1e4, 1000.0))};
  scene.bodies[0].velocity = {2.0, -0.7, 1.5};
  Simulation simulation(scene, 1);
  const SeriesRow start = simulation.diagnostics();
  run_until(simulation, 0.2);
  const SeriesRow end = simulation.diagnostics();
  EXPECT_GT(simulation.counters().sorts, 4);
  // sums of 384 m |v|, and their moments, over some 200 steps with a rounding each
  const double momentum = end.mass_kg_per_m * 2.7;
  const double exact = 384 * 200 * 2.2e-16 * momentum;
  EXPECT_NEAR(end.momentum_x, start.momentum_x, exact);
  EXPECT_NEAR(end.momentum_y, start.momentum_y, exact);
  EXPECT_NEAR(end.momentum_z, start.momentum_z, exact);
  EXPECT_NEAR(end.angular_momentum, start.angular_momentum, exact);
  EXPECT_NEAR(end.angular_momentum_x, start.angular_momentum_x, exact);
  EXPECT_NEAR(end.angular_momentum_y, start.angular_momentum_y, exact);
  // uniform motion strains nothing: stress of E times a strain known to ε v dt/h per step
  for (const double q : simulation.snapshot().mises_Pa) EXPECT_LT(q, 1e4 * 200 * 1e-14);
}

// A spinning cube (its points in the corners turn at 0.26 m/s against a wave speed of 3.7 m/s):
// angular momentum to round-off, and what it strains is of the order (v/c)² = 0.5 %.
TEST(SpaceTest, ASpinningCubeTurnsOn) {
  Scene scene = empty_space(1.0, 1.0, 1.0, 0.05);
  scene.bodies = {block_in_space({0.35, 0.35, 0.4}, {0.3, 0.3, 0.2}, rubber(1e4, 1000.0))};
  scene.bodies[0].spin = 1.25;
  Simulation simulation(scene, 1);
  const SeriesRow start = simulation.diagnostics();
  EXPECT_GT(start.angular_momentum, 0.1);
  run_until(simulation, 0.3);
  const SeriesRow end = simulation.diagnostics();
  const double exact = 864 * 300 * 2.2e-16 * start.mass_kg_per_m * 0.26;
  EXPECT_NEAR(end.angular_momentum, start.angular_momentum, exact);
  EXPECT_NEAR(end.angular_momentum_x, start.angular_momentum_x, exact);
  EXPECT_NEAR(end.angular_momentum_y, start.angular_momentum_y, exact);
  EXPECT_NEAR(end.momentum_x, 0.0, exact);
  EXPECT_NEAR(end.momentum_z, 0.0, exact);
  for (const double q : simulation.snapshot().mises_Pa) EXPECT_LT(q, 1e4 * 0.005 * 3.0);
}

/// A cylinder about the corner of the box, or about its middle.
Scene cylinder(const LawSpec& law, double aspect, bool whole, double radius = 0.1,
               double h = 0.0125) {
  const double reach = 2.5 * radius;  // 20, or 15, cells
  Scene scene = empty_space(whole ? 2.0 * reach : reach, std::ceil(1.25 * aspect * radius / h) * h,
                            whole ? 2.0 * reach : reach, h);
  scene.gravity = 9.8;
  scene.floor = {Wall::Kind::no_slip};
  scene.bodies.push_back(block(0.0, 0.0, 0.0, 0.0, law));
  const double centre = whole ? reach : 0.0;
  set_cylinder(scene.bodies[0], {{centre, centre}, radius, 0.0}, 0.0, aspect * radius);
  return scene;
}

// Slip walls are planes of symmetry: a quarter is a quarter of the whole, to round-off as above.
TEST(SpaceTest, AQuarterOfACylinderMovesAsTheWhole) {
  Scene quarter = cylinder(mu_i(26000.0), 1.0, false, 0.1, 0.025);
  Scene whole = cylinder(mu_i(26000.0), 1.0, true, 0.1, 0.025);
  quarter.dt = whole.dt = 2e-4;
  Simulation a(quarter, 1), b(whole, 1);
  run_steps(a, 200);
  run_steps(b, 200);
  EXPECT_EQ(b.point_count(), 4 * a.point_count());
  const SeriesRow q = a.diagnostics(), w = b.diagnostics();
  EXPECT_GT(q.kinetic_J_per_m, 1e-3);
  EXPECT_NEAR(w.kinetic_J_per_m, 4.0 * q.kinetic_J_per_m, 1e-9 * w.kinetic_J_per_m);
  EXPECT_NEAR(w.potential_J_per_m, 4.0 * q.potential_J_per_m, 1e-9 * w.potential_J_per_m);
  // what the planes of symmetry take from the nodes behind them, the whole loses in the transfer
  EXPECT_NEAR(w.wall_loss_J_per_m + w.transfer_loss_J_per_m,
              4.0 * (q.wall_loss_J_per_m + q.transfer_loss_J_per_m), 1e-9 * w.kinetic_J_per_m);
  EXPECT_NEAR(w.front_m, q.front_m, 1e-9);
  EXPECT_NEAR(w.height_m, q.height_m, 1e-9);
  EXPECT_NEAR(w.momentum_x, 0.0, 1e-9);
  EXPECT_NEAR(q.momentum_x, q.momentum_z, 1e-9);
}

// The collapse of a low cylinder, coarse: it slumps from the side, comes to rest, keeps its energy
// balance, and is round: the fastest points lie as far along the walls as between them, to a cell.
TEST(SpaceTest, AxisymmetricCollapse) {
  Scene scene = cylinder(mu_i(26000.0), 0.5, false, 0.1, 0.1 / 6.0);
  scene.transfer = Transfer::relaxed;
  scene.courant = 0.65;
  Simulation simulation(scene, 2);
  const SeriesRow start = simulation.diagnostics();
  EXPECT_NEAR(start.front_m, 0.1, scene.h);
  EXPECT_NEAR(start.height_m, 0.05, 0.05 * 0.05);  // in the first ring, of 7 rows of points
  run_until(simulation, 0.6);  // 8 √(H/g): collapses settle until 6 of them (physics.md)
  const SeriesRow end = simulation.diagnostics();
  EXPECT_LT(end.kinetic_J_per_m, 1e-3 * (start.potential_J_per_m - end.potential_J_per_m));
  EXPECT_LT(std::abs(end.energy_residual_J_per_m),
            0.02 * (start.potential_J_per_m - end.potential_J_per_m));
  // Lube et al. (2004): 1 + 1.24 a = 1.62 R_0, with some scatter; a front at 2 % of the height and
  // these grains stop short of their fastest ones
  EXPECT_GT(end.front_m, 1.3 * 0.1);
  EXPECT_LT(end.front_m, 1.8 * 0.1);
  const auto shot = simulation.snapshot();
  double along = 0.0, between = 0.0;
  for (std::size_t k = 0; k < shot.x_m.size(); ++k) {
    const double r = std::hypot(shot.x_m[k], shot.z_m[k]);
    const double angle = std::atan2(shot.z_m[k], shot.x_m[k]) * 180.0 / std::numbers::pi;
    double& sector = angle < 15.0 || angle > 75.0 ? along : between;
    if (angle < 15.0 || angle > 75.0 || (angle > 30.0 && angle < 60.0))
      sector = std::max(sector, r);
  }
  EXPECT_NEAR(along, between, 2.0 * scene.h);
}

/// Laws, shapes and walls together, in motion: sorting, several ranges per block, outflow.
Scene everything(Kernel kernel) {
  Scene scene = empty_space(0.8, 0.4, 0.2, 0.025);
  scene.kernel = kernel;
  scene.gravity = 9.8;
  scene.tilt_deg = 10.0;
  scene.right = {Wall::Kind::open};
  scene.left = {Wall::Kind::friction, 0.3};
  scene.floor = {Wall::Kind::no_slip};
  scene.far = {Wall::Kind::friction, 0.5};
  scene.transfer = Transfer::relaxed;
  scene.bodies = {
      block_in_space({0.0, 0.0, 0.0}, {0.1, 0.1, 0.2}, mu_i(26000.0)),
      block_in_space({0.15, 0.0, 0.0}, {0.1, 0.05, 0.1}, cam_clay()),
      block_in_space({0.7, 0.1, 0.1}, {0.1, 0.05, 0.1}, newtonian(0.01, 26000.0, 7.0, 1300.0))};
  scene.bodies[1].velocity = {1.0, 0.0, 2.0};
  scene.bodies[1].spin = 2.0;
  scene.bodies[2].velocity = {6.0, 0.0, 0.0};  // leaves
  return scene;
}

TEST(SpaceTest, TheSameBitsForAnyNumberOfThreadsAndAfterResuming) {
  const tbb::global_control three(tbb::global_control::max_allowed_parallelism, 3);
  for (const Kernel kernel : {Kernel::cubic, Kernel::quadratic}) {
    const Scene scene = everything(kernel);
    const ScratchFile file;
    const auto run = [&](int threads) {
      Simulation simulation(scene, threads);
      run_steps(simulation, 30);
      if (threads == 1) simulation.save(file.path());
      run_steps(simulation, 30);
      EXPECT_GT(simulation.counters().sorts, 2);
      EXPECT_GT(simulation.diagnostics().outflow_kg_per_m, 0.1);
      return saved_state(simulation);
    };
    const SavedState one = run(1);
    EXPECT_EQ(run(2), one);
    EXPECT_EQ(run(3), one);
    Simulation resumed(scene, 2);
    resumed.load(file.path());
    run_steps(resumed, 30);
    EXPECT_EQ(saved_state(resumed), one);
  }
}

TEST(SpaceTest, WhatOnlyPlaneStrainHasIsRefused) {
  const auto refused = [](auto&& change) {
    Scene scene = cylinder(mu_i(), 1.0, false);
    change(scene);
    try {
      validate(scene);
    } catch (const InputError& error) {
      return error.key();
    }
    return std::string("nothing");
  };
  EXPECT_EQ(refused([](Scene&) {}), "nothing");
  EXPECT_EQ(refused([](Scene& s) { s.transfer = Transfer::xpic; }), "step.transfer");
  EXPECT_EQ(refused([](Scene& s) { s.viscosity = Viscosity::implicit_solve; }), "step.viscosity");
  EXPECT_EQ(refused([](Scene& s) { s.pressure_averaging = 1.0; }), "step.pressure_averaging");
  EXPECT_EQ(refused([](Scene& s) { s.floor.speed = 0.1; }), "domain.floor");
  EXPECT_EQ(refused([](Scene& s) { s.left = s.right = {Wall::Kind::periodic}; }), "domain.left");
  EXPECT_EQ(refused([](Scene& s) { s.points_per_cell = 4; }), "grid.points_per_cell");
  EXPECT_EQ(refused([](Scene& s) { s.domain[2] = 0.24; }), "domain.size");
  EXPECT_EQ(refused([](Scene& s) { s.near = {Wall::Kind::no_slip}; }), "domain.near");
  EXPECT_EQ(refused([](Scene& s) { s.bodies[0].disc->hole = 0.2; }), "body[0].hole");
  EXPECT_EQ(refused([](Scene& s) { s.bodies[0].origin[2] = 0.2; }), "body[0].origin");
}

}  // namespace
}  // namespace repose::mpm

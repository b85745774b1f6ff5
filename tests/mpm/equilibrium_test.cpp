/// Starts at rest: layers and slopes (mpm/step/equilibrium.hpp).

#include <random>

#include <gtest/gtest.h>

#include "mpm/boundary/periodic.hpp"
#include "mpm/boundary/rigid_contact.hpp"
#include "mpm/scene/fill.hpp"
#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

constexpr double g = 9.8, degree = std::numbers::pi / 180.0;

LawSpec grains(double rho_0, double mu_0 = 0.5) {
  LawSpec law = mu_i(2e6);
  law.values["mu_0"] = mu_0;
  law.values["mu_d"] = mu_0 + 0.1;
  law.values["rho_0"] = rho_0;
  law.values["rho_p"] = 2650.0;
  return law;
}
LawSpec clay(double kappa = 0.01) {
  LawSpec law = cam_clay();
  law.values["M"] = 0.9;
  law.values["lambda"] = 5.0 * kappa;
  law.values["kappa"] = kappa;
  law.values["Gamma"] = 1.8;
  law.values["p_ref"] = 1000.0;
  law.values["rho_p"] = 2650.0;
  return law;
}

struct Layer {
  double height, K0;
  LawSpec law;
};

Scene box(bool space, double width, double height, double h = 0.05) {
  Scene scene = empty_box(width, height, h);
  if (space) {
    scene.domain[2] = width;
    scene.points_per_cell = 8;
    scene.near = scene.far = {Wall::Kind::slip};
  }
  scene.gravity = g;
  scene.floor = {Wall::Kind::no_slip};
  return scene;
}

Scene layers(bool space, const std::vector<Layer>& list) {
  Scene scene = box(space, 0.4, 1.0);
  double y = 0.0;
  for (const Layer& layer : list) {
    Body body = block(0.0, y, 0.4, layer.height, layer.law);
    body.size[2] = space ? 0.4 : 0.0;
    body.initial = {};
    body.initial.K0 = layer.K0;
    body.lithostatic = true;
    scene.bodies.push_back(body);
    y += layer.height;
  }
  return scene;
}

/// A slope of 20° from wall to wall on the floor, or a layer of constant thickness on a plane.
Scene slope(double mu_0, bool on_plane, double h = 0.05) {
  Scene scene = box(false, 2.0, 1.6, h);
  const double fall = 2.0 * std::tan(20.0 * degree);
  Body body = block(0.0, 0.0, 1.0, 1.0, grains(1500.0, mu_0));
  set_polygon(body,
              {{{0.0, on_plane ? fall - 0.1 : 0.0}, {2.0, 0.0}, {2.0, 0.4}, {0.0, 0.4 + fall}}});
  if (on_plane) {
    Surface plane;
    plane.solid.shape =
        HalfSpace{{0.0, fall + 0.05, 0.0}, {std::sin(20.0 * degree), std::cos(20.0 * degree), 0.0}};
    scene.surfaces = {plane};
  }
  body.initial = {};
  body.initial.K0 = 0.6;
  body.lithostatic = true;
  scene.bodies = {body};
  return scene;
}

/// The largest kinetic energy of any step until a time, over the potential energy above the floor.
double motion(const Scene& scene, double until, int threads = 1) {
  Simulation simulation(scene, threads);
  const double potential = simulation.diagnostics().potential_J_per_m;
  double peak = 0.0;
  while (simulation.time() < until) {
    simulation.step(until);
    peak = std::max(peak, simulation.diagnostics().kinetic_J_per_m);
  }
  std::printf("[ measured ] out of balance %.2g, kinetic/potential %.2g\n",
              simulation.counters().out_of_balance, peak / potential);
  EXPECT_TRUE(simulation.warnings().empty()) << simulation.warnings().front();
  return peak / potential;
}

std::vector<std::vector<Layer>> stacks() {
  return {{{0.4, 0.5, clay()}, {0.2, 0.5, grains(1500.0)}},
          {{0.3, 0.5, clay()}, {0.2, 0.5, grains(1500.0)}, {0.2, 0.6, clay(0.02)}}};
}

// Accelerations of the weight's residual r ≤ 1e-9 lead to elastic waves of a kinetic energy of
// r² ρ g H/E of the potential: nothing that double precision of the sums, 1e-16, would not cover.
TEST(Equilibrium, LayersStayAtRest) {
  for (const bool space : {false, true})
    for (const Kernel kernel : {Kernel::cubic, Kernel::quadratic})
      for (const Transfer transfer : {Transfer::relaxed, Transfer::tpic})
        for (const std::vector<Layer>& stack : stacks()) {
          Scene scene = layers(space, stack);
          scene.kernel = kernel;
          scene.transfer = transfer;
          EXPECT_LT(motion(scene, space ? 0.05 : 0.5), 1e-15)
              << space << name_of(kernel) << name_of(transfer) << stack.size();
        }
}

// Single precision rounds a stress to 2⁻²⁵ of itself, a node's force to that over ρgh of the
// stress ρgH, r = 3e-8 H/h = 5e-7: r² ρgH/E, at most 1e-14 for E >= 20 ρgH.
TEST(Equilibrium, OfFloatsToTheirRounding) {
  Scene scene = layers(false, stacks()[0]);
  scene.storage = Storage::single_precision;
  EXPECT_LT(motion(scene, 0.1), 1e-13);
}

// Laws without a shear stress at rest stand on each other by their pressure.
TEST(Equilibrium, LiquidsStayAtRest) {
  Scene scene = layers(false, {{0.4, 1.0, newtonian(1.0, 1e6, 7.0, 1300.0)},
                               {0.2, 1.0, newtonian(1.0, 1e6, 7.0, 1000.0)}});
  EXPECT_LT(motion(scene, 0.2), 1e-15);
}

// The vertical stress is the weight above and K0 what was asked. A stress of points balances the
// grid's sums, which see it over a stencil: beside the floor and a step of the density the two may
// differ by what half a cell weighs, elsewhere by (h/H)² of that.
TEST(Equilibrium, KeepsK0AndTheWeight) {
  const std::vector<Layer> stack = stacks()[1];
  const Scene scene = layers(false, stack);
  const Simulation simulation(scene, 1);
  const auto points = points_of(simulation);
  for (const PointState& p : points) {
    double above = 0.0;  // per area: rows of points of the same height
    for (const PointState& q : points)
      above += q[Y] > p[Y] + 1e-9 ? q[MASS] : std::abs(q[Y] - p[Y]) < 1e-9 ? 0.5 * q[MASS] : 0.0;
    const double weight = g * above / 0.4;
    EXPECT_NEAR(-p[SYY], weight, 0.5 * p[RHO] * g * scene.h) << p[Y];
    // the correction is a column's, Δσ_h = K0 Δσ_v, to the residual of its search
    EXPECT_NEAR(p[SXX] / p[SYY], stack[p.body].K0, 1e-6) << p[Y];
    EXPECT_NEAR(p[SZZ] / p[SYY], stack[p.body].K0, 1e-6) << p[Y];
  }
  for (std::size_t b = 0; b < stack.size(); ++b) {
    double horizontal = 0.0, vertical = 0.0;
    for (const PointState& p : points)
      if (p.body == b) {
        horizontal += p[SXX];
        vertical += p[SYY];
      }
    std::printf("[ measured ] body %zu: K0 %.5f, asked %.2f\n", b, horizontal / vertical,
                stack[b].K0);
  }
}

// Slopes of 20°. The friction angle asked for in plane strain is arcsin μ_0 (no volume change,
// σ_zz = p): 20° is μ_0 = 0.342.
TEST(Equilibrium, SlopesStayAtRest) {
  for (const bool on_plane : {false, true})
    for (const Kernel kernel : {Kernel::cubic, Kernel::quadratic}) {
      Scene scene = slope(0.8, on_plane);
      scene.kernel = kernel;
      EXPECT_LT(motion(scene, 0.5), 1e-8) << on_plane << name_of(kernel);
    }
}

TEST(Equilibrium, SaysThatASlopeIsTooSteep) {
  Scene scene = slope(0.25, false);
  scene.bodies[0].initial.K0 = 0.8;
  Simulation simulation(scene, 1);
  ASSERT_FALSE(simulation.warnings().empty());
  EXPECT_NE(simulation.warnings()[0].find("of the weight is out of balance"), std::string::npos);
  const double potential = simulation.diagnostics().potential_J_per_m;
  run_until(simulation, 0.3);
  EXPECT_GT(simulation.diagnostics().kinetic_J_per_m, 1e-5 * potential);  // it goes on, and slides
}

// Smooth side walls bear no weight: over every level cut the vertical stress adds up to what is
// above it. The midpoint rule over a row of points between the wall and wall is off by the second
// difference, (h/L)² of the change along it; what the surface's cut cells add is light.
TEST(Equilibrium, EveryCutOfASlopeBearsWhatIsAboveIt) {
  const Scene scene = slope(0.8, false);
  const Simulation simulation(scene, 1);
  const auto points = points_of(simulation);
  const double spacing = point_spacing(scene);
  for (const double level : {0.1125, 0.2125, 0.3125}) {
    double force = 0.0, above = 0.0;
    for (const PointState& p : points) {
      const bool in_row = std::abs(p[Y] - level) < 1e-9;
      if (in_row) force -= p[SYY] * spacing;
      above += p[Y] > level + 1e-9 ? p[MASS] : in_row ? 0.5 * p[MASS] : 0.0;
    }
    std::printf("[ measured ] cut at %.4f m: %.5f of the weight above\n", level,
                force / (g * above));
    EXPECT_NEAR(force, g * above, 0.01 * g * above) << level;
  }
}

// A layer on a plane of 20°, the box tilted with it and without ends: τ = ρ g sin20° (H − y) of
// what is above, and at the base all of the weight's share.
TEST(Equilibrium, AnInfiniteSlopeBearsItsShear) {
  Scene scene = layers(false, {{0.4, 0.6, grains(1500.0, 0.8)}, {0.2, 0.6, grains(1500.0, 0.8)}});
  scene.left = scene.right = {Wall::Kind::periodic};
  scene.tilt_deg = 20.0;
  scene.equilibrium = true;
  EXPECT_LT(motion(scene, 0.2), 1e-15);
  const Simulation simulation(scene, 1);
  const auto points = points_of(simulation);
  for (const PointState& p : points) {
    double above = 0.0;
    for (const PointState& q : points)
      above += q[Y] > p[Y] + 1e-9 ? q[MASS] : std::abs(q[Y] - p[Y]) < 1e-9 ? 0.5 * q[MASS] : 0.0;
    const double shear = g * std::sin(20.0 * degree) * above / 0.4;
    // as of the weight: half a cell at floor and surface
    EXPECT_NEAR(p[SXY], shear, 0.5 * p[RHO] * g * std::sin(20.0 * degree) * scene.h) << p[Y];
  }
}

// A single box between walls is left as it was filled.
TEST(Equilibrium, IsNotSoughtForASingleBox) {
  Scene one = layers(false, {{0.4, 0.6, grains(1500.0)}});
  EXPECT_EQ(Simulation(one, 1).counters().out_of_balance, 0.0);
  EXPECT_FALSE(seeks_equilibrium(one));
  one.equilibrium = true;
  EXPECT_LT(motion(one, 0.2), 1e-15);
}

TEST(Equilibrium, HasTheSameBitsForAnyNumberOfThreads) {
  for (const Scene& scene : {slope(0.8, true), layers(true, stacks()[0])}) {
    Simulation one(scene, 1), four(scene, 4);
    EXPECT_EQ(saved_state(one), saved_state(four));
  }
}

// Below a water table a body weighs (1 − ρ_w/ρ_p) of what it does: σ_v′ is the dry weight above
// the table and that below it, as in KeepsK0AndTheWeight; and it stays at rest, in plane and space.
TEST(WaterTable, LayersBelowItAreBuoyant) {
  for (const bool space : {false, true}) {
    Scene scene = layers(space, stacks()[0]);
    scene.water_table = 0.3;
    EXPECT_LT(motion(scene, space ? 0.05 : 0.3), 1e-15);
  }
  Scene scene = layers(false, stacks()[0]);
  scene.water_table = 0.3;
  const Simulation simulation(scene, 1);
  const auto points = points_of(simulation);
  for (const PointState& p : points) {
    double above = 0.0;
    for (const PointState& q : points) {
      const double weight = q[MASS] * (q[Y] < 0.3 ? 1.0 - 1000.0 / 2650.0 : 1.0);
      above += q[Y] > p[Y] + 1e-9 ? weight : std::abs(q[Y] - p[Y]) < 1e-9 ? 0.5 * weight : 0.0;
    }
    EXPECT_NEAR(-p[SYY], g * above / 0.4, 0.5 * p[RHO] * g * scene.h) << p[Y];
  }
}

// A body that falls through the table loses what the potential says, from above it to below.
TEST(WaterTable, TheLedgerCloses) {
  for (const bool space : {false, true}) {
    Scene scene = box(space, 0.4, 1.2);
    Body body = block(0.1, 0.7, 0.2, 0.2, grains(1500.0));
    if (space) {
      body.origin[2] = 0.1;
      body.size[2] = 0.2;
    }
    scene.bodies = {body};
    scene.water_table = 0.6;
    Simulation simulation(scene, 1);
    const double start = simulation.diagnostics().potential_J_per_m;
    run_until(simulation, 0.3);
    const SeriesRow row = simulation.diagnostics();
    // ½Δt F·v of the moment (ledger.hpp), the force being the weight, and a point's force changes
    // within a step as it crosses: Δt/t of the fall each
    const double fall = start - row.potential_J_per_m;
    EXPECT_GT(fall, 0.0);
    EXPECT_LT(std::abs(row.energy_residual_J_per_m), 4.0 * row.dt_s / 0.3 * fall);
    // free fall above the table, then (1 − 1000/2650) g: about
    EXPECT_LT(row.kinetic_J_per_m, fall * 1.001);
  }
}

TEST(WaterTable, RefusesALawWithoutADensityOfGrains) {
  Scene scene = layers(false, stacks()[0]);
  scene.tilt_deg = 5.0;
  scene.water_table = 0.3;
  EXPECT_THROW(validate(scene), InputError);
}

// Gravity grows to what it is; the ledger closes, and the bed is then as deep in its weight as one
// that was filled lithostatic: the mean of the vertical stress is half of that at the floor.
TEST(GravityRamp, PreparesABed) {
  for (const bool water : {false, true}) {
    Scene scene = layers(false, {{0.5, 1.0, grains(1500.0)}});
    scene.bodies[0].lithostatic = false;
    scene.bodies[0].initial = {};
    scene.gravity_ramp = 0.4;
    if (water) scene.water_table = 0.3;
    Simulation simulation(scene, 1);
    EXPECT_EQ(simulation.diagnostics().potential_J_per_m, 0.0);
    double peak = 0.0;
    while (simulation.time() < 0.4) {
      simulation.step(0.4);
      peak = std::max(peak, simulation.diagnostics().kinetic_J_per_m);
    }
    const SeriesRow row = simulation.diagnostics();
    double stress = 0.0, volume = 0.0, exact = 0.0;
    for (const PointState& p : points_of(simulation)) {
      const double V = p[MASS] / p[RHO];
      const double share = water ? 1.0 - 1000.0 / 2650.0 : 1.0, y = p[Y];
      const double weight = water && y < 0.3 ? 0.2 + share * (0.3 - y) : 0.5 - y;
      stress -= p[SYY] * V;
      exact += 1500.0 * g * weight * V;
      volume += V;
    }
    std::printf(
        "[ measured ] peak kinetic/potential %.2g, mean stress %.4f of the exact, residual "
        "%.2g of the potential\n",
        peak / row.potential_J_per_m, stress / exact,
        row.energy_residual_J_per_m / row.potential_J_per_m);
    // a layer of stiffness M on its first wave, ω = π/2H √(M/ρ) = 300/s, is driven for 0.4 s by a
    // force whose second derivative is 6/T²: it swings by 6/(ωT)² = 4e-4 of its weight's stress
    EXPECT_NEAR(stress / exact, 1.0, 0.01);
    EXPECT_LT(peak, 1e-5 * row.potential_J_per_m);
    EXPECT_LT(std::abs(row.energy_residual_J_per_m), 1e-6 * row.potential_J_per_m);
  }
}

TEST(GravityRamp, GoesOnFromACheckpointWithTheSameBits) {
  Scene scene = layers(false, {{0.5, 1.0, grains(1500.0)}});
  scene.bodies[0].lithostatic = false;
  scene.bodies[0].initial = {};
  scene.gravity_ramp = 0.1;
  scene.water_table = 0.3;
  Simulation whole(scene, 1), first(scene, 2), second(scene, 4);
  run_until(whole, 0.05);
  run_until(first, 0.05);
  const ScratchFile file;
  first.save(file.path());
  second.load(file.path());
  run_until(whole, 0.12);
  run_until(second, 0.12);
  EXPECT_EQ(saved_state(whole), saved_state(second));
}

TEST(GravityRamp, DoesNotGoWithALithostaticBody) {
  Scene scene = layers(false, stacks()[0]);
  scene.gravity_ramp = 0.1;
  EXPECT_THROW(validate(scene), InputError);
}

/// <T x, y> = <x, Tᵀ y> of surfaces, then edges, for any masses.
template <int dim>
void expect_transposed(const std::vector<Surface>& surfaces) {
  Scene scene = box(dim == 3, 0.6, 0.6);
  Body body = block(0.0, 0.0, 0.6, 0.6, grains(1500.0));
  body.size[2] = dim == 3 ? 0.6 : 0.0;
  scene.bodies = {body};
  std::vector<PointsOf<dim>> bodies{fill<dim>(body, scene, 0)};
  std::array<int, dim> cells;
  cells.fill(12);
  GridOf<dim> grid(scene.h, cells);
  grid.sort(bodies);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  using Field = std::vector<std::array<typename NodeBlockOf<dim>::Nodes, dim>>;
  Field x(grid.node_blocks.size()), y = x, Tx = x, Ty = x;
  const auto exchange = [&](const Field* in, Field* out) {
    for (std::size_t k = 0; k < x.size(); ++k)
      if (in != nullptr)
        grid.node_blocks[k].v = (*in)[k];
      else
        (*out)[k] = grid.node_blocks[k].v;
  };
  for (std::size_t k = 0; k < x.size(); ++k) {
    for (double& m : grid.node_blocks[k].mass) m = 0.5 + 0.5 * any(random);
    grid.node_blocks[k].mirrored_mass = grid.node_blocks[k].mass;
    for (std::size_t i = 0; i < dim; ++i)
      for (std::size_t n = 0; n < x[k][i].size(); ++n) {
        x[k][i][n] = any(random);
        y[k][i][n] = any(random);
      }
  }
  const Walls walls{scene.left, scene.right, scene.floor, scene.top, scene.near, scene.far};
  RigidContact<dim> contact(surfaces);
  tbb::task_arena arena(1);
  std::vector<MirroredTriple> record;
  double work = 0.0;
  exchange(&x, nullptr);
  contact.apply(grid, 0.0, true, arena, work);
  apply_walls(grid, walls, &record);
  exchange(nullptr, &Tx);
  exchange(&y, nullptr);
  transpose_walls(grid, record);
  contact.transpose(grid);
  exchange(nullptr, &Ty);
  double left = 0.0, right = 0.0, size = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k)
    for (std::size_t i = 0; i < dim; ++i)
      for (std::size_t n = 0; n < x[k][i].size(); ++n) {
        left += Tx[k][i][n] * y[k][i][n];
        right += x[k][i][n] * Ty[k][i][n];
        size += std::abs(Tx[k][i][n] * y[k][i][n]);
      }
  EXPECT_GT(size, 100.0);
  EXPECT_NEAR(left, right, 1e-13 * size);  // round-off of a sum
}

TEST(Equilibrium, TransposesSurfacesAndEdges) {
  Surface plane, ball;
  plane.solid.shape = HalfSpace{{0.0, 0.21, 0.0}, {0.3, 1.0, 0.1}};
  plane.contact = Surface::Contact::slip;
  ball.solid.shape = Ball{{0.3, 0.3, 0.3}, 0.11};
  Surface smooth = ball;  // a bend along which things slide
  smooth.contact = Surface::Contact::slip;
  for (const std::vector<Surface>& surfaces :
       {std::vector<Surface>{}, {plane}, {plane, ball}, {smooth}, {plane, smooth}}) {
    expect_transposed<2>(surfaces);
    expect_transposed<3>(surfaces);
  }
}

}  // namespace
}  // namespace repose::mpm

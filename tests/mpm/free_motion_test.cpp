/// Bodies in empty space: what forces within a body can never change.

#include <gtest/gtest.h>

#include "models/scalar.hpp"
#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

struct Case {
  const char* name;
  LawSpec law;
  double p;  ///< initial pressure: the body bursts
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
const Case every_law[] = {{"newtonian", newtonian(0.1, 2e4, 7, 1000), 50.0},
                          {"cohesive", newtonian(0.1, 2e4, 7, 1000, true), -50.0},
                          {"mu_i", mu_i(), 50.0},
                          {"mu_i_regularised", mu_i(254800, "regularised"), 50.0},
                          {"cam_clay", cam_clay(), 2.27},
                          {"cam_clay_v", cam_clay("v-ln_p"), 2.27},
                          {"critical_state", critical_state(), 2.27}};

class FreeMotionTest : public ::testing::TestWithParam<Case> {
 protected:
  /// A square in the middle of a large box, moving and turning.
  static Scene thrown(double gravity, double spin) {
    Scene scene = empty_box(2.0, 1.5, 0.025);
    scene.gravity = gravity;
    scene.tilt_deg = 15.0;
    Body body = block(0.8, 0.9, 0.2, 0.2, GetParam().law);
    body.velocity = {0.6, 0.3};
    body.spin = spin;
    body.initial.p = GetParam().p;
    scene.bodies = {body};
    scene.dt = 1e-4;  // the same for all, and exact to compare with
    if (GetParam().name == std::string("mu_i_regularised")) scene.bodies[0].law.values["r"] = 10.0;
    return scene;
  }
};

// Whatever the stress does, the centre of mass flies as a stone, exactly as symplectic Euler does:
// v = v_0 + g t, x = x_0 + v_0 t + ½ g t(t + Δt).
TEST_P(FreeMotionTest, TheCentreOfMassFallsLikeAStone) {
  const Scene scene = thrown(9.8, 3.0);
  Simulation simulation(scene, 2);
  const int steps = 2500;
  run_steps(simulation, steps);
  const double t = simulation.time();
  EXPECT_NEAR(t, steps * 1e-4, 1e-12);
  const SeriesRow row = simulation.diagnostics();
  const double angle = 15.0 * std::numbers::pi / 180.0;
  const double g[] = {9.8 * std::sin(angle), -9.8 * std::cos(angle)};
  double x[2] = {0, 0};
  for (const PointState& p : points_of(simulation)) {
    x[0] += p[MASS] * p[X] / row.mass_kg_per_m;
    x[1] += p[MASS] * p[Y] / row.mass_kg_per_m;
  }
  // every step adds a sum over 256 points: 2500 steps × 16 eps, relative to |x| and |v| of order 1
  const double round_off = 2500 * 16 * 2.2e-16;
  EXPECT_NEAR(row.momentum_x / row.mass_kg_per_m, 0.6 + g[0] * t, round_off);
  EXPECT_NEAR(row.momentum_y / row.mass_kg_per_m, 0.3 + g[1] * t, round_off * 3);
  EXPECT_NEAR(x[0], 0.9 + 0.6 * t + 0.5 * g[0] * t * (t + 1e-4), round_off);
  EXPECT_NEAR(x[1], 1.0 + 0.3 * t + 0.5 * g[1] * t * (t + 1e-4), round_off);
  EXPECT_GT(simulation.counters().sorts, 3);
}

// Forces are symmetric, and APIC keeps the angular momentum of its affine part too.
TEST_P(FreeMotionTest, AngularMomentumIsKept) {
  const Scene scene = thrown(0.0, 6.0);  // its corners are 0.15 m from the nearest wall at the end
  Simulation simulation(scene, 2);
  const double start = angular_momentum(points_of(simulation), scene);
  const int steps = 2000;
  run_steps(simulation, steps);
  const double end = angular_momentum(points_of(simulation), scene);
  double scale = 0.0;  // what is summed: m |x| |v|
  for (const PointState& p : points_of(simulation))
    scale += p[MASS] * std::hypot(p[X], p[Y]) * std::hypot(p[VX], p[VY]);
  EXPECT_NEAR(end, start, steps * 16 * 2.2e-16 * scale);
  EXPECT_GT(std::abs(start), 0.01 * scale);
}

// Without stress there is no difference between the points either.
TEST(FreeFallTest, EveryPointFallsLikeAStone) {
  for (const LawSpec& law : {newtonian(0.1, 2e4, 7, 1000), mu_i(), mu_i(254800, "regularised")}) {
    Scene scene = empty_box(0.5, 1.5, 0.025);
    scene.gravity = 9.8;
    scene.bodies = {block(0.1, 1.2, 0.2, 0.2, law)};
    scene.bodies[0].velocity = {0.2, -1.0};
    scene.dt = 1e-3;
    Simulation simulation(scene, 2);
    const auto start = points_of(simulation);
    run_steps(simulation, 200);
    const auto end = points_of(simulation);
    const double t = simulation.time();
    for (std::size_t k = 0; k < start.size(); ++k) {
      const double round_off = 200 * 16 * 2.2e-16 * 3;  // |v| up to 3
      EXPECT_NEAR(end[k][X], start[k][X] + 0.2 * t, round_off);
      EXPECT_NEAR(end[k][Y], start[k][Y] - 1.0 * t - 0.5 * 9.8 * t * (t + 1e-3), round_off);
      EXPECT_NEAR(end[k][VX], 0.2, round_off);
      EXPECT_NEAR(end[k][VY], -1.0 - 9.8 * t, round_off);
    }
  }
}

// The first step of a turning body under stress: nothing strains its inside yet but the step itself
// (uniform stress, no force). Points go along their tangents, x + Δt ω × x, so that all lengths
// grow by √(1 + ω²Δt²) and the step's strain is ½(ωΔt)²; the stress turns by Cayley's angle 2
// atan(½ωΔt), to round-off, and the law does the rest.
TEST(RotationTest, StressTurnsWithTheBody) {
  const double omega = 4.0, dt = 2e-3;
  for (const LawSpec& law : {mu_i(), cam_clay(), cam_clay("v-ln_p"), critical_state()}) {
    Scene scene = empty_box(1.0, 1.0, 0.025);
    Body body = block(0.3, 0.3, 0.4, 0.4, law);
    body.spin = omega;
    body.initial = {};
    body.initial.sigma = {{1000.0, 1300.0, 1100.0, 80.0, 0.0, 0.0}};
    if (law.values.count("kappa") > 0) body.initial.ocr = 1.5;
    scene.bodies = {body};
    scene.dt = dt;
    Simulation simulation(scene, 2);
    const auto start = points_of(simulation);
    simulation.step(HUGE_VAL);
    const double angle = 2.0 * std::atan(0.5 * omega * dt), e = 0.5 * omega * omega * dt * dt;
    const double c = std::cos(angle), s = std::sin(angle);
    std::array<std::array<double, pack_size>, STATE + max_state> field{};
    for (std::size_t f = 0; f < field.size(); ++f) field[f].fill(start[0][f]);
    field[SXX].fill(c * c * -1000 + s * s * -1300 - 2 * s * c * -80);
    field[SYY].fill(s * s * -1000 + c * c * -1300 + 2 * s * c * -80);
    field[SXY].fill(s * c * (-1000 + 1300) + (c * c - s * s) * -80);
    std::array<double, pack_size> expansion{}, none{};
    expansion.fill(e);
    Batch batch;
    batch.count = 1;
    batch.dt = dt;
    batch.strain = {expansion.data(), expansion.data(), none.data(), none.data()};
    batch.density = field[RHO].data();
    for (std::size_t k = 0; k < 4; ++k) batch.stress[k] = field[SXX + k].data();
    for (std::size_t k = 0; k < max_state; ++k) batch.state[k] = field[STATE + k].data();
    ASSERT_TRUE(make_material(law)->update(batch).ok());
    EXPECT_LT(field[SXX][0], -500.0) << "still under stress";
    int inside = 0;
    for (const PointState& p : points_of(simulation)) {
      const PointState& q = start[static_cast<std::size_t>(p.id)];
      if (std::max(std::abs(q[X] - 0.5), std::abs(q[Y] - 0.5)) > 0.2 - 3 * scene.h) continue;
      ++inside;
      // strain from round-off: 1e-15 × ω Δt × the stiffness (1e6 Pa): far below 1e-9 Pa
      for (const Field f : {SXX, SYY, SXY, SZZ}) EXPECT_NEAR(p[f], field[f][0], 1e-8);
      EXPECT_NEAR(p[RHO] / q[RHO], std::exp(-2.0 * e), 1e-13);
    }
    EXPECT_GT(inside, 300);
  }
}

// A viscous drop that holds together, spinning once around. Any body that turns steadily is kept
// together by the tension ∫(σ_xx + σ_yy) dV = ω² ∫ρr² dV = 2 E_kin (the virial theorem), whatever
// its shape; its particles are back where they were.
TEST(RotationTest, ACohesiveDropTurnsAsOne) {
  const double omega = 2.0, eta = 2e4, rho = 1000.0, half = 0.2;
  Scene scene = empty_box(1.0, 1.0, 0.05);
  scene.bodies = {
      block(0.5 - half, 0.5 - half, 2 * half, 2 * half, newtonian(eta, 4e6, 1.0, rho, true))};
  scene.bodies[0].spin = omega;
  scene.courant = 0.6;
  Simulation simulation(scene, 1);
  const auto start = points_of(simulation);
  const double kinetic = simulation.diagnostics().kinetic_J_per_m;
  const double turn = 2.0 * std::numbers::pi / omega;
  // a square's corners are pulled outwards: a viscous strain rate of up to ρω²R²/2η, and with it
  // goes the speed of rotation
  const double strain = turn * rho * omega * omega * 2.0 * half * half / (2.0 * eta);
  for (int quarter = 1; quarter <= 4; ++quarter) {
    run_until(simulation, quarter * turn / 4);
    const auto now = points_of(simulation);
    const double ledger = simulation.diagnostics().kinetic_J_per_m;
    double tension = 0.0;
    for (const PointState& p : now) tension += p[MASS] / p[RHO] * (p[SXX] + p[SYY]);
    // the drop changes its size by `strain` per turn, its moment of inertia to second order in
    // time: a share ρ(strain/turn)² of the tension, 1e-6; pressure waves from the start decay at
    // once
    EXPECT_NEAR(tension / (2.0 * ledger), 1.0, 1e-4);
    EXPECT_NEAR(ledger, kinetic, strain * kinetic);
    const auto round_off = static_cast<double>(simulation.steps()) * 2.2e-16;
    EXPECT_NEAR(angular_momentum(now, scene) / angular_momentum(start, scene), 1.0, round_off);
    // turned by a quarter after the other, within the strain
    const double c[] = {1, 0, -1, 0, 1}, s[] = {0, 1, 0, -1, 0};
    for (std::size_t k = 0; k < now.size(); ++k) {
      const double x = start[k][X] - 0.5, y = start[k][Y] - 0.5;
      EXPECT_NEAR(now[k][X] - 0.5, c[quarter] * x - s[quarter] * y, strain * half);
      EXPECT_NEAR(now[k][Y] - 0.5, s[quarter] * x + c[quarter] * y, strain * half);
    }
  }
}

// A collision of two laws: momentum and angular momentum survive, whichever body comes first.
TEST(CollisionTest, KeepsMomentum) {
  Scene scene = empty_box(2.0, 1.5, 0.025);
  scene.courant = 0.4;
  Body clay = block(0.6, 0.6, 0.2, 0.2, cam_clay());
  clay.velocity = {1.0, 0.0};
  Body water = block(0.9, 0.65, 0.2, 0.2, newtonian(0.1, 2e4, 7, 1000));
  water.velocity = {-1.0, 0.2};
  water.spin = 1.0;
  std::array<SeriesRow, 2> ends{};
  for (std::size_t order = 0; order < 2; ++order) {
    scene.bodies = order == 0 ? std::vector<Body>{clay, water} : std::vector<Body>{water, clay};
    Simulation simulation(scene, 2);
    const SeriesRow start = simulation.diagnostics();
    const double spin = angular_momentum(points_of(simulation), scene);
    run_until(simulation, 0.2);
    const SeriesRow end = simulation.diagnostics();
    const double round_off = static_cast<double>(simulation.steps()) * 16 * 2.2e-16;
    EXPECT_EQ(end.mass_kg_per_m, start.mass_kg_per_m);
    EXPECT_NEAR(end.momentum_x, start.momentum_x, round_off * start.mass_kg_per_m);
    EXPECT_NEAR(end.momentum_y, start.momentum_y, round_off * start.mass_kg_per_m);
    EXPECT_NEAR(angular_momentum(points_of(simulation), scene), spin,
                round_off * start.mass_kg_per_m);
    EXPECT_LT(end.kinetic_J_per_m, 0.9 * start.kinetic_J_per_m) << "they did meet";
    ends[order] = end;
  }
  // only the order of the sums differs: 991 steps of a flow that does not amplify it much
  EXPECT_NEAR(ends[0].mass_kg_per_m, ends[1].mass_kg_per_m, 1e-12 * ends[0].mass_kg_per_m);
  EXPECT_NEAR(ends[0].momentum_x, ends[1].momentum_x, 1e-11 * ends[0].mass_kg_per_m);
  EXPECT_NEAR(ends[0].momentum_y, ends[1].momentum_y, 1e-11 * ends[0].mass_kg_per_m);
  EXPECT_NEAR(ends[0].kinetic_J_per_m / ends[1].kinetic_J_per_m, 1.0, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Laws, FreeMotionTest, ::testing::ValuesIn(every_law),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace repose::mpm

/// The energies of the ledger, each against a closed form of its own; and its residual, which says
/// whether they belong together.

#include <gtest/gtest.h>

#include "tests/mpm/manufactured_block.hpp"

namespace repose::mpm {
namespace {

constexpr double width = 0.8, height = 0.8, area = width * height;

/// Round-off of a sum over some hundred points, of terms that a law computes to a few eps.
constexpr double round_off = 1000 * 2.2e-16;

/// A block that fills a box, between a floor at rest and a lid at `speed`, in uniform shear.
Scene filled(const LawSpec& law, double speed = 0.0) {
  Scene scene = empty_box(width, height, 0.1);
  scene.left = scene.right = {Wall::Kind::periodic};
  scene.floor = {Wall::Kind::no_slip};
  scene.top = {Wall::Kind::no_slip, 0.0, speed};
  scene.bodies = {block(0.0, 0.0, width, height, law)};
  return scene;
}

Simulation sheared(const Scene& scene) {
  const double rate = scene.top.speed / height;
  Prescribed shear;
  shear.start = [rate](double, double Y) {
    return PointMotion{{rate * Y, 0.0}, {0.0, rate, 0.0, 0.0}};
  };
  return Simulation(scene, shear, 1);
}

double elastic_at_start(const Scene& scene) {
  Simulation simulation(scene, 1);
  const SeriesRow row = simulation.diagnostics();
  // nothing has happened yet
  EXPECT_EQ(row.dissipated_J_per_m, 0.0);
  EXPECT_EQ(row.work_residual_J_per_m, 0.0);
  EXPECT_EQ(row.transfer_loss_J_per_m, 0.0);
  EXPECT_EQ(row.wall_loss_J_per_m, 0.0);
  EXPECT_EQ(row.energy_residual_J_per_m, 0.0);
  return row.elastic_J_per_m;
}

/// Work of compression from ρ_0 to ρ per volume at ρ, ρ ∫ p/ρ² dρ, by Simpson's rule: 1000
/// intervals of a smooth integrand over a range of Δρ/ρ < 0.2 err by (Δρ/1000)⁴/180 p⁗ < 1e-13.
template <class Pressure>
double work_of_compression(double rho_0, double rho, const Pressure& p) {
  constexpr int n = 1000;
  const double step = (rho - rho_0) / n;
  double sum = 0.0;
  for (int k = 0; k <= n; ++k) {
    const double r = rho_0 + k * step;
    sum += (k == 0 || k == n ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * p(r) / (r * r);
  }
  return rho * sum * step / 3.0;
}

// p = K[(ρ/ρ_0)^α − 1]
TEST(ElasticEnergy, OfACompressedFluid) {
  const double K = 26e3, alpha = 7.0, rho_0 = 1300.0, p = 8e3;
  for (const bool carried : {false, true}) {
    Scene scene = filled(newtonian(0.5, K, alpha, rho_0, carried));
    scene.bodies[0].initial.p = p;
    const double rho = rho_0 * std::pow(1.0 + p / K, 1.0 / alpha);
    const double expected =
        work_of_compression(rho_0, rho,
                            [&](double r) { return K * (std::pow(r / rho_0, alpha) - 1.0); }) *
        area;
    EXPECT_NEAR(elastic_at_start(scene), expected, 1e-12 * expected);
  }
}

// p = K(ρ/ρ_0 − 1), and where the form remembers a shear stress, τ²/2G with G = 4K
TEST(ElasticEnergy, OfCompressedAndShearedGrains) {
  const double K = 26e3, rho_0 = 1300.0, p = 2e3, tau = 0.3 * p, G = 4.0 * K;
  const double compressed = work_of_compression(rho_0, rho_0 * (1.0 + p / K),
                                                [&](double r) { return K * (r / rho_0 - 1.0); }) *
                            area;
  for (const char* form : {"elastoviscoplastic", "regularised"}) {
    Scene scene = filled(mu_i(K, form));
    scene.bodies[0].initial.p = p;
    EXPECT_NEAR(elastic_at_start(scene), compressed, 1e-12 * compressed) << form;
  }
  Scene scene = filled(mu_i(K));
  scene.bodies[0].initial.sigma = {p, p, p, tau, 0.0, 0.0};
  const double expected = compressed + tau * tau / (2.0 * G) * area;
  EXPECT_NEAR(elastic_at_start(scene), expected, 1e-12 * expected);
}

// Energy per reference volume λ/2 ln²J + μ/2 (tr b − 3 − 2 ln J), over J per volume: of b = s² I,
// and of simple shear, b_xx = 1 + γ², b_xy = γ, J = 1, of which σ = μ(b − I).
TEST(ElasticEnergy, OfACompressedAndOfAShearedSolid) {
  const double E = 1e5, nu = 0.3;
  const double lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), mu = 0.5 * E / (1.0 + nu);
  Scene scene = filled(neo_hookean(E, nu, 1000.0));
  const double s = 0.97, J = s * s * s, ln_J = 3.0 * std::log(s);
  scene.bodies[0].initial.p = -(lambda * ln_J + mu * (s * s - 1.0)) / J;
  const double W = 0.5 * lambda * ln_J * ln_J + 0.5 * mu * (3.0 * s * s - 3.0 - 2.0 * ln_J);
  // λ ln J and μ(tr b − 3) nearly cancel twice in it, by the strain: 1/0.03² of the round-off
  EXPECT_NEAR(elastic_at_start(scene), W / J * area, 1.1e3 * round_off * W / J * area);
  const double gamma = 0.2;
  scene.bodies[0].initial.p.reset();
  scene.bodies[0].initial.sigma = {-mu * gamma * gamma, 0.0, 0.0, -mu * gamma, 0.0, 0.0};
  const double sheared_solid = 0.5 * mu * gamma * gamma * area;
  EXPECT_NEAR(elastic_at_start(scene), sheared_solid, 1.1e3 * round_off * sheared_solid);
}

// Unloading down the swelling line, −∫ p dV: v ∝ p^{−κ} gives κp/(1 − κ) per volume, v = v_κ − κ
// ln p gives κp/v. Shear: q²/6G with G = 3(1 − 2ν)/(2(1 + ν)) p/κ*, κ* = κ or κ/v.
TEST(ElasticEnergy, OfClay) {
  const double kappa = 0.0010, nu = 0.3, p = 1e3, ocr = 2.0;
  for (const char* compression : {"ln_v-ln_p", "v-ln_p"}) {
    Scene scene = filled(cam_clay(compression));
    scene.bodies[0].initial.p = p;
    scene.bodies[0].initial.ocr = ocr;
    const bool logarithmic = std::string_view(compression) == "ln_v-ln_p";
    const auto kappa_star = [&] {
      return logarithmic ? kappa
                         : kappa / (2000.0 / Simulation(scene, 1).diagnostics().density_min);
    };
    const auto compressed = [&] {
      return logarithmic ? kappa * p / (1.0 - kappa) : kappa_star() * p;
    };
    EXPECT_NEAR(elastic_at_start(scene), compressed() * area, 1e-12 * compressed() * area);
    // q = 0.5 p lies within the yield surface, q < Mp√(p_c/p − 1)
    const double tau = 0.5 * p / std::sqrt(3.0);
    scene.bodies[0].initial.p.reset();
    scene.bodies[0].initial.sigma = {p, p, p, tau, 0.0, 0.0};
    const double G = 1.5 * (1.0 - 2.0 * nu) / (1.0 + nu) * p / kappa_star();
    const double expected = (compressed() + 3.0 * tau * tau / (6.0 * G)) * area;
    EXPECT_NEAR(elastic_at_start(scene), expected, 1e-12 * expected) << compression;
  }
}

// Of a block of H over the floor, thrown into uniform shear: m g H/2 and ½ρW∫(γ̇y)²dy, of which 16
// rows of points in their middles see 1 − 1/(4·16²).
TEST(Ledger, PotentialAndKineticEnergy) {
  const double rho = 1000.0, speed = 0.4, g = 9.8;
  Scene scene = filled(newtonian(0.0, 2e4, 1.0, rho), speed);
  scene.gravity = g;
  Simulation simulation = sheared(scene);
  const SeriesRow row = simulation.diagnostics();
  const double potential = rho * area * g * 0.5 * height;
  EXPECT_NEAR(row.potential_J_per_m, potential, round_off * potential);
  const double kinetic = rho * area * speed * speed / 6.0 * (1.0 - 1.0 / (4.0 * 16.0 * 16.0));
  EXPECT_NEAR(row.kinetic_J_per_m, kinetic, round_off * kinetic);
}

/// What a steady shear does from one moment to another, in steps of dt.
struct Window {
  double time, dt, dissipated, plastic, viscous, wall_loss, transfer_loss, elastic_before,
      elastic_after, work_residual;
};
Window window(Simulation& simulation, double from, double to) {
  run_until(simulation, from);
  const SeriesRow a = simulation.diagnostics();
  run_until(simulation, to);
  const SeriesRow b = simulation.diagnostics();
  const double time = b.time_s - a.time_s;
  return {time,
          time / static_cast<double>(b.step - a.step),
          b.dissipated_J_per_m - a.dissipated_J_per_m,
          b.plastic_J_per_m - a.plastic_J_per_m,
          b.viscous_J_per_m - a.viscous_J_per_m,
          b.wall_loss_J_per_m - a.wall_loss_J_per_m,
          b.transfer_loss_J_per_m - a.transfer_loss_J_per_m,
          a.elastic_J_per_m,
          b.elastic_J_per_m,
          b.work_residual_J_per_m - a.work_residual_J_per_m};
}

/// A lid drags at τ: it gives τγ̇ per volume, all of which is dissipated. The work of a step takes
/// the mean of the stress before, turned by γ̇Δt/2, and after it. Turned, the xy component is τ cos
/// γ̇Δt less sin γ̇Δt of a normal stress that turning leaves behind, up to τ²/G in a law that
/// remembers its stress: together 1 − (γ̇Δt)²/4 to fourth order, and less up to γ̇Δt τ/G, `give`
/// being τ/G. `share`: by how much the law's stress may differ from τ.
void expect_steady(const Window& w, double tau, double rate, double share, double give = 0.0) {
  const double work = tau * rate * area * w.time, turn = rate * w.dt;
  EXPECT_NEAR(w.dissipated, work * (1.0 - 0.25 * turn * turn),
              (share + turn * turn * turn * turn + turn * give) * work);
  EXPECT_NEAR(w.wall_loss, -work, share * work);
  EXPECT_NEAR(w.transfer_loss, 0.0, share * work);
  EXPECT_NEAR(w.elastic_after, w.elastic_before, share * w.elastic_before);
  EXPECT_NEAR(w.work_residual, 0.0, share * work);
}

// ηγ̇² per volume; round-off is that of the pressure, 16 eps K against τ in each of 400 steps.
TEST(Dissipation, OfAFluid) {
  const double eta = 50.0, speed = 0.4, rate = speed / height;
  Scene scene = filled(newtonian(eta, 2e4, 1.0, 1000.0), speed);
  scene.bodies[0].initial.p = 100.0;
  scene.dt = 2e-3;
  Simulation simulation = sheared(scene);
  const Window w = window(simulation, 0.2, 1.0);
  expect_steady(w, eta * rate, rate, 400 * 16 * 2.2e-16 * 2e4 / (eta * rate));
  EXPECT_EQ(w.viscous, w.dissipated);
}

// τ = μ(I)p, I = γ̇d√(ρ_p/p), beside an elastic energy of τ²/2G. The normal stress that turning
// leaves takes its part of the deviator: (τ/G)² = 2e-7.
TEST(Dissipation, OfGrains) {
  const double K = 254800.0, G = 4.0 * K, p = 1e3, speed = 20.0, rate = speed / height;
  const double I = rate * 0.0053 * std::sqrt(2000.0 / p);
  const double tau = (0.3819 + (0.5718 - 0.3819) * I / (0.279 + I)) * p;
  Scene scene = filled(mu_i(K), speed);
  scene.bodies[0].initial.p = p;
  Simulation simulation = sheared(scene);
  const Window w = window(simulation, 0.1, 0.2);
  expect_steady(w, tau, rate, 1e-6, tau / G);
  EXPECT_EQ(w.plastic, w.dissipated);
  const double compressed = work_of_compression(1300.0, 1300.0 * (1.0 + p / K),
                                                [&](double r) { return K * (r / 1300.0 - 1.0); });
  const double elastic = (compressed + tau * tau / (2.0 * G)) * area;
  EXPECT_NEAR(w.elastic_after, elastic, 1e-6 * elastic);
}

// Critical state, reached at constant volume: p_cs = p_0 2^{−(λ−κ)/λ} from a normally consolidated
// state, whose shear stress is Mp_cs/√3; strain 2.5 is 140 times λ − κ, over which it is reached.
// (τ/G)² = 7e-7.
TEST(Dissipation, OfClay) {
  const double M = 0.6614, lambda = 0.0186, kappa = 0.0010, p = 1e4, speed = 20.0;
  const double rate = speed / height;
  const double p_cs = p * std::exp2(-(lambda - kappa) / lambda);
  const double tau = M * p_cs / std::sqrt(3.0);
  const double G = 1.5 * (1.0 - 2.0 * 0.3) / (1.0 + 0.3) * p_cs / kappa;
  Scene scene = filled(cam_clay(), speed);
  scene.bodies[0].initial.p = p;
  Simulation simulation = sheared(scene);
  const Window w = window(simulation, 0.1, 0.2);
  expect_steady(w, tau, rate, 2e-6, tau / G);
  EXPECT_EQ(w.plastic, w.dissipated);
}

// An elastic solid in simple shear: σ_xy = μγ, ½μγ² per volume, and nothing is lost. Turning and
// straining one after the other errs by γ̇Δt² in a step, 400 of which make up γ: 1e-6 of it. The
// wall's work lags behind by half a step at both ends: 1/400 of it.
TEST(Dissipation, OfASolidIsNone) {
  const double E = 1e5, nu = 0.3, mu = 0.5 * E / (1.0 + nu), speed = 0.4;
  Scene scene = filled(neo_hookean(E, nu, 1000.0), speed);
  scene.dt = 2e-3;  // γ grows by 1e-3 a step
  Simulation simulation = sheared(scene);
  run_until(simulation, 0.8);
  const SeriesRow row = simulation.diagnostics();
  const double gamma = speed / height * 0.8, elastic = 0.5 * mu * gamma * gamma * area;
  EXPECT_NEAR(row.elastic_J_per_m, elastic, 2e-6 * elastic);
  EXPECT_EQ(row.dissipated_J_per_m, 0.0);
  EXPECT_NEAR(row.work_residual_J_per_m, 0.0, 2e-6 * elastic);
  EXPECT_NEAR(row.wall_loss_J_per_m, -elastic, 1.01 / 400 * elastic);
}

// A fluid without viscosity swings in a closed box: nothing is lost, so that the work of its stress
// is what the elastic energy grows by, to second order in the step. (Over the volume at the end of
// a step it is off by half a step of p D_v², to first order.)
TEST(Dissipation, OfAFluidWithoutViscosityIsOfSecondOrder) {
  const double K = 2e4, speed = 1.0;
  const auto lost = [&](double dt) {
    Scene scene = filled(newtonian(0.0, K, 1.0, 1000.0));
    scene.floor = scene.top = {Wall::Kind::slip};
    scene.bodies[0].initial.p = 2e3;
    scene.dt = dt;
    Prescribed wave;
    wave.start = [&](double, double Y) {
      const double k = std::numbers::pi / height;
      return PointMotion{{0.0, speed * std::sin(k * Y)},
                         {0.0, 0.0, 0.0, speed * k * std::cos(k * Y)}};
    };
    Simulation simulation(scene, wave, 1);
    run_until(simulation, 0.08);
    EXPECT_EQ(simulation.diagnostics().dissipated_J_per_m, 0.0);
    return simulation.diagnostics().work_residual_J_per_m;
  };
  // ω² = (π/H)² K/ρ; a step closes its share of the energy to (ωΔt)²/12
  const double omega = std::numbers::pi / height * std::sqrt(K / 1000.0);
  const double swinging = 0.25 * 1000.0 * speed * speed * area;
  const double coarse = std::abs(lost(5e-4)), fine = std::abs(lost(2.5e-4));
  EXPECT_LT(fine, std::pow(omega * 2.5e-4, 2) / 12.0 * swinging);
  EXPECT_GT(coarse, 3.0 * fine);
}

// --- what the laws say of their work, in whole collapses ----------------------------------------

struct Collapse {
  const char* name;
  LawSpec law;
  double averaging = 0.0;
  Viscosity viscosity = Viscosity::explicit_force;
  Storage storage = Storage::double_precision;
  double bound = 0.0;  ///< on the share of the drop
};
void PrintTo(const Collapse& one, std::ostream* out) { *out << one.name; }

class WorkOfACollapse : public ::testing::TestWithParam<Collapse> {};

/// Every joule of stress work is stored, plastic, viscous, of hypoelasticity, of contact, of
/// averaging or of the density floor, each measured by itself; what is left is the error of taking
/// the mean of two stresses over a step. That is of second order: with a strain Δε a step,
/// (Δε/ε_e)²/12 of the elastic energy that comes and goes, ε_e being the elastic strain that the
/// stress goes with: 1e-6 of the drop where a thousandth of it is stored and steps are small
/// against ε_e. The mistakes in tests/mutants are a thousandth of the drop and more.
TEST_P(WorkOfACollapse, IsAccountedFor) {
  const Collapse& given = GetParam();
  Scene scene = column_collapse(given.law, 0.025);
  scene.domain[1] = 0.55;
  scene.transfer = Transfer::relaxed;
  scene.pressure_averaging = given.averaging;
  scene.viscosity = given.viscosity;
  scene.storage = given.storage;
  Simulation simulation(scene, 2);
  const double start = simulation.diagnostics().potential_J_per_m;
  double most = 0.0, drop = 0.0;
  for (int k = 1; k <= 25; ++k) {
    run_until(simulation, k * 0.02);
    const SeriesRow row = simulation.diagnostics();
    most = std::max(most, std::abs(row.work_residual_J_per_m));
    drop = start - row.potential_J_per_m;
    EXPECT_NEAR(row.dissipated_J_per_m, row.plastic_J_per_m + row.viscous_J_per_m, 1e-12 * start);
  }
  const SeriesRow end = simulation.diagnostics();
  RecordProperty("work_residual_over_drop_in_1e-9", static_cast<int>(1e9 * most / drop));
  EXPECT_LT(most, given.bound * drop) << most / drop;
  EXPECT_GT(end.dissipated_J_per_m, 0.3 * drop);
  EXPECT_EQ(end.averaging_loss_J_per_m == 0.0, given.averaging == 0.0);
  if (given.averaging > 0.0) {
    EXPECT_GT(std::abs(end.averaging_loss_J_per_m), 20.0 * given.bound * drop) << "it matters here";
  }
}

const LawSpec syrup = newtonian(30.0, 26000.0, 7.0, 1300.0);
const Collapse collapses[] = {
    {"clay", cam_clay(), 0.0, Viscosity::explicit_force, Storage::double_precision, 3e-6},
    {"clay_v", cam_clay("v-ln_p"), 0.0, Viscosity::explicit_force, Storage::double_precision, 3e-6},
    {"clay_averaged", cam_clay(), 300.0, Viscosity::explicit_force, Storage::double_precision,
     3e-6},
    {"critical_state", critical_state(), 0.0, Viscosity::explicit_force, Storage::double_precision,
     3e-6},
    {"grains", mu_i(), 0.0, Viscosity::explicit_force, Storage::double_precision, 3e-6},
    {"grains_averaged", mu_i(), 50.0, Viscosity::explicit_force, Storage::double_precision, 3e-6},
    {"grains_float", mu_i(), 0.0, Viscosity::explicit_force, Storage::single_precision, 3e-6},
    {"viscous_grains", mu_i(254800.0, "regularised"), 0.0, Viscosity::implicit_solve,
     Storage::double_precision, 3e-6},
    {"syrup", syrup, 0.0, Viscosity::explicit_force, Storage::double_precision, 3e-6},
    {"syrup_implicit", syrup, 0.0, Viscosity::implicit_solve, Storage::double_precision, 3e-6},
    {"syrup_averaged", syrup, 10.0, Viscosity::explicit_force, Storage::double_precision, 3e-6}};
INSTANTIATE_TEST_SUITE_P(Laws, WorkOfACollapse, ::testing::ValuesIn(collapses),
                         [](const auto& its) { return std::string(its.param.name); });

// A fluid that holds together under tension is flung apart, a point per cell, v = a x: from J = 1
// on its density would be ρ_0/J², J = 1 + at, and meets the floor 0.2 m/h² = 0.2ρ_0 at J = √5. From
// there on every step's stretch is taken back, and with it what the tension has stored. p = K(ρ/ρ_0
// − 1) stays at −0.8K.
TEST(DensityFloor, IsCountedWithItsEnergy) {
  const double K = 0.1, a = 2.0, h = 0.1;
  Scene scene = empty_box(4.0, 4.0, h);
  scene.points_per_cell = 1;
  scene.bodies = {block(1.8, 1.8, 0.4, 0.4, newtonian(0.0, K, 1.0, 1000.0, true))};
  scene.dt = 2e-3;
  Prescribed start;
  start.start = [a](double X, double Y) {
    return PointMotion{{a * (X - 2.0), a * (Y - 2.0)}, {a, 0.0, 0.0, a}};
  };
  Simulation simulation(scene, start, 1);
  const SeriesRow first = simulation.diagnostics();
  run_until(simulation, 0.5);
  EXPECT_EQ(simulation.counters().most_points_held, 0) << "J = 2: before it";
  EXPECT_EQ(simulation.diagnostics().density_floor_J_per_m, 0.0);
  EXPECT_TRUE(simulation.warnings().empty());
  run_until(simulation, 1.2);
  const Simulation::Counters counters = simulation.counters();
  const SeriesRow end = simulation.diagnostics();
  EXPECT_EQ(counters.points_held, 16);
  EXPECT_EQ(counters.most_points_held, 16);
  EXPECT_GT(counters.point_steps_held, 16);
  EXPECT_NEAR(end.density_min, 0.2 * 1000.0, 1e-9);
  ASSERT_FALSE(simulation.warnings().empty());
  EXPECT_NE(simulation.warnings().front().find("more than spray"), std::string::npos);
  // of every point at the floor, r = ρ/ρ_0 = 0.2: K(r ln r − r + 1)/r per initial volume
  const double r = 0.2, stored = K * (r * std::log(r) - r + 1.0) / r * 0.16;
  EXPECT_NEAR(end.elastic_J_per_m, stored, 1e-12 * stored);
  // Work of 0.8K on a volume of 5V_0 that stretches. As long as points share nodes they dilate with
  // 2a/(1 + at); one alone, with nothing around it to tell it otherwise, as it did when it lost the
  // others, which is after the floor is met: between the two.
  const double met = (std::sqrt(5.0) - 1.0) / a, power = 0.8 * K * 5.0 * 0.16 * 2.0 * a;
  EXPECT_GT(end.density_floor_J_per_m, power / a * std::log((1.0 + 1.2 * a) / (1.0 + met * a)));
  EXPECT_LT(end.density_floor_J_per_m, power / (1.0 + met * a) * (1.2 - met));
  // In a step of δ = 2aΔt/√5 the stress is ahead of that of the held density by 0.2Kδ: δ/8 of it.
  const double ahead = 2.0 * a * *scene.dt / std::sqrt(5.0) / 8.0;
  EXPECT_NEAR(end.work_residual_J_per_m, 0.0, 1.1 * ahead * end.density_floor_J_per_m);
  EXPECT_EQ(end.dissipated_J_per_m, 0.0);
  EXPECT_NEAR(end.energy_residual_J_per_m, 0.0, 1e-3 * first.kinetic_J_per_m);
}

}  // namespace
}  // namespace repose::mpm

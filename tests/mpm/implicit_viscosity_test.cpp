/// Implicit viscosity: exact flows at steps far beyond the explicit limit, agreement with the
/// explicit form as Δt → 0, energy, determinism, and the collapse of MUI-3 with r = 1e-4.
#include "mpm/step/implicit_viscosity.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/mpm/layer.hpp"

namespace repose::mpm {
namespace {

constexpr double g = 9.8;
constexpr double rho = 1000.0;
constexpr double K = 1e5;  // c = 10 m/s

/// A kinematic viscosity whose explicit limit 0.9 h²/4ν is `times` smaller than the step that the
/// waves allow, 0.4 h/c.
double viscosity_beyond(double times, double h) {
  return times * 0.9 * h * std::sqrt(K / rho) / (4.0 * 0.4);
}

Scene incline(double H, int n, double nu) {
  const LawSpec law = newtonian(rho * nu, K, 1.0, rho);
  Scene scene = layer(H, n, law, [](double) { return 0.0; });
  scene.bodies = {block(0.2, 0.0, 0.8, H, law)};
  scene.bodies[0].lithostatic = true;
  scene.gravity = g;
  scene.tilt_deg = 30.0;
  scene.viscosity = Viscosity::implicit_solve;
  return scene;
}

// u = (g sinθ/ν)(Hy − y²/2), the difference decaying as (16 g sinθ H²/νπ³) Σ m⁻³ sin(mπy/2H)
// e^{−m²t/τ}, τ = 4H²/π²ν. With `times` = 10 the steps resolve τ; beyond they do not, and only the
// end is exact.
TEST(ImplicitFlow, ALayerOnAnInclineReachesTheParabola) {
  const double H = 0.05, g_sin = 0.5 * g;
  const int n = 16;
  for (const double times : {10.0, 100.0, 1000.0}) {
    const double nu = viscosity_beyond(times, H / n);
    const double tau = 4.0 * H * H / (pi * pi * nu), U = g_sin * H * H / (2.0 * nu);
    Simulation simulation(incline(H, n, nu), 1);
    const double dt = simulation.next_dt();
    EXPECT_NEAR(dt / (0.9 * H * H / (n * n) / (4.0 * nu)), times, 0.05 * times)
        << "density and speed";
    const auto error_at = [&](double t) {
      run_until(simulation, t);
      return largest_error(middle(simulation, H), [&](double y) {
        return g_sin / nu * (H * y - 0.5 * y * y) - modes(y, H, t, tau, [&](int m) {
                 return 16.0 * g_sin * H * H / (nu * std::pow(m * pi, 3));
               });
      });
    };
    // Second order in h/H as the explicit form has it (shear_flow_test.cpp); backward Euler is late
    // by tΔt/2τ² of a mode: 32/π³ e⁻¹ Δt/2τ of U at t = τ.
    const double late = 16.0 / std::pow(pi, 3) * std::exp(-1.0) * dt / tau;
    if (times < 50.0) {
      EXPECT_LT(error_at(tau), (1.0 / (n * n) + late) * U) << times;
    }
    // 0.03 s at most: the release waves from the free ends, 0.35 m away, are not there yet
    EXPECT_LT(error_at(std::max(5.0 * tau, 50.0 * dt)), 1.0 / (n * n) * U) << times;
  }
}

// Between two fixed plates: u = (g sinθ/2ν) y(H − y).
TEST(ImplicitFlow, PlatesCarryAParabola) {
  const double H = 0.05, g_sin = 0.5 * g;
  const int n = 16;
  for (const double times : {10.0, 1000.0}) {
    const double nu = viscosity_beyond(times, H / n);
    Scene scene = incline(H, n, nu);
    scene.bodies[0].law = newtonian(rho * nu, K, 1.0, rho, true);
    scene.domain[1] = H;
    scene.top = {Wall::Kind::no_slip};
    Simulation simulation(scene, 1);
    run_until(simulation, std::max(8.0 * H * H / (pi * pi * nu), 50.0 * simulation.next_dt()));
    EXPECT_LT(largest_error(middle(simulation, H),
                            [&](double y) { return g_sin / (2.0 * nu) * y * (H - y); }),
              1.0 / (n * n) * g_sin * H * H / (8.0 * nu))
        << times;
  }
}

// A viscous block collapses; the implicit form differs from the explicit one by a term of first
// order in the step.
TEST(ImplicitFlow, AgreesWithTheExplicitFormAsTheStepShrinks) {
  const auto centre = [](Viscosity viscosity, double dt) {
    Scene scene = empty_box(0.6, 0.3, 0.025);
    scene.gravity = g;
    scene.floor = {Wall::Kind::no_slip};
    scene.bodies = {block(0.0, 0.0, 0.1, 0.2, newtonian(20.0, 26000.0, 1.0, 1300.0))};
    scene.transfer = Transfer::relaxed;  // the same damping whatever the step
    scene.dt = dt;
    scene.viscosity = viscosity;
    scene.viscosity_tolerance = 1e-8;
    Simulation simulation(scene, 1);
    run_until(simulation, 0.15);
    double moment = 0.0, mass = 0.0;
    for (const PointState& p : points_of(simulation)) {
      moment += p[MASS] * p[X];
      mass += p[MASS];
    }
    return moment / mass;
  };
  double gap[2];
  for (const int k : {0, 1}) {
    const double dt = 5e-4 / (1 << k);
    gap[k] = centre(Viscosity::implicit_solve, dt) - centre(Viscosity::explicit_force, dt);
  }
  // half, up to the next order in Δt over the time of the flow, 0.1 s
  EXPECT_NEAR(gap[1] / gap[0], 0.5, 0.05);
  // that ratio, 5e-3, of the centre's way of some 20 mm
  EXPECT_LT(std::abs(gap[0]), 1e-4);
}

/// Grains as a viscosity, a fluid and elastoplastic grains.
Scene three_bodies(Kernel kernel, Transfer transfer) {
  Scene scene = empty_box(1.0, 0.5, 0.025);
  scene.kernel = kernel;
  scene.transfer = transfer;
  scene.gravity = g;
  scene.tilt_deg = 10.0;
  scene.floor = {Wall::Kind::no_slip};
  scene.right = {Wall::Kind::open};
  scene.viscosity = Viscosity::implicit_solve;
  const LawSpec laws[] = {mu_i(26000.0, "regularised"), newtonian(50.0, 26000.0, 7.0, 1300.0, true),
                          mu_i(26000.0)};
  for (std::size_t b = 0; b < 3; ++b) {
    scene.bodies.push_back(block(0.1 + 0.3 * static_cast<double>(b), 0.0, 0.2, 0.2, laws[b]));
    scene.bodies.back().velocity = {2.0, 0.0};  // the last one leaves
  }
  return scene;
}

// What frames show is the stress of the law at the velocity gradient of the end of the step.
TEST(ImplicitStep, StoresTheStressOfItsVelocity) {
  Simulation simulation(three_bodies(Kernel::cubic, Transfer::apic), 1);
  run_steps(simulation, 40);
  double largest = 0.0;
  for (const PointState& p : points_of(simulation)) {
    if (p.body != 1) continue;
    const double eta = 50.0, m = (p[LXX] + p[LYY]) / 3.0;
    const double pressure = 26000.0 * (std::pow(p[RHO] / 1300.0, 7.0) - 1.0);
    // round-off of p = K(r⁷ − 1): a few eps of K
    EXPECT_NEAR(p[SXX], -pressure + 2.0 * eta * (p[LXX] - m), 1e-10 * 26000.0);
    EXPECT_NEAR(p[SYY], -pressure + 2.0 * eta * (p[LYY] - m), 1e-10 * 26000.0);
    EXPECT_NEAR(p[SXY], eta * (p[LXY] + p[LYX]), 1e-10 * 26000.0);
    largest = std::max(largest, std::abs(p[SXY]));
  }
  EXPECT_GT(largest, 1.0);
}

TEST(ImplicitStep, SameBitsForAnyThreadsAndAfterResuming) {
  // four real threads, also where there are fewer cores
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  for (const Kernel kernel : {Kernel::cubic, Kernel::quadratic}) {
    const Scene scene =
        three_bodies(kernel, kernel == Kernel::cubic ? Transfer::relaxed : Transfer::apic);
    const ScratchFile file;
    const auto run = [&](int threads, bool save) {
      Simulation simulation(scene, threads);
      run_steps(simulation, 100);
      if (save) simulation.save(file.path());
      run_steps(simulation, 100);
      EXPECT_GT(simulation.counters().cg_iterations, simulation.steps());
      EXPECT_GT(simulation.diagnostics().outflow_kg_per_m, 0.1);
      return saved_state(simulation);
    };
    const SavedState one = run(1, true);
    EXPECT_EQ(run(2, false), one);
    EXPECT_EQ(run(4, false), one);
    Simulation resumed(scene, 2);
    resumed.load(file.path());
    run_steps(resumed, 100);
    EXPECT_EQ(saved_state(resumed), one);
  }
}

// r = 1e-200: at rest under pressure the viscosity is beyond any number.
TEST(ImplicitStep, SaysWhyItEnds) {
  Scene scene = column_collapse(mu_i(254800.0, "regularised"), 0.05);
  scene.domain[1] = 0.55;
  scene.bodies[0].law.values["r"] = 1e-200;
  scene.bodies[0].lithostatic = true;
  scene.viscosity = Viscosity::implicit_solve;
  Simulation simulation(scene, 1);
  try {
    simulation.step(HUGE_VAL);
    FAIL() << "there is no such velocity";
  } catch (const NumericalFailure& failure) {
    EXPECT_NE(std::string(failure.what()).find("the implicit viscosity"), std::string::npos)
        << failure.what();
    EXPECT_NE(std::string(failure.what()).find("conjugate gradient iterations"), std::string::npos);
  }
}

// A rigid body in free flight is left alone: no force, and none is invented.
TEST(ImplicitStep, LetsARigidBodyFly) {
  Scene scene = empty_box(1.0, 1.0, 0.025);
  scene.bodies = {block(0.3, 0.3, 0.3, 0.3, newtonian(1e6, 1e5, 1.0, rho, true))};
  scene.bodies[0].velocity = {1.0, 0.5};
  scene.viscosity = Viscosity::implicit_solve;
  Simulation simulation(scene, 1);
  run_steps(simulation, 100);
  for (const PointState& p : points_of(simulation)) {
    // the solve may leave its round-off at every step, 16 eps of Δt·diag(K)/M ≈ 4Δtη/ρh² ≈ 8e3, on
    // the lightest nodes
    EXPECT_NEAR(p[VX], 1.0, 1e-8);
    EXPECT_NEAR(p[VY], 0.5, 1e-8);
  }
}

// Every joule found again, the viscous work with the material's.
TEST(ImplicitCollapse, LedgerCloses) {
  for (const double r : {1e-4, 1.0}) {
    Scene scene = column_collapse(mu_i(254800.0, "regularised"), 0.025);
    scene.domain[1] = 0.55;
    scene.bodies[0].law.values["r"] = r;
    scene.viscosity = Viscosity::implicit_solve;
    Simulation simulation(scene, 2);
    const SeriesRow start = simulation.diagnostics();
    run_until(simulation, 0.6);
    const SeriesRow end = simulation.diagnostics();
    const double drop = start.potential_J_per_m - end.potential_J_per_m;
    // of second order in the step: the bound of every law (collapse_test.cpp)
    EXPECT_LT(std::abs(end.energy_residual_J_per_m), 0.01 * drop);
    EXPECT_GT(end.dissipated_J_per_m, 0.5 * drop);
  }
}

// MUI-3 with r = 1e-4 at the step that the waves allow, 10⁵ times the explicit limit. It is the
// same heap as that of MUI-4, and it comes to rest: creep at r over 1.2 s strains it by 1e-4.
TEST(ImplicitCollapse, StiffGrainsComeToRest) {
  struct Outcome {
    SeriesRow end;
    std::vector<double> depth;
  };
  const auto collapse = [](const char* form, Viscosity viscosity) {
    Scene scene = column_collapse(mu_i(254800.0, form));
    scene.transfer = Transfer::relaxed;  // does not damp by the step, and the two differ in theirs
    scene.viscosity = viscosity;
    Simulation simulation(scene, 2);
    double kinetic = HUGE_VAL;
    for (const double t : {0.9, 1.0, 1.1, 1.2}) {
      run_until(simulation, t);
      const double now = simulation.diagnostics().kinetic_J_per_m;
      EXPECT_LT(now, kinetic) << "falls and keeps falling, t = " << t;
      kinetic = now;
    }
    if (viscosity == Viscosity::implicit_solve) {
      // p = ρgH_0/2, γ̇ = 0: the explicit limit of half the column
      const double eta = 0.3819 * 2548.0 / 1e-4;
      EXPECT_GT(simulation.counters().dt_min_s,
                1e4 * 0.9 * 1300.0 * scene.h * scene.h / (4.0 * eta));
      EXPECT_GT(simulation.counters().dt_min_s, 0.4 * simulation.counters().dt_max_s)
          << "stops halve";
    }
    return Outcome{simulation.diagnostics(), simulation.profile().depth_m};
  };
  const Outcome viscous = collapse("regularised", Viscosity::implicit_solve);
  const Outcome elastic = collapse("elastoviscoplastic", Viscosity::explicit_force);
  EXPECT_LT(viscous.end.kinetic_J_per_m, 2e-5);
  EXPECT_LT(elastic.end.kinetic_J_per_m, 2e-5);
  // a front is read to the cell where the depth passes 0.02 H_0
  EXPECT_NEAR(viscous.end.front_m, elastic.end.front_m, 0.0125);
  double difference = 0.0, area = 0.0;
  for (std::size_t i = 0; i < viscous.depth.size(); ++i) {
    difference += std::abs(viscous.depth[i] - elastic.depth[i]);
    area += elastic.depth[i];
  }
  EXPECT_LT(difference, 0.02 * area) << "of the area; point noise in a column of cells is 1 in 50";
}

}  // namespace
}  // namespace repose::mpm

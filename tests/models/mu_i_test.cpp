/// \file
/// μ(I): the flow curve in both forms, arrest, bounds, ill-posedness, pressure and energy, initial
/// states.

#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

using Flowing = MuIElastoviscoplastic;
using Viscous = MuIRegularised;

template <class L>
typename L::template Params<double> column(const std::map<std::string, double>& changes = {}) {
  LawExample example = examples_of<L>()[0];
  for (const auto& [name, x] : changes) example.spec.values[name] = x;
  return parameters_of<L>(example);
}

/// Simple shear in xy by γ.
Sym<double, 6> shear(double gamma) {
  Sym<double, 6> strain = Sym<double, 6>::isotropic(0.0);
  strain[3] = 0.5 * gamma;
  return strain;
}

template <class L, class P>
LawPoint<L> at_pressure(const P& par, double p) {
  InitialConditions given;
  given.p = p;
  const InitialPoint start = L::initial(par, given);
  return {start.stress, {}, start.density};
}

/// μ(I) and I as printed: physics.md MUI-2.
template <class P>
double mu_of(const P& par, double gamma_dot, double p) {
  const double I = gamma_dot * par.d * std::sqrt(par.rho_p / p);
  return par.mu_0 + (par.mu_d - par.mu_0) / (par.I_0 / I + 1.0);
}

TEST(MuI, SteadyShearFollowsTheFlowCurveOverTwelveDecades) {
  // r far below every rate, so that √(γ̇² + r²) = γ̇
  const auto viscous = column<Viscous>({{"r", 1e-20}});
  const auto flowing = column<Flowing>();
  for (const double p : {1.0, 1e3, 1e5}) {
    for (int decade = -6; decade <= 6; ++decade) {
      for (const double digit : {1.0, 3.0}) {
        const double rate = digit * std::pow(10.0, decade);
        const double mu = mu_of(viscous, rate, p);

        LawPoint<Viscous> fluid = at_pressure<Viscous>(viscous, p);
        const double p_fluid = pressure(fluid.stress);
        ASSERT_FALSE(fluid.step(viscous, shear(rate * 1e-4), 1e-4));
        // 12 roundings, and p known to ε K (it is a difference of densities), which moves μ by less
        EXPECT_NEAR(fluid.stress[3] / p_fluid, mu, (12.0 + 2.0 * viscous.K / p) * epsilon * mu);

        LawPoint<Flowing> solid = at_pressure<Flowing>(flowing, p);
        // steps of a tenth of the yield strain: steady when nothing changes any more
        const double dt = 0.1 * flowing.mu_0 * p / flowing.G / rate;
        double before = -1.0;
        int steps = 0;
        for (; steps < 100000 && solid.stress[3] != before; ++steps) {
          before = solid.stress[3];
          ASSERT_FALSE(solid.step(flowing, shear(rate * dt), dt));
        }
        // The step gives τ = f(τ + GγΔt) to 10 ε of τ + GγΔt; f' < 1, and 1 − f' is what the
        // approach to the steady state leaves: at worst (slow flow, f' ≈ 1 − α⁻¹…) some 100 ε.
        EXPECT_NEAR(solid.stress[3] / pressure(solid.stress), mu,
                    (400.0 + 2.0 * flowing.K / p) * epsilon * mu)
            << "p = " << p << " rate " << rate << " after " << steps;
      }
    }
  }
}

TEST(MuI, OneLargeStepReachesTheSteadyState) {
  // Δt → ∞ at constant rate: the implicit step has τ = μ(I)p as its fixed point; GγΔt = 1e6 τ
  const auto P = column<Flowing>();
  for (const double rate : {1e-3, 1.0, 1e3}) {
    LawPoint<Flowing> point = at_pressure<Flowing>(P, 1e3);
    const double dt = 1e6 * P.mu_0 * 1e3 / P.G / rate;
    for (int step = 0; step < 3; ++step) ASSERT_FALSE(point.step(P, shear(rate * dt), dt));
    const double mu = mu_of(P, rate, 1e3);
    // γ̇_p = γ̇ − τ̇/G is met to ε of γ̇, and the flow curve is flat: dμ/μ < dγ̇/γ̇; p to ε K
    EXPECT_NEAR(point.stress[3] / pressure(point.stress), mu,
                (64.0 + 2.0 * P.K / 1e3) * epsilon * mu);
  }
}

TEST(MuI, ImplicitStepSolvesItsEquationWithoutCancellation) {
  // (τ_tr − τ)(S_2 − τ) = α(τ − S_0)                                                        MUI-4
  const auto P = column<Flowing>();
  Random random(51);
  for (int sample = 0; sample < 20000; ++sample) {
    LawPoint<Flowing> point = at_pressure<Flowing>(P, random.decade(0.0, 5.0));
    const double p = pressure(point.stress);
    const double S_0 = P.mu_0 * p, S_2 = P.mu_d * p;
    // trial stresses from yield to far beyond, and right at S_2, where B² − 4H cancels
    const double tau_trial = sample % 2 == 0
                                 ? S_0 * (1.0 + random.decade(-8.0, 3.0))
                                 : S_2 * (1.0 + random(-1.0, 1.0) * random.decade(-16.0, 0.0));
    const double dt = random.decade(-15.0, 3.0);
    ASSERT_FALSE(point.step(P, shear(tau_trial / P.G), dt));
    const double tau = point.stress[3];
    if (tau_trial <= S_0) {
      EXPECT_NEAR(tau, tau_trial, 4.0 * epsilon * tau_trial);
      continue;
    }
    // the same root in long double, from the plain formula
    const long double alpha = static_cast<long double>(P.G) * dt * (P.I_0 / P.d) *
                              std::sqrt(static_cast<long double>(p) / P.rho_p);
    const long double t = static_cast<long double>(P.G) * (tau_trial / P.G);
    const long double B = S_2 + t + alpha;
    const long double H = static_cast<long double>(S_2) * t + S_0 * alpha;
    const long double root = 2.0L * H / (B + std::sqrt(std::max(0.0L, B * B - 4.0L * H)));
    // S_0, S_2 and τ_tr are rounded (2 ε each); their effect on τ is at most √ where the root is
    // nearly double, (S_2 − τ_tr − α)² ≈ 4α(S_2 − S_0): relative ε S_2/√(4α(S_2 − S_0))
    const double gap = static_cast<double>(
        std::sqrt((t - S_2 + alpha) * (t - S_2 + alpha) + 4.0L * alpha * (S_2 - S_0)));
    const double magnified = 8.0 * epsilon * (1.0 + std::min(S_2 / gap, 1e8));
    EXPECT_NEAR(tau, static_cast<double>(root), 4.0 * magnified * tau);
    EXPECT_GE(tau, S_0 * (1.0 - 4.0 * epsilon));
    EXPECT_LE(tau, std::max(S_2, S_0) * (1.0 + 4.0 * epsilon));
  }
}

TEST(MuI, ArrestsBelowTheStaticFriction) {
  const auto P = column<Flowing>();
  LawPoint<Flowing> point = at_pressure<Flowing>(P, 1e3);
  // below μ_0 p nothing flows: any number of cycles of stress returns to zero strain at zero stress
  const double gamma = 0.99 * P.mu_0 * 1e3 / P.G;
  for (int cycle = 0; cycle < 1000; ++cycle) {
    for (const double sign : {1.0, -1.0, -1.0, 1.0})
      ASSERT_FALSE(point.step(P, shear(sign * gamma), 1.0));
  }
  // 4000 steps add a rounding each
  EXPECT_NEAR(point.stress[3], 0.0, 4000.0 * epsilon * P.G * gamma);
  // flow, then rest: τ falls to μ_0 p and not below, however long it rests
  for (int step = 0; step < 100; ++step) ASSERT_FALSE(point.step(P, shear(0.01), 1e-3));
  EXPECT_GT(point.stress[3], 1.1 * P.mu_0 * 1e3);
  double before = point.stress[3];
  for (int step = 0; step < 1000; ++step) {
    ASSERT_FALSE(point.step(P, shear(0.0), 1e-3));
    EXPECT_LE(point.stress[3], before * (1.0 + 4.0 * epsilon));
    before = point.stress[3];
  }
  EXPECT_NEAR(point.stress[3], P.mu_0 * pressure(point.stress), 16.0 * epsilon * 1e3);
}

TEST(MuI, WithoutPressureNothingIsCarried) {
  const auto flowing = column<Flowing>();
  LawPoint<Flowing> point = at_pressure<Flowing>(flowing, 1e3);
  ASSERT_FALSE(point.step(flowing, shear(1e-2), 1e-3));
  const Sym<double, 6> swell = Sym<double, 6>::isotropic(0.01);
  ASSERT_FALSE(point.step(flowing, swell + shear(1e-2), 1e-3));
  for (int k = 0; k < 6; ++k) EXPECT_EQ(point.stress[k], 0.0);
  // the rate at p = 0, τ = 0 is a number: nothing flows
  Sym<double, 6> rate;
  std::array<double, 0> none{};
  Flowing::rate(flowing, point.stress, none, point.density, shear(1.0), Branch::plastic, rate,
                none);
  for (int k = 0; k < 6; ++k) EXPECT_TRUE(std::isfinite(rate[k]));
  const auto viscous = column<Viscous>();
  EXPECT_EQ(Viscous::viscosity(viscous, point.stress, 0.9 * viscous.rho_0, shear(1.0)), 0.0);
  EXPECT_EQ(Viscous::viscosity(viscous, point.stress, 0.9 * viscous.rho_0, shear(0.0)), 0.0);
}

TEST(MuI, RegularisedViscosityIsBoundedAtRest) {
  const auto P = column<Viscous>();
  EXPECT_EQ(P.r, 1e-4);
  for (const double p : {10.0, 5e3}) {
    const double at_rest = Viscous::effective_viscosity(P, p, 0.0);
    // η(0) = μ_0 p/r + (μ_d − μ_0) d √(pρ_p)/I_0                                              MUI-3
    const double bound =
        P.mu_0 * p / P.r + (P.mu_d - P.mu_0) * P.d * std::sqrt(p * P.rho_p) / P.I_0;
    EXPECT_NEAR(at_rest, bound, 8.0 * epsilon * bound);
    for (double rate = 1e-8; rate < 1e8; rate *= 10.0) {
      const double eta = Viscous::effective_viscosity(P, p, rate);
      EXPECT_LT(eta, at_rest * (1.0 + 4.0 * epsilon));
      // with r: the static part is μ_0 p γ̇/√(γ̇² + r²)
      const double tau =
          P.mu_0 * p * rate / std::sqrt(rate * rate + P.r * P.r) + (mu_of(P, rate, p) - P.mu_0) * p;
      EXPECT_NEAR(eta * rate, tau, 16.0 * epsilon * mu_of(P, rate, p) * p);
    }
  }
  // the published bound at the column's base, 0.4 m under 1300 kg/m³: 1.9e7 Pa s (two digits)
  EXPECT_NEAR(Viscous::effective_viscosity(P, 1300.0 * 9.8 * 0.4, 0.0), 1.9e7, 0.05e7);
}

TEST(MuI, PressureAndItsEnergy) {
  const auto P = column<Flowing>();
  // p = K(ρ/ρ0 − 1), none below ρ0 MUI-1
  EXPECT_NEAR(mu_i::pressure_of(P, 1.01 * 1300.0), 0.01 * P.K, 4.0 * epsilon * P.K);
  EXPECT_EQ(mu_i::pressure_of(P, 0.99 * 1300.0), 0.0);
  EXPECT_NEAR(mu_i::density_at(P, 5e3), 1300.0 * (1.0 + 5e3 / P.K), 1e-12 * 1300.0);
  for (const double r : {1.0001, 1.02, 1.5}) {
    // ρ ∫ p/ρ² dρ by Simpson's rule with n intervals: error below (r−1)⁵ p⁗/(180 n⁴) < 1e-13 K
    const int n = 2000;
    const double h = (r - 1.0) * 1300.0 / n;
    double integral = 0.0;
    for (int i = 0; i <= n; ++i) {
      const double rho = 1300.0 + h * i;
      const double weight = i == 0 || i == n ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
      integral += weight * h / 3.0 * mu_i::pressure_of(P, rho) / (rho * rho);
    }
    const double rho = r * 1300.0;
    EXPECT_NEAR(mu_i::compression_energy(P, rho), rho * integral,
                1e-13 * P.K + 16.0 * epsilon * P.K);
  }
  EXPECT_EQ(mu_i::compression_energy(P, 1200.0), 0.0);
  // elastic shear: τ²/(2G)
  LawPoint<Flowing> point = at_pressure<Flowing>(P, 1e3);
  const double at_rest = Flowing::stored_energy(P, point.stress, {}, point.density);
  point.stress[3] = 250.0;
  EXPECT_NEAR(Flowing::stored_energy(P, point.stress, {}, point.density) - at_rest,
              250.0 * 250.0 / (2.0 * P.G), 8.0 * epsilon * P.K);
}

TEST(MuI, InitialStates) {
  const auto P = column<Flowing>();
  InitialConditions given;
  given.p = 2e3;
  InitialPoint start = Flowing::initial(P, given);
  EXPECT_NEAR(start.density, 1300.0 * (1.0 + 2e3 / 254800.0), 1e-12 * 1300.0);
  EXPECT_NEAR(pressure(start.stress), 2e3, 4.0 * epsilon * P.K);  // p of a rounded ρ
  given = {};
  given.density = 1310.0;
  start = Flowing::initial(P, given);
  EXPECT_EQ(start.density, 1310.0);
  EXPECT_NEAR(pressure(start.stress), P.K * (10.0 / 1300.0), 4.0 * epsilon * P.K);
  given.K0 = 0.7;
  start = Flowing::initial(P, given);
  EXPECT_NEAR(start.stress[0] / start.stress[1], 0.7, 1e-12);
  given = {};
  EXPECT_EQ(pressure(Flowing::initial(P, given).stress), 0.0);  // nothing given: p = 0 at ρ0
  EXPECT_EQ(Flowing::initial(P, given).density, 1300.0);

  const auto refused = [](auto&& f) {
    try {
      f();
    } catch (const InputError& error) {
      return error.key() + ": " + error.what();
    }
    return std::string("accepted");
  };
  const auto of = [&](const InitialConditions& conditions) {
    return refused([&] { Flowing::initial(P, conditions); });
  };
  given.p = 1e3;
  given.K0 = 0.4;  // τ/p = 0.58
  EXPECT_EQ(of(given), "K0: the initial stress is beyond yield: tau/p must be <= mu_0 at rest");
  given.K0 = 0.7;
  EXPECT_EQ(refused([&] { Viscous::initial(column<Viscous>(), given); }),
            "K0: the regularised form carries no shear stress at rest: the initial stress must be "
            "isotropic (form = \"elastoviscoplastic\" takes any)");
  given = {};
  given.p = -1.0;
  EXPECT_EQ(of(given), "p: p must be >= 0 Pa: grains carry no tension");
  given.p = 1.0;
  given.ocr = 2.0;
  EXPECT_EQ(of(given), "ocr: mu_i has no preconsolidation pressure: leave ocr out");
  given.ocr.reset();
  given.v = 1.6;
  EXPECT_EQ(of(given), "v: mu_i starts from p, sigma or density, not from a specific volume");
  given.v.reset();
  given.density = 1300.0;
  EXPECT_EQ(of(given), "density: give either density or p for mu_i: one follows from the other");
}

}  // namespace
}  // namespace repose

/// \file
/// The Newtonian fluid: shear, equation of state, stored energy, initial states.

#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

template <class L>
class NewtonianUnit : public ::testing::Test {};
using Forms = ::testing::Types<Newtonian<Tension::cut_off>, Newtonian<Tension::carried>>;
TYPED_TEST_SUITE(NewtonianUnit, Forms, LawName);

TYPED_TEST(NewtonianUnit, ShearStressIsViscosityTimesRate) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    LawPoint<L> point{Sym<double, 6>::isotropic(0.0), {}, P.rho_0};
    for (double rate = 1e-6; rate < 1e7; rate *= 10.0) {
      Sym<double, 6> strain = Sym<double, 6>::isotropic(0.0);
      strain[3] = 0.5 * rate * 1e-3;  // γ = 2ε_xy in 1 ms
      ASSERT_FALSE(point.step(P, strain, 1e-3));
      EXPECT_NEAR(point.stress[3], P.eta * rate, 4.0 * epsilon * P.eta * rate);
      EXPECT_EQ(pressure(point.stress), 0.0);
      EXPECT_EQ(L::viscosity(P, point.stress, point.density, strain), P.eta);
    }
    // axial stretching without change of volume: σ_xx − σ_yy = 2η(D_xx − D_yy)
    Sym<double, 6> strain = Sym<double, 6>::isotropic(0.0);
    strain[0] = 1e-4;
    strain[1] = -1e-4;
    ASSERT_FALSE(point.step(P, strain, 1e-3));
    EXPECT_NEAR(point.stress[0] - point.stress[1], 4.0 * P.eta * 0.1, 16.0 * epsilon * P.eta);
  }
}

TYPED_TEST(NewtonianUnit, EquationOfState) {
  using L = TypeParam;
  const bool carries = L::option == "false";
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    for (const double r : {0.5, 0.9, 0.9999, 1.0, 1.0001, 1.1, 2.0}) {
      // p = K(r^α − 1), in long double
      const long double exact = P.K * (std::pow(static_cast<long double>(r), P.alpha) - 1.0L);
      const double expected = carries || r > 1.0 ? static_cast<double>(exact) : 0.0;
      const double p = L::equation_of_state(P, r * P.rho_0);
      // ρ/ρ0 known to ε: αK r^α ε, and the functions' own roundings
      EXPECT_NEAR(p, expected, 8.0 * epsilon * P.alpha * P.K * std::pow(r, P.alpha)) << r;
      if (p > 0.0) {
        EXPECT_NEAR(L::density_at(P, p, 1.0), r * P.rho_0, 8.0 * epsilon * P.rho_0 * r);
      }
      // dp/dlnρ by a central difference: h² α³K/6 + ε αK/h
      const double h = 1e-5;
      if (std::abs(r - 1.0) < 2.0 * h) continue;
      const double slope = (L::equation_of_state(P, r * P.rho_0 * std::exp(h)) -
                            L::equation_of_state(P, r * P.rho_0 * std::exp(-h))) /
                           (2.0 * h);
      const double size = P.alpha * P.K * std::pow(r, P.alpha);
      EXPECT_NEAR(L::bulk_modulus(P, r * P.rho_0), slope,
                  size * (P.alpha * P.alpha * h * h + 16.0 * epsilon / h));
    }
  }
}

TYPED_TEST(NewtonianUnit, StoredEnergyIsTheWorkOfThePressure) {
  using L = TypeParam;
  for (LawExample example : examples_of<L>()) {
    for (const double alpha : {1.0, 1.0 + 1e-9, 1.5, 7.0}) {
      example.spec.values["alpha"] = alpha;
      const auto P = parameters_of<L>(example);
      for (const double r : {0.7, 0.99, 1.001, 1.05, 1.4}) {
        // ρ ∫ p/ρ² dρ by Simpson's rule with 4000 intervals: error (Δr)⁵ f⁗/(180 n⁴) < 1e-14 K
        const int n = 4000;
        const double h = (r - 1.0) * P.rho_0 / n;
        double integral = 0.0;
        for (int i = 0; i <= n; ++i) {
          const double rho = P.rho_0 + h * i;
          const double weight = i == 0 || i == n ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
          integral += weight * h / 3.0 * L::equation_of_state(P, rho) / (rho * rho);
        }
        const double W = L::stored_energy(P, Sym<double, 4>{}, {}, r * P.rho_0);
        // terms of the size of αK r^α cancel
        EXPECT_NEAR(W, r * P.rho_0 * integral, 64.0 * epsilon * alpha * P.K * std::pow(r, alpha))
            << "alpha " << alpha << " r " << r;
        EXPECT_GE(W, 0.0);
      }
    }
  }
}

TYPED_TEST(NewtonianUnit, StiffEnoughForTheStepWhereItIsApart) {
  using L = TypeParam;
  const auto P = parameters_of<L>(examples_of<L>()[0]);
  // ρc² = αK(ρ/ρ0)^α in compression; in dilation c stays c(ρ0)
  const double at_rest = P.alpha * P.K;
  EXPECT_NEAR(L::modulus(P, Sym<double, 4>{}, {}, P.rho_0), at_rest, 4.0 * epsilon * at_rest);
  EXPECT_NEAR(L::modulus(P, Sym<double, 4>{}, {}, 1.1 * P.rho_0), at_rest * std::pow(1.1, P.alpha),
              32.0 * epsilon * at_rest);
  EXPECT_NEAR(L::modulus(P, Sym<double, 4>{}, {}, 0.8 * P.rho_0), 0.8 * at_rest,
              8.0 * epsilon * at_rest);
}

TYPED_TEST(NewtonianUnit, InitialStates) {
  using L = TypeParam;
  const auto P = parameters_of<L>(examples_of<L>()[0]);
  InitialConditions given;
  EXPECT_EQ(L::initial(P, given).density, P.rho_0);
  given.p = 1e3;
  InitialPoint start = L::initial(P, given);
  EXPECT_NEAR(start.density, P.rho_0 * std::pow(1.0 + 1e3 / P.K, 1.0 / 7.0), 1e-12 * P.rho_0);
  EXPECT_NEAR(pressure(start.stress), 1e3, 8.0 * epsilon * P.alpha * P.K);
  given = {};
  given.sigma = {1e3, 1e3, 1e3, 0.0, 0.0, 0.0};
  EXPECT_NEAR(pressure(L::initial(P, given).stress), 1e3, 8.0 * epsilon * P.alpha * P.K);
  given = {};
  given.density = 1.01 * P.rho_0;
  start = L::initial(P, given);
  EXPECT_EQ(start.density, 1.01 * P.rho_0);
  EXPECT_NEAR(pressure(start.stress), P.K * (std::pow(1.01, 7.0) - 1.0),
              16.0 * epsilon * P.alpha * P.K);

  const auto refused = [&](const InitialConditions& conditions) {
    try {
      L::initial(P, conditions);
    } catch (const InputError& error) {
      return error.key() + ": " + error.what();
    }
    return std::string("accepted");
  };
  given.p = 1.0;
  EXPECT_EQ(refused(given),
            "density: give either density or p for newtonian: one follows from the other");
  given = {};
  given.K0 = 0.5;
  EXPECT_EQ(refused(given), "K0: a fluid at rest has K0 = 1, not another value");
  given = {};
  given.sigma = {1e3, 1e3, 1e3, 100.0, 0.0, 0.0};
  EXPECT_EQ(refused(given),
            "sigma: a fluid at rest carries no shear stress: sigma must be isotropic");
  given = {};
  given.p = -1e3;
  EXPECT_EQ(refused(given),
            L::option == "false"
                ? "accepted"
                : "p: p must be >= 0 for newtonian with tension_cutoff, > -K without");
  given.p = -P.K;
  EXPECT_EQ(refused(given), "p: p must be >= 0 for newtonian with tension_cutoff, > -K without");
  given = {};
  given.density = -1.0;
  EXPECT_EQ(refused(given), "density: density must be > 0 kg/m³");
}

}  // namespace
}  // namespace repose

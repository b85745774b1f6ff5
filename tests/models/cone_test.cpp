/// \file
/// The shape of the cone of friction: against the invariants of Matsuoka & Nakai, its closed forms,
/// and what the laws make of it in triaxial compression, extension and simple shear.

#include <numbers>

#include <gtest/gtest.h>

#include "models/dual.hpp"
#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

constexpr double mn = 1.0;  // shape = "matsuoka_nakai"

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// det of −σ
double third_invariant(const Sym<double, 6>& a) {
  return -(a[2] * (a[0] * a[1] - a[3] * a[3]) + 2.0 * a[3] * a[4] * a[5] - a[0] * a[4] * a[4] -
           a[1] * a[5] * a[5]);
}

// I_1I_2/I_3 of a stress p, q = M g p in any direction of shear, from its components alone.
TEST(ConeTest, TheInvariantsAreThoseOfMatsuokaAndNakai) {
  Random random(1);
  for (int sample = 0; sample < 20'000; ++sample) {
    const double phi = random(1.0, 60.0);
    const double M = cone::slope_of_angle(phi);
    Sym<double, 6> s = deviator(random.tensor(1.0));
    const double q = mises(s);
    const double p = random.decade(0.0, 5.0);
    const double g = cone::share(mn, M, s);
    const Sym<double, 6> stress = (M * g * p / q) * s - Sym<double, 6>::isotropic(p);
    const double I1 = -trace(stress);
    const double I2 = 0.5 * (I1 * I1 - contract(stress, stress));
    const double expected = 9.0 + 8.0 * std::pow(std::tan(radians(phi)), 2);
    // I_3 is a difference of terms of the size p³, each to a few ε; for 60° it is 0.05 p³
    const double I3 = third_invariant(stress);
    EXPECT_NEAR(I1 * I2 / I3, expected, 1e2 * epsilon * expected * p * p * p / I3)
        << "phi " << phi << " cos 3 theta " << cone::cos_3_theta(s);
    ASSERT_GT(g, 0.0);
    ASSERT_LE(g, 1.0 + 4.0 * epsilon);
  }
}

TEST(ConeTest, TriaxialTestsHaveOneFrictionAngleAndSimpleShearMore) {
  const Sym<double, 6> compression{{1.0, -2.0, 1.0}}, extension{{-1.0, 2.0, -1.0}},
      shear{{0.0, 0.0, 0.0, 1.0}};
  EXPECT_DOUBLE_EQ(cone::cos_3_theta(compression), 1.0);
  EXPECT_DOUBLE_EQ(cone::cos_3_theta(extension), -1.0);
  EXPECT_DOUBLE_EQ(cone::cos_3_theta(shear), 0.0);
  for (double phi = 0.5; phi < 89.0; phi += 0.5) {
    const double M = cone::slope_of_angle(phi), sine = std::sin(radians(phi));
    // a few ε each of M, b and the root, and of 3 − sin φ
    EXPECT_NEAR(cone::share(mn, M, compression), 1.0, 16 * epsilon);
    EXPECT_NEAR(cone::share(mn, M, extension), (3.0 - sine) / (3.0 + sine), 16 * epsilon);
    // at s_2 = 0 the invariants give sin φ of plane strain = 2t/√(3 + 4t²) = τ/p, t = tan φ
    const double t = std::tan(radians(phi));
    const double tau_over_p = M * cone::share(mn, M, shear) / std::sqrt(3.0);
    EXPECT_NEAR(tau_over_p, 2.0 * t / std::sqrt(3.0 + 4.0 * t * t), 16 * epsilon);
    EXPECT_NEAR(cone::shear_share(mn, M), cone::share(mn, M, shear), 16 * epsilon);
    EXPECT_EQ(cone::share(0.0, M, extension), 1.0);
  }
  // the angles that docs/physics.md names
  EXPECT_NEAR(cone::slope_of_angle(22.0), 0.8562, 1e-4);
  const double M = cone::slope_of_angle(22.0);
  EXPECT_NEAR(std::asin(M * cone::shear_share(mn, M) / std::sqrt(3.0)) * 180.0 / std::numbers::pi,
              25.0, 0.05);
}

// Every friction there is, in every direction: the cubic's residual, and that the root is its
// largest.
TEST(ConeTest, TheRootIsFoundForEveryFriction) {
  Random random(2);
  for (int sample = 0; sample < 200'000; ++sample) {
    const double M =
        sample % 2 == 0 ? 3.0 * random.decade(-12.0, 0.0) : 3.0 - random.decade(-9.0, 0.0);
    const double c = sample % 3 == 0 ? 1.0 - random.decade(-16.0, 0.3) : random(-1.0, 1.0);
    const double b = M * (3.0 + M);
    const double z = cone::inverse_share(M, c);
    const double residual = (9.0 * z * z - 9.0 - b) * z + b * c;
    const double slope = 27.0 * z * z - 9.0 - b;
    // terms of at most 27, each rounded; the slope vanishes with 3 − M and 1 − c, where two roots
    // meet
    EXPECT_LE(std::abs(residual), 27.0 * 8.0 * epsilon + 1e-16 * slope) << M << " " << c;
    EXPECT_GE(slope, 0.0) << M << " " << c;
    EXPECT_GE(z, 1.0 - 1e-8);
  }
}

// d ln g/dt against a central difference D(h) along directions of size 1: 4/3|D(h) − D(h/2)|
// estimates its error by the third derivative, and ln g is known to some 10 ε.
TEST(ConeTest, ItsRateIsItsDerivative) {
  Random random(3);
  int sharp = 0;
  for (int sample = 0; sample < 2000; ++sample) {
    const double M = random(0.1, 1.8);
    const bool plane = sample % 2 == 0;
    Sym<double, 6> s = deviator(random.tensor(1.0, plane));
    s = (1.0 / mises(s)) * s;
    const Sym<double, 6> rate = deviator(random.tensor(1.0, plane));
    const double h = 1e-4;
    const auto difference = [&](double step) {
      return (std::log(cone::share(mn, M, s + step * rate)) -
              std::log(cone::share(mn, M, s - step * rate))) /
             (2.0 * step);
    };
    const double whole = difference(h), half = difference(0.5 * h);
    const double exact = cone::share_rate(mn, M, s, rate);
    const double tolerance = 4.0 / 3.0 * std::abs(whole - half) + 4.0 * 10.0 * epsilon / h;
    EXPECT_NEAR(exact, half, tolerance);
    if (tolerance < 1e-6) ++sharp;
    if (plane) {
      EXPECT_NEAR(cone::share_rate(mn, M, LawPoint<MuIRegularised>::truncated<4>(s),
                                   LawPoint<MuIRegularised>::truncated<4>(rate)),
                  exact, 64 * epsilon * (1.0 + std::abs(exact)));
    }
    // and that of dual numbers
    using D = Dual<1>;
    Sym<D, 6> moving;
    for (int k = 0; k < 6; ++k) {
      moving[k] = D(s[k]);
      moving[k].v[0] = rate[k];
    }
    const D g = cone::share(D(mn), D(M), moving);
    EXPECT_NEAR(g.v[0] / g.a, exact, 1e-12 * (1.0 + std::abs(exact)));
  }
  EXPECT_GT(sharp, 1900) << "comparisons that say something";
  const Sym<double, 6> none{};
  EXPECT_EQ(cone::share_rate(mn, 1.0, none, Sym<double, 6>{{1.0, 0.0, -1.0}}), 0.0);
  EXPECT_EQ(cone::share(mn, 1.0, none), 1.0);
}

// Slow flow at constant volume ends at q = M g p of its direction. From the exact undrained
// solution M g − q/p = 2M g e^{−M g ε_q/(κ*Λ)}: with κ* = 0.028, Λ = 0.61 and ε_q = 0.7 a share of
// e^{−28}; 40 000 steps round by ε each.
TEST(ConeTest, CriticalStateIsOnTheCone) {
  using L = ModifiedCamClay<Compression::v_ln_p>;
  for (const LawExample& example : examples_of<L>()) {
    if (!example.spec.values.contains("shape")) continue;
    const auto P = parameters_of<L>(example);
    const double sine = 3.0 * P.M / (6.0 + P.M), t = std::tan(std::asin(sine));
    const std::array<std::pair<Sym<double, 6>, double>, 3> ways{{
        {{{0.5, -1.0, 0.5}}, P.M},
        {{{-0.5, 1.0, -0.5}}, 6.0 * sine / (3.0 + sine)},
        {{{0.0, 0.0, 0.0, 0.8}}, std::sqrt(3.0) * 2.0 * t / std::sqrt(3.0 + 4.0 * t * t)},
    }};
    for (const auto& [way, slope] : ways) {
      InitialConditions given;
      given.p = example.pressure;
      const InitialPoint start = L::initial(P, given);
      LawPoint<L> point{start.stress, {start.state[0], start.state[1]}, start.density};
      for (int step = 0; step < 40'000; ++step)
        ASSERT_FALSE(point.step(P, (1e-3 * example.strain) * way, example.time));
      EXPECT_NEAR(mises(point.stress) / pressure(point.stress), slope, 4e4 * epsilon * slope)
          << example.label;
    }
  }
}

// τ = μ(I) g p at once, along D′, for a viscous form; and after a long shear for the other.
TEST(ConeTest, SteadyShearOfGrainsIsOnTheCone) {
  const auto check = [&]<class L>(L) {
    for (const LawExample& example : examples_of<L>()) {
      if (!example.spec.values.contains("shape")) continue;
      const auto P = parameters_of<L>(example);
      for (const Sym<double, 6>& way :
           {Sym<double, 6>{{0.5, -1.0, 0.5}}, Sym<double, 6>{{-0.5, 1.0, -0.5}},
            Sym<double, 6>{{0.0, 0.0, 0.0, 1.0}}}) {
        const LawPoint<L> end = [&] {
          InitialConditions given;
          given.p = example.pressure;
          const InitialPoint start = L::initial(P, given);
          LawPoint<L> point{start.stress, {}, start.density};
          for (int step = 0; step < 5000; ++step)
            EXPECT_FALSE(point.step(P, (1e-2 * example.strain) * way, example.time));
          return point;
        }();
        const double p = pressure(end.stress);
        const double gamma_dot = 2.0 * shear_norm(way) * 1e-2 * example.strain / example.time;
        const double g = cone::share(mn, std::sqrt(3.0) * P.mu_0, way);
        auto round_P = P;
        round_P.shape = 0.0;
        const double of_circle = L::steady_shear_stress(round_P, p, gamma_dot);
        EXPECT_NEAR(shear_norm(deviator(end.stress)), g * of_circle, 500.0 * epsilon * of_circle)
            << example.label;
        if (way[3] != 0.0) {
          EXPECT_NEAR(L::steady_shear_stress(P, p, gamma_dot), g * of_circle, 1e-12 * of_circle);
        }
      }
    }
  };
  check(MuIElastoviscoplastic{});
  check(MuIRegularised{});
  check(MuIBarkerGray{});
}

TEST(ConeTest, FrictionBeyondEveryAngleIsRefused) {
  const LawSpec steep{"mu_i",
                      {},
                      {{"mu_0", 1.8},
                       {"mu_d", 2.0},
                       {"I_0", 0.279},
                       {"d", 0.005},
                       {"rho_p", 2000.0},
                       {"rho_0", 1300.0},
                       {"K", 26000.0},
                       {"shape", 1.0}}};
  EXPECT_THROW(checked_parameters(steep), InputError);
  LawSpec between = steep;
  between.values["mu_0"] = 0.4;
  between.values["shape"] = 0.5;
  EXPECT_THROW(checked_parameters(between), InputError);
}

}  // namespace
}  // namespace repose

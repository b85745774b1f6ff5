/// The hypoplastic sand of examples/umat against what von Wolffersdorff's equations say by
/// themselves: limits in closed form, and the rate equation integrated by another program.
#include <cmath>
#include <numbers>

#include "tests/umat/in/umat_fixture.hpp"

namespace repose::umat {
namespace {

#ifdef HYPOPLASTIC_SAND

using point::Curve;
using point::Kind;
using point::Quantity;
using point::Status;

struct Sand {
  double phi_c, h_s, n, e_d0, e_c0, e_i0, alpha, beta;
};
// of the order of Herle & Gudehus (Mechanics of Cohesive-Frictional Materials 4, 1999), table 1
constexpr Sand sand{33.0, 2.6e9, 0.27, 0.61, 0.98, 1.10, 0.18, 1.1};

TestLaw make_sand() {
  Description d = describe(HYPOPLASTIC_SAND, 8, 1);
  d.void_ratio_statev = 1;
  return make_law(
      d, {sand.phi_c, sand.h_s, sand.n, sand.e_d0, sand.e_c0, sand.e_i0, sand.alpha, sand.beta});
}

/// exp(−(3p/h_s)^n)
double decay(double p) { return std::exp(-std::pow(3.0 * p / sand.h_s, sand.n)); }

/// The rate equation for principal values, in the form σ̇ = f_s (L D + f_d N |D|) with the paper's
/// f_s = f_b f_e / tr(T̂²), L D = F² D + a² T̂ tr(T̂ D), N = a F (T̂ + T̂*). y: three stresses, tension
/// positive, and the void ratio.
using State = std::array<double, 4>;
State rate(const State& y, const std::array<double, 3>& D) {
  const double tr = y[0] + y[1] + y[2];
  std::array<double, 3> T, S;
  double T2 = 0.0, S2 = 0.0, S3 = 0.0, TD = 0.0, D2 = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    T[i] = y[i] / tr;
    S[i] = T[i] - 1.0 / 3.0;
    T2 += T[i] * T[i];
    S2 += S[i] * S[i];
    S3 += S[i] * S[i] * S[i];
    TD += T[i] * D[i];
    D2 += D[i] * D[i];
  }
  const double p3 = -tr, shrink = std::exp(-std::pow(p3 / sand.h_s, sand.n));
  const double e = y[3], e_i = sand.e_i0 * shrink, e_c = sand.e_c0 * shrink,
               e_d = sand.e_d0 * shrink;
  const double sine = std::sin(sand.phi_c * std::numbers::pi / 180.0);
  const double a = std::sqrt(3.0) * (3.0 - sine) / (2.0 * std::sqrt(2.0) * sine);
  const double tan_psi = std::sqrt(3.0 * S2);
  const double cos_3 = S2 > 1e-20 ? -std::sqrt(6.0) * S3 / std::pow(S2, 1.5) : 1.0;
  const double F = std::sqrt(tan_psi * tan_psi / 8.0 +
                             (2.0 - tan_psi * tan_psi) / (2.0 + std::sqrt(2.0) * tan_psi * cos_3)) -
                   tan_psi / (2.0 * std::sqrt(2.0));
  const double f_d = std::pow((e - e_d) / (e_c - e_d), sand.alpha);
  const double f_e = std::pow(e_c / e, sand.beta);
  const double f_b = sand.h_s / sand.n * (1.0 + e_i) / e_i *
                     std::pow(sand.e_i0 / sand.e_c0, sand.beta) *
                     std::pow(p3 / sand.h_s, 1.0 - sand.n) /
                     (3.0 + a * a -
                      std::sqrt(3.0) * a *
                          std::pow((sand.e_i0 - sand.e_d0) / (sand.e_c0 - sand.e_d0), sand.alpha));
  State dy;
  for (std::size_t i = 0; i < 3; ++i)
    dy[i] = f_b * f_e / T2 *
            (F * F * D[i] + a * a * T[i] * TD + f_d * a * F * (T[i] + S[i]) * std::sqrt(D2));
  dy[3] = (1.0 + e) * (D[0] + D[1] + D[2]);
  return dy;
}

/// Runge and Kutta's fourth order over the strain D in steps so many that halving them changes
/// nothing beyond 1e-10.
State integrate(State y, const std::array<double, 3>& D, int steps) {
  const auto moved = [](const State& from, const State& k, double h) {
    State to;
    for (std::size_t i = 0; i < 4; ++i) to[i] = from[i] + h * k[i];
    return to;
  };
  const double h = 1.0 / steps;
  for (int s = 0; s < steps; ++s) {
    const State k1 = rate(y, D), k2 = rate(moved(y, k1, h / 2), D),
                k3 = rate(moved(y, k2, h / 2), D), k4 = rate(moved(y, k3, h), D);
    for (std::size_t i = 0; i < 4; ++i) y[i] += h / 6.0 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  }
  return y;
}

point::PointTest strained(const std::array<double, 3>& compression, int rows, double p, double e) {
  point::LegSpec leg;
  for (int i = 0; i < 6; ++i)
    leg.rows[static_cast<std::size_t>(i)] =
        point::strain_rate(i, i < 3 ? 1e-3 * compression[static_cast<std::size_t>(i)] : 0.0);
  leg.duration = 1000.0;
  leg.points = rows;
  point::PointTest test;
  test.path = point::custom_path({leg});
  test.initial.p = p;
  test.initial.v = 1.0 + e;
  return test;
}

// The library keeps the error of each of its steps to 1e-7 of the stress. In 200 increments it
// takes one or two steps each, and what errors there are shrink along these paths, on which
// stiffness grows with pressure: 400 × 1e-7 at worst.
constexpr double drift = 400 * 1e-7;

class UmatHypoplastic : public testing::TestWithParam<std::array<double, 3>> {};

TEST_P(UmatHypoplastic, FollowsItsRateEquation) {
  const TestLaw law = make_sand();
  const double p = 1e5, e = 0.75;
  const point::PointTest test = strained(GetParam(), 20, p, e);
  Curve curve;
  ASSERT_EQ(point::simulate(*law.info, law.theta, test, curve).status, Status::completed);
  std::array<double, 3> D;
  for (std::size_t i = 0; i < 3; ++i) D[i] = -GetParam()[i];
  const State exact = integrate({-p, -p, -p, e}, D, 4000);
  const State coarser = integrate({-p, -p, -p, e}, D, 2000);
  const auto& row = curve.rows.back();
  const double size = std::abs(exact[0]) + std::abs(exact[1]) + std::abs(exact[2]);
  for (int i = 0; i < 3; ++i) {
    const auto I = static_cast<std::size_t>(i);
    ASSERT_NEAR(coarser[I], exact[I], 1e-10 * size) << "of the reference itself";
    EXPECT_NEAR(row.stress[i], exact[I], drift * size);
  }
  // (1 + e) = (1 + e_0) exp(tr ε)
  EXPECT_NEAR(row.state[0], (1.0 + e) * std::exp(D[0] + D[1] + D[2]) - 1.0, drift);
}

INSTANTIATE_TEST_SUITE_P(Paths, UmatHypoplastic,
                         testing::Values(std::array{0.0, 0.03, 0.0},      // oedometer
                                         std::array{-0.02, 0.04, -0.02},  // undrained compression
                                         std::array{0.02, -0.04, 0.02},   // undrained extension
                                         std::array{-0.03, 0.04, 0.0},    // plane strain
                                         std::array{0.01, 0.01, 0.01}),   // isotropic
                         [](const auto& path) { return "path_" + std::to_string(path.index); });

// From the loosest state on, isotropic compression follows e_i = e_i0 exp(−(3p/h_s)^n).
TEST(UmatHypoplasticLimits, LoosestStateStaysOnItsLine) {
  const TestLaw law = make_sand();
  const double p = 1e4, e = sand.e_i0 * decay(p);
  const point::PointTest test = strained({0.02, 0.02, 0.02}, 20, p, e);
  Curve curve;
  ASSERT_EQ(point::simulate(*law.info, law.theta, test, curve).status, Status::completed);
  for (const auto& row : curve.rows) {
    const double now = pressure(row.stress);
    EXPECT_NEAR(row.state[0], sand.e_i0 * decay(now), drift);
  }
  EXPECT_GT(pressure(curve.rows.back().stress), 50 * p) << "over more than a decade of pressure";
}

// In the critical state, sheared on at constant volume, nothing changes: q/p = 6 sin φ/(3 − sin φ)
// in compression, 6 sin φ/(3 + sin φ) in extension. F² D, a² T̂ tr(T̂ D) and N |D| cancel to
// round-off, of which f_b f_e/tr(T̂²) = 1e8 Pa makes 1e8 × 0.1 × 1e-15 Pa.
TEST(UmatHypoplasticLimits, CriticalStateIsAtRest) {
  const TestLaw law = make_sand();
  const double p = 2e5, sine = std::sin(sand.phi_c * std::numbers::pi / 180.0);
  for (const double sign : {1.0, -1.0}) {
    const double q = sign * 6.0 * sine / (3.0 - sign * sine) * p;
    point::PointTest test =
        strained({-0.05 * sign, 0.1 * sign, -0.05 * sign}, 10, p, sand.e_c0 * decay(p));
    test.initial.p.reset();
    test.initial.sigma = std::array{p - q / 3.0, p + 2.0 * q / 3.0, p - q / 3.0, 0.0, 0.0, 0.0};
    Curve curve;
    ASSERT_EQ(point::simulate(*law.info, law.theta, test, curve).status, Status::completed);
    const auto &first = curve.rows.front(), &last = curve.rows.back();
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(last.stress[i], first.stress[i], 1e-6) << sign;
  }
}

// And it is where drained shearing leads, from the dense side and from the loose side.
TEST(UmatHypoplasticLimits, DrainedShearingLeadsToTheCriticalState) {
  const TestLaw law = make_sand();
  const double sine = std::sin(sand.phi_c * std::numbers::pi / 180.0);
  const double M = 6.0 * sine / (3.0 - sine);
  for (const double e : {0.75, 0.95}) {
    point::PointTest test = triaxial(1e5, 1.0, 40);
    test.initial.v = 1.0 + e;
    test.settings.check_tangent = true;
    Curve curve;
    const point::Outcome outcome = point::simulate(*law.info, law.theta, test, curve);
    ASSERT_EQ(outcome.status, Status::completed);
    const auto q = column(law, test, curve, Quantity::q), p = column(law, test, curve, Quantity::p);
    const auto off = [&](std::size_t row) { return std::abs(q[row] / p[row] - M) / M; };
    // the way to it is exponential in strain: half of the strain again must bring it much closer
    EXPECT_LT(off(40), 0.01) << e;
    EXPECT_LT(off(40), 0.5 * off(20)) << e;
    EXPECT_NEAR(curve.rows.back().state[0], sand.e_c0 * decay(p[40]), 0.02);
    // DDSDDE is made of differences over a ten-thousandth of the step, and checked by those over a
    // hundredth; only near |D| = 0 of a reversal, which is not here, the two could differ
    EXPECT_EQ(outcome.counts.tangents_off, 0);
  }
}

// Grains that are pulled apart carry nothing, and no NaN comes of it.
TEST(UmatHypoplasticLimits, ParticlesPartInTension) {
  const TestLaw law = make_sand();
  const point::PointTest test = strained({-0.05, -0.05, -0.05}, 10, 1e4, 0.75);
  Curve curve;
  ASSERT_EQ(point::simulate(*law.info, law.theta, test, curve).status, Status::completed);
  EXPECT_NEAR(pressure(curve.rows.back().stress), 1e-9 * sand.h_s, 1e-9);
}

#else
TEST(UmatHypoplastic, NeedsAFortranCompiler) { GTEST_SKIP() << "no gfortran at configure time"; }
#endif

}  // namespace
}  // namespace repose::umat

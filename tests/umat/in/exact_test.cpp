/// UMATs whose answer is known in closed form, through the point driver.
#include <cmath>
#include <numbers>

#include "tests/umat/in/umat_fixture.hpp"

namespace repose::umat {
namespace {

using point::Condition;
using point::Curve;
using point::Kind;
using point::Quantity;
using point::Status;

// The control is met to PointLaw::control_goal = 1e-10 of the stress.
constexpr double control = 1e-10;

TEST(UmatElasticity, FollowsHookeInTriaxialCompression) {
  const double E = 1e7, nu = 0.25, p = 1e5;
  const TestLaw law = make_law(VON_MISES, {E, nu});
  const point::PointTest test = triaxial(p, 0.02, 20);
  Curve curve;
  ASSERT_EQ(point::simulate(*law.info, law.theta, test, curve).status, Status::completed);
  ASSERT_EQ(curve.rows.size(), 21u);
  for (const auto& row : curve.rows) {
    const double e = -row.strain[1];
    // σ is linear in the logarithmic strain: q = E ε_a, ε_r = −ν ε_a. Each of 200 steps misses the
    // radial stress by 1e-10 of 3e5 Pa at most
    EXPECT_NEAR(-row.stress[1] - p, E * e, 200 * control * 3e5);
    EXPECT_NEAR(row.strain[0], nu * e, 200 * control * 3e5 / E);
    EXPECT_NEAR(-row.stress[0], p, control * 3e5);
    // SSE is filled, so that nothing counts as lost: what is left of the sums is round-off
    EXPECT_NEAR(row.dissipated, 0.0, 1e-9 * (1.0 + row.work));
  }
}

TEST(UmatElasticity, FollowsHookeInOedometerAndSimpleShear) {
  const double E = 1e7, nu = 0.25;
  const TestLaw law = make_law(VON_MISES, {E, nu});
  point::Stage stage;
  stage.kind = Kind::oedometer;
  stage.goal = point::Goal{Quantity::eps_a, 0.01};
  stage.points = 5;
  point::PointTest test;
  test.path = point::path_of({stage});
  test.initial.p = 1e5;
  Curve curve;
  ASSERT_EQ(point::simulate(*law.info, law.theta, test, curve).status, Status::completed);
  const double M = E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
  const double eps = std::numeric_limits<double>::epsilon();
  // strain is prescribed: 50 additions of some 1e5 Pa
  EXPECT_NEAR(-curve.rows.back().stress[1] - 1e5, M * 0.01, 100 * eps * 3e5);
  EXPECT_NEAR(-curve.rows.back().stress[0] - 1e5, nu / (1.0 - nu) * M * 0.01, 100 * eps * 3e5);

  stage.kind = Kind::simple_shear;
  stage.condition = Condition::constant_volume;
  stage.goal = point::Goal{Quantity::gamma, 0.01};
  test.path = point::path_of({stage});
  ASSERT_EQ(point::simulate(*law.info, law.theta, test, curve).status, Status::completed);
  EXPECT_NEAR(curve.rows.back().stress[3], E / (2.0 * (1.0 + nu)) * 0.01, 100 * eps * 1e5)
      << "γ, not ε, goes into a UMAT";
}

TEST(UmatVonMises, HardensAlongItsTangentModulus) {
  const double E = 1e7, nu = 0.25, yield = 2e4, H = 1e6;
  const TestLaw law = make_law(VON_MISES, {E, nu, yield, H}, 1);
  const point::PointTest test = triaxial(1e5, 0.02, 20);
  Curve curve;
  ASSERT_EQ(point::simulate(*law.info, law.theta, test, curve).status, Status::completed);
  const double e = -curve.rows.back().strain[1];
  const double plastic = (e - yield / E) * E / (E + H);  // from q = σ_y + H ε_p = E (ε_a − ε_p)
  EXPECT_NEAR(column(law, test, curve, Quantity::q).back(), yield + H * plastic,
              200 * control * 2e5);
  EXPECT_NEAR(curve.rows.back().state[0], plastic, 200 * control * 2e5 / E);
  // ∫ q dε_p, exact for a trapezoid but for the one step in which it yields: a step of 1e-4 misses
  // at most half of its own σ_y-sized work
  EXPECT_NEAR(curve.rows.back().dissipated, (yield + 0.5 * H * plastic) * plastic,
              0.5 * 1e-4 * yield);
}

TEST(UmatTangent, IsCheckedAgainstDifferences) {
  const TestLaw law = make_law(VON_MISES, {1e7, 0.25, 2e4, 1e6}, 1);
  point::PointTest test = triaxial(1e5, 0.02, 20);
  test.settings.check_tangent = true;
  Curve curve;
  const point::Outcome good = point::simulate(*law.info, law.theta, test, curve);
  EXPECT_EQ(good.counts.tangents_checked, good.counts.steps);
  // only a step that straddles yield within a hundredth of itself may count as off
  EXPECT_LE(good.counts.tangents_off, 1);
  test.settings.check_tangent = false;
  EXPECT_EQ(point::simulate(*law.info, law.theta, test, curve).counts.tangents_checked, 0);

  // half as stiff as it says: all of 200 steps, and Newton still gets there
  const TestLaw wrong = make_law(WRONG_TANGENT, {1e7});
  test.settings.check_tangent = true;
  const point::Outcome bad = point::simulate(*wrong.info, wrong.theta, test, curve);
  EXPECT_EQ(bad.status, Status::completed);
  EXPECT_EQ(bad.counts.tangents_off, bad.counts.tangents_checked);
  EXPECT_EQ(bad.counts.tangents_checked, bad.counts.steps);
}

#ifdef MOHR_COULOMB

struct Strength {
  double phi, psi, c;
};
class UmatMohrCoulomb : public testing::TestWithParam<Strength> {
 protected:
  const double E = 2e7, nu = 0.25, p = 1e5;
  TestLaw law() const {
    const auto [phi, psi, c] = GetParam();
    return make_law(MOHR_COULOMB, {E, nu, phi, psi, c});
  }
  double N() const {
    const double s = std::sin(GetParam().phi * std::numbers::pi / 180.0);
    return (1.0 + s) / (1.0 - s);
  }
};

// σ_1 = N σ_3 + 2 c √N. A step's stress is returned to the surface to round-off, and the radial
// stress is met to 1e-10, which N multiplies: 1e-8 holds with room.
TEST_P(UmatMohrCoulomb, CarriesItsStrengthInCompression) {
  const TestLaw law = this->law();
  const point::PointTest test = triaxial(p, 0.1, 40);
  Curve curve;
  const point::Outcome outcome = point::simulate(*law.info, law.theta, test, curve);
  ASSERT_EQ(outcome.status, Status::completed) << point::explain(*law.info, law.theta, test, curve);
  const double expected = N() * p + 2.0 * GetParam().c * std::sqrt(N());
  EXPECT_NEAR(-curve.rows.back().stress[1], expected, 1e-8 * expected);
}

TEST_P(UmatMohrCoulomb, CarriesItsStrengthInExtension) {
  const TestLaw law = this->law();
  const point::PointTest test = triaxial(p, -0.1, 40);
  Curve curve;
  const point::Outcome outcome = point::simulate(*law.info, law.theta, test, curve);
  ASSERT_EQ(outcome.status, Status::completed) << point::explain(*law.info, law.theta, test, curve);
  const double expected = (p - 2.0 * GetParam().c * std::sqrt(N())) / N();
  EXPECT_NEAR(-curve.rows.back().stress[1], expected, 1e-8 * p);
}

TEST_P(UmatMohrCoulomb, CarriesItsStrengthInPlaneStrain) {
  const TestLaw law = this->law();
  point::LegSpec leg;
  leg.rows = {point::stress_rate(0, 0.0), point::strain_rate(1, 1e-4), point::strain_rate(2, 0.0),
              point::strain_rate(3, 0.0), point::strain_rate(4, 0.0),  point::strain_rate(5, 0.0)};
  leg.duration = 1000.0;
  leg.points = 40;
  point::PointTest test;
  test.path = point::custom_path({leg});
  test.initial.p = p;
  Curve curve;
  const point::Outcome outcome = point::simulate(*law.info, law.theta, test, curve);
  ASSERT_EQ(outcome.status, Status::completed) << point::explain(*law.info, law.theta, test, curve);
  const double expected = N() * p + 2.0 * GetParam().c * std::sqrt(N());
  EXPECT_NEAR(-curve.rows.back().stress[1], expected, 1e-8 * expected);
  EXPECT_LT(-curve.rows.back().stress[2], expected) << "the middle one";
  EXPECT_GT(-curve.rows.back().stress[2], p);
}

// Sheared at constant ψ: ε̇_v/ε̇_a = −2 sin ψ/(1 − sin ψ), compression positive. Two rows of full
// flow, 2.5e-3 of strain apart, whose strains are met to 1e-10 σ/E < 1e-11.
TEST_P(UmatMohrCoulomb, Dilates) {
  const TestLaw law = this->law();
  const point::PointTest test = triaxial(p, 0.1, 40);
  Curve curve;
  ASSERT_EQ(point::simulate(*law.info, law.theta, test, curve).status, Status::completed);
  const auto e_v = column(law, test, curve, Quantity::eps_v);
  const auto e_a = column(law, test, curve, Quantity::eps_a);
  const double s = std::sin(GetParam().psi * std::numbers::pi / 180.0);
  const std::size_t n = e_v.size();
  EXPECT_NEAR((e_v[n - 1] - e_v[n - 2]) / (e_a[n - 1] - e_a[n - 2]), -2.0 * s / (1.0 - s),
              2e-11 / 2.5e-3);
}

// Pulled apart evenly: the apex, c cot φ of tension, which the elastic part reaches within 0.02 of
// strain; a return to a point is exact to round-off.
TEST_P(UmatMohrCoulomb, EndsAtItsApexWhenPulled) {
  const TestLaw law = this->law();
  point::LegSpec leg;
  for (int i = 0; i < 6; ++i)
    leg.rows[static_cast<std::size_t>(i)] = point::strain_rate(i, i < 3 ? -1e-4 : 0.0);
  leg.duration = 200.0;
  leg.points = 4;
  point::PointTest test;
  test.path = point::custom_path({leg});
  test.initial.p = p;
  Curve curve;
  ASSERT_EQ(point::simulate(*law.info, law.theta, test, curve).status, Status::completed);
  const double apex = GetParam().c / std::tan(GetParam().phi * std::numbers::pi / 180.0);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(curve.rows.back().stress[i], apex, 1e-10 * p);
}

// The tangent of the return, in general directions: sheared and compressed at once.
TEST_P(UmatMohrCoulomb, HasItsTangent) {
  const TestLaw law = this->law();
  point::LegSpec leg;
  const std::array<double, 6> rate{-2e-5, 1e-4, 1e-5, 4e-5, 3e-5, -2e-5};
  for (int i = 0; i < 6; ++i)
    leg.rows[static_cast<std::size_t>(i)] =
        point::strain_rate(i, rate[static_cast<std::size_t>(i)]);
  leg.duration = 200.0;
  leg.points = 20;
  point::PointTest test;
  test.path = point::custom_path({leg});
  test.initial.sigma = std::array{1.2e5, 0.8e5, 1e5, 0.1e5, 0.05e5, 0.0};
  test.settings.check_tangent = true;
  Curve curve;
  const point::Outcome outcome = point::simulate(*law.info, law.theta, test, curve);
  ASSERT_EQ(outcome.status, Status::completed);
  EXPECT_EQ(outcome.counts.tangents_checked, 200);
  // steps in which the return changes its kind, elastic to plane to edge, within a hundredth
  EXPECT_LE(outcome.counts.tangents_off, 2);
}

INSTANTIATE_TEST_SUITE_P(Soils, UmatMohrCoulomb,
                         testing::Values(Strength{33.0, 0.0, 1e3}, Strength{30.0, 10.0, 5e3},
                                         Strength{40.0, 40.0, 0.5e3}));

#else
TEST(UmatMohrCoulomb, NeedsAFortranCompiler) { GTEST_SKIP() << "no gfortran at configure time"; }
#endif

}  // namespace
}  // namespace repose::umat

// The figures that a laboratory quotes, against closed forms of modified Cam-Clay.
#include "pointdriver/study/laboratory_figures.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/pointdriver/test_material.hpp"

namespace repose::point {
namespace {

using Way = CompressionBranch::Way;

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

LaboratoryFigures figures_of(const Law& law, const PointTest& test,
                             std::vector<double> secants_at = {}) {
  const Curve curve = run(law, test);
  EXPECT_EQ(curve.outcome.status, Status::completed);
  return laboratory_figures(*law.info, law.theta, test, curve, secants_at);
}

// The integrator's tolerance per step is 1e-10; over some thousand steps their sum stays below
// 1e-6.
constexpr double integrated = 1e-6;

TEST(CriticalFrictionAngle, HasTheKnownValuesAtTheThreeIntermediateStresses) {
  for (const double M : {0.6, 0.888, 1.2, 1.4}) {
    EXPECT_NEAR(critical_friction_angle(M, 0.0), degrees(std::asin(3.0 * M / (6.0 + M))), 1e-11);
    EXPECT_NEAR(critical_friction_angle(M, 1.0), degrees(std::asin(3.0 * M / (6.0 - M))), 1e-11);
    EXPECT_NEAR(critical_friction_angle(M, 0.5), degrees(std::asin(M / std::sqrt(3.0))), 1e-11);
  }
  EXPECT_TRUE(std::isnan(critical_friction_angle(2.0, 0.5)));  // no such stress without tension
}

TEST(LaboratoryFigures, UndrainedCompressionOfNormallyConsolidatedClay) {
  for (const bool v_ln_p : {false, true}) {
    const exact::CamClay c = london(v_ln_p);
    const Law law = cam_clay(c);
    const double p0 = 200e3, strain = 0.4;
    const PointTest test =
        make_test({triaxial(Condition::undrained, strain)}, p0, 1.0, Method::adaptive);
    const double v0 = start_value(*law.info, law.theta, test, Quantity::v);
    const exact::Point end = exact::undrained(c, p0, 1.0, v0, strain);
    const LaboratoryFigures f = figures_of(law, test);
    ASSERT_TRUE(f.undrained);
    EXPECT_NEAR(f.undrained->S_u, 0.5 * end.q, integrated * end.q);
    EXPECT_NEAR(f.undrained->strain, strain, 1e-9);
    EXPECT_EQ(f.undrained->after, After::plateau);
    // u = p_0 + q/3 − p′
    EXPECT_NEAR(f.undrained->A_f, (p0 + end.q / 3.0 - end.p) / end.q, integrated);
    ASSERT_TRUE(f.friction);
    const double eta = end.q / end.p;
    EXPECT_NEAR(f.friction->end, degrees(std::asin(3.0 * eta / (6.0 + eta))), 1e-4);
    EXPECT_NEAR(f.friction->critical, degrees(std::asin(3.0 * c.M / (6.0 + c.M))), 1e-9);
    EXPECT_EQ(f.friction->b, 0.0);
    EXPECT_TRUE(std::isnan(f.friction->on_plane));
    EXPECT_TRUE(f.compression.empty());
  }
}

TEST(LaboratoryFigures, ATestThatEndsOnTheWayHasNoStrengthYet) {
  const Law law = cam_clay(london(false));
  const LaboratoryFigures f = figures_of(
      law, make_test({triaxial(Condition::undrained, 0.01)}, 200e3, 1.0, Method::adaptive));
  EXPECT_EQ(f.undrained->after, After::rising);
}

TEST(LaboratoryFigures, UndrainedExtensionHasItsOwnAngleAndPorePressureParameter) {
  const exact::CamClay c = london(false);
  const Law law = cam_clay(c);
  const double p0 = 200e3;
  const PointTest test =
      make_test({triaxial(Condition::undrained, -0.4)}, p0, 1.0, Method::adaptive);
  const exact::Point end = exact::undrained(c, p0, 1.0, 1.0, 0.4);  // the law knows no sign of q
  const LaboratoryFigures f = figures_of(law, test);
  EXPECT_NEAR(f.undrained->S_u, 0.5 * end.q, integrated * end.q);
  EXPECT_NEAR(f.undrained->strain, -0.4, 1e-9);
  // Δσ_1 = 0, Δσ_3 = −q; u = p_0 − q/3 − p′
  const double u = p0 - end.q / 3.0 - end.p;
  EXPECT_NEAR(f.undrained->A_f, (u + end.q) / end.q, integrated);
  EXPECT_EQ(f.friction->b, 1.0);
  EXPECT_NEAR(f.friction->critical, degrees(std::asin(3.0 * c.M / (6.0 - c.M))), 1e-9);
  EXPECT_NEAR(f.friction->end, f.friction->critical, 0.1);
}

TEST(LaboratoryFigures, ElasticModuliWhateverTheRows) {
  // Undrained and elastic p′ stays, and with it G = αvp′/κ (v = 1 on ln v – ln p lines), so that
  // every secant is G, and E50 is 3G. With OCR 20 half of the peak is elastic.
  for (const bool v_ln_p : {false, true})
    for (const int points : {2, 200}) {
      const exact::CamClay c = london(v_ln_p);
      const Law law = cam_clay(c);
      const double p0 = 50e3;
      const PointTest test =
          make_test({triaxial(Condition::undrained, 0.2, points)}, p0, 20.0, Method::adaptive);
      const double v = v_ln_p ? start_value(*law.info, law.theta, test, Quantity::v) : 1.0;
      const double G = c.alpha() * v * p0 / c.kappa;
      const LaboratoryFigures f = figures_of(law, test, {1e-6, 1e-4, 1e-3});
      ASSERT_TRUE(f.stiffness);
      EXPECT_NEAR(f.stiffness->E50, 3.0 * G, integrated * G);
      ASSERT_EQ(f.secants.size(), 3u);
      for (const SecantShear& s : f.secants) EXPECT_NEAR(s.G, G, integrated * G) << s.gamma;
    }
}

// At constant p′ the elastic G is constant, whichever quantity ends the stage: compression lowers
// σ_r and raises q.
TEST(LaboratoryFigures, SecantModulusAtConstantMeanStress) {
  const exact::CamClay c = london(true);
  const Law law = cam_clay(c);
  for (const Goal& to : {Goal{Quantity::sigma_r, 85e3}, Goal{Quantity::sigma_r, 115e3},
                         Goal{Quantity::q, 45e3}, Goal{Quantity::q, -45e3}}) {
    Stage stage = triaxial(Condition::constant_p, 0.0);
    stage.goal = to;
    const PointTest test = make_test({stage}, 100e3, 4.0, Method::adaptive);
    const double v = start_value(*law.info, law.theta, test, Quantity::v);
    const double G = c.alpha() * v * 100e3 / c.kappa;
    const LaboratoryFigures f = figures_of(law, test, {1e-4, 1e-2});
    ASSERT_EQ(f.secants.size(), 2u);
    for (const SecantShear& s : f.secants) EXPECT_NEAR(s.G, G, integrated * G) << to.value;
  }
}

TEST(LaboratoryFigures, SecantModulusOfYieldingClayInBothDirections) {
  const exact::CamClay c = london(false);
  const Law law = cam_clay(c);
  const double p0 = 200e3, gamma = 3e-3;
  const double q = exact::undrained(c, p0, 1.0, 1.0, gamma / 1.5).q;  // ε_q = 2/3 γ
  for (const double sign : {1.0, -1.0}) {
    const LaboratoryFigures f = figures_of(
        law, make_test({triaxial(Condition::undrained, 0.1 * sign)}, p0, 1.0, Method::adaptive),
        {gamma, 5.0});
    ASSERT_EQ(f.secants.size(), 2u);
    EXPECT_NEAR(f.secants[0].G, 0.5 * q / gamma, integrated * q / gamma);
    EXPECT_EQ(f.secants[0].gamma, gamma);
  }
}

TEST(LaboratoryFigures, SimpleShearOnItsPlane) {
  const exact::CamClay c = london(false);
  const Law law = cam_clay(c);
  Stage shear;
  shear.kind = Kind::simple_shear;
  shear.condition = Condition::constant_volume;
  shear.goal = Goal{Quantity::gamma, -0.6};
  const double p0 = 100e3;
  const LaboratoryFigures f =
      figures_of(law, make_test({shear}, p0, 1.5, Method::adaptive), {1e-4});
  const double G = c.alpha() * p0 / c.kappa;
  ASSERT_EQ(f.secants.size(), 1u);
  EXPECT_NEAR(f.secants[0].G, G, integrated * G);
  // critical state: p_f = p_0 (R/2)^Λ, q = √3 τ = M p_f; p_xx = p_yy = p_f
  const double p_f = p0 * std::pow(0.75, c.Lambda()), tau = c.M * p_f / std::sqrt(3.0);
  EXPECT_NEAR(f.undrained->S_u, tau, 0.01 * tau);  // approached exponentially
  EXPECT_NEAR(f.friction->b, 0.5, 0.0);
  EXPECT_NEAR(f.friction->critical, degrees(std::asin(c.M / std::sqrt(3.0))), 1e-9);
  EXPECT_GT(f.friction->on_plane, degrees(std::atan(c.M / std::sqrt(3.0))) - 0.2);
  EXPECT_TRUE(std::isnan(f.undrained->A_f));
}

TEST(LaboratoryFigures, TheDrySideHasAPeak) {
  const exact::CamClay c = london(false);
  const Law law = cam_clay(c);
  const LaboratoryFigures f = figures_of(
      law, make_test({triaxial(Condition::drained, 0.4, 400)}, 50e3, 10.0, Method::adaptive));
  ASSERT_TRUE(f.friction);
  EXPECT_FALSE(f.undrained);
  EXPECT_EQ(f.friction->after, After::peak);
  // the peak is where the path meets the first yield surface: 9(p − p_0)² = M²p(p_c − p)
  const exact::Point yield = [&] {
    const double p0 = 50e3, M2 = c.M * c.M, A = 9.0 + M2, B = -(18.0 + M2 * 10.0) * p0,
                 C = 9.0 * p0 * p0;
    const double p = (-B + std::sqrt(B * B - 4.0 * A * C)) / (2.0 * A);
    return exact::Point{p, 3.0 * (p - p0), 0.0, 0.0};
  }();
  const double eta = yield.q / yield.p, peak = degrees(std::asin(3.0 * eta / (6.0 + eta)));
  EXPECT_LT(f.friction->peak, peak + 1e-6);
  EXPECT_GT(f.friction->peak, peak - 1.0);  // a row every 0.1 %
  EXPECT_GT(f.friction->peak, f.friction->critical + 5.0);
  EXPECT_LT(f.friction->end, f.friction->peak - 5.0);  // it softens, and from above
  EXPECT_GT(f.friction->end, f.friction->critical);
}

TEST(LaboratoryFigures, OedometerFromItsOwnNormalStress) {
  for (const bool v_ln_p : {false, true}) {
    const exact::CamClay c = london(v_ln_p);
    const Law law = cam_clay(c);
    const double eta = exact::one_dimensional_ratio(c), K0 = exact::K0(eta), sigma = 100e3;
    Stage load;
    load.kind = Kind::oedometer;
    load.drive = Drive::stress;
    load.points = 40;
    std::vector<Stage> stages;
    for (const double to : {800e3, 100e3, 1600e3}) {
      load.goal = Goal{Quantity::sigma_a, to};
      stages.push_back(load);
    }
    PointTest test = make_test(stages, 0.0, 0.0, Method::adaptive);
    test.initial.p.reset();
    test.initial.sigma_v = sigma;
    test.initial.K0 = K0;
    test.initial.ocr_v = 1.0;
    const LaboratoryFigures f = figures_of(law, test);
    EXPECT_TRUE(f.oedometer);
    EXPECT_FALSE(f.friction);
    ASSERT_EQ(f.compression.size(), 4u);
    const CompressionBranch &virgin = f.compression[0], &unloading = f.compression[1],
                            &reloading = f.compression[2], &again = f.compression[3];
    EXPECT_EQ(virgin.way, Way::virgin);
    EXPECT_EQ(unloading.way, Way::unloading);
    EXPECT_EQ(reloading.way, Way::reloading);
    EXPECT_EQ(again.way, Way::virgin);
    EXPECT_NEAR(virgin.K0, K0, integrated);
    EXPECT_NEAR(virgin.p_over_x, 1.0, integrated);
    // Between rows e is taken on the chord in ln σ′_a, which for lines in ln v is off by
    // λ²v(Δ ln σ)²/8; 40 rows from 100 to 800 kPa leave Δ ln σ = 0.039 at 400 kPa.
    const double chord = v_ln_p ? integrated : c.lambda * 0.039 * 0.039;
    const double v_end = start_value(*law.info, law.theta, test, Quantity::v) *
                         (v_ln_p ? 1.0 : std::pow(8.0, -c.lambda));
    const double C_c = v_ln_p ? c.lambda * std::numbers::ln10
                              : v_end * (std::pow(2.0, c.lambda) - 1.0) / std::log10(2.0);
    EXPECT_NEAR(virgin.C, C_c, chord * C_c);
    EXPECT_EQ(unloading.OCR, unloading.from / unloading.to);
    EXPECT_NEAR(unloading.OCR, 8.0, 1e-6);
    EXPECT_GT(unloading.K0, 1.5 * K0);
    EXPECT_LT(unloading.C_over_kappa, 0.9);  // K0 rises: C_s is not κ ln 10
    // elastic: dv = −κ d ln p′ (or d ln v, whose mean v serves to second order in κ ln 8)
    const double mean_v = v_ln_p ? integrated : std::pow(c.kappa * std::log(8.0), 2) / 12.0;
    EXPECT_NEAR(unloading.C_over_kappa, unloading.p_over_x, mean_v + integrated);
    EXPECT_NEAR(reloading.from, 100e3, 1.0);
    EXPECT_EQ(again.stage, 3);
  }
}

TEST(LaboratoryFigures, IsotropicLinesHaveTheLawsOwnSlopes) {
  const exact::CamClay c = london(true);
  const Law law = cam_clay(c);
  Stage load;
  load.kind = Kind::isotropic;
  load.drive = Drive::stress;
  load.points = 50;
  std::vector<Stage> stages;
  for (const double to : {400e3, 50e3}) {
    load.goal = Goal{Quantity::p, to};
    stages.push_back(load);
  }
  const LaboratoryFigures f = figures_of(law, make_test(stages, 100e3, 2.0, Method::adaptive));
  ASSERT_EQ(f.compression.size(), 3u);
  EXPECT_EQ(f.compression[0].way, Way::reloading);
  EXPECT_EQ(f.compression[1].way, Way::virgin);
  EXPECT_NEAR(f.compression[1].C, c.lambda * std::numbers::ln10, integrated);
  EXPECT_NEAR(f.compression[2].C, c.kappa * std::numbers::ln10, integrated);
  EXPECT_NEAR(f.compression[2].C_over_kappa, 1.0, integrated);
  EXPECT_FALSE(f.oedometer);
}

TEST(LaboratoryFigures, GrainsAtRestHaveTheirOwnCriticalFriction) {
  const Law law = mu_i("elastoviscoplastic");
  Stage shear;
  shear.kind = Kind::simple_shear;
  shear.condition = Condition::constant_p;
  shear.goal = Goal{Quantity::gamma, 1.0};
  shear.rate = 1e-3;
  PointTest test = make_test({shear}, 1e3, 0.0, Method::automatic, 1e-8);
  const LaboratoryFigures f = figures_of(law, test);
  ASSERT_TRUE(f.friction);
  EXPECT_NEAR(f.friction->critical, degrees(std::asin(0.3819)), 1e-9);
  EXPECT_FALSE(f.undrained);  // p is kept, not the volume
}

TEST(LaboratoryFigures, CountWhatTheMaterialHasCarriedBefore) {
  const Law law = cam_clay(london(true));
  Stage load;
  load.kind = Kind::isotropic;
  load.drive = Drive::stress;
  std::vector<Stage> stages;
  for (const double to : {200e3, 50e3}) {
    load.goal = Goal{Quantity::p, to};
    stages.push_back(load);
  }
  const LaboratoryFigures f = figures_of(law, make_test(stages, 100e3, 4.0, Method::adaptive));
  ASSERT_EQ(f.compression.size(), 2u);
  EXPECT_NEAR(f.compression[0].OCR, 2.0, 1e-9);  // 400 kPa before
  EXPECT_NEAR(f.compression[1].OCR, 8.0, 1e-6);
}

// From a start in extension: what is mobilised there is not the strength in compression.
TEST(LaboratoryFigures, AreOfTheSenseInWhichAStageShears) {
  const Law law = cam_clay(london(false));
  PointTest test = make_test({triaxial(Condition::undrained, 0.2)}, 0.0, 0.0, Method::adaptive);
  test.initial.p.reset();
  test.initial.sigma_v = 40e3;
  test.initial.K0 = 2.4;
  test.initial.ocr_v = 6.0;
  test.initial.K0_nc = 0.7;
  const LaboratoryFigures f = figures_of(law, test);
  EXPECT_EQ(f.friction->b, 0.0);
  EXPECT_GT(f.friction->strain, 0.0);
  EXPECT_GT(f.undrained->strain, 0.0);
  // drained to failure, then undrained extension: its own strength, in its own stage
  const LaboratoryFigures two = figures_of(
      law, make_test({triaxial(Condition::drained, 0.3), triaxial(Condition::undrained, -0.5)},
                     100e3, 1.0, Method::adaptive));
  EXPECT_EQ(two.undrained->stage, 2);
  EXPECT_LT(two.undrained->strain, -0.01);
  EXPECT_NE(two.undrained->after, After::peak);
}

TEST(LaboratoryFigures, OfALaterStageInEngineeringStrainAreThoseOfItAlone) {
  const Law law = cam_clay(london(true));
  Stage load;
  load.kind = Kind::isotropic;
  load.drive = Drive::stress;
  load.goal = Goal{Quantity::p, 300e3};
  Stage shear = triaxial(Condition::undrained, -std::log1p(-0.2));
  shear.goal->of_stage = true;
  PointTest staged = make_test({load, shear}, 100e3, 1.0, Method::adaptive),
            alone = make_test({shear}, 300e3, 1.0, Method::adaptive);
  staged.path.measure = alone.path.measure = StrainMeasure::engineering;
  const LaboratoryFigures a = figures_of(law, staged), b = figures_of(law, alone);
  EXPECT_NEAR(a.undrained->strain, 0.2, 1e-9);
  EXPECT_NEAR(a.undrained->S_u, b.undrained->S_u, integrated * b.undrained->S_u);
  EXPECT_NEAR(a.stiffness->E50, b.stiffness->E50, 1e-5 * b.stiffness->E50);
  EXPECT_EQ(a.stiffness->stage, 2);
}

TEST(LaboratoryFigures, NoPeakIsMadeOfUnloadingAndNoSecantOfWhatIsNotReached) {
  const Law law = cam_clay(london(false));
  Stage back = triaxial(Condition::undrained, 0.0);
  back.goal = Goal{Quantity::q, 0.0};
  const LaboratoryFigures f = figures_of(
      law, make_test({triaxial(Condition::undrained, 2e-3), back}, 100e3, 4.0, Method::adaptive),
      {1e-3, 0.5});
  EXPECT_EQ(f.undrained->after, After::rising);
  EXPECT_EQ(f.friction->after, After::rising);
  ASSERT_EQ(f.secants.size(), 4u);
  EXPECT_GT(f.secants[0].G, 0.0);
  EXPECT_TRUE(std::isnan(f.secants[1].G));
}

TEST(LaboratoryFigures, TensionIsSaid) {
  const Law law = cam_clay(london(false));
  const LaboratoryFigures f = figures_of(
      law, make_test({triaxial(Condition::undrained, -0.2)}, 100e3, 4.0, Method::adaptive));
  EXPECT_TRUE(f.friction->tension);
}

// σ_r rises in extension where σ_a or p is kept.
TEST(TriaxialStages, ARadialStressIsReachedFromItsOwnSide) {
  const Law law = cam_clay(london(true));
  for (const Condition condition : {Condition::constant_sigma_a, Condition::constant_p})
    for (const double to : {85e3, 115e3}) {
      Stage stage = triaxial(condition, 0.0);
      stage.goal = Goal{Quantity::sigma_r, to};
      const PointTest test = make_test({stage}, 100e3, 2.0, Method::adaptive);
      const Curve curve = run(law, test);
      ASSERT_EQ(curve.outcome.status, Status::completed) << to;
      EXPECT_NEAR(column(law, test, curve, Quantity::sigma_r).back(), to, 1e-6 * to);
      EXPECT_EQ(column(law, test, curve, Quantity::eps_a).back() > 0.0, to < 100e3);
    }
}

TEST(PathPlaces, CountStagesAndCycles) {
  std::vector<Stage> stages{triaxial(Condition::drained, 0.01)};
  for (const Stage& half : cycles(triaxial(Condition::undrained, 0.0), Quantity::q, -1e3, 1e3, 2))
    stages.push_back(half);
  stages.push_back(triaxial(Condition::drained, 0.1));
  const std::vector<Path::Place> places = path_of(stages).places();
  std::vector<std::pair<int, int>> at;
  for (const auto& [stage, cycle] : places) at.emplace_back(stage, cycle);
  const std::vector<std::pair<int, int>> wanted{{1, 0}, {2, 1}, {2, 1}, {2, 2}, {2, 2}, {3, 0}};
  EXPECT_EQ(at, wanted);
}

}  // namespace
}  // namespace repose::point

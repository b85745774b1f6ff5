// Strains of stages count from their own start; engineering strains; stresses beyond the strength.
#include <gtest/gtest.h>

#include "pointdriver/integrate/strength.hpp"
#include "tests/pointdriver/test_material.hpp"

namespace repose::point {
namespace {

constexpr std::array<Method, 4> integrators{Method::adaptive, Method::implicit, Method::cvode,
                                            Method::ida};

/// Weald-like clay of the undrained test after an oedometer.
Law soft_clay() {
  return make_law(
      {"modified_cam_clay",
       {{"compression", "v-ln_p"}},
       {{"M", 1.02}, {"lambda", 0.26}, {"kappa", 0.05}, {"nu", 0.3}, {"Gamma", 3.767}}});
}

Stage oedometer_to(double sigma_a) {
  Stage stage;
  stage.kind = Kind::oedometer;
  stage.drive = Drive::stress;
  stage.goal = Goal{Quantity::sigma_a, sigma_a};
  stage.points = 10;
  return stage;
}

Stage of_stage(Stage stage) {
  stage.goal->of_stage = true;
  return stage;
}

TEST(StageStrain, counts_from_the_start_of_the_stage) {
  const Law law = soft_clay();
  for (const Method method : integrators) {
    const PointTest test =
        make_test({oedometer_to(200e3), of_stage(triaxial(Condition::undrained, 0.2, 10))}, 10e3,
                  1.0, method, 1e-9);
    const Curve curve = run(law, test);
    ASSERT_EQ(curve.outcome.status, Status::completed)
        << explain(*law.info, law.theta, test, curve);
    ASSERT_EQ(curve.rows.size(), 21u);
    const auto eps_a = column(law, test, curve, Quantity::eps_a);
    const auto q = column(law, test, curve, Quantity::q);
    EXPECT_GT(eps_a[10], 0.2) << "the consolidation uses more than the shear";
    EXPECT_NEAR(eps_a[20] - eps_a[10], 0.2, 1e-12);
    EXPECT_GT(q[20], 0.0) << "compression, not extension";
    // the same shear on a sample that starts where the consolidation ended
    PointTest shear = make_test({triaxial(Condition::undrained, 0.2, 10)}, 1.0, 0.0, method, 1e-9);
    shear.initial = {};
    shear.initial.sigma.emplace();
    const Row<double>& end = curve.rows[10];
    for (std::size_t i = 0; i < 6; ++i) (*shear.initial.sigma)[i] = -end.stress.c[i];
    shear.initial.ocr = (1.0 + 1e-11) * end.state[0] / pressure(end.stress);
    shear.initial.density = end.density;
    const Curve alone = run(law, shear);
    ASSERT_EQ(alone.outcome.status, Status::completed)
        << explain(*law.info, law.theta, shear, alone);
    // 1e-9 per step over a hundred steps; the implicit method repeats its own steps
    EXPECT_NEAR(q[20], column(law, shear, alone, Quantity::q)[10], 1e-7 * q[20]) << name_of(method);
  }
}

TEST(StageStrain, counted_from_the_start_of_the_test_it_leads_back) {
  const Law law = soft_clay();
  const PointTest test = make_test({oedometer_to(200e3), triaxial(Condition::undrained, 0.2, 10)},
                                   10e3, 1.0, Method::adaptive);
  const Curve curve = run(law, test);
  EXPECT_NEAR(column(law, test, curve, Quantity::eps_a).back(), 0.2, 1e-12);
  EXPECT_LT(column(law, test, curve, Quantity::q).back(), 0.0);
}

TEST(StageStrain, every_strain_that_ends_a_stage) {
  const Law law = soft_clay();
  Stage shear;
  shear.kind = Kind::simple_shear;
  shear.condition = Condition::constant_volume;
  shear.points = 4;
  shear.goal = Goal{Quantity::gamma, 0.1, true};
  Stage swell;
  swell.kind = Kind::isotropic;
  swell.points = 4;
  swell.goal = Goal{Quantity::eps_v, -0.01, true};
  Stage on_the_way = triaxial(Condition::drained, 0.0, 4);
  on_the_way.goal = Goal{Quantity::eps_v, 0.02, true};  // located
  const std::vector<std::pair<Stage, Quantity>> cases{
      {shear, Quantity::gamma}, {swell, Quantity::eps_v}, {on_the_way, Quantity::eps_v}};
  for (const Method method : integrators)
    for (const auto& [stage, quantity] : cases) {
      const bool sheared = quantity == Quantity::gamma;
      Stage first = sheared ? stage : oedometer_to(50e3);
      first.points = 4;
      const PointTest test = make_test({first, stage}, 10e3, 1.0, method, 1e-9);
      const Curve curve = run(law, test);
      ASSERT_EQ(curve.outcome.status, Status::completed)
          << name_of(method) << explain(*law.info, law.theta, test, curve);
      const auto values = column(law, test, curve, quantity);
      EXPECT_NEAR(values[8] - values[4], stage.goal->value, 1e-9)
          << name_of(method) << " " << column_name(quantity);
    }
}

TEST(StageStrain, limits_of_cycles_count_from_the_first_of_them) {
  const Law law = soft_clay();
  Stage half = triaxial(Condition::undrained, 0.0, 4);
  std::vector<Stage> stages{oedometer_to(50e3)};
  for (const Stage& stage : cycles(half, Quantity::eps_a, -0.002, 0.004, 2, true))
    stages.push_back(stage);
  const PointTest test = make_test(stages, 10e3, 1.0, Method::adaptive);
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::completed);
  const auto eps_a = column(law, test, curve, Quantity::eps_a);
  const double zero = eps_a[10];
  for (std::size_t k = 1; k <= 4; ++k)
    EXPECT_NEAR(eps_a[10 + 4 * k] - zero, k % 2 == 1 ? 0.004 : -0.002, 1e-12) << k;
}

TEST(StageStrain, stop_conditions_count_from_the_start_of_the_stage_too) {
  const Law law = soft_clay();
  for (const Method method : integrators) {
    Stage shear = of_stage(triaxial(Condition::undrained, 0.2, 10));
    shear.stops = {{Quantity::eps_q, 0.05, true}};
    const PointTest test = make_test({oedometer_to(200e3), shear}, 10e3, 1.0, method, 1e-9);
    const Curve curve = run(law, test);
    ASSERT_EQ(curve.outcome.status, Status::stopped) << name_of(method);
    const auto eps_q = column(law, test, curve, Quantity::eps_q);
    EXPECT_NEAR(eps_q.back() - eps_q[10], 0.05, 1e-9) << name_of(method);
    EXPECT_NE(explain(*law.info, law.theta, test, curve)
                  .find("stopped where eps_q reached 0.05, counted from the start of the stage"),
              std::string::npos);
  }
}

// ε = 1 − exp(−ε_log), change of length over the length at the start.
TEST(EngineeringStrain, is_read_off_the_curve) {
  const Law law = soft_clay();
  PointTest test = make_test({triaxial(Condition::drained, 0.15, 5)}, 100e3, 1.0, Method::adaptive);
  const Curve curve = run(law, test);
  const auto log_a = column(law, test, curve, Quantity::eps_a);
  const auto log_v = column(law, test, curve, Quantity::eps_v);
  test.path.measure = StrainMeasure::engineering;
  const auto eng_a = column(law, test, curve, Quantity::eps_a);
  const auto eng_v = column(law, test, curve, Quantity::eps_v);
  const auto eng_q = column(law, test, curve, Quantity::eps_q);
  const auto v = column(law, test, curve, Quantity::v);
  for (std::size_t i = 0; i < curve.rows.size(); ++i) {
    EXPECT_NEAR(eng_a[i], 1.0 - std::exp(-log_a[i]), 1e-15);
    EXPECT_NEAR(eng_v[i], 1.0 - v[i] / v[0], 1e-14) << "change of volume over the first volume";
    EXPECT_NEAR(eng_q[i], eng_a[i] - eng_v[i] / 3.0, 1e-15);
    EXPECT_NEAR(logarithmic_strain(Quantity::eps_v, eng_v[i]), log_v[i], 1e-15);
  }
  EXPECT_EQ(logarithmic_strain(Quantity::gamma, 0.3), 0.3);
  EXPECT_TRUE(std::isnan(logarithmic_strain(Quantity::eps_a, 1.0)));
}

/// The message of a stress-driven test that fails.
std::string message_of(const Law& law, const PointTest& test) {
  const Curve curve = run(law, test);
  EXPECT_TRUE(is_failure(curve.outcome.status)) << name_of(test.settings.method);
  return explain(*law.info, law.theta, test, curve);
}

/// Drained, normally consolidated: q = 3 M p_0/(3 − M) in compression, 3 M p_0/(3 + M) in
/// extension (the circle in the deviatoric plane); at constant p: q = M p_0.
TEST(Strength, is_told_with_the_figure_for_every_integrator) {
  const Law law = cam_clay({1.2, 7.7e-2, 6.6e-3, 0.3, true});
  for (const Method method : integrators) {
    Stage stage = triaxial(Condition::drained, 0.0, 20);
    stage.drive = Drive::stress;
    stage.goal = Goal{Quantity::sigma_a, 650e3};
    PointTest test = make_test({stage}, 200e3, 1.0, method, 1e-8);
    test.settings.max_steps = 20000;
    // q = 3·1.2·200/1.8 = 400 kPa at σ_a = 600 kPa
    const std::string text = message_of(law, test);
    EXPECT_NE(text.find("the stress asked for lies beyond the strength q = 4e+05 Pa (sigma_a_Pa = "
                        "6e+05, asked for: sigma_a_Pa = 6.5e+05)"),
              std::string::npos)
        << name_of(method) << ": " << text;
    EXPECT_EQ(text.find("cvode and implicit"), std::string::npos) << text;
  }
}

TEST(Strength, is_told_for_every_kind_of_stress_control) {
  const Law law = cam_clay({1.2, 0.2, 0.04, 0.3, true});
  const auto strength = [&](const Stage& stage) {
    PointTest test = make_test({stage}, 200e3, 1.0, Method::adaptive, 1e-8);
    test.settings.max_steps = 20000;
    const Curve curve = run(law, test);
    EXPECT_TRUE(is_failure(curve.outcome.status));
    const auto found = strength_exceeded(*law.info, law.theta, test, curve);
    EXPECT_TRUE(found.has_value());
    return found.value_or(Strength{});
  };
  Stage extension = triaxial(Condition::drained, 0.0, 20);
  extension.drive = Drive::stress;
  extension.goal = Goal{Quantity::q, -195e3};  // −3·1.2·200/4.2 = −171.4 kPa
  EXPECT_NEAR(strength(extension).carried, -3.0 * 1.2 * 200e3 / 4.2, 1e-4 * 200e3);
  Stage constant_p = triaxial(Condition::constant_p, 0.0, 20);
  constant_p.drive = Drive::stress;
  constant_p.goal = Goal{Quantity::q, 300e3};
  EXPECT_NEAR(strength(constant_p).q, 1.2 * 200e3, 1e-4 * 200e3);
  // at constant p, simple shear: √3 τ grows to M p; the coaxial stresses fade as the strain grows
  Stage shear;
  shear.kind = Kind::simple_shear;
  shear.condition = Condition::constant_p;
  shear.drive = Drive::stress;
  shear.points = 20;
  shear.goal = Goal{Quantity::tau, 200e3};
  EXPECT_LT(strength(shear).carried, 1.2 * 200e3 / std::sqrt(3.0) * (1.0 + 1e-6));
  EXPECT_GT(strength(shear).carried, 0.98 * 1.2 * 200e3 / std::sqrt(3.0));
}

// σ̇_r = σ̇_a/10: all stresses change, in proportion.
TEST(Strength, is_told_for_custom_stress_rates) {
  const Law law = cam_clay({1.2, 7.7e-2, 6.6e-3, 0.3, true});
  LegSpec leg;
  leg.name = "custom";
  leg.rows = {stress_rate(0, 100.0), stress_rate(1, 1000.0), stress_rate(2, 100.0),
              strain_rate(3, 0.0),   strain_rate(4, 0.0),    strain_rate(5, 0.0)};
  leg.duration = 1000.0;  // to σ_a = 1200 kPa, σ_r = 300 kPa
  leg.points = 20;
  PointTest test = make_test({triaxial(Condition::drained, 0.1)}, 200e3, 1.0, Method::adaptive);
  test.path = custom_path({leg});
  const Curve curve = run(law, test);
  ASSERT_TRUE(is_failure(curve.outcome.status));
  const auto found = strength_exceeded(*law.info, law.theta, test, curve);
  ASSERT_TRUE(found.has_value());
  // q = 0.9 Δσ_a = M (p_0 + 0.4 Δσ_a): Δσ_a = 1.2·200/(0.9 − 0.48) kPa
  const double rise = 1.2 * 200e3 / (0.9 - 0.48);
  EXPECT_EQ(found->quantity, Quantity::sigma_a);
  EXPECT_NEAR(found->asked, 1200e3, 1e-6);
  EXPECT_NEAR(found->carried, 200e3 + rise, 1e-3 * rise);
}

TEST(Strength, of_grains_is_friction_times_pressure) {
  const Law law = mu_i("elastoviscoplastic");
  Stage shear;
  shear.kind = Kind::simple_shear;
  shear.condition = Condition::constant_p;
  shear.drive = Drive::stress;
  shear.goal = Goal{Quantity::tau, 900.0};  // μ_d p = 572 Pa at most
  shear.stress_rate = 1.0;
  shear.points = 10;
  const PointTest test = make_test({shear}, 1000.0, 0.0, Method::automatic, 1e-8);
  const std::string text = message_of(law, test);
  EXPECT_NE(text.find("the stress asked for lies beyond the strength q = "), std::string::npos)
      << text;
  EXPECT_NE(text.find("found at a strain rate of 0.0001 1/s"), std::string::npos) << text;
}

TEST(Strength, is_not_blamed_for_other_failures) {
  const Law law = cam_clay({1.2, 7.7e-2, 6.6e-3, 0.3, true});
  PointTest test = make_test({triaxial(Condition::drained, 0.1)}, 200e3, 1.0, Method::adaptive);
  test.settings.max_steps = 3;
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::step_limit);
  EXPECT_FALSE(strength_exceeded(*law.info, law.theta, test, curve).has_value());
  Stage stage = triaxial(Condition::drained, 0.0, 20);
  stage.drive = Drive::stress;
  stage.goal = Goal{Quantity::q, 300e3};  // within 400 kPa
  PointTest within = make_test({stage}, 200e3, 1.0, Method::adaptive, 1e-8);
  within.settings.max_steps = 3;
  const Curve broken = run(law, within);
  ASSERT_EQ(broken.outcome.status, Status::step_limit);
  EXPECT_FALSE(strength_exceeded(*law.info, law.theta, within, broken).has_value());
}

}  // namespace
}  // namespace repose::point

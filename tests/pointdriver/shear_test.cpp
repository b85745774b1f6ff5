// Flow curves: μ(I) and Newtonian shear at constant pressure and constant volume over decades.
#include <gtest/gtest.h>

#include "tests/pointdriver/test_material.hpp"

namespace repose::point {
namespace {

PointTest sweep(Condition condition, double from, double to, int count, double strain,
                Method method) {
  Stage shear;
  shear.kind = Kind::simple_shear;
  shear.condition = condition;
  return make_test(rate_sweep(shear, from, to, count, strain), 1000.0, 0.0, method, 1e-8);
}

double mu_of(double I) { return 0.3819 + (0.5718 - 0.3819) / (0.279 / I + 1.0); }

/// Both forms, both conditions, nine decades of rate: τ/p = μ(I) at every rate. The elastoviscous
/// stress reaches its steady value up to e^{-Δγ G/(...)}, far below 1e-8 for 0.5 strain per rate.
TEST(Shear, both_forms_draw_mu_of_I) {
  for (const char* form : {"regularised", "elastoviscoplastic"}) {
    const Law law = mu_i(form);
    for (const Condition condition :
         {Condition::constant_p, Condition::constant_volume, Condition::constant_normal_stress})
      for (const Method method : {Method::automatic, Method::arkode, Method::implicit}) {
        if (method == Method::arkode && !law.info->has_stress_memory) continue;
        // the regularised law creeps below r = 1e-4 1/s: stay four decades above
        PointTest test = sweep(condition, 1.0, 1e5, 26, 0.5, method);
        const Curve curve = run(law, test);
        ASSERT_EQ(curve.outcome.status, Status::completed)
            << form << " " << name_of(condition) << " "
            << explain(*law.info, law.theta, test, curve);
        ASSERT_EQ(curve.rows.size(), 27u);
        const auto I = column(law, test, curve, Quantity::I);
        const auto mu = column(law, test, curve, Quantity::mu);
        const auto p = column(law, test, curve, Quantity::p);
        for (std::size_t i = 1; i < I.size(); ++i) {
          EXPECT_NEAR(mu[i], mu_of(I[i]), 1e-7)
              << form << " " << name_of(condition) << " I = " << I[i] << " " << name_of(method);
          if (condition == Condition::constant_p) {
            EXPECT_NEAR(p[i], 1000.0, 1e-4);
          }
          EXPECT_LE(curve.rows[i].residual, 1e-10);
        }
        EXPECT_LT(I[1], 0.02);
        EXPECT_GT(I.back(), 100.0);
      }
  }
}

TEST(Shear, slow_flow_of_the_exact_form_rests_on_mu_0) {
  // at 1e-8 1/s I = 7e-11: stiff by 1e12, no step limit may show
  const Law law = mu_i("elastoviscoplastic");
  for (const Method method : {Method::cvode, Method::ida, Method::implicit}) {
    const PointTest test = sweep(Condition::constant_p, 1e-8, 1e-7, 2, 0.1, method);
    const Curve curve = run(law, test);
    ASSERT_EQ(curve.outcome.status, Status::completed)
        << name_of(method) << ": " << explain(*law.info, law.theta, test, curve);
    EXPECT_NEAR(column(law, test, curve, Quantity::mu).back(), 0.3819, 1e-6) << name_of(method);
  }
}

TEST(Shear, an_explicit_method_says_that_the_law_is_too_stiff) {
  const Law law = mu_i("elastoviscoplastic");
  PointTest test = sweep(Condition::constant_p, 1e-6, 1e-5, 2, 0.1, Method::adaptive);
  test.settings.max_steps = 20000;
  const Curve curve = run(law, test);
  EXPECT_EQ(curve.outcome.status, Status::step_limit);
  EXPECT_NE(explain(*law.info, law.theta, test, curve).find("too stiff"), std::string::npos);
}

TEST(Shear, newtonian_stress_is_viscosity_times_rate) {
  const Law law =
      make_law({"newtonian", {}, {{"eta", 0.002}, {"K", 26e3}, {"alpha", 7.0}, {"rho_0", 1000.0}}});
  for (const Condition condition : {Condition::constant_p, Condition::constant_volume}) {
    const PointTest test = sweep(condition, 1e-6, 1e6, 13, 0.5, Method::automatic);
    const Curve curve = run(law, test);
    ASSERT_EQ(curve.outcome.status, Status::completed);
    const auto tau = column(law, test, curve, Quantity::tau);
    const auto rate = column(law, test, curve, Quantity::shear_rate);
    for (std::size_t i = 1; i < tau.size(); ++i)
      EXPECT_NEAR(tau[i], 0.002 * rate[i], 1e-12 * rate[i]);
    EXPECT_NEAR(rate.back(), 1e6, 1e-6);
  }
}

TEST(Shear, shear_stress_control_finds_the_rate) {
  // τ raised to 450 Pa at p = 1000 Pa: I = I_0 (μ − μ_0)/(μ_d − μ) must flow
  const Law law = mu_i("regularised");
  Stage stage;
  stage.kind = Kind::simple_shear;
  stage.condition = Condition::constant_p;
  stage.drive = Drive::stress;
  stage.stress_rate = 100.0;
  stage.goal = Goal{Quantity::tau, 450.0};
  stage.points = 20;
  PointTest test = make_test({stage}, 1000.0, 0.0, Method::automatic);
  test.settings.max_strain = 1e9;
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::completed) << explain(*law.info, law.theta, test, curve);
  EXPECT_NEAR(column(law, test, curve, Quantity::tau).back(), 450.0, 1e-7);
  const double I = 0.279 * (0.45 - 0.3819) / (0.5718 - 0.45);
  EXPECT_NEAR(column(law, test, curve, Quantity::I).back(), I, 1e-6 * I);
}

TEST(Shear, relaxation_stops_at_yield_and_creep_flows_on) {
  const Law law = mu_i("elastoviscoplastic");
  Stage shear;
  shear.kind = Kind::simple_shear;
  shear.condition = Condition::constant_volume;
  shear.rate = 10.0;
  shear.goal = Goal{Quantity::gamma, 1.0};
  shear.points = 5;
  Stage hold = shear;
  hold.drive = Drive::relaxation;
  hold.duration = 10.0;
  for (const Method method : {Method::cvode, Method::ida, Method::implicit}) {
    const PointTest test = make_test({shear, hold}, 1000.0, 0.0, method, 1e-8);
    const Curve curve = run(law, test);
    ASSERT_EQ(curve.outcome.status, Status::completed)
        << name_of(method) << ": " << explain(*law.info, law.theta, test, curve);
    const auto mu = column(law, test, curve, Quantity::mu);
    EXPECT_GT(mu[5], 0.40);                                   // flowing
    EXPECT_NEAR(mu.back(), 0.3819, 1e-5) << name_of(method);  // exact arrest
  }
  Stage creep = hold;
  creep.drive = Drive::creep;
  creep.condition = Condition::constant_p;
  creep.duration = 0.1;
  const PointTest test = make_test({shear, creep}, 1000.0, 0.0, Method::arkode, 1e-8);
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::completed);
  // τ held: the rate stays at 10 1/s
  const auto gamma = column(law, test, curve, Quantity::gamma);
  EXPECT_NEAR(gamma.back() - gamma[5], 10.0 * 0.1, 1e-4);
}

TEST(Shear, methods_that_need_a_stress_rate_refuse_laws_without_one) {
  const Law law = mu_i("regularised");
  const PointTest test = sweep(Condition::constant_p, 1.0, 10.0, 2, 0.1, Method::cvode);
  const Curve curve = run(law, test);
  EXPECT_EQ(curve.outcome.status, Status::unsupported);
  EXPECT_NE(explain(*law.info, law.theta, test, curve).find("use implicit"), std::string::npos);
}

}  // namespace
}  // namespace repose::point

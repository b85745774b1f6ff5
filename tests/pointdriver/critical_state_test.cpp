// Critical-state μ(I) along laboratory paths: the limit of slow tests, rates over decades, steady
// states, all integrators, sensitivities, and a jump of the rate that no stress can follow.
#include <gtest/gtest.h>

#include "pointdriver/integrate/sensitivity.hpp"
#include "tests/pointdriver/test_material.hpp"

namespace repose::point {
namespace {

constexpr double root_3 = 1.7320508075688772;

/// Kaolin of the exact solutions, with a rate dependence of clays; N follows from Γ.
Law kaolin(double I_M = 1e-11, double I_v = 3e-10) {
  const exact::CamClay c = london(false);
  Law law = make_law({"critical_state_mu_i",
                      {},
                      {{"M", c.M},
                       {"lambda", c.lambda},
                       {"kappa", c.kappa},
                       {"nu", c.nu},
                       {"Gamma", 2.759},
                       {"d", 1e-6},
                       {"M_inf", 1.3 * c.M},
                       {"I_M", I_M},
                       {"I_v", I_v}}});
  law.theta[5] = std::numeric_limits<double>::quiet_NaN();
  return law;
}

struct Grains {
  double M = 0.6614, lambda = 0.0186, kappa = 0.001, Gamma = 1.0 / 0.648, rho_p = 2000.0;
  double M_inf = 0.9904, I_M = 0.1611, I_v = 0.5, d = 0.0053;
  Law law() const {
    return make_law({"critical_state_mu_i",
                     {},
                     {{"M", M},
                      {"lambda", lambda},
                      {"kappa", kappa},
                      {"nu", 0.3},
                      {"Gamma", Gamma},
                      {"p_ref", 1.0},
                      {"rho_p", rho_p},
                      {"M_inf", M_inf},
                      {"I_M", I_M},
                      {"I_v", I_v},
                      {"d", d}}});
  }
  double M_of(double I) const { return M + (M_inf - M) * I / (I_M + I); }
  double v_of(double p, double I) const { return Gamma * std::pow(p, -lambda) * std::exp(I / I_v); }
};

PointTest slow(Stage stage, double ocr, Method method = Method::automatic) {
  // I = 1e-13·1e-6·√(2650/1e5) = 1.6e-20: friction is 0.3·I/I_M = 5e-10 above that at rest, p_s is
  // I/(I_v(λ−κ)) = 5e-10
  stage.rate = 1e-13;
  return make_test({stage}, 100e3, ocr, method);
}

// CSM-5: closed forms of Cam-Clay on ln v – ln p lines, wet and dry.
TEST(CriticalState, SlowTestsAreCamClay) {
  const exact::CamClay c = london(false);
  const Law law = kaolin();
  for (const double ocr : {1.0, 1.5, 4.0, 8.0}) {
    for (const Condition condition : {Condition::undrained, Condition::drained}) {
      // A drained test that starts at q = 0 on the surface, at this rate, flows at an overstress of
      // (q/p)·5e-10, which is below the round-off of p: for `implicit`, not for a rate form.
      if (condition == Condition::drained && ocr == 1.0) continue;
      const PointTest test = slow(triaxial(condition, 0.2), ocr);
      const Curve curve = run(law, test);
      ASSERT_EQ(curve.outcome.status, Status::completed)
          << ocr << explain(*law.info, law.theta, test, curve);
      const auto p = column(law, test, curve, Quantity::p),
                 q = column(law, test, curve, Quantity::q);
      const auto eps_a = column(law, test, curve, Quantity::eps_a);
      if (condition == Condition::drained && ocr > 2.0) continue;  // softens: no closed form here
      for (std::size_t i = 1; i < p.size(); ++i) {
        const exact::Point at = condition == Condition::undrained
                                    ? exact::undrained(c, 100e3, ocr, 1.0, eps_a[i])
                                    : exact::drained(c, 100e3, ocr, eps_a[i]);
        EXPECT_NEAR(p[i], at.p, 1e-8 * 100e3) << ocr << " row " << i;
        EXPECT_NEAR(q[i], at.q, 1e-8 * 100e3) << ocr << " row " << i;
      }
    }
  }
}

// M_∞ = M and no I_v: no parameter knows a rate, and the law is Cam-Clay's at any. I, which then
// nothing tells, reads 0, and p_c is a number.
TEST(CriticalState, WithoutRateEffectsItIsCamClay) {
  const exact::CamClay c = london(false);
  const Law law = make_law({"critical_state_mu_i",
                            {},
                            {{"M", c.M},
                             {"lambda", c.lambda},
                             {"kappa", c.kappa},
                             {"nu", c.nu},
                             {"Gamma", 2.759},
                             {"d", 1e-3},
                             {"M_inf", c.M},
                             {"I_M", 0.1}}});
  for (const double ocr : {1.0, 1.5, 4.0})
    for (const Method method : {Method::automatic, Method::adaptive, Method::implicit}) {
      PointTest test = make_test({triaxial(Condition::undrained, 0.1, 10)}, 100e3, ocr, method);
      test.settings.substeps = 400;
      const Curve curve = run(law, test);
      ASSERT_EQ(curve.outcome.status, Status::completed)
          << name_of(method) << explain(*law.info, law.theta, test, curve);
      const auto p = column(law, test, curve, Quantity::p),
                 q = column(law, test, curve, Quantity::q);
      const auto eps_a = column(law, test, curve, Quantity::eps_a);
      for (std::size_t i = 1; i < p.size(); ++i) {
        const exact::Point at = exact::undrained(c, 100e3, ocr, 1.0, eps_a[i]);
        // implicit is of first order: steps of 2.5e-5 against the 0.01 over which q follows
        const double tolerance = (method == Method::implicit ? 3e-3 : 1e-8) * 100e3;
        EXPECT_NEAR(p[i], at.p, tolerance) << name_of(method) << " ocr " << ocr << " row " << i;
        EXPECT_NEAR(q[i], at.q, tolerance) << name_of(method) << " ocr " << ocr << " row " << i;
      }
      for (const double I : column(law, test, curve, Quantity::I)) EXPECT_EQ(I, 0.0);
      for (const double p_c : column(law, test, curve, Quantity::p_c)) EXPECT_GT(p_c, 0.0);
    }
}

// Δt → 0: at 1e12 1/s nothing has the time to flow, q = 3Gε_a and the volume strains elastically.
TEST(CriticalState, FastTestsAreElastic) {
  const Law law = kaolin();
  Stage stage = triaxial(Condition::undrained, 1e-3, 4);
  stage.rate = 1e12;
  const PointTest test = make_test({stage}, 100e3, 1.5, Method::automatic);
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::completed);
  const exact::CamClay c = london(false);
  const double G = c.alpha() * 100e3 / c.kappa;
  // what flows keeps I/(I_v(λ−κ)) of order one, a rate of some 2e-4 1/s: 1e-16 of the strain's
  EXPECT_NEAR(column(law, test, curve, Quantity::p).back(), 100e3, 1e-8 * 100e3);
  EXPECT_NEAR(column(law, test, curve, Quantity::q).back(), 3.0 * G * 1e-3, 1e-8 * 3.0 * G * 1e-3);
}

// Undrained triaxial compression over eight decades of rate: each ends at q = M M_I(I) p and
// v = Γ (p_ref/p)^λ e^{I/I_v} at the I of its rate.
TEST(CriticalState, UndrainedStrengthOverEightDecadesOfRate) {
  const Law law = kaolin();
  const exact::CamClay c = london(false);
  double last = 0.0;
  for (int decade = -12; decade <= -4; ++decade) {
    Stage stage = triaxial(Condition::undrained, 2.0, 10);
    stage.rate = std::pow(10.0, decade);
    const PointTest test = make_test({stage}, 100e3, 1.5, Method::automatic, 1e-11);
    const Curve curve = run(law, test);
    ASSERT_EQ(curve.outcome.status, Status::completed)
        << decade << explain(*law.info, law.theta, test, curve);
    const double p = column(law, test, curve, Quantity::p).back();
    const double q = column(law, test, curve, Quantity::q).back();
    const double v = column(law, test, curve, Quantity::v).back();
    const double I = stage.rate * 1e-6 * std::sqrt(2650.0 / p);
    const double M_I = 1.0 + 0.3 * I / (1e-11 + I);
    // a strain of 2 is some 60 of what the approach to critical state takes: e^{-60} is left
    EXPECT_NEAR(q, c.M * M_I * p, 1e-8 * q) << decade;
    EXPECT_NEAR(v, 2.759 * std::pow(1e3 / p, c.lambda) * std::exp(I / 3e-10), 1e-8 * v) << decade;
    EXPECT_NEAR(column(law, test, curve, Quantity::I).back(), I, 1e-6 * I) << decade;
    EXPECT_GT(q, last) << "strength grows with the rate";
    last = q;
  }
}

// The same drained: σ_r is kept, so p = 3p_0/(3 − η) at η = M M_I(I).
TEST(CriticalState, DrainedStrengthOverEightDecadesOfRate) {
  const Law law = kaolin();
  const exact::CamClay c = london(false);
  for (int decade = -12; decade <= -4; ++decade) {
    Stage stage = triaxial(Condition::drained, 3.0, 10);
    stage.rate = std::pow(10.0, decade);
    const PointTest test = make_test({stage}, 100e3, 1.5, Method::automatic, 1e-11);
    const Curve curve = run(law, test);
    ASSERT_EQ(curve.outcome.status, Status::completed)
        << decade << explain(*law.info, law.theta, test, curve);
    const double p = column(law, test, curve, Quantity::p).back();
    const double I = stage.rate * 1e-6 * std::sqrt(2650.0 / p);
    const double eta = c.M * (1.0 + 0.3 * I / (1e-11 + I));
    EXPECT_NEAR(p, 3.0 * 100e3 / (3.0 - eta), 1e-8 * p) << decade;
    EXPECT_NEAR(column(law, test, curve, Quantity::q).back(), eta * p, 1e-8 * p) << decade;
    EXPECT_NEAR(column(law, test, curve, Quantity::v).back(),
                2.759 * std::pow(1e3 / p, c.lambda) * std::exp(I / 3e-10), 1e-7)
        << decade;
  }
}

// Shear at constant volume from I = 1e-8 to 1: μ(I) and φ(I).
TEST(CriticalState, ConstantVolumeShearOverEightDecadesOfI) {
  const Grains g;
  const Law law = g.law();
  for (int decade = -16; decade <= 0; ++decade) {
    // the volume of steady flow at 1 kPa and this I, at rest on its compression line
    const double I = std::pow(10.0, 0.5 * decade), p_flow = 1e3;
    Stage shear;
    shear.kind = Kind::simple_shear;
    shear.condition = Condition::constant_volume;
    shear.rate = root_3 * I / g.d * std::sqrt(p_flow / g.rho_p);
    shear.goal = Goal{Quantity::gamma, 2.0};
    shear.points = 4;
    PointTest test = make_test({shear}, 0.0, 0.0, Method::automatic, 1e-10);
    test.initial.p.reset();
    test.initial.v = g.v_of(p_flow, I);
    // (loose material has no pressure at rest: it is driven at what is left)
    if (*test.initial.v > g.Gamma * std::pow(2.0, g.lambda - g.kappa) * std::pow(0.02, -g.lambda))
      continue;
    const Curve curve = run(law, test);
    ASSERT_EQ(curve.outcome.status, Status::completed)
        << I << explain(*law.info, law.theta, test, curve);
    const double p = column(law, test, curve, Quantity::p).back();
    EXPECT_NEAR(p, p_flow, 1e-7 * p_flow) << I;  // v tells ln p to 1/λ = 54 times its own error
    EXPECT_NEAR(column(law, test, curve, Quantity::q).back(), g.M_of(I) * p, 1e-8 * p) << I;
    EXPECT_NEAR(column(law, test, curve, Quantity::I).back(), I, 1e-6 * I) << I;
    EXPECT_NEAR(column(law, test, curve, Quantity::p_c).back(), 2.0 * p, 1e-6 * p) << I;
  }
}

// Shear at constant pressure up to I = 1, where the volume has grown by e: the rate is raised by
// steps that dilation can follow (ΔI/(I_v(λ−κ)) of 0.7), and held at the end for 2.5, more than 20
// times the strain over which the volume follows.
TEST(CriticalState, ConstantPressureShearUpToIOfOne) {
  Grains g;
  g.I_v = 1.0;
  const Law law = g.law();
  const double p = 1e3, per_I = root_3 / g.d * std::sqrt(p / g.rho_p);
  for (const double I : {1e-8, 1e-6, 1e-4, 0.01, 0.1, 0.3, 1.0}) {
    std::vector<Stage> stages;
    const int steps = std::max(1, static_cast<int>(std::ceil(I / 0.0125)));
    for (int k = 1; k <= steps; ++k) {
      Stage shear;
      shear.kind = Kind::simple_shear;
      shear.condition = Condition::constant_p;
      shear.rate = per_I * I * k / steps;
      shear.goal = Goal{Quantity::gamma, k == steps ? 2.5 : 0.15, true};
      shear.points = 2;
      stages.push_back(shear);
    }
    const PointTest test = make_test(stages, p, 1.5, Method::automatic, 1e-10);
    const Curve curve = run(law, test);
    ASSERT_EQ(curve.outcome.status, Status::completed)
        << I << explain(*law.info, law.theta, test, curve);
    EXPECT_NEAR(column(law, test, curve, Quantity::I).back(), I, 1e-7 * I + 1e-15) << I;
    EXPECT_NEAR(column(law, test, curve, Quantity::q).back(), g.M_of(I) * p, 1e-8 * p) << I;
    EXPECT_NEAR(column(law, test, curve, Quantity::v).back() / g.v_of(p, I), 1.0, 1e-8) << I;
  }
}

// Every integrator draws the same curve; the implicit one, of first order, as its steps shrink.
TEST(CriticalState, IntegratorsAgree) {
  const Law law = kaolin();
  for (const Condition condition : {Condition::undrained, Condition::drained})
    for (const double ocr : {1.0, 6.0}) {
      Stage stage = triaxial(condition, 0.1, 20);
      stage.rate = 1e-5;
      const PointTest reference = make_test({stage}, 100e3, ocr, Method::adaptive, 1e-11);
      const Curve exact = run(law, reference);
      ASSERT_EQ(exact.outcome.status, Status::completed)
          << explain(*law.info, law.theta, reference, exact);
      const auto q_exact = column(law, reference, exact, Quantity::q);
      for (const Method method : {Method::cvode, Method::ida, Method::arkode}) {
        const PointTest test = make_test({stage}, 100e3, ocr, method, 1e-10);
        const Curve curve = run(law, test);
        ASSERT_EQ(curve.outcome.status, Status::completed)
            << name_of(method) << explain(*law.info, law.theta, test, curve);
        const auto q = column(law, test, curve, Quantity::q);
        for (std::size_t i = 1; i < q.size(); ++i)
          EXPECT_NEAR(q[i], q_exact[i], 1e-7 * 100e3) << name_of(method) << " row " << i;
      }
      double coarse = 0.0;
      for (const int substeps : {20, 40, 80}) {
        PointTest test = make_test({stage}, 100e3, ocr, Method::implicit);
        test.settings.substeps = substeps;
        const Curve curve = run(law, test);
        ASSERT_EQ(curve.outcome.status, Status::completed);
        const auto q = column(law, test, curve, Quantity::q);
        double error = 0.0;
        for (std::size_t i = 1; i < q.size(); ++i)
          error = std::max(error, std::abs(q[i] - q_exact[i]));
        EXPECT_LT(error, 5e-3 * 100e3);
        if (coarse > 0.0) {
          EXPECT_NEAR(error / coarse, 0.5, 0.1) << "first order";
        }
        coarse = error;
      }
    }
}

// CSM-2 on every row of a test, with the p_c and I of its columns.
TEST(CriticalState, RowsObeyTheStateRelation) {
  const Grains g;
  const Law law = g.law();
  Stage shear;
  shear.kind = Kind::simple_shear;
  shear.condition = Condition::constant_volume;
  shear.rate = 20.0;
  shear.goal = Goal{Quantity::gamma, 0.3};
  shear.points = 100;
  const PointTest test = make_test({shear}, 1e3, 1.2, Method::automatic);
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::completed);
  const auto p = column(law, test, curve, Quantity::p),
             p_c = column(law, test, curve, Quantity::p_c);
  const auto I = column(law, test, curve, Quantity::I), v = column(law, test, curve, Quantity::v);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double on_lines = g.v_of(0.5 * p_c[i], I[i]) * std::pow(0.5 * p_c[i] / p[i], g.kappa);
    EXPECT_NEAR(v[i], on_lines, 1e-9 * v[i]) << i;
  }
  EXPECT_GT(I.back(), 0.01);
}

// Sensitivities to every parameter of the law against differences, by the update that fits use.
TEST(CriticalState, SensitivitiesAgreeWithDifferences) {
  const Law law = kaolin();
  std::vector<int> which;
  for (const char* name : {"M", "lambda", "kappa", "nu", "M_inf", "I_M"})
    which.push_back(parameter_index(law.info->parameters, name));
  std::vector<int> more{parameter_index(law.info->parameters, "I_v"),
                        parameter_index(law.info->parameters, "Gamma")};
  for (const std::vector<int>& group : {which, more})
    for (const Condition condition : {Condition::undrained, Condition::drained})
      for (const double ocr : {1.0, 5.0}) {
        Stage stage = triaxial(condition, 0.1, 8);
        stage.rate = 1e-5;
        PointTest test = make_test({stage}, 100e3, ocr, Method::implicit);
        test.settings.substeps = 5;
        GradientCurve curve;
        ASSERT_EQ(simulate_with_gradient(*law.info, law.theta, group, test, curve).status,
                  Status::completed);
        std::vector<double> values, slopes;
        read_column_with_gradient(*law.info, law.theta, group, test, curve, Quantity::q, values,
                                  slopes);
        for (std::size_t j = 0; j < group.size(); ++j) {
          const auto at = static_cast<std::size_t>(group[j]);
          const auto moved = [&](double step) {
            Law other = law;
            other.theta[at] *= 1.0 + step;
            return column(other, test, run(other, test), Quantity::q);
          };
          const double h = 2e-4;
          const auto a = moved(h), b = moved(-h), c = moved(0.5 * h), d = moved(-0.5 * h);
          for (std::size_t i = 0; i < values.size(); ++i) {
            const double slope = (4.0 * (c[i] - d[i]) / h - (a[i] - b[i]) / (2.0 * h)) / 3.0;
            // a run is met to 1e-12, twice extrapolated over h: 4e-8 of 100 kPa; and h⁴
            EXPECT_NEAR(slopes[i * group.size() + j] * law.theta[at], slope, 2e-7 * 100e3)
                << law.info->parameters[at].name << " row " << i << " ocr " << ocr;
          }
        }
      }
}

// CSM-9: at constant p a jump of the rate drives q/p far above 3 before dilation catches up; where
// the walls of a shear box keep the sample from widening, dilation feeds the shear itself and no
// stress can follow: said, not hidden.
TEST(CriticalState, AJumpOfTheRateAtConstantPressure) {
  const Grains g;
  const Law law = g.law();
  Stage shear;
  shear.kind = Kind::simple_shear;
  shear.condition = Condition::constant_p;
  shear.goal = Goal{Quantity::gamma, 0.2};
  shear.rate = 1.0;
  const PointTest gentle = make_test({shear}, 1e3, 1.0, Method::automatic, 1e-8);
  const Curve follows = run(law, gentle);
  EXPECT_EQ(follows.outcome.status, Status::completed);
  shear.rate = 10.0;
  for (const Method method : {Method::adaptive, Method::cvode}) {
    PointTest jump = make_test({shear}, 1e3, 1.0, method, 1e-8);
    if (method == Method::cvode)
      jump.settings.max_steps = 2000;  // it goes after the blow-up longer
    const Curve curve = run(law, jump);
    EXPECT_TRUE(is_failure(curve.outcome.status)) << name_of(method);
    if (method == Method::adaptive) {
      EXPECT_NE(explain(*law.info, law.theta, jump, curve).find("cannot be carried any further"),
                std::string::npos);
    }
    for (const auto& row : curve.rows) EXPECT_TRUE(std::isfinite(row.stress[3]));
  }
}

}  // namespace
}  // namespace repose::point

// The integrators against the closed forms of physics.md. Error bound 1e-8 relative at tolerance
// 1e-10: the tolerance bounds the local error per step, about 1e2 steps add up at most.
#include <gtest/gtest.h>

#include "tests/pointdriver/test_material.hpp"

namespace repose::point {
namespace {

constexpr double bound = 1e-8;

double relative(double a, double b, double scale) { return std::abs(a - b) / scale; }

class ExactSolutions : public testing::TestWithParam<Method> {};

/// Every row of an undrained test; errors relative to p (stress) and to the strain at the end.
void check_undrained(Method method, bool v_ln_p, double R, double end_strain) {
  const exact::CamClay c = london(v_ln_p);
  const Law law = cam_clay(c);
  const double p0 = 100e3;
  const PointTest test = make_test({triaxial(Condition::undrained, end_strain)}, p0, R, method);
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::completed) << explain(*law.info, law.theta, test, curve);
  ASSERT_EQ(curve.rows.size(), 51u);
  const auto eps_a = column(law, test, curve, Quantity::eps_a);
  const auto p = column(law, test, curve, Quantity::p);
  const auto q = column(law, test, curve, Quantity::q);
  const auto v = column(law, test, curve, Quantity::v);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const exact::Point e = exact::undrained(c, p0, R, v[0], eps_a[i]);
    EXPECT_LE(relative(p[i], e.p, e.p), bound) << "R = " << R << ", eps_a = " << eps_a[i];
    EXPECT_LE(relative(q[i], e.q, e.p), bound) << "R = " << R << ", eps_a = " << eps_a[i];
    EXPECT_LE(curve.rows[i].residual, 1e-10);
  }
}

void check_drained(Method method, double R, double end_strain) {
  const exact::CamClay c = london(false);
  const Law law = cam_clay(c);
  const double p0 = 100e3;
  const PointTest test = make_test({triaxial(Condition::drained, end_strain)}, p0, R, method);
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::completed) << explain(*law.info, law.theta, test, curve);
  const auto eps_a = column(law, test, curve, Quantity::eps_a);
  const auto p = column(law, test, curve, Quantity::p);
  const auto q = column(law, test, curve, Quantity::q);
  const auto eps_v = column(law, test, curve, Quantity::eps_v);
  for (std::size_t i = 1; i < p.size(); ++i) {
    const exact::Point e = exact::drained(c, p0, R, eps_a[i]);
    EXPECT_LE(relative(p[i], e.p, e.p), bound) << "R = " << R << ", eps_a = " << eps_a[i];
    EXPECT_LE(relative(q[i], e.q, e.p), bound) << "R = " << R << ", eps_a = " << eps_a[i];
    EXPECT_LE(relative(eps_v[i], e.eps_v, eps_a[i]), bound)
        << "R = " << R << ", eps_a = " << eps_a[i];
    EXPECT_LE(curve.rows[i].residual, 1e-10);
  }
}

TEST_P(ExactSolutions, undrained_normally_consolidated) {
  for (const bool v_ln_p : {false, true}) check_undrained(GetParam(), v_ln_p, 1.0, 0.15);
}
TEST_P(ExactSolutions, undrained_wet_side) {
  for (const bool v_ln_p : {false, true}) check_undrained(GetParam(), v_ln_p, 1.5, 0.15);
}
TEST_P(ExactSolutions, undrained_dry_side) {
  for (const bool v_ln_p : {false, true}) check_undrained(GetParam(), v_ln_p, 4.0, 0.3);
}
TEST_P(ExactSolutions, drained_normally_consolidated) { check_drained(GetParam(), 1.0, 0.25); }
TEST_P(ExactSolutions, drained_wet_side) { check_drained(GetParam(), 1.5, 0.25); }
TEST_P(ExactSolutions, drained_dry_side_softens) { check_drained(GetParam(), 12.0, 0.15); }

TEST_P(ExactSolutions, isotropic_load_unload_reload) {
  for (const bool v_ln_p : {false, true}) {
    const exact::CamClay c = london(v_ln_p);
    const Law law = cam_clay(c);
    const double p0 = 50e3, p_c0 = 100e3;
    std::vector<Stage> stages;
    for (const double target : {400e3, 20e3, 800e3}) {
      Stage stage;
      stage.kind = Kind::isotropic;
      stage.drive = Drive::stress;
      stage.goal = Goal{Quantity::p, target};
      stage.points = 40;
      stages.push_back(stage);
    }
    const PointTest test = make_test(stages, p0, p_c0 / p0, GetParam());
    const Curve curve = run(law, test);
    ASSERT_EQ(curve.outcome.status, Status::completed)
        << explain(*law.info, law.theta, test, curve);
    const auto p = column(law, test, curve, Quantity::p);
    const auto v = column(law, test, curve, Quantity::v);
    double p_max = p0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      p_max = std::max(p_max, p[i]);
      const double fallen = exact::isotropic_compression(c, p0, p_c0, p_max, p[i]);
      const double expected = v_ln_p ? v[0] - fallen : v[0] * std::exp(-fallen);
      EXPECT_LE(relative(v[i], expected, expected), bound) << "p = " << p[i];
    }
    EXPECT_NEAR(p.back(), 800e3, 800e3 * 1e-10);
  }
}

TEST_P(ExactSolutions, one_dimensional_compression_keeps_K0) {
  for (const bool v_ln_p : {false, true}) {
    const exact::CamClay c = london(v_ln_p);
    const Law law = cam_clay(c);
    const double eta = exact::one_dimensional_ratio(c);
    const double p0 = 100e3;
    for (const Drive drive : {Drive::strain, Drive::stress}) {
      Stage stage;
      stage.kind = Kind::oedometer;
      stage.drive = drive;
      stage.goal =
          drive == Drive::strain ? Goal{Quantity::eps_a, 0.2} : Goal{Quantity::sigma_a, 500e3};
      stage.points = 30;
      PointTest test = make_test({stage}, p0, 0.0, GetParam());
      test.initial.K0 = exact::K0(eta);
      const Curve curve = run(law, test);
      ASSERT_EQ(curve.outcome.status, Status::completed)
          << explain(*law.info, law.theta, test, curve);
      const auto p = column(law, test, curve, Quantity::p);
      const auto q = column(law, test, curve, Quantity::q);
      const auto v = column(law, test, curve, Quantity::v);
      for (std::size_t i = 0; i < p.size(); ++i) {
        EXPECT_LE(relative(q[i], eta * p[i], p[i]), bound);
        const double fallen = c.lambda * std::log(p[i] / p0);
        const double expected = v_ln_p ? v[0] - fallen : v[0] * std::exp(-fallen);
        EXPECT_LE(relative(v[i], expected, expected), bound);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(methods, ExactSolutions,
                         testing::Values(Method::adaptive, Method::cvode, Method::ida),
                         [](const auto& method) { return std::string(name_of(method.param)); });

/// Backward Euler: halving the step halves the error (order 1 ± 0.15 at these step sizes).
TEST(ImplicitMethod, converges_at_first_order) {
  const exact::CamClay c = london(false);
  const Law law = cam_clay(c);
  const double p0 = 100e3;
  for (const Condition condition : {Condition::undrained, Condition::drained})
    for (const double R : {1.0, 4.0}) {
      double before = 0.0;
      for (const int substeps : {8, 16, 32, 64}) {
        PointTest test = make_test({triaxial(condition, 0.2, 10)}, p0, R, Method::implicit);
        test.settings.substeps = substeps;
        const Curve curve = run(law, test);
        ASSERT_EQ(curve.outcome.status, Status::completed);
        const auto p = column(law, test, curve, Quantity::p);
        const auto q = column(law, test, curve, Quantity::q);
        const auto eps_a = column(law, test, curve, Quantity::eps_a);
        double error = 0.0;
        for (std::size_t i = 1; i < p.size(); ++i) {
          const exact::Point e = condition == Condition::undrained
                                     ? exact::undrained(c, p0, R, 1.0, eps_a[i])
                                     : exact::drained(c, p0, R, eps_a[i]);
          error = std::max({error, std::abs(p[i] - e.p) / e.p, std::abs(q[i] - e.q) / e.p});
          EXPECT_LE(curve.rows[i].residual, 1e-10);
        }
        if (before > 0.0) {
          EXPECT_NEAR(std::log2(before / error), 1.0, 0.15) << "R = " << R;
        }
        before = error;
      }
      EXPECT_LT(before, 2e-3);
    }
}

}  // namespace
}  // namespace repose::point

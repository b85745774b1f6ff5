// Derivatives of curves: dual numbers against differences and against CVODES.
#include "pointdriver/integrate/sensitivity.hpp"

#include <gtest/gtest.h>

#include "pointdriver/integrate/dual_start.hpp"
#include "tests/pointdriver/test_material.hpp"

namespace repose::point {
namespace {

/// Parameters as given: N follows from Γ.
Law given_clay(bool v_ln_p) {
  Law law = cam_clay(london(v_ln_p));
  law.theta[static_cast<std::size_t>(parameter_index(law.info->parameters, "N"))] =
      std::numeric_limits<double>::quiet_NaN();
  return law;
}

std::vector<int> indices(const Law& law, std::initializer_list<const char*> names) {
  std::vector<int> list;
  for (const char* name : names) list.push_back(parameter_index(law.info->parameters, name));
  return list;
}

/// Central differences with extrapolation: error about h⁴ + ε_run/h with h = 1e-4 relative and a
/// run's own noise of 1e-12: 1e-8 of value/parameter.
std::vector<double> differences(const Law& law, const PointTest& test, int parameter, Quantity q) {
  const auto values = [&](double step) {
    Law moved = law;
    moved.theta[static_cast<std::size_t>(parameter)] += step;
    return column(moved, test, run(moved, test), q);
  };
  const double h = 2e-4 * law.theta[static_cast<std::size_t>(parameter)];
  const auto a = values(h), b = values(-h), c = values(0.5 * h), d = values(-0.5 * h);
  std::vector<double> slope;
  for (std::size_t i = 0; i < a.size(); ++i)
    slope.push_back((4.0 * (c[i] - d[i]) / h - (a[i] - b[i]) / (2.0 * h)) / 3.0);
  return slope;
}

void compare_with_differences(const Law& law, const PointTest& test, Quantity q, double scale,
                              double bound) {
  const std::vector<int> which = indices(law, {"M", "lambda", "kappa", "nu"});
  GradientCurve curve;
  ASSERT_EQ(simulate_with_gradient(*law.info, law.theta, which, test, curve).status,
            Status::completed);
  std::vector<double> values, slopes;
  read_column_with_gradient(*law.info, law.theta, which, test, curve, q, values, slopes);
  const auto plain = column(law, test, run(law, test), q);
  ASSERT_EQ(values.size(), plain.size());
  for (std::size_t j = 0; j < which.size(); ++j) {
    const auto expected = differences(law, test, which[j], q);
    const double parameter = law.theta[static_cast<std::size_t>(which[j])];
    for (std::size_t i = 0; i < values.size(); ++i) {
      EXPECT_NEAR(values[i], plain[i], 1e-12 * scale);
      EXPECT_NEAR(slopes[i * which.size() + j] * parameter, expected[i] * parameter, bound * scale)
          << "row " << i << ", parameter "
          << law.info->parameters[static_cast<std::size_t>(which[j])].name;
    }
  }
}

// The start's own derivatives: with h = 1e-3 x, Richardson's extrapolation of two central
// differences is off by h^4 f(5)/480 (3e-14 of e^x at x = 2) and round-off/h (1e-13); one alone by
// h^2 f(3)/6 (7e-7).
TEST(Sensitivity, OfAStartIsOfFourthOrder) {
  const auto start = [](std::span<const double> theta) {
    return std::vector<double>{std::exp(theta[0]), std::log(theta[1]), theta[0] * theta[1]};
  };
  const std::vector<double> theta{2.0, 0.16};
  const std::vector<double> by_x = flat_derivative(start, theta, 0);
  const std::vector<double> by_y = flat_derivative(start, theta, 1);
  EXPECT_NEAR(by_x[0], std::exp(2.0), 1e-11 * std::exp(2.0));
  EXPECT_EQ(by_x[1], 0.0);
  EXPECT_NEAR(by_x[2], 0.16, 1e-12);
  EXPECT_NEAR(by_y[1], 1.0 / 0.16, 1e-11 / 0.16);
}

TEST(Sensitivity, adaptive_agrees_with_differences_across_yield) {
  for (const bool v_ln_p : {true, false})
    for (const Condition c : {Condition::undrained, Condition::drained})
      for (const double ocr : {1.0, 1.6, 5.0}) {
        const Law law = given_clay(v_ln_p);
        const PointTest test =
            make_test({triaxial(c, 0.15, 25)}, 100e3, ocr, Method::adaptive, 1e-12);
        compare_with_differences(law, test, Quantity::p, 100e3, 1e-6);
        compare_with_differences(law, test, Quantity::q, 100e3, 1e-6);
      }
}

TEST(Sensitivity, implicit_agrees_with_differences) {
  for (const Condition c : {Condition::undrained, Condition::drained}) {
    const Law law = given_clay(true);
    PointTest test = make_test({triaxial(c, 0.15, 10)}, 100e3, 1.0, Method::implicit);
    test.settings.substeps = 4;
    compare_with_differences(law, test, Quantity::p, 100e3, 1e-6);
    compare_with_differences(law, test, Quantity::q, 100e3, 1e-6);
  }
}

TEST(Sensitivity, a_goal_on_the_way_carries_the_derivative_of_its_time) {
  // loading to q = 40 kPa, then unloading to 0: rows lie at shares of legs whose length depends on
  // the parameters
  const Law law = given_clay(true);
  Stage half = triaxial(Condition::undrained, 0.0, 6);
  const PointTest test =
      make_test(cycles(half, Quantity::q, 0.0, 40e3, 1), 100e3, 1.3, Method::adaptive, 1e-12);
  compare_with_differences(law, test, Quantity::p, 100e3, 1e-6);
  compare_with_differences(law, test, Quantity::eps_a, 0.02, 1e-6);
}

TEST(Sensitivity, dual_numbers_agree_with_cvodes_and_its_jump_at_yield) {
  const Law law = given_clay(true);
  for (const Condition c : {Condition::undrained, Condition::drained})
    for (const double ocr : {1.6, 5.0}) {
      const PointTest test = make_test({triaxial(c, 0.2, 20)}, 100e3, ocr, Method::adaptive, 1e-11);
      for (const char* name : {"M", "lambda", "kappa", "nu"}) {
        const std::vector<int> which = indices(law, {name});
        GradientCurve curve;
        ASSERT_EQ(simulate_with_gradient(*law.info, law.theta, which, test, curve).status,
                  Status::completed);
        std::vector<CvodesRow> rows;
        ASSERT_EQ(cvodes_gradient(*law.info, law.theta, which[0], test, rows), Status::completed);
        ASSERT_EQ(rows.size() + 1, curve.rows.size());
        const double parameter = law.theta[static_cast<std::size_t>(which[0])];
        for (std::size_t i = 0; i < rows.size(); ++i)
          for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(curve.rows[i + 1].stress[k].v[0] * parameter,
                        rows[i].derivative[k] * parameter, 1e-6 * 100e3)
                << name << " row " << i;
            EXPECT_NEAR(curve.rows[i + 1].stress[k].a, rows[i].stress[k], 1e-7 * 100e3);
          }
      }
    }
}

TEST(Sensitivity, derived_parameters_follow) {
  // G = 4K where it is not given: doubling K's effect includes G
  Law law = mu_i("elastoviscoplastic");
  law.theta[7] = std::numeric_limits<double>::quiet_NaN();
  Stage shear;
  shear.kind = Kind::simple_shear;
  shear.condition = Condition::constant_volume;
  shear.rate = 1.0;
  shear.goal = Goal{Quantity::gamma, 2e-4};  // below yield: τ = Gγ
  shear.points = 2;
  const PointTest test = make_test({shear}, 1000.0, 0.0, Method::adaptive);
  const std::vector<int> which{6};
  GradientCurve curve;
  ASSERT_EQ(simulate_with_gradient(*law.info, law.theta, which, test, curve).status,
            Status::completed);
  EXPECT_NEAR(curve.rows.back().stress[3].a, 4.0 * 254800.0 * 2e-4, 1e-6);
  EXPECT_NEAR(curve.rows.back().stress[3].v[0], 4.0 * 2e-4, 1e-10);
}

}  // namespace
}  // namespace repose::point

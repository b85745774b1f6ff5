// The mechanism itself: six rows on twelve rates.
#include "pointdriver/path/control.hpp"

#include <gtest/gtest.h>

#include "models/parameter.hpp"

namespace repose::point {
namespace {

std::array<Constraint, 6> no_strain() {
  std::array<Constraint, 6> rows;
  for (int i = 0; i < 6; ++i) rows[static_cast<std::size_t>(i)] = strain_rate(i, 0.0);
  return rows;
}

Constraint constant_volume() {
  Constraint row;
  row.strain = {1.0, 1.0, 1.0, 0.0, 0.0, 0.0};
  return row;
}

std::string message_of(const std::array<Constraint, 6>& rows) {
  try {
    Control{rows};
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Control, strain_control_leaves_nothing_to_solve) {
  auto rows = no_strain();
  rows[1].rate = 2e-4;  // compression
  rows[3].rate = 1e-4;
  const Control control(rows);
  EXPECT_EQ(control.unknowns(), 0);
  EXPECT_EQ(control.prescribed()[1], -2e-4);  // tension positive inside
  EXPECT_EQ(control.prescribed()[3], 1e-4);
  EXPECT_FALSE(control.keeps_volume());
}

TEST(Control, undrained_triaxial_is_strain_control) {
  const Control control({strain_rate(3, 0.0), strain_rate(4, 0.0), strain_rate(5, 0.0),
                         equal_strain(0, 2), constant_volume(), strain_rate(1, 1e-3)});
  EXPECT_EQ(control.unknowns(), 0);
  EXPECT_TRUE(control.keeps_volume());
  EXPECT_NEAR(control.prescribed()[0], 5e-4, 1e-18);
  EXPECT_NEAR(control.prescribed()[1], -1e-3, 1e-18);
  EXPECT_NEAR(control.prescribed()[2], 5e-4, 1e-18);
}

TEST(Control, a_drained_triaxial_test_has_one_unknown) {
  Constraint radial;
  radial.stress = {0.5, 0.0, 0.5, 0.0, 0.0, 0.0};
  const Control control({strain_rate(3, 0.0), strain_rate(4, 0.0), strain_rate(5, 0.0),
                         equal_strain(0, 2), radial, strain_rate(1, 1e-3)});
  ASSERT_EQ(control.unknowns(), 1);
  const auto& N = control.direction(0);
  EXPECT_EQ(N[0], N[2]);
  EXPECT_NE(N[0], 0.0);
  EXPECT_EQ(N[1], 0.0);
  EXPECT_EQ(control.stress_row(0).stress[0], -0.5);
}

TEST(Control, rows_that_repeat_are_refused) {
  auto rows = no_strain();
  rows[5] = strain_rate(0, 1e-3);
  EXPECT_NE(message_of(rows).find("constraint 6 repeats or contradicts the others"),
            std::string::npos)
      << message_of(rows);
  rows = no_strain();
  rows[2] = constant_volume();
  rows[4].rate = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message_of(rows).find("constraint 5 holds a value that is not finite"),
            std::string::npos);
  rows = no_strain();
  rows[0] = stress_rate(1, 0.0);
  rows[1] = stress_rate(1, 5.0);
  EXPECT_NE(message_of(rows), "");
}

TEST(Control, residual_measures_a_violation) {
  auto rows = no_strain();
  rows[1] = stress_rate(1, 1e3);
  const Control control(rows);
  Sym<double, 6> strain, change, stress = Sym<double, 6>::isotropic(-1e5);
  change[1] = -1e3;  // compression positive 1 kPa after 1 s
  EXPECT_LE(control.residual(strain, change, stress, 1.0), 1e-15);
  change[1] = -1e3 - 1.0;
  // 1 Pa of |σ| + |Δσ| = 101001 Pa
  EXPECT_NEAR(control.residual(strain, change, stress, 1.0), 1.0 / 101001.0, 1e-12);
}

TEST(SolveSmall, solves_and_tells_a_singular_system) {
  std::array<std::array<double, 6>, 6> a{{{0.0, 2.0}, {1e9, 1e9}}};
  std::array<double, 6> b{4.0, 5e9};
  ASSERT_TRUE(solve_small(2, a, b));
  EXPECT_DOUBLE_EQ(b[0], 3.0);
  EXPECT_DOUBLE_EQ(b[1], 2.0);
  std::array<std::array<double, 6>, 6> singular{{{1.0, 2.0}, {2.0, 4.0}}};
  EXPECT_FALSE(solve_small(2, singular, b));
}

}  // namespace
}  // namespace repose::point

// Prescribed histories: a table becomes a path, and what is wrong with one is said.
#include "pointdriver/path/history.hpp"

#include <gtest/gtest.h>

#include "tests/pointdriver/test_material.hpp"

namespace repose::point {
namespace {

std::string message_of(std::string_view text) {
  try {
    history_path(parse_table(text, "h.csv"));
  } catch (const TableError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(History, a_measured_strain_path_is_followed) {
  const Law law = cam_clay(london(true));
  // loading, unloading, reloading in axial strain at constant radial stress
  PointTest test;
  test.path =
      history_path(parse_table("# a comment\n"
                               "time_s,eps_a_percent,sigma_r_kPa\n"
                               "0,0,100\n10,1,100\n20,0.8,100\n40,3,110\n",
                               "h.csv"));
  test.initial.p = 100e3;
  test.initial.ocr = 1.0;
  test.settings.method = Method::adaptive;
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::completed) << explain(*law.info, law.theta, test, curve);
  ASSERT_EQ(curve.rows.size(), 4u);
  const auto eps_a = column(law, test, curve, Quantity::eps_a);
  const auto sigma_r = column(law, test, curve, Quantity::sigma_r);
  const auto time = column(law, test, curve, Quantity::time);
  EXPECT_NEAR(eps_a[2], 0.008, 1e-15);
  EXPECT_NEAR(eps_a[3], 0.03, 1e-15);
  EXPECT_NEAR(sigma_r[2], 100e3, 1e-7);
  EXPECT_NEAR(sigma_r[3], 110e3, 1e-7);
  EXPECT_DOUBLE_EQ(time[3], 40.0);
}

TEST(History, says_what_is_wrong_and_where) {
  const std::string head = "time_s,eps_a,eps_r\n0,0,0\n";
  EXPECT_NE(message_of(head + "1,nan,0\n")
                .find("h.csv:3: column eps_a holds \"nan\", and a finite number is needed"),
            std::string::npos)
      << message_of(head + "1,nan,0\n");
  EXPECT_NE(message_of(head + "1,0\n").find("h.csv:3: 2 values, and the header names 3 columns"),
            std::string::npos);
  EXPECT_NE(message_of(head + "0,0.1,0\n").find("h.csv:3: time_s must grow"), std::string::npos);
  EXPECT_NE(message_of("eps_a,eps_r\n0,0\n").find("column time_s is missing"), std::string::npos);
  EXPECT_NE(message_of("time_s,eps_a\n0,0\n1,0\n").find("six are needed"), std::string::npos);
  EXPECT_NE(message_of("time_s,eps_a,sigma_r\n0,0,0\n1,0,0\n")
                .find("needs a unit of stress in its name: sigma_r_Pa or sigma_r_kPa"),
            std::string::npos);
  EXPECT_NE(message_of("time_s,eps_a_kPa,eps_r\n0,0,0\n1,0,0\n").find("is a strain"),
            std::string::npos);
  EXPECT_NE(message_of("time_s,epsa,eps_r\n0,0,0\n1,0,0\n").find("did you mean \"eps_a\"?"),
            std::string::npos);
  EXPECT_NE(message_of("time_s,eps_a,eps_a\n0,0,0\n").find("appears twice"), std::string::npos);
  EXPECT_NE(message_of("time_s,eps_a,eps_r\n").find("no rows"), std::string::npos);
  EXPECT_NE(message_of("").find("names no columns"), std::string::npos);
}

}  // namespace
}  // namespace repose::point

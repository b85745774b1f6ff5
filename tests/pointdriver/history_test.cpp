// Prescribed histories: a table becomes a path, and what is wrong with one is said.
#include "pointdriver/path/history.hpp"

#include <gtest/gtest.h>

#include "io/measured_table.hpp"
#include "tests/pointdriver/test_material.hpp"

namespace repose::point {
namespace {

/// The columns and numbers of a text, units left to the names.
Table table_of(const std::string& text) {
  const io::RawTable raw = io::parse_table(text, "h.csv");
  Table table;
  table.name = "h.csv";
  for (std::size_t c = 0; c < raw.columns(); ++c) {
    table.columns.push_back(raw.headers()[c].text);
    const io::MeasuredColumn column = io::read_column(
        raw, {.name = table.columns.back(), .number = static_cast<int>(c) + 1, .unit = "-"});
    table.values.push_back(column.values);
    table.lines = column.file_rows;
  }
  return table;
}

std::string message_of(const std::string& text) {
  try {
    history_path(table_of(text));
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
      history_path(table_of("# a comment\n"
                            "time_s,eps_a_percent,sigma_r_kPa\n"
                            "0,0,100\n10,1,100\n20,0.8,100\n40,3,110\n"));
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

/// Cam-Clay at p = 100 kPa driven along a table.
PointTest history_test(const std::string& text, HistoryIs is = HistoryIs::absolute,
                       StrainMeasure measure = StrainMeasure::logarithmic) {
  PointTest test;
  test.path = history_path(table_of(text), is, measure);
  test.initial.p = 100e3;
  test.initial.ocr = 1.0;
  test.settings.method = Method::adaptive;
  return test;
}

std::string start_refused(const Law& law, const PointTest& test) {
  try {
    check_start(*law.info, law.theta, test);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

// What a table of a laboratory means: its first row is the state that the test starts from.
TEST(History, a_first_row_that_contradicts_the_start_is_refused) {
  const Law law = cam_clay(london(true));
  const PointTest stress = history_test("time_s,eps_a_percent,sigma_r_kPa\n0,0,200\n1000,10,200\n");
  EXPECT_EQ(
      start_refused(law, stress),
      "h.csv:2: the first row says sigma_r_kPa = 200000 Pa, and the test starts at 100000 Pa: "
      "give the same stress in [initial], or history_is = \"change\" if only the differences "
      "count");
  EXPECT_EQ(run(law, stress).outcome.status, Status::bad_initial);
  const PointTest strain = history_test("time_s,eps_a,sigma_r_kPa\n0,0.02,100\n1000,0.1,100\n");
  EXPECT_EQ(start_refused(law, strain),
            "h.csv:2: the first row says eps_a = 0.02, and the test starts at 0: strains are zero "
            "at the start, or history_is = \"change\" if only the differences count");
  const PointTest both =
      history_test("time_s,sigma_a_kPa,sigma_r_kPa\n0,0,0\n100,100,100\n1000,200,100\n");
  EXPECT_NE(start_refused(law, both).find("sigma_a_kPa = 0 Pa, and the test starts at 100000 Pa"),
            std::string::npos);
}

TEST(History, changes_count_where_the_table_says_so) {
  const Law law = cam_clay(london(true));
  const PointTest test =
      history_test("time_s,eps_a,sigma_r_kPa\n0,0.02,200\n1000,0.1,210\n", HistoryIs::change);
  EXPECT_EQ(start_refused(law, test), "accepted");
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::completed);
  EXPECT_NEAR(column(law, test, curve, Quantity::eps_a).back(), 0.08, 1e-15);
  EXPECT_NEAR(column(law, test, curve, Quantity::sigma_r).back(), 110e3, 1e-7);
}

TEST(History, absolute_values_end_where_the_last_row_says) {
  const Law law = cam_clay(london(true));
  const PointTest test =
      history_test("time_s,sigma_a_kPa,sigma_r_kPa\n0,100,100\n100,110,105\n1000,130,105\n");
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::completed);
  EXPECT_NEAR(column(law, test, curve, Quantity::sigma_a).back(), 130e3, 1e-7);
  EXPECT_NEAR(column(law, test, curve, Quantity::sigma_r).back(), 105e3, 1e-7);
}

TEST(History, engineering_strains_are_followed) {
  const Law law = cam_clay(london(true));
  const PointTest test =
      history_test("time_s,eps_a,sigma_r_kPa\n0,0,100\n10,0.05,100\n20,0.12,100\n",
                   HistoryIs::absolute, StrainMeasure::engineering);
  const Curve curve = run(law, test);
  ASSERT_EQ(curve.outcome.status, Status::completed);
  const auto eps_a = column(law, test, curve, Quantity::eps_a);
  EXPECT_NEAR(eps_a[1], 0.05, 1e-15);
  EXPECT_NEAR(eps_a[2], 0.12, 1e-15);
  EXPECT_NEAR(-curve.rows[2].strain[1], -std::log(0.88), 1e-15);
}

TEST(History, a_strain_in_per_cent_under_a_plain_name_is_noticed) {
  EXPECT_NE(message_of("time_s,eps_a,eps_r\n0,0,0\n1,15,0\n")
                .find("h.csv:3: eps_a = 15 is a strain of 1500 %, beyond integration.max_strain = "
                      "10: a column in per cent is named eps_a_percent"),
            std::string::npos)
      << message_of("time_s,eps_a,eps_r\n0,0,0\n1,15,0\n");
}

TEST(History, says_what_is_wrong_and_where) {
  const std::string head = "time_s,eps_a,eps_r\n0,0,0\n";
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
}

}  // namespace
}  // namespace repose::point

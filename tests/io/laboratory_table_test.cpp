// Tables of the shapes that laboratories publish, with figures of our own.
#include <cmath>
#include <functional>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "io/measured_table.hpp"

namespace repose::io {
namespace {

/// A curve with the shape of an undrained test: strain [-], q and u [Pa].
struct Point {
  double eps, q, u;
};
std::vector<Point> curve() {
  std::vector<Point> points;
  for (int i = 1; i <= 20; ++i) {
    const double eps = 0.005 * i;
    points.push_back(
        {eps, 115e3 * (1.0 - std::exp(-140.0 * eps)), 123e3 * (1.0 - std::exp(-62.0 * eps))});
  }
  return points;
}

/// Eight digits, as the tables have them.
std::string digits(double x) { return fmt::format("{:.8g}", x); }
double as_written(double x) { return std::stod(digits(x)); }

using RowText = std::function<std::string(const Point&, char)>;

std::string rows(const RowText& row, char separator) {
  std::string text;
  for (const Point& p : curve()) text += row(p, separator) + "\n";
  return text;
}

std::string plain_row(const Point& p, char s) {
  return fmt::format("{}{}{}{}{}", digits(p.eps), s, digits(p.q), s, digits(p.u));
}

/// The three columns as curve() has them, whatever else the file holds.
void expect_curve(const std::string& text, std::size_t skip = 0, double factor_eps = 1.0,
                  double factor_q = 1.0) {
  const RawTable table = parse_table(text, "t.csv");
  const auto eps = read_column(table, {.name = "eps_a", .dimension = dimension::number});
  const auto q = read_column(table, {.name = "q_Pa", .dimension = dimension::stress});
  const auto u = read_column(table, {.name = "u_Pa", .dimension = dimension::stress});
  const std::vector<Point> points = curve();
  ASSERT_EQ(eps.values.size(), points.size() + skip);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(eps.values[i + skip], as_written(points[i].eps * factor_eps));
    EXPECT_EQ(q.values[i + skip], as_written(points[i].q * factor_q));
    EXPECT_EQ(u.values[i + skip], as_written(points[i].u * factor_q));
  }
}

TEST(LaboratoryTable, what_was_refused_before_is_read) {
  const std::string head = "eps_a,q_Pa,u_Pa\n", body = rows(plain_row, ',');
  expect_curve(head + body);
  expect_curve("\xEF\xBB\xBF" + head + body);                   // bom
  expect_curve("\xEF\xBB\xBF# lab 1\n" + head + body);          // bom_comment
  expect_curve("\"eps_a\",\"q_Pa\",\"u_Pa\"\n" + body);         // quoted
  expect_curve("eps_a;q_Pa;u_Pa\n" + rows(plain_row, ';'));     // semicolon
  expect_curve("eps_a\tq_Pa\tu_Pa\n" + rows(plain_row, '\t'));  // tab
  expect_curve(head + "-0.0002,0,0\n0,0,0\n" + body, 2);        // negfirst
  expect_curve("test_id,eps_a,q_Pa,u_Pa\n" +                    // testid
               rows([](const Point& p, char s) { return "CU1," + plain_row(p, s); }, ','));
  expect_curve("eps_a,q_Pa,u_Pa,B_value\n" +  // empty_unused
               rows([](const Point& p, char s) { return plain_row(p, s) + ","; }, ','));
  // percent_in_frac and kpa_in_pa: the file says Pa and no unit, and is believed
  expect_curve(head + rows(
                          [](const Point& p, char) {
                            return fmt::format("{},{},{}", digits(100 * p.eps), digits(p.q),
                                               digits(p.u));
                          },
                          ','),
               0, 100.0);
  expect_curve(head + rows(
                          [](const Point& p, char) {
                            return fmt::format("{},{},{}", digits(p.eps), digits(1e-3 * p.q),
                                               digits(1e-3 * p.u));
                          },
                          ','),
               0, 1.0, 1e-3);
}

TEST(LaboratoryTable, a_strain_that_steps_back_and_one_that_goes_on_are_rows_like_others) {
  std::string text = "eps_a,q_Pa,u_Pa\n" + rows(plain_row, ',');
  text += "0.0999,115000,123000\n0.12,115000,123000\n";  // jitter, beyond
  const MeasuredColumn eps = read_column(parse_table(text, "t.csv"), {.name = "eps_a"});
  ASSERT_EQ(eps.values.size(), 22u);
  EXPECT_EQ(eps.values[20], 0.0999);
  EXPECT_EQ(eps.max, 0.12);
}

/// Several specimens in one file, after a long comment with every mark in it.
TEST(LaboratoryTable, specimens_are_picked_by_their_name) {
  const RawTable table = parse_table(
      "# copy of {A7,F2}.csv ; G1 from G1.json, p'c = 399.67 kPa (nominal 400; total 900)\n"
      "LabID,Material,PointType,p_eff_kPa,VoidRatioShifted\n"
      "A7,K100,initial,18.99,1.329\nA7,K100,t100,47.5,1.269\nA7,K100,t100,95.75,1.21\n"
      "D1,K100,initial,20.1,1.348\nD1,K100,t100,48.2,1.304\nD1,K100,t100,1478.8,0.8425\n",
      "compression.csv");
  RowFilter filter;
  filter.where = {{"LabID", "D1"}, {"PointType", "t100"}};
  const auto p =
      read_column(table, {.name = "p_Pa", .from = "p_eff", .dimension = dimension::stress}, filter);
  const auto v = read_column(
      table,
      {.name = "v", .from = "VoidRatioShifted", .dimension = dimension::number, .offset = 1.0},
      filter);
  EXPECT_EQ(p.values, (std::vector<double>{48.2 * 1e3, 1478.8 * 1e3}));
  EXPECT_EQ(v.values, (std::vector<double>{1.304 + 1.0, 0.8425 + 1.0}));
  EXPECT_EQ(p.file_rows, (std::vector<int>{7, 8}));
  EXPECT_EQ(table.layout().header_row, 2);
  filter.first = 8;
  EXPECT_EQ(read_column(table, {.name = "p", .from = "p_eff_kPa"}, filter).values.size(), 1u);
}

/// Names padded by blanks, one of them with blanks inside, a row of units, data with tabs.
TEST(LaboratoryTable, padded_names_above_tabs) {
  const RawTable table = parse_table(
      "eps1        epsv         Void ratio    q           eta = q/p  \r\n"
      "[%]         [%]          [%]           [kPa]       [-]\r\n\r\n"
      "0\t0\t0.8177\t1.75\t0.01\r\n0.0133\t-0.0126\t0.8175\t9.5585\t0.0470\r\n0.0427\t0.0214\t0."
      "8173\t28.8415\t0.1376\r\n",
      "TMD.dat");
  EXPECT_EQ(table.layout().separator, Separator::tab);
  EXPECT_EQ(table.layout().unit_row, 2);
  EXPECT_EQ(table.layout().header_row, 1);
  const auto eps = read_column(table, {.name = "eps_a",
                                       .from = "eps1",
                                       .dimension = dimension::number,
                                       .sign = -1,
                                       .offset = 0.0012});
  EXPECT_EQ(eps.values[1], -(0.0133 * 1e-2) + 0.0012);
  EXPECT_EQ(eps.unit, "[%]");
  EXPECT_EQ(eps.unit_source, "row 2");
  // the file's unit is wrong, and the user knows
  const auto v = read_column(table, {.name = "v",
                                     .from = "Void ratio",
                                     .unit = "-",
                                     .dimension = dimension::number,
                                     .offset = 1.0});
  EXPECT_EQ(v.values[0], 0.8177 + 1.0);
  EXPECT_EQ(read_column(table, {.name = "q", .dimension = dimension::stress}).values[2],
            28.8415 * 1e3);
  EXPECT_EQ(read_column(table, {.name = "eta = q/p"}).values[0], 0.01);
}

TEST(LaboratoryTable, headers_in_odd_places) {
  // above it lines of a program, each a name and a value
  const RawTable gds = parse_table(
      "Hole Name:,BH1\nDepth,12.5\nTest number,3,\n\nStage Number,Axial Strain (%),Deviator Stress "
      "(kPa)\n1,0.5,10\n1,1.0,20\n2,1.5,30\n",
      "t.csv");
  EXPECT_EQ(gds.layout().header_row, 5);
  EXPECT_EQ(gds.layout().lines_above, 3);
  EXPECT_EQ(
      read_column(gds, {.name = "q", .from = "deviator stress", .dimension = dimension::stress})
          .values.back(),
      30e3);
  // in a comment
  const RawTable comment = parse_table("# made by hand\n# t q\n0 1\n1 2\n", "t.dat");
  EXPECT_TRUE(comment.layout().header_in_comment);
  EXPECT_EQ(read_column(comment, {.name = "q"}).values, (std::vector<double>{1, 2}));
  // a sign for the number
  const RawTable number = parse_table("#;t;q\n1;0;1\n2;1;2\n", "t.csv");
  EXPECT_EQ(read_column(number, {.name = "q"}).values, (std::vector<double>{1, 2}));
  EXPECT_EQ(number.headers()[0].text, "#");
  // nowhere
  const RawTable bare = parse_table("0.0;1\n1.0;2\n", "t.csv");
  EXPECT_EQ(bare.layout().header_row, 0);
  EXPECT_EQ(read_column(bare, {.name = "q", .number = 2}).values, (std::vector<double>{1, 2}));
  // where the caller says
  const RawTable forced = parse_table("1;2\n3;4\n", "t.csv", {.header_row = 1});
  EXPECT_EQ(read_column(forced, {.name = "2"}).values, (std::vector<double>{4}));
  // a line break inside a name, rows counted on
  const RawTable broken = parse_table("t,\"Axial\nstrain [%]\"\n0,1\n1,2\n", "t.csv");
  EXPECT_EQ(broken.headers()[1].text, "Axial strain [%]");
  EXPECT_EQ(broken.file_row(0), 3);
  // units with a per cent sign alone begin like a comment
  const RawTable percent = parse_table("eps;q\n%;kPa\n1;2\n", "t.csv");
  EXPECT_EQ(percent.layout().unit_row, 2);
  EXPECT_EQ(read_column(percent, {.name = "eps"}).values[0], 1 * 1e-2);
  // blank cells at the end, in names and rows
  const RawTable trailing = parse_table("t;q;\n0;1;\n1;2;\n", "t.csv");
  EXPECT_EQ(read_column(trailing, {.name = "q"}).values, (std::vector<double>{1, 2}));
}

TEST(LaboratoryTable, one_column_with_decimal_commas) {
  const RawTable table = parse_table("p\n1,5\n2,5\n", "t.csv");
  EXPECT_EQ(table.layout().separator, Separator::none);
  EXPECT_EQ(read_column(table, {.name = "p"}).values, (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(
      read_column(parse_table("1,5\n2,5\n", "t.csv", {.decimal = ','}), {.name = "p", .number = 1})
          .values,
      (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(read_column(parse_table("1,5\n2,5\n", "t.csv", {.separator = Separator::comma}),
                        {.name = "p", .number = 2})
                .values,
            (std::vector<double>{5, 5}));
  EXPECT_EQ(read_column(parse_table("a;b\n1;1,234\n", "t.csv", {.decimal = ','}), {.name = "b"})
                .values[0],
            1.234);
}

TEST(LaboratoryTable, a_long_line_and_many_columns) {
  std::string names, numbers;
  for (int i = 0; i < 20000; ++i) {
    names += fmt::format("{}c{}", i > 0 ? "," : "", i);
    numbers += fmt::format("{}{}", i > 0 ? "," : "", 0.5 * i);
  }
  const RawTable table =
      parse_table("# " + std::string(1 << 20, 'x') + "\n" + names + "\n" + numbers + "\n", "t.csv");
  EXPECT_EQ(table.columns(), 20000u);
  EXPECT_EQ(read_column(table, {.name = "c19999"}).values[0], 0.5 * 19999);
}

TEST(LaboratoryTable, numbers_at_the_ends_of_double) {
  const RawTable table = parse_table(
      "a\n1.7976931348623157e308\n4.9e-324\n-1e-400\n0.1" + std::string(500, '0') + "1\n", "t.csv");
  const MeasuredColumn a = read_column(table, {.name = "a"});
  EXPECT_EQ(a.values[0], std::numeric_limits<double>::max());
  EXPECT_EQ(a.values[1], std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(a.values[2], 0.0);
  EXPECT_EQ(a.values[3], 0.1);
}

TEST(LaboratoryTable, tells_how_it_was_understood) {
  const RawTable table = parse_table(
      "\xEF\xBB\xBFtitle\n# c\nAxial strain;q;v\n%;kPa;-\n-1,5;10,5;2\n-2,5;;2\n", "x.csv");
  EXPECT_EQ(describe(table),
            "x.csv: UTF-8 with byte-order mark, separator semicolon, decimal mark \",\", header in "
            "row 3, units in row 4, "
            "2 rows of data (5 to 6), 1 comment, 1 line above the header passed over");
  EXPECT_EQ(describe(read_column(
                table, {.name = "eps_a", .from = "Axial strain", .sign = -1, .offset = 0.0012})),
            "eps_a: column 1 \"Axial strain\", unit % (row 4), sign -1, plus 0.0012, 2 rows used, "
            "from 0.0162 to 0.0262 in SI");
  EXPECT_EQ(
      describe(read_column(
          table, {.name = "q_Pa", .from = "q", .unit = "kN/m2", .dimension = dimension::stress})),
      "q_Pa: column 2 \"q\", unit kN/m2 (given), 1 row used, 1 dropped (blank or nan), from 10500 "
      "to 10500 in SI");
  EXPECT_EQ(describe(read_column(table, {.name = "w", .optional = true})), "w: not in the file");
}

}  // namespace
}  // namespace repose::io

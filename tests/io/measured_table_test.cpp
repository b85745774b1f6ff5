// One small table in thousands of dialects: every one is read to the last bit, or refused with the
// row and the column.
#include "io/measured_table.hpp"

#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/io/table_writer.hpp"

namespace repose::io {
namespace {

ColumnSpec strain_spec(const Dialect& d) {
  return {.name = "strain",
          .unit = d.units == WrittenUnits::none ? "%" : "",
          .dimension = dimension::number};
}
ColumnSpec stress_spec(const Dialect& d) {
  return {.name = "q",
          .unit = d.units == WrittenUnits::none ? "kPa" : "",
          .dimension = dimension::stress};
}
ColumnSpec time_spec(const Dialect& d) {
  return {.name = "t",
          .unit = d.units == WrittenUnits::none ? "min" : "",
          .dimension = dimension::time};
}

/// What the dialect is to be read as; everything has been checked when this is true.
bool read_right(const Dialect& d, const Truth& truth, const WrittenTable& file) {
  const RawTable table = parse_table(file.bytes, "t.csv");
  EXPECT_EQ(table.layout().header_row, file.header_row);
  EXPECT_EQ(table.layout().unit_row, file.unit_row);
  EXPECT_EQ(table.layout().decimal, d.decimal);
  const char* separator = d.separator == ','   ? "comma"
                          : d.separator == ';' ? "semicolon"
                          : d.separator == ' ' ? "blanks"
                                               : "tab";
  EXPECT_EQ(name_of(table.layout().separator), separator);
  const auto check = [&](const ColumnSpec& spec, const std::vector<std::string>& raw, double factor,
                         bool gaps) {
    const MeasuredColumn column = read_column(table, spec);
    std::vector<double> values;
    std::vector<int> rows;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (gaps && (i == truth.gaps[0] || i == truth.gaps[1])) continue;
      values.push_back(std::strtod(raw[i].c_str(), nullptr) * factor);
      rows.push_back(file.rows[i]);
    }
    EXPECT_EQ(column.values, values) << spec.name;
    EXPECT_EQ(column.file_rows, rows) << spec.name;
    EXPECT_EQ(column.dropped, gaps ? 2u : 0u) << spec.name;
    EXPECT_EQ(column.min, *std::min_element(values.begin(), values.end()));
    EXPECT_EQ(column.max, *std::max_element(values.begin(), values.end()));
  };
  check(strain_spec(d), truth.strain, 1e-2, false);
  check(stress_spec(d), truth.stress, 1e3, false);
  check(time_spec(d), truth.time, 60.0, d.gaps > 0);
  if (d.text_column) {
    RowFilter filter;
    filter.where = {{"Lab\"ID\"", "A\"7\""}};
    EXPECT_EQ(read_column(table, strain_spec(d), filter).values.size(), 4u);
  }
  return !testing::Test::HasFailure();
}

/// Deterministic draws: all of the first kinds together, the others in turn.
class Dialects {
 public:
  template <class Visit>
  void each(int draws, const Visit& visit) {
    for (const char separator : {',', ';', '\t', ' '})
      for (const char decimal : {'.', ','})
        for (int encoding = 0; encoding < 7; ++encoding)
          for (const std::string_view line_end : {"\n", "\r\n", "\r"})
            for (int quotes = 0; quotes < 3; ++quotes)
              for (int draw = 0; draw < draws; ++draw) {
                Dialect d;
                d.separator = separator;
                d.decimal = decimal;
                d.encoding = static_cast<WrittenEncoding>(encoding);
                d.line_end = line_end;
                d.quotes = quotes;
                d.units = static_cast<WrittenUnits>(next(6));
                d.spelling = static_cast<Spelling>(next(6));
                d.comments = next(4);
                d.title = next(2) != 0;
                d.text_column = next(2) != 0;
                d.gaps = next(6);
                d.empty_lines = next(2) != 0;
                d.padded = next(3) == 0;
                d.last_line_end = next(4) != 0;
                // "0,5 , 1,5" can be told: blanks separate, and commas are a column
                if (separator == ',' && decimal == ',') d.padded = false;
                // blanks can neither hold an empty cell nor pad one
                if (separator == ' ' && d.gaps == 1 && quotes < 2) d.gaps = 2;
                visit(d);
              }
  }

 private:
  /// Park and Miller's generator, CACM 31 (1988) 1192.
  int next(int below) {
    state_ = state_ * 48271 % 2147483647;
    return static_cast<int>(state_ % below);
  }
  long long state_ = 20011;
};

/// A comma that separates and marks decimals at once needs quotes around the cells.
bool cannot_be_told(const Dialect& d) {
  return d.separator == ',' && d.decimal == ',' && d.quotes < 2;
}

TEST(MeasuredTable, every_dialect_is_read_to_the_last_bit_or_refused) {
  const Truth truth;
  int read = 0, refused = 0;
  Dialects().each(8, [&](const Dialect& d) {
    if (testing::Test::HasFailure()) return;
    SCOPED_TRACE(to_string(d));
    const WrittenTable file = written(truth, d);
    try {
      EXPECT_TRUE(read_right(d, truth, file)) << file.bytes;
      EXPECT_FALSE(cannot_be_told(d));
      ++read;
    } catch (const TableError& error) {
      EXPECT_TRUE(cannot_be_told(d)) << error.what() << "\n" << file.bytes;
      // a row of data that has more cells than names, and the column where they begin; or the
      // header, which has fewer names
      const bool at_data =
          std::find(file.rows.begin(), file.rows.end(), error.row()) != file.rows.end();
      EXPECT_TRUE(at_data || error.row() == file.header_row) << error.what();
      EXPECT_FALSE(error.cure().empty());
      ++refused;
    }
  });
  EXPECT_EQ(read + refused, 4 * 2 * 7 * 3 * 3 * 8);
  EXPECT_EQ(refused, 7 * 3 * 2 * 8);
}

/// A cell of the table is spoilt: the message names it.
TEST(MeasuredTable, a_bad_cell_is_named_in_every_dialect) {
  struct Defect {
    std::string cell_with_point, cause;
  };
  const std::vector<Defect> defects{{"broken", "\"broken\" is no number"},
                                    {"1e400", "exceeds what a double can hold"},
                                    {"inf", "is not finite"},
                                    {"12kPa", "\"12kPa\" is no number"}};
  int count = 0;
  Dialects().each(2, [&](Dialect d) {
    if (testing::Test::HasFailure() || cannot_be_told(d)) return;
    d.spelling = Spelling::plain;
    const Defect& defect = defects[static_cast<std::size_t>(count) % defects.size()];
    const std::size_t at = static_cast<std::size_t>(count++) % 4 + 1;
    Truth truth;
    truth.stress[at] = defect.cell_with_point;
    const WrittenTable file = written(truth, d);
    SCOPED_TRACE(to_string(d));
    try {
      const RawTable table = parse_table(file.bytes, "t.csv");
      read_column(table, strain_spec(d));  // another column, which is sound
      read_column(table, stress_spec(d));
      ADD_FAILURE() << "accepted";
    } catch (const TableError& error) {
      EXPECT_EQ(error.row(), file.rows[at]) << error.what();
      EXPECT_EQ(error.column().substr(0, 1), std::to_string(file.first + 2)) << error.what();
      EXPECT_NE(error.cause().find(defect.cause), std::string::npos) << error.what();
      EXPECT_FALSE(error.cure().empty());
    }
  });
  EXPECT_GT(count, 900);
}

/// Groups of three digits, in the marks of both halves of the world.
TEST(MeasuredTable, a_thousands_separator_is_named_in_every_dialect) {
  int count = 0;
  Dialects().each(1, [&](Dialect d) {
    if (testing::Test::HasFailure()) return;
    d.spelling = Spelling::plain;
    const char group = d.decimal == '.' ? ',' : '.';
    if (d.separator == ',' && d.quotes < 2) return;  // the cell would fall apart
    Truth truth;
    truth.stress[4] = "1" + std::string(1, '@') + "048.37";
    WrittenTable file = written(truth, d);
    const std::string mark =
        encoded("@", d.encoding == WrittenEncoding::utf8_mark  ? WrittenEncoding::utf8
                     : d.encoding == WrittenEncoding::utf16_le ? WrittenEncoding::utf16_le_bare
                     : d.encoding == WrittenEncoding::utf16_be ? WrittenEncoding::utf16_be_bare
                                                               : d.encoding);
    const std::size_t at = file.bytes.find('@');
    ASSERT_NE(at, std::string::npos);
    file.bytes[at] = group;
    SCOPED_TRACE(to_string(d));
    try {
      read_column(parse_table(file.bytes, "t.csv"), stress_spec(d));
      ADD_FAILURE() << "accepted";
    } catch (const TableError& error) {
      EXPECT_EQ(error.row(), file.rows[4]) << error.what();
      EXPECT_EQ(error.column().substr(0, 1), std::to_string(file.first + 2)) << error.what();
      EXPECT_NE(error.cause().find("has a thousands separator"), std::string::npos) << error.what();
      EXPECT_NE(error.cure().find("write the number without it"), std::string::npos)
          << error.what();
    }
    ++count;
  });
  EXPECT_GT(count, 380);
}

}  // namespace
}  // namespace repose::io

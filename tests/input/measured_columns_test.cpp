// Tables of fits and histories in the dialects of laboratories, with the keys that say how to read
// them: the numbers are the same to the last bit, and what is wrong is said.
#include <fstream>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "input/fit_table.hpp"
#include "input/history_table.hpp"
#include "input/read_keys.hpp"
#include "input/test_keys.hpp"
#include "io/atomic_file.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::input {
namespace {

class MeasuredTables : public testing::Test {
 protected:
  void write(const std::string& text) const {
    std::ofstream(scratch_.path() / "t.csv", std::ios::binary) << text;
  }
  InputFile file_with(const std::string& keys) const {
    return InputFile::parse(keys, (scratch_.path() / "f.toml").string());
  }
  /// q and u over eps_a, with the keys of a target.
  FitTable fit(const std::string& keys) {
    InputFile file =
        file_with("data = \"t.csv\"\n" + keys + "\nx = \"eps_a\"\ny = [\"q_Pa\", \"u_Pa\"]\n");
    const FitTable table = read(file);
    said_ = file.tables().empty() ? "" : file.tables().front();
    return table;
  }
  static FitTable read(InputFile& file) { return read(file, false).front(); }
  static std::vector<FitTable> read(InputFile& file, bool apart) {
    TomlReader target(file);
    TargetTable given;
    ReadKeys keys(target);
    target_keys(keys, given);
    std::vector<FitTable> tables = read_fit_tables(target, given, apart);
    file.throw_if_bad();
    return tables;
  }
  std::optional<point::Table> history(const std::string& keys) {
    InputFile file = file_with("kind = \"custom\"\nhistory = \"t.csv\"\n" + keys);
    TomlReader test(file);
    TestTable given;
    ReadKeys read_keys(test);
    test_keys(read_keys, given, {});
    auto table = read_history_table(test, given.history);
    file.throw_if_bad();
    said_ = file.tables().empty() ? "" : file.tables().front();
    return table;
  }
  template <class Read>
  static std::string complaint(const Read& read) {
    try {
      read();
    } catch (const BadInput& error) {
      return error.what();
    }
    return "accepted";
  }

  const ScratchFolder scratch_;
  std::string said_;
};

const std::string plain =
    "eps_a_percent,q_kPa,u_kPa\n0.5,57.25,33.5\n1,85.125,63.75\n2.5,108.5,104.25\n";

void expect_plain(const FitTable& table, int first_line) {
  EXPECT_EQ(table.x, (std::vector<double>{0.5 * 1e-2, 1 * 1e-2, 2.5 * 1e-2}));
  ASSERT_EQ(table.y.size(), 2u);
  EXPECT_EQ(table.y[0], (std::vector<double>{57250, 85125, 108500}));
  EXPECT_EQ(table.y[1], (std::vector<double>{33500, 63750, 104250}));
  EXPECT_EQ(table.lines, (std::vector<int>{first_line, first_line + 1, first_line + 2}));
  EXPECT_EQ(table.note, "");
}

TEST_F(MeasuredTables, of_a_fit_are_read_as_they_come) {
  write(plain);
  expect_plain(fit(""), 2);
  write(
      "\xEF\xBB\xBF# "
      "lab\r\neps_a;q;u\r\n%;kPa;kPa\r\n0,5;57,25;33,5\r\n1;85,125;63,75\r\n2,5;108,5;104,25\r\n");
  expect_plain(fit(""), 4);
  EXPECT_NE(
      said_.find("t.csv: UTF-8 with byte-order mark, separator semicolon, decimal mark \",\", "
                 "header in row 2, units in row 3, 3 rows of data (4 to 6), 1 comment\n"
                 "  eps_a: column 1 \"eps_a\", unit % (row 3), 3 rows used, from 0.005 to "
                 "0.025 in SI\n  q_Pa: column 2 \"q\", unit kPa (row 3)"),
      std::string::npos)
      << said_;
}

TEST_F(MeasuredTables, columns_where_and_rows_choose) {
  write(
      "LabID,Axial strain [%],\"Stress, deviatoric\",u,B\nD3,1,1,1,\nA7,-0.5,57.25,33.5,\n"
      "A7,-1,85.125,63.75,\nA7,-2.5,108.5,104.25,\n");
  const std::string columns =
      "columns = { eps_a = { from = \"axial strain\", sign = -1 }, q = { from = 3, unit = \"kPa\" "
      "}, "
      "u_Pa = { from = \"u\", unit = \"kN/m2\" } }\n";
  expect_plain(fit(columns + "where = { LabID = \"A7\" }"), 3);
  EXPECT_NE(said_.find("3 of 4 rows pass rows and where"), std::string::npos) << said_;
  expect_plain(fit(columns + "rows = [3, 5]"), 3);
  // eps = 1 - 2 (cell in SI)
  write(plain);
  EXPECT_EQ(fit("columns = { eps_a = { scale = 2, sign = -1, offset = 1 } }").x[0],
            -1.0 * 2.0 * (0.5 * 1e-2) + 1.0);
  // a text is a header
  write("a,b,c\n0.5,1,2\n0.6,1,2\n");
  EXPECT_EQ(
      fit("columns = { eps_a = \"a\", q = { from = \"b\", unit = \"Pa\" }, u = { from = \"c\", "
          "unit = \"bar\" } }")
          .y[1][0],
      2e5);
}

TEST_F(MeasuredTables, a_void_ratio_is_a_specific_volume) {
  write("p_kPa,e\n100,0.5\n200,0.25\n");
  const auto v = [&](const std::string& keys) {
    InputFile file = file_with("data = \"t.csv\"\n" + keys + "\nx = \"p_Pa\"\ny = \"v\"\n");
    return read(file).y.at(0);
  };
  EXPECT_EQ(v(""), (std::vector<double>{1.5, 1.25}));
  write("p_kPa,Void ratio [%]\n100,0.5\n200,0.25\n");
  EXPECT_EQ(v("columns = { e = { from = \"Void ratio\", unit = \"-\" } }"),
            (std::vector<double>{1.5, 1.25}));
  EXPECT_EQ(v("columns = { v = { from = \"Void ratio\", unit = \"-\", offset = 1 } }"),
            (std::vector<double>{1.5, 1.25}));
}

TEST_F(MeasuredTables, blank_cells_drop_their_rows_and_are_counted) {
  write("eps_a,q_Pa,u_Pa\n0.1,1,1\n0.2,,2\n0.3,3,nan\n0.4,4,4\n");
  const FitTable table = fit("");
  EXPECT_EQ(table.lines, (std::vector<int>{2, 5}));
  EXPECT_NE(table.note.find("t.csv: 2 rows left out, a compared cell is blank: 3, 4"),
            std::string::npos)
      << table.note;
  EXPECT_NE(said_.find(
                "u_Pa: column 3 \"u_Pa\", unit Pa (header), 3 rows used, 1 dropped (blank or nan)"),
            std::string::npos)
      << said_;
}

TEST_F(MeasuredTables, a_blank_cell_costs_its_own_channel_alone) {
  write("eps_a,q_Pa,u_Pa\n0.1,1,1\n0.2,,2\n0.3,3,nan\n0.4,4,4\n,5,5\n");
  const auto tables = [&](bool apart) {
    InputFile file = file_with("data = \"t.csv\"\nx = \"eps_a\"\ny = [\"q_Pa\", \"u_Pa\"]\n");
    return read(file, apart);
  };
  const std::vector<FitTable> two = tables(true);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].channels, (std::vector<std::string>{"q_Pa"}));
  EXPECT_EQ(two[0].lines, (std::vector<int>{2, 4, 5}));
  EXPECT_EQ(two[0].y[0], (std::vector<double>{1, 3, 4}));
  EXPECT_EQ(two[1].channels, (std::vector<std::string>{"u_Pa"}));
  EXPECT_EQ(two[1].lines, (std::vector<int>{2, 3, 5}));
  EXPECT_EQ(two[1].x, (std::vector<double>{0.1, 0.2, 0.4}));
  EXPECT_NE(two[0].note.find("each is compared over its own rows (q_Pa 3, u_Pa 3)"),
            std::string::npos)
      << two[0].note;
  EXPECT_EQ(tables(false).size(), 1u);
  // blank in the same rows: one table
  write("eps_a,q_Pa,u_Pa\n0.1,1,1\n0.2,,\n0.3,3,3\n");
  EXPECT_EQ(tables(true).size(), 1u);
}

TEST_F(MeasuredTables, what_is_wrong_in_a_fit_is_said) {
  write(plain);
  for (const auto& [keys, part] : std::vector<std::pair<std::string, std::string>>{
           {"columns = { epsa = { unit = \"%\" } }",
            "f.toml:2:13: columns.epsa: nothing asks for this quantity; did you mean 'eps_a'?"},
           {"columns = { eps_a = { form = \"x\" } }", "did you mean"},
           {"columns = { eps_a = { sign = 2 } }",
            "eps_a.sign = 2 must be 1 or -1; a factor is scale"},
           {"columns = { eps_a = { unit = \"kPa\" } }",
            "the unit kPa measures a stress, and eps_a is a number without dimension"},
           {"columns = { q = { from = \"qq\" } }", "there is no column \"qq\""},
           {"columns = { q = { from = 4 } }", "there is no column number 4"},
           {"rows = [5, 2]", "rows must be the first and the last row of the file"},
           {"rows = [500, 900]", "no data in rows 500 to 900; the file's rows of data are 2 to 4"},
           {"where = { Lab = \"A7\" }", "there is no column \"Lab\""},
           {"where = { q_kPa = [1] }", "must be the text or the number that the cell holds"},
           {"where = { q_kPa = 7 }", "column 2 (q_kPa): no row holds \"7\"; it holds \"57.25\""},
           {"separator = \"|\"", "separator must be \",\", \";\", \"tab\""},
           {"separator = \";\"", "there are no rows with numbers"},
           {"decimal = \";\"", "decimal must be \".\" or \",\""},
           {"from = 0.02", "has 1 rows with eps_a in the range that is compared"}}) {
    const std::string text = complaint([&, &written = keys] { fit(written); });
    EXPECT_NE(text.find(part), std::string::npos) << keys << "\n" << text;
    EXPECT_NE(text.find("f.toml:"), std::string::npos) << text;
  }
  write("eps_a,q,u_Pa\n0.1,1,1\n0.2,2,2\n");
  EXPECT_NE(complaint([&] { fit(""); }).find("the file names no unit, and q_Pa is a stress"),
            std::string::npos);
}

TEST_F(MeasuredTables, of_a_history_are_read_as_they_come) {
  write("time_s,eps_a_percent,sigma_r_kPa\n0,0,100\n30,1.25,100\n60,2.5,110\n");
  const auto plain_table = history("");
  ASSERT_TRUE(plain_table);
  EXPECT_EQ(plain_table->columns, (std::vector<std::string>{"time_s", "eps_a", "sigma_r_Pa"}));
  EXPECT_EQ(plain_table->values[1], (std::vector<double>{0, 1.25 * 1e-2, 2.5 * 1e-2}));
  EXPECT_EQ(plain_table->values[2], (std::vector<double>{100e3, 100e3, 110e3}));
  // a blank cell lies on the straight line between its neighbours
  write(
      "Laboratory\nLab;t;Axial strain;Cell pressure\n;min;%;kPa\nA;0,0;-0,0;100\nA;0,5;;100\n"
      "B;9;9;9\nA;1,0;-2,5;110\n");
  const std::string keys =
      "where = { Lab = \"A\" }\ncolumns = { time = \"t\", eps_a = { from = \"axial strain\", sign "
      "= -1 "
      "}, sigma_r = \"Cell pressure\" }\n";
  const auto other = history(keys);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->lines, (std::vector<int>{4, 5, 7}));
  for (std::size_t c = 0; c < 3; ++c) {
    const auto same =
        std::find(other->columns.begin(), other->columns.end(), plain_table->columns[c]);
    ASSERT_NE(same, other->columns.end());
    EXPECT_EQ(other->values[static_cast<std::size_t>(same - other->columns.begin())],
              plain_table->values[c]);
  }
  EXPECT_NE(complaint([&] { history(keys + "rows = [4, 5]"); })
                .find("row 5, column 3 (Axial strain) is blank, and a history needs its first and "
                      "its last row"),
            std::string::npos);
  EXPECT_NE(complaint([&] { history(keys + "decimal = \".\""); }).find("another decimal mark"),
            std::string::npos);
  write("time_s,eps_a_kPa,eps_r\n0,0,0\n1,0,0\n");
  EXPECT_NE(complaint([&] { history(""); }).find("measures a stress, and eps_a is a number"),
            std::string::npos);
  write("time_s,eps_a,sigma_r\n0,0,1\n1,0,1\n");
  EXPECT_NE(
      complaint([&] { history(""); }).find("the file names no unit, and sigma_r_Pa is a stress"),
      std::string::npos);
}

TEST_F(MeasuredTables, a_file_that_is_not_there_is_an_error_of_its_own) {
  EXPECT_THROW(fit(""), io::IoError);
}

}  // namespace
}  // namespace repose::input

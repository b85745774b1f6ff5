// What cannot be read: the message names row, column, cause and cure.
#include <gtest/gtest.h>

#include "io/measured_table.hpp"

namespace repose::io {
namespace {

using namespace std::string_literals;

struct Refusal {
  std::string text;
  int row;
  std::string column;  // how it starts; "" if none is named
  std::string cause, cure;
  TableFormat format{};
};

/// Reads everything there is, the stress first.
void read_all(const Refusal& r) {
  const RawTable table = parse_table(r.text, "t.csv", r.format);
  for (std::size_t i = table.columns(); i-- > 0;)
    read_column(table, {.name = "it", .number = static_cast<int>(i) + 1});
}

void check(const Refusal& r) {
  try {
    read_all(r);
    ADD_FAILURE() << "accepted:\n" << r.text;
  } catch (const TableError& error) {
    EXPECT_EQ(error.file(), "t.csv");
    EXPECT_EQ(error.row(), r.row) << error.what() << "\n" << r.text;
    EXPECT_EQ(error.column().substr(0, r.column.size()), r.column) << error.what();
    EXPECT_EQ(error.column().empty(), r.column.empty()) << error.what();
    EXPECT_NE(error.cause().find(r.cause), std::string::npos) << error.what();
    EXPECT_NE(error.cure().find(r.cure), std::string::npos) << error.what();
    const std::string what = error.what();
    EXPECT_NE(what.find(error.cause()), std::string::npos);
    EXPECT_NE(what.find(error.cure()), std::string::npos);
  }
}

TEST(TableRefusals, say_row_column_cause_and_cure) {
  const TableFormat comma{.separator = Separator::comma}, decimal_comma{.decimal = ','};
  const std::vector<Refusal> refusals{
      // nothing to read
      {"", 0, "", "the file is empty", "give a table"},
      {" \n\t\r\n", 0, "", "the file is empty", "give a table"},
      {"\xEF\xBB\xBF", 0, "", "the file is empty", "give a table"},
      {"a,b\n", 0, "", "no rows with numbers below the header", "rows that were measured"},
      {"# a,b\n", 0, "", "no rows with numbers", "rows that were measured"},
      {"a;b\nx;y\n", 0, "", "no rows with numbers", "rows that were measured"},
      // a sheet with decimal commas and one cell too many is still one of semicolons
      {"L;e [%];q [kPa]\nT1;0,00;0,0\nT1;0,51;57,9\nT1;0,99;87,2\nT1;1,99;115,3;7\nT1;5,02;1,0\n",
       5, "4", "4 cells, and the header in row 1 names 3 columns (separator: semicolon)",
       "name all columns"},
      // no text
      {"PK\x03\x04rest", 0, "", "this is a workbook (xlsx, ods)", "save the table as CSV"},
      {"\xD0\xCF\x11\xE0rest", 0, "", "an old Excel workbook", "save the table as CSV"},
      {"%PDF-1.7", 0, "", "a PDF document", "save the table as CSV"},
      {"\x1F\x8B\x08", 0, "", "compressed by gzip", "save the table as CSV"},
      {"a,b\n1,\0002\n"s, 2, "", "a NUL byte", "save the table as CSV"},
      {"a,b\n1,2\n\x01\n", 3, "", "a control character (0x01)", "save the table as CSV"},
      {"\xFF\xFE"
       "a",
       0, "", "odd number of bytes", "save the table as CSV"},
      {"\xFF\xFE"
       "a\0\n\0\x00\xD8"s,
       2, "", "half a character", "save the table as CSV"},
      {"\xFF\xFE\0\0"s, 0, "", "UTF-32", "save the table as CSV"},
      {"a,b\n\x81,2\n", 2, "", "neither UTF-8 nor Windows-1252", "save the table as CSV"},
      // rows of another length
      {"a,b\n1,2\n3\n", 3, "2 (b)", "1 cell, and the header in row 1 names 2 columns",
       "fill the row"},
      {"a,b\n1,2\n3,4,5\n6,7\n", 3, "3", "3 cells, and the header in row 1 names 2 columns",
       "a cell with commas needs quotes"},
      {"# c\n\na;b\n1;2\n3;4;5\n", 5, "3", "3 cells, and the header in row 3 names 2 columns",
       "put a cell that holds the separator in quotes"},
      {"a b\n1 2\n3 4 5\n", 3, "3", "3 cells", "name all columns"},
      {"a\tb\n1\t2\n3\n", 3, "2 (b)", "1 cell", "fill the row"},
      {"a,b\n0,5,1,5\n0,6,1,7\n", 1, "3", "2 cells here, and 4 in row 2 below (separator: comma)",
       "if commas are decimal marks, separate by semicolons"},
      {"a,b,c\n1,2\n3,4\n", 1, "3", "3 cells here, and 2 in row 2 below", "name every column"},
      {"1;2\n3;4\n5\n", 3, "2", "1 cell, and the first row of data has 2", "fill the row"},
      {"p,q\n1,000,5\n2,000,6\n", 1, "3", "2 cells here, and 3 in row 2 below",
       "name every column"},
      {"a,b\n1,2\nend of stage\n3,4\n", 3, "2 (b)", "1 cell", "start it with # if it is no data"},
      // quotes
      {"a,b\n1,2\n3,\"4\n", 3, "2", "a quote opens here and none closes it", "close it"},
      {"a,b\n1,\"2\n3,4\n5,6\n", 2, "2", "a quote opens here and none closes it", "close it"},
      // thousands and decimal marks
      {"a;b\n1;1,234.5\n2;5.5\n", 2, "2 (b)", "\"1,234.5\" has a thousands separator",
       "write the number without it"},
      {"a;b\n1;1.234,5\n2;5,5\n", 2, "2 (b)", "\"1.234,5\" has a thousands separator",
       "write the number without it"},
      {"a;b\n1;1.234.567\n2;5,5\n", 2, "2 (b)", "\"1.234.567\" has a thousands separator",
       "without it"},
      {"a;b\n1;1 234\n2;5.5\n", 2, "2 (b)", "\"1 234\" has a thousands separator", "without it"},
      {"a;b\n1;1'234.5\n2;5.5\n", 2, "2 (b)", "has a thousands separator", "without it"},
      {"a;b\n1;1\u00A0234\n2;5.5\n", 2, "2 (b)", "has a thousands separator", "without it"},
      {"a;b\n1.5;1,234\n2.5;1,500\n", 2, "2 (b)",
       "\"1,234\" has a thousands separator (decimal mark of the file: \".\")",
       "or give decimal = \",\""},
      {"a;b\n1,5;1.234\n2,5;1.500\n", 2, "2 (b)",
       "\"1.234\" has a thousands separator (decimal mark of the file: \",\")",
       "or give decimal = \".\""},
      {"a;b\n1;1,234\n2;5,678\n", 2, "2 (b)", "is a thousand times as much if its comma stands",
       "give decimal = \",\""},
      {"a;b\n1;1,234\n2;5.678\n", 2, "2 (b)", "no cell of the file tells",
       "give decimal = \",\" or decimal = \".\""},
      {"a;b\n0,5;1\n0.5;2\n", 2, "1 (a)",
       "both marks are in use: \"0,5\" here, and \"0.5\" in row 3",
       "decimal = \",\" or decimal = \".\""},
      {"a;b\n0,5;1\n0.5;2\n", 3, "1 (a)", "\"0.5\" has another decimal mark than the rest",
       "write one of them everywhere", decimal_comma},
      {"1,5\n2,6\n", 1, "", "a comma may separate columns or be the decimal mark",
       "give separator = \",\" or decimal = \",\""},
      {"a;b\n1,;2\n2,;3\n", 2, "1 (a)", "\"1,\" is no number", "finish the number"},
      // numbers
      {"a,b\n1,1e309\n2,3\n", 2, "2 (b)", "\"1e309\" exceeds what a double can hold",
       "leave the cell empty"},
      {"a,b\n1,-1d+4000\n2,3\n", 2, "2 (b)", "exceeds what a double can hold",
       "leave the cell empty"},
      {"a,b\n1,"s + std::string(400, '9') + "\n2,3\n", 2, "2 (b)", "exceeds what a double can hold",
       ""},
      {"a,b\n1,-inf\n2,3\n", 2, "2 (b)", "\"-inf\" is not finite", "leave the cell empty"},
      {"a,b\n1,x\n2,3\n", 2, "2 (b)", "\"x\" is no number", "rows or where"},
      {"a,b\n1,12 %\n2,3\n", 2, "2 (b)", "\"12 %\" is no number", "the unit in the header"},
      {"a,b\n1,0x10\n2,3\n", 2, "2 (b)", "\"0x10\" is no number", "leave the cell empty"},
      {"a,b\n1,1e\n2,3\n", 2, "2 (b)", "\"1e\" is no number", "leave the cell empty"},
      {"a,b\n1,.\n2,3\n", 2, "2 (b)", "\".\" is no number", "leave the cell empty"},
      {"a,b\n1,1 2\n2,3\n", 2, "2 (b)", "\"1 2\" is no number", "leave the cell empty"},
      {"a,b\n1,--5\n2,3\n", 2, "2 (b)", "\"--5\" is no number", "leave the cell empty"},
      {"a,b\n1,2016-03-12\n2,3\n", 2, "2 (b)", "is no number", "leave the cell empty"},
      // what a caller forces
      {"a;b\n1;2\n", 0, "", "no rows with numbers", "rows that were measured", comma},
      {"a,b\n1,2\n", 7, "", "this row has no text", "from 1", {.header_row = 7}},
  };
  for (const Refusal& r : refusals) check(r);
}

std::string message_of(const RawTable& table, const ColumnSpec& spec,
                       const RowFilter& filter = {}) {
  try {
    read_column(table, spec, filter);
  } catch (const TableError& error) {
    return error.what();
  }
  return "accepted";
}

void expect_in(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(TableRefusals, columns_and_their_units) {
  const RawTable table = parse_table(
      "Axial strain [%],q (kPa),q_MPa,u,odd [kPAA],twice,twice,,e_min\n1,2,3,4,5,6,7,8,9\n",
      "t.csv");
  using namespace dimension;
  expect_in(message_of(table, {.name = "Axial stain"}),
            "there is no column \"Axial stain\"; did you mean \"Axial strain\"");
  expect_in(message_of(table, {.name = "zzz"}),
            "its columns are 1 (Axial strain [%]), 2 (q (kPa)), 3 (q_MPa)");
  expect_in(message_of(table, {.name = "q"}),
            "2 columns are called \"q\": numbers 2 and 3; give the column's number: from = 2");
  expect_in(message_of(table, {.name = "twice"}),
            "t.csv:1: column 7 (twice): 2 columns are called \"twice\": numbers 6 and 7");
  expect_in(message_of(table, {.name = "u", .dimension = stress}),
            "t.csv:1: column 4 (u): the file names no unit, and u is a stress; give the unit for "
            "u, one of Pa, kPa, MPa");
  expect_in(message_of(table, {.name = "odd", .dimension = stress}),
            "column 5 (odd [kPAA]): \"kPAA\" is no unit that is known; did you mean \"kPa\"");
  expect_in(message_of(table, {.name = "u", .unit = "kpascal", .dimension = stress}),
            "\"kpascal\" is no unit that is known");
  expect_in(message_of(table, {.name = "u", .unit = "mPa", .dimension = stress}),
            "\"mPa\" is no unit that is known; did you mean \"MPa\"");
  expect_in(message_of(table, {.name = "Axial strain", .dimension = stress}),
            "the unit % that the file names measures a number without dimension (a strain, a void "
            "ratio), and Axial strain is a stress");
  expect_in(message_of(table, {.name = "u", .unit = "mm", .dimension = stress}),
            "the unit mm measures a length, and u is a stress");
  expect_in(message_of(table, {.name = "x", .number = 10}), "there is no column number 10");
  EXPECT_EQ(message_of(table, {.name = "blank", .number = 8}), "accepted");
  EXPECT_EQ(message_of(table, {.name = "e_min", .dimension = dimension::number}),
            "accepted");  // a void ratio, not minutes
  expect_in(message_of(table, {.name = "e", .dimension = dimension::number}),
            "there is no column \"e\"");
  EXPECT_EQ(message_of(table, {.name = "zzz", .optional = true}), "accepted");
  EXPECT_FALSE(read_column(table, {.name = "zzz", .optional = true}).present);
}

TEST(TableRefusals, rows_and_conditions) {
  const RawTable table = parse_table("LabID,p\nA7,1\nA7,2\nD1,3\n", "t.csv");
  expect_in(message_of(table, {.name = "p"}, {.where = {{"LabID", "A8"}}}),
            "t.csv: column 1 (LabID): no row holds \"A8\"; it holds \"A7\", \"D1\"");
  expect_in(message_of(table, {.name = "p"}, {.where = {{"Lab", "A7"}}}),
            "there is no column \"Lab\"; did you mean \"LabID\"?");
  expect_in(message_of(table, {.name = "p"}, {.first = 9}), "no data in rows 9 to");
  expect_in(message_of(table, {.name = "p"}, {.first = 9}), "the file's rows of data are 2 to 4");
}

}  // namespace
}  // namespace repose::io

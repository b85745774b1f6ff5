#pragma once
/// \file
/// Measured columns in SI units from a table as a laboratory writes it. One reader for all of them:
/// load_table() and then read_column() with {.name = "q_Pa", .from = "Deviator stress", .unit =
/// "kPa", .dimension = dimension::stress}.

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "io/raw_table.hpp"
#include "io/units.hpp"

namespace repose::io {

/// A column that is wanted: value = sign · scale · (cell in SI) + offset.
struct ColumnSpec {
  std::string name;  ///< what it is for, in messages and reports; and the column if `from` is empty
  std::string from{};                    ///< header in the file, with or without its unit
  int number = 0;                        ///< or the column's number, from 1
  std::string unit{};                    ///< empty: the file's own
  std::optional<Dimension> dimension{};  ///< what the unit must measure; none: any, and no unit too
  double sign = 1.0;                     ///< 1 or -1
  double scale = 1.0;
  double offset = 0.0;    ///< in SI, added at last
  bool optional = false;  ///< no column of that name is no error
};

/// Rows that are read. All conditions hold together.
struct RowFilter {
  struct Equals {
    std::string column;  ///< as ColumnSpec::from
    std::string text;    ///< the cell; numbers are compared by value, 9 = 9.0
  };
  std::vector<Equals> where{};
  int first = 1;  ///< rows of the file, as an editor or a spreadsheet counts
  int last = std::numeric_limits<int>::max();
};

struct MeasuredColumn {
  std::string name;         ///< as in ColumnSpec
  std::string header;       ///< as in the file; empty if an optional column is absent
  std::size_t column = 0;   ///< from 0
  std::string unit;         ///< as it was understood: "kPa", "-"
  std::string unit_source;  ///< "given", "row 2", "header", "none in the file"
  double sign = 1.0, scale = 1.0, offset = 0.0;
  std::vector<double> values;                             ///< SI
  std::vector<int> file_rows;                             ///< of each value
  std::size_t dropped = 0;                                ///< rows whose cell is blank or nan
  double min = std::numeric_limits<double>::quiet_NaN();  ///< of the values
  double max = std::numeric_limits<double>::quiet_NaN();
  bool present = false;  ///< false: an optional column that the file lacks
};

/// The column of a header: the whole text, or else the text without its unit, or else either
/// without regard to letter case and blanks. What follows the last low line of a name is a unit
/// without doubt only if it measures `dimension`: "e" is not found as e_min, "t" is as t_min if a
/// time is wanted. None if there is none. Throws TableError if several columns fit equally well.
std::optional<std::size_t> find_column(const RawTable& table, std::string_view header,
                                       const std::optional<Dimension>& dimension = {});

/// Rows of the table (from 0) that pass. Throws TableError for a column that does not exist, and if
/// no row passes (with what the column holds).
std::vector<std::size_t> select_rows(const RawTable& table, const RowFilter& filter);

/// Throws TableError with row, column, cause and cure: no such column (with the nearest names), a
/// unit that is unknown, or that measures something else, or that is needed and named nowhere; a
/// cell that is text, has separators between thousands or the other decimal mark, or exceeds
/// double.
MeasuredColumn read_column(const RawTable& table, const ColumnSpec& spec,
                           const RowFilter& filter = {});
/// The same on rows that were selected before.
MeasuredColumn read_column(const RawTable& table, const ColumnSpec& spec,
                           const std::vector<std::size_t>& rows);

/// How the file was understood, one line; and one line per column that was read.
std::string describe(const RawTable& table);
std::string describe(const MeasuredColumn& column);

}  // namespace repose::io

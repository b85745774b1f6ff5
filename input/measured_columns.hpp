#pragma once
/// \file
/// A measured table that an input file names, with the keys beside it that say how it is to be
/// read:
///     separator = ";"   decimal = ","   header_row = 3   (as a rule found from the file)
///     columns = { eps_a = { from = "Axial strain", unit = "%", sign = -1, offset = 0.0012 } }
///     where = { LabID = "A7" }   rows = [2, 40]

#include <filesystem>
#include <map>
#include <optional>

#include "input/keys.hpp"
#include "input/toml_reader.hpp"
#include "io/measured_table.hpp"

namespace repose::input {

/// Tells of the keys that may stand beside a table, where keys are told of.
void describe_table_keys(Keys& keys);

class MeasuredColumns {
 public:
  /// Reads the table that `key` names ("data", "history"; file: its value, "" if it is missing) and
  /// the keys beside it. What is wrong is reported; then usable() is false. Errors: IoError if the
  /// file cannot be read.
  MeasuredColumns(TomlReader& reader, std::string_view key, const std::string& file);

  bool usable() const { return table_.has_value(); }
  const io::RawTable& table() const { return *table_; }
  /// Rows of the table that pass `rows` and `where`.
  const std::vector<std::size_t>& rows() const { return rows_; }
  /// Quantities that `columns` names, as written there.
  std::vector<std::string> chosen() const;

  /// A quantity as a simulation names it, "q_Pa", in SI units: the entry of `columns` of that name
  /// (with or without the unit), or else the column of that name in any unit of its dimension; v is
  /// also found as e, 1 + e. What is wrong is reported at the key `at`.
  std::optional<io::MeasuredColumn> read(const std::string& quantity, std::string_view at);

  /// Adds what was read, and how, to the input file's tables; reports entries of `columns` that
  /// nothing asked for.
  void finish();

 private:
  void read_columns(TomlReader& reader);
  void read_filter(TomlReader& reader);
  io::TableFormat read_format(TomlReader& reader);

  TomlReader* reader_;
  std::string key_;
  std::optional<io::RawTable> table_;
  io::RowFilter filter_;
  std::vector<std::size_t> rows_;
  std::map<std::string, io::ColumnSpec> columns_;
  std::map<std::string, bool> asked_for_;
  std::vector<std::string> lines_;  ///< what is told of the columns
};

}  // namespace repose::input

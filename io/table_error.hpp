#pragma once
/// \file
/// Why a table cannot be used, where, and how to mend it.

#include <stdexcept>
#include <string>

namespace repose::io {

/// what(): "lab.csv:12: column 3 (q): \"1,234.5\" has a thousands separator; write 1234.5".
class TableError : public std::runtime_error {
 public:
  /// row: of the file, as an editor or a spreadsheet counts, from 1; 0 where no row is to blame.
  /// column: its number from 1 with its name, "3 (q)"; empty where no column is to blame.
  TableError(std::string file, int row, std::string column, std::string cause, std::string cure)
      : std::runtime_error(file + (row > 0 ? ":" + std::to_string(row) : "") + ": " +
                           (column.empty() ? "" : "column " + column + ": ") + cause +
                           (cure.empty() ? "" : "; " + cure)),
        file_(std::move(file)),
        row_(row),
        column_(std::move(column)),
        cause_(std::move(cause)),
        cure_(std::move(cure)) {}

  const std::string& file() const { return file_; }
  int row() const { return row_; }
  const std::string& column() const { return column_; }
  const std::string& cause() const { return cause_; }
  const std::string& cure() const { return cure_; }

 private:
  std::string file_;
  int row_;
  std::string column_, cause_, cure_;
};

}  // namespace repose::io

#pragma once
/// \file
/// A measured table as its file has it: names, units, cells, and how the file was understood.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/cell_splitter.hpp"
#include "io/table_error.hpp"
#include "io/text_decoding.hpp"

namespace repose::io {

/// What a caller wants in place of what the file looks like.
struct TableFormat {
  Separator separator = Separator::detect;
  char decimal = 0;                 ///< '.' or ','; 0: to be detected
  std::optional<int> header_row{};  ///< of the file, from 1; 0: no header
};

/// "comma" or ",", "semicolon" or ";", "tab" or "\t", "blanks" or " ", "none".
std::optional<Separator> find_separator(std::string_view text);

/// How a file was understood.
struct TableLayout {
  Encoding encoding = Encoding::utf8;
  Separator separator = Separator::comma;
  char decimal = '.';
  int header_row = 0;              ///< of the file; 0: it has none
  bool header_in_comment = false;  ///< the names stand in a comment
  int unit_row = 0;                ///< 0: none
  int lines_above = 0;             ///< lines above the header that are no comments
  int comments = 0;                ///< lines that start with #, % or //
};

struct ColumnHeader {
  std::string text;  ///< as in the file: "Axial strain [%]"; empty if the column has no name
  std::string name;  ///< without the unit: "Axial strain"
  std::string unit;  ///< as the file writes it, from its row of units or the header; may be empty
  bool unit_in_name = false;  ///< the unit is the end of a word: "q_kPa"
};

class RawTable {
 public:
  const std::string& file() const { return file_; }
  const TableLayout& layout() const { return layout_; }
  const std::vector<ColumnHeader>& headers() const { return headers_; }
  std::size_t columns() const { return headers_.size(); }
  std::size_t rows() const { return records_.size(); }
  /// Row of the file, from 1.
  int file_row(std::size_t row) const { return records_[row].row; }
  std::string_view cell(std::size_t row, std::size_t column) const {
    return storage_->cells.cell(records_[row], column);
  }
  /// "3 (q)": a column in a message.
  std::string column_title(std::size_t column) const;

 private:
  friend RawTable parse_table(std::string, std::string, const TableFormat&);
  struct Storage {
    std::string text;
    CellList cells;
  };
  std::string file_;
  TableLayout layout_;
  std::vector<ColumnHeader> headers_;
  std::vector<Record> records_;
  std::shared_ptr<const Storage> storage_;
};

/// Finds separator, decimal mark, header and row of units by these rules, from the whole file:
///
/// 1. Lines without text, and those that start with #, % or //, do not count.
/// 2. Each separator (semicolon, tab, comma, blanks, none) is tried. A row of data has at least one
///    number and as many cells as most such rows. The header is the first row without a number, as
///    wide as these, that such a row follows, directly or below a row of units. The separator that
///    agrees with the header and with every row wins, then the one that makes most of the text
///    numbers, then the first of the list.
/// 3. If all commas and points stand once and in front of three digits, or if without a header
///    "1,5" may be one cell or two, nothing tells what they mean: the file is refused. Otherwise a
///    comma that cannot stand between groups of three digits (0,5 or 12,34) makes the comma the
///    decimal mark, which the point is in any other case.
/// 4. The row below the header is one of units if all its cells are: "[kPa]", "(%)", "kPa", "-".
/// 5. Without a header of its own a file may have one in the last comment above the data.
///
/// Throws TableError for what decode_text() refuses, a file without text, no names and no numbers,
/// no rows, rows of another length than the header (blank cells at the end do not count), a quote
/// that does not end, and where rule 3 leaves it open.
RawTable parse_table(std::string bytes, std::string file, const TableFormat& format = {});

/// The same from a file. Throws IoError if it cannot be read.
RawTable load_table(const std::filesystem::path& file, const TableFormat& format = {});

}  // namespace repose::io

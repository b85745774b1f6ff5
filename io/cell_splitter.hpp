#pragma once
/// \file
/// Lines of text become records of cells.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace repose::io {

enum class Separator : std::uint8_t { detect, comma, semicolon, tab, blanks, none };

/// "comma", "semicolon", "tab", "blanks", "none (one column)".
std::string_view name_of(Separator separator);

/// One line that is not empty, or several where a quoted cell holds line breaks.
struct Record {
  int row = 0;                       ///< of the file, from 1; the first of several
  std::size_t begin = 0, count = 0;  ///< of CellList::cells
  bool comment = false;              ///< starts with #, % or //
  std::string_view line;             ///< as it stands in the file
};

/// Cells point into the text that was split, or into `rewritten` where quotes were doubled.
struct CellList {
  std::vector<Record> records;
  std::vector<std::string_view> cells;
  std::vector<std::unique_ptr<const std::string>> rewritten;  // which moving leaves in place
  int open_quote_row = 0;           ///< where a quoted cell starts that does not end; 0: nowhere
  std::size_t open_quote_cell = 0;  ///< its number in the record, from 0

  std::string_view cell(const Record& record, std::size_t i) const {
    return cells[record.begin + i];
  }
};

/// Splits at CR, LF or CRLF and then at the separator (not `detect`). Cells lose the blanks around
/// them; a cell that starts with a quote ends at the next one that is not doubled, up to 20 lines
/// later, if the separator or the line's end follows; any other quote is a character. Lines without
/// text, or with separators only, are no records.
CellList split_cells(std::string_view text, Separator separator);

/// The cells of one line in columns padded by blanks: two or more, or a tab, separate.
std::vector<std::string_view> split_padded(std::string_view line);
/// At every run of blanks and tabs.
std::vector<std::string_view> split_blanks(std::string_view line);

/// The line's text after the mark of a comment.
std::string_view comment_text(std::string_view line);

}  // namespace repose::io

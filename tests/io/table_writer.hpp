#pragma once
// Writes one small known table in any of the spellings that laboratories and their programs use.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace repose::io {

enum class WrittenUnits : std::uint8_t { brackets, parentheses, in_word, row, bracket_row, none };
enum class Spelling : std::uint8_t { plain, plus, exponent, fortran, unicode_minus, short_form };
enum class WrittenEncoding : std::uint8_t {
  utf8,
  utf8_mark,
  utf16_le,
  utf16_be,
  utf16_le_bare,
  utf16_be_bare,
  windows_1252,
};

struct Dialect {
  char separator = ',';  // ' ': blanks
  char decimal = '.';
  WrittenEncoding encoding = WrittenEncoding::utf8;
  std::string_view line_end = "\n";
  int quotes = 0;  // 0: none, 1: names, 2: all cells
  WrittenUnits units = WrittenUnits::brackets;
  Spelling spelling = Spelling::plain;
  int comments = 0;    // 0: none, 1: #, 2: %, 3: //
  bool title = false;  // lines above the header
  bool text_column = false;
  int gaps = 0;  // in the last column: 0 none, 1 blank, 2 nan, 3 NA, 4 -, 5 en dash
  bool empty_lines = false;
  bool padded = false;  // blanks around cells
  bool last_line_end = true;
};

/// The table's numbers, as written with a point: strain in %, stress in kPa, time in min.
struct Truth {
  std::vector<std::string> strain{"-0.02", "0", "0.5", "1.25", "2.5", "10"};
  std::vector<std::string> stress{"-1.3", "0.75", "57.199402", "85.985213", "1048.3796", "114.8"};
  std::vector<std::string> time{"0", "1", "2.5", "30", "600.25", "86400"};
  /// Rows (from 0) whose time is left out where the dialect has gaps.
  std::vector<std::size_t> gaps{1, 4};
};

struct WrittenTable {
  std::string bytes;
  std::vector<int> rows;  // of the file, of each row of data
  int header_row = 0;
  int unit_row = 0;       // 0: none
  std::size_t first = 0;  // number of columns before the strain
};

std::string encoded(const std::string& utf8, WrittenEncoding encoding);
std::string respelled(const std::string& number, Spelling spelling, char decimal);
WrittenTable written(const Truth& truth, const Dialect& dialect);
std::string to_string(const Dialect& dialect);

}  // namespace repose::io

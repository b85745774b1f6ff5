#pragma once
/// \file
/// What a cell's text is: a number in one of its many spellings, nothing measured, or text.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace repose::io {

/// A cell as messages show it: in quotes, cut after 40 characters.
std::string shown(std::string_view cell);

/// A text as a cell of a CSV table: in quotes where it needs them (RFC 4180).
std::string csv_cell(std::string text);

/// To two significant digits, any double: "about" figures must not look exact.
double two_digits(double x);

/// A whole number with a space between thousands: 12 345 678.
std::string grouped(double x);

/// Without blanks, tabs and no-break spaces around it.
std::string_view trimmed(std::string_view text);

enum class CellKind : std::uint8_t {
  blank,
  missing,     ///< nan, NA, n/a, #N/A, null, -, --, en and em dash
  not_finite,  ///< inf
  number,      ///< with at most one mark
  grouped,     ///< digits in groups of three: 1,234.5  1.234.567  1 234  1'234
  text,
};

struct CellShape {
  CellKind kind = CellKind::blank;
  char mark = 0;  ///< '.' or ',' of a number, 0 if it has none; of a grouped number the
                  ///< mark that cannot stand between groups
  bool may_be_grouped = false;  ///< a number like 1,234 or 1.234: a whole one with groups as well
};

/// Numbers: an optional sign (+, -, Unicode minus, en dash), digits, at most one mark, digits, an
/// optional exponent (e, E, d, D). "1." and ".5" count; "1," does not.
CellShape shape_of(std::string_view cell);

/// The value of a number whose mark is `mark` ('.' or ','); none if it exceeds double. A value
/// below the smallest double is 0. Only for cells of kind number with that mark or none.
std::optional<double> value_of(std::string_view cell, char mark);

}  // namespace repose::io

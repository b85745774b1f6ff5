#pragma once
/// \file
/// How the records of a table are to be read: which is the header, which are data.

#include <optional>
#include <string_view>
#include <vector>

#include "io/cell_splitter.hpp"
#include "io/number_text.hpp"

namespace repose::io {

/// How well one separator explains the file; smaller is better.
enum class Fit : std::uint8_t {
  whole,      ///< header and every row agree
  mostly,     ///< the header and at least half of the rows agree
  no_header,  ///< rows agree, and nothing names them
  poor,       ///< rows with numbers, of many lengths, or under a header of another length
  doubtful,   ///< one column, and its header has separators in it
  none,       ///< no number anywhere
};

/// One reading of the file.
struct Reading {
  Separator separator = Separator::none;
  CellList list;
  Fit fit = Fit::none;
  std::size_t width = 0;                     ///< columns
  std::size_t numbers_size = 0;              ///< characters that belong to numbers
  std::optional<std::size_t> header, units;  ///< records
  std::optional<std::size_t> first_data;     ///< record
  bool header_in_comment = false;
  std::vector<std::string_view> names, unit_texts;
};

/// Splits and judges; `decimal` and `header_row` as in TableFormat.
Reading read_as(std::string_view text, Separator separator, char decimal,
                std::optional<int> header_row);

/// Does the record have as many cells as the table has columns? Blank ones at the end do not count.
bool has_width(const CellList& list, const Record& record, std::size_t width);

/// Are all cells units, blank or "-", at least one of them a unit?
bool are_units(const std::vector<std::string_view>& cells);

}  // namespace repose::io

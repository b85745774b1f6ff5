#pragma once
/// \file
/// A measured table of a fit: the columns that are compared, in SI units, cut and shifted.

#include <string>
#include <vector>

#include "input/fit_keys.hpp"
#include "input/toml_reader.hpp"

namespace repose::input {

/// Rows that are compared, SI units.
struct FitTable {
  std::vector<std::string> channels;  ///< of the target's y, those that these rows have
  std::vector<double> x;
  std::vector<std::vector<double>> y;  ///< per channel
  std::vector<int> lines;              ///< of the file
  std::string note;                    ///< rows that were left out, and why; may be empty
};

/// Reads the columns x and y off the target's `data` (measured_columns.hpp), keeping rows with
/// from <= x <= to, after adding x_shift. A row without x is left out. Where a channel is blank in
/// some of the rows and another is not, each channel has a table of its own, with all of its rows,
/// if `apart` allows it; otherwise a row that lacks one is left out. Reports what is wrong and
/// returns a table without rows then.
std::vector<FitTable> read_fit_tables(TomlReader& target, const TargetTable& given, bool apart);

}  // namespace repose::input

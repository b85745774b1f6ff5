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
  std::vector<double> x;
  std::vector<std::vector<double>> y;  ///< per channel
  std::vector<int> lines;              ///< of the file
  std::string note;                    ///< rows that were left out, and why; may be empty
};

/// Reads the columns x and y off the target's `data` (measured_columns.hpp), keeping rows with
/// from <= x <= to, after adding x_shift. A row in which x or a channel is blank is left out.
/// Reports what is wrong and returns no rows then.
FitTable read_fit_table(TomlReader& target, const TargetTable& given);

}  // namespace repose::input

#pragma once
/// \file
/// A measured table of a fit: columns with units in their names, cut and shifted.

#include <filesystem>

#include "input/fit_keys.hpp"
#include "input/toml_reader.hpp"
#include "pointdriver/path/curve.hpp"
#include "pointdriver/path/history.hpp"

namespace repose::input {

/// Rows that are compared, SI units.
struct FitTable {
  std::vector<double> x;
  std::vector<std::vector<double>> y;  ///< per channel
  std::vector<int> lines;              ///< of the file
};

/// Reads the columns x and y off the target's `data`, keeping rows with from <= x <= to, after
/// adding x_shift. A quantity "q_Pa" is found as q_Pa, q_kPa or q_MPa, a strain as eps_a or
/// eps_a_percent, the specific volume v also as the void ratio e. Reports what is wrong and returns
/// no rows then.
FitTable read_fit_table(TomlReader& target, const TargetTable& given);

}  // namespace repose::input

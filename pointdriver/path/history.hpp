#pragma once
/// \file
/// Prescribed histories from a table: measured strains or stresses over time become a path.

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "pointdriver/path/path.hpp"

namespace repose::point {

/// A table that cannot be used: "file.csv:12: …".
class TableError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A table of numbers, as somebody has read it off a file.
struct Table {
  std::string name;  ///< for messages
  std::vector<std::string> columns;
  std::vector<std::vector<double>> values;  ///< by column
  std::vector<int> lines;                   ///< line of each row in the file
};

/// What the columns of a history hold: values, or changes from wherever the test starts.
enum class HistoryIs : std::uint8_t { absolute, change };

/// The path along a table: between two rows every prescribed quantity changes linearly in time, one
/// row of output at each. Columns: time_s (increasing) and what is prescribed,
///     eps_xx … eps_zx [-]  or  eps_xx_percent,    sigma_xx_Pa … or sigma_xx_kPa,
///     eps_a (= eps_yy), eps_r (= eps_xx and eps_zz), eps_v, gamma (= 2 eps_xy),
///     sigma_a_*, sigma_r_* (mean of xx and zz, with equal radial strains), tau_* (= sigma_xy);
/// compression positive. Shear components that are not named stay unstrained; together six
/// independent rows are needed. The first row is the start. With `absolute` it must agree with it
/// to 1e-4 of the column's largest value: strains are zero there, stresses are those of [initial]
/// (the path's start_claims, which check_start() compares). Strains are read in `measure`.
/// `max_strain`: a larger strain in the table is refused (15 where 15 % is meant).
/// Throws TableError (a unit that is not known, a column that is missing, times that do not grow).
Path history_path(const Table& table, HistoryIs is = HistoryIs::absolute,
                  StrainMeasure measure = StrainMeasure::logarithmic, double max_strain = 10.0);

}  // namespace repose::point

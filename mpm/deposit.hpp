#pragma once
/// \file
/// The shape of a deposit, independent of how loose it is: column mass over reference density.

#include <vector>

#include "mpm/points.hpp"

namespace repose::mpm {

struct Deposit {
  double h;                   ///< spacing of the columns [m]
  std::vector<double> depth;  ///< solid depth at x = i h [m]

  /// Spreads each point's mass over the two nearest columns (linear hat functions, so that the
  /// depth is continuous in the points' positions); the end columns are half as wide.
  Deposit(const std::vector<PointSet>& bodies, double column_spacing, int columns);

  /// Largest x at which the piecewise linear depth reaches `threshold` [m]; 0 if it never does.
  double front(double threshold) const;
};

}  // namespace repose::mpm

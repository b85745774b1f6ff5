#pragma once
/// \file
/// The shape of a deposit, independent of how loose it is: column mass over reference density.

#include <vector>

#include "mpm/grid/points.hpp"

namespace repose::mpm {

struct Deposit {
  double h;                   ///< spacing of the columns [m]
  std::vector<double> depth;  ///< solid depth at x = i h, or at the radius i h [m]

  /// Spreads each point's mass over the two nearest columns (linear hat functions, so that the
  /// depth is continuous in the points' positions). The end columns are half as wide, or with
  /// periodic edges one column, seen at both ends. In space the columns are `breadth` [m] deep.
  template <int dim>
  Deposit(const std::vector<PointsOf<dim>>& bodies, double column_spacing, int columns,
          bool periodic, double breadth = 1.0);

  /// The same over rings about an upright axis at (x, z) [m], of which the box holds the share
  /// `whole` (1, ½ or ¼). Rings beyond a wall of the box are not full: `columns` ends before.
  Deposit(const std::vector<PointsOf<3>>& bodies, double ring_spacing, int columns,
          const std::array<double, 2>& axis, double whole);

  /// Largest x at which the piecewise linear depth reaches `threshold` [m]; 0 if it never does.
  double front(double threshold) const;
};

/// The x left of which lies `share` of the mass in a box of the given width [m]; 0 if it is empty.
/// It is the mean x of the slice about that mark that weighs as much as the heaviest point: linear
/// between the points of a body, and continuous in all positions, also where points of different
/// masses pass each other. What has left the box counts at its edge, and whole turns through
/// periodic edges do not count. In space, with an axis at (x, z), the radius takes the place of x.
template <int dim>
double mass_front(const std::vector<PointsOf<dim>>& bodies, double width, double share,
                  bool periodic, const std::array<double, 2>* axis = nullptr);

}  // namespace repose::mpm

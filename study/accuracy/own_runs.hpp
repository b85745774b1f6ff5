#pragma once
/// \file
/// What the runs of a scene tend to and how far that may be off, by nothing but these runs: what
/// holds where no other scene can speak for this one.

#include <optional>
#include <span>

#include "study/accuracy/richardson.hpp"

namespace repose::study {

/// An estimate from two cell sizes and more.
struct OwnEstimate {
  Eigen::VectorXd value;
  int sizes = 3;           ///< that count, 3 or 2
  double error = 0.0;      ///< error bar, relative
  double scattered = 0.0;  ///< its part by scatter
  double order = 0.0;      ///< used, within own_orders
  double observed = 0.0;   ///< of the three sizes; NaN where the changes do not shrink
};

/// Orders that extrapolations use: less than 1 would add more than the last change, which no scene
/// has borne out.
inline constexpr double least_own_order = 1.0, largest_own_order = 2.0;

/// From levels, coarse to fine, of which three count: the finest, u_f, and each time the finest
/// that is at least 1.9 times as coarse, u_m and u_c. The value is u_f + w (u_f − u_m),
/// w = 1/(r^p − 1). Its error bar is the root of the squares of
///  - half of what is extrapolated, w |u_f − u_m|, and all of it where the changes do not shrink
///    (the grid convergence index of Roache 1994 with its factors of 1.25 and 3, less what is
///    extrapolated, would be a quarter and twice that). Changes that agree by chance do not count:
///    |u_f − u_m| is taken to be no less than the largest order makes of |u_m − u_c|;
///  - the change of the value where the order is the observed one within 0.5 and 2, or 1;
///  - half the largest distance from the estimates that the two sizes next coarser than the finest
///    give (all of it where there is but one): an estimate is as good as it is steady;
///  - twice the scatter of the means carried through, `scatter` being the standard deviation of one
///    run relative to it; runs of one size that show more count as they are;
/// and no less than half of what the next coarser size gave, or twice its own where that is the
/// first: a small bar has to show itself twice.
/// Of two sizes no order can be seen: the value is u_f and its bar three times the last change at
/// order 1. Absent for one.
std::optional<OwnEstimate> own_estimate(std::span<const Resolution> levels, double scatter);

/// From three sizes that lie closer, each 1.3 times as coarse as the next or more, which is the
/// least that shows an order (Celik et al. 2008, J. Fluids Eng. 130, 078001): own_estimate()
/// without what only sizes further apart can tell, its steadiness. Absent where there are no such
/// three.
std::optional<OwnEstimate> close_estimate(std::span<const Resolution> levels);

}  // namespace repose::study

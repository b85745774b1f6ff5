#pragma once
/// \file
/// Shares of an output's variance (Sobol' 1993), by differences of runs.

#include "study/sensitivity/bootstrap.hpp"

namespace repose::study {

/// Of one input: what its variance alone brings, and what would be left if all others were known.
struct VarianceShares {
  Bounded first, total;
};

/// Blocks of inputs + 2 rows, each a point a, a point b, and a with one coordinate of b in turn
/// (Saltelli and others 2010); a and b are halves of a low-discrepancy point. Block i depends on
/// seed and i alone.
Eigen::MatrixXd variance_points(int inputs, int blocks, std::uint64_t seed);

/// y: of every row of variance_points(). With f_j that of a with b's coordinate j,
///   S_j  = mean f(b) (f_j − f(a)) / V             Saltelli and others 2010, table 2 (b)
///   ST_j = mean (f(a) − f_j)² / (2 V)             Jansen 1999
/// A block with a y that is not finite is left out. Intervals are those of blocks drawn again;
/// since blocks are more even than random ones, they are rather too wide. Without variance, or two
/// blocks: NaN.
std::vector<VarianceShares> variance_shares(int inputs, const Eigen::VectorXd& y,
                                            std::uint64_t seed);

}  // namespace repose::study

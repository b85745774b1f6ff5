#pragma once
/// \file
/// Whether chains agree, and how many independent draws they are worth: Vehtari, Gelman, Simpson,
/// Carpenter & Bürkner, Bayesian Anal. 16 (2021) 667.

#include <Eigen/Core>

namespace repose::calibration {

/// Of one quantity over all chains.
struct Convergence {
  double r_hat =
      0.0;  ///< rank-normalised and split, of the place and of the spread; 1 if they agree
  double bulk_ess = 0.0;  ///< effective size for the middle
  double tail_ess = 0.0;  ///< the smaller one of those for the 5 and the 95 % quantile
};

/// draws: iterations × chains. NaN where there are fewer than four per chain or all are alike.
Convergence convergence(const Eigen::MatrixXd& draws);

/// The share-quantile of a sample, linear between its order statistics.
double sample_quantile(Eigen::VectorXd sample, double share);

}  // namespace repose::calibration

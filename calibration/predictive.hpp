#pragma once
/// \file
/// What a posterior predicts: bands about every curve, fitted or held out.

#include "calibration/posterior.hpp"

namespace repose::calibration {

/// Of one target; every matrix is rows × channels, in the channels' units. 90 %: from the 5 to the
/// 95 % quantile.
struct PredictiveBand {
  Eigen::MatrixXd median;                    ///< of the curves
  Eigen::MatrixXd curve_lower, curve_upper;  ///< 90 % of the curves: what the parameters leave open
  Eigen::MatrixXd lower, upper;              ///< 90 % of a repetition: with errors drawn anew
  std::vector<bool> has_errors;  ///< per channel: false where nothing tells of its errors
};

/// Bands from posterior draws (coordinates u). A held-out channel has the errors of a fitted one of
/// its name, of several by turns, or else its declared noise. Paths that break off are left out.
/// Deterministic in the seed, whatever the threads.
std::vector<PredictiveBand> predictive_bands(const Posterior& posterior,
                                             const std::vector<Eigen::VectorXd>& draws,
                                             std::uint64_t seed);

/// Share of the measured rows of a channel that lie within its band.
double share_inside(const Channel& channel, const PredictiveBand& band, Eigen::Index column);

}  // namespace repose::calibration

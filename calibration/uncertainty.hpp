#pragma once
/// \file
/// How well the data determine the parameters at an optimum: covariance, intervals, what cannot be
/// told apart, profile likelihood, residual bootstrap.

#include <array>

#include "calibration/optimise.hpp"

namespace repose::calibration {

/// One fitted channel at the optimum.
struct ChannelScore {
  std::size_t target = 0, channel = 0;
  Eigen::Index rows = 0;
  double rms = 0.0;              ///< of simulated − observed, in the channel's unit
  double relative_rms = 0.0;     ///< over the range of the data
  double bias = 0.0;             ///< mean of simulated − observed, channel's unit
  double chi2_per_row = 0.0;     ///< (rms/noise)²; NaN without a declared noise
  double lag_correlation = 0.0;  ///< of neighbouring residuals; noise has 0 ± 2/√n
  double objective = 0.0;        ///< its share of ½ rᵀr
  double variance = 0.0;         ///< used for the covariance, in units of scale²
  bool systematic = false;       ///< misfit beyond noise: too large or correlated along the curve
  Eigen::Index worst_row = 0;    ///< of the largest residual
};
/// Scores of every channel of every target, held-out ones too.
std::vector<ChannelScore> score(const Problem& problem, const Eigen::VectorXd& z);

/// A direction in parameter space: relative changes of the parameters that act together.
struct Combination {
  double singular_value = 0.0;  ///< of ∂r/∂ln value, in units of the residuals' own scatter
  double relative_sd = 0.0;   ///< relative standard deviation of the combination, 1/singular_value
  Eigen::VectorXd direction;  ///< unit vector over the parameters
  std::string words;
};

struct Uncertainty {
  Eigen::VectorXd values;
  Eigen::VectorXd standard_error;  ///< of the values; infinite where the data say nothing
  Eigen::VectorXd shift;           ///< of the values by the simulator's own error; 0 without one
  Eigen::VectorXd white_error;     ///< the same if residuals were uncorrelated noise
  Eigen::MatrixXd correlation;     ///< of the values; 0 where undefined
  std::vector<std::array<double, 2>> interval;  ///< 95 %, within the bounds
  std::vector<int> at_bound;  ///< −1 lower, +1 upper, 0 inside; fixed there for the rest
  std::vector<Combination> combinations;  ///< worst determined first
  Eigen::Index freedom = 0;               ///< rows − parameters
  double quantile = 1.96;                 ///< of the interval
  std::vector<ChannelScore> channels;
};

/// Covariance H⁻¹ (Σ_c v_c J_cᵀJ_c) H⁻¹, H = JᵀJ (Huber 1967): right also where weights are not
/// 1/variance. A channel's variance v_c is its declared noise, or more where its misfit is more
/// than noise (99 %), or the scatter of its residuals where none is declared; times (1 + ρ)/(1 − ρ)
/// where neighbouring residuals are correlated (Bartlett 1946).
/// simulator_error: a typical error of the simulator in r (empty: none), one standard deviation of
/// unknown sign; what it moves the parameters by, J⁺ error, is added as s sᵀ to the covariance.
Uncertainty uncertainty(const Problem& problem, const Eigen::VectorXd& z,
                        const Eigen::VectorXd& simulator_error = {});

/// Student's t, two-sided 95 %.
double t_quantile(double freedom);

/// The objective with one parameter held, all others fitted again.
struct Profile {
  int parameter = 0;
  std::vector<double> value, excess;  ///< 2Δobjective over the variance factor; 3.84 at 95 %
  double lower = 0.0, upper = 0.0;    ///< 95 %
  bool lower_open = false, upper_open = false;  ///< the bound is reached first
};
Profile profile(const Problem& problem, const Uncertainty& at, const Eigen::VectorXd& z,
                int parameter, int points_per_side = 6);

/// Refits to the fitted curve plus residuals, drawn with replacement in blocks as long as their
/// correlation; rows of the result are the refitted values. Deterministic in the seed.
Eigen::MatrixXd bootstrap(const Problem& problem, const Eigen::VectorXd& z, int repeats,
                          std::uint64_t seed);

}  // namespace repose::calibration

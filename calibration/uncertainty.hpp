#pragma once
/// \file
/// How well the data determine the parameters at an optimum: covariance, intervals, what cannot be
/// told apart, profile likelihood, residual bootstrap.

#include <array>

#include "calibration/noise.hpp"
#include "calibration/optimise.hpp"
#include "calibration/quantiles.hpp"

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
  bool large = false;            ///< misfit of a tenth of the data's range or more: always told
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
  /// Of the values; infinite where the data say nothing, NaN at a bound (there is none).
  Eigen::VectorXd standard_error;
  Eigen::VectorXd shift;        ///< of the values by the simulator's own error; 0 without one
  Eigen::VectorXd white_error;  ///< the same if residuals were uncorrelated noise
  Eigen::MatrixXd correlation;  ///< of the values; 0 where undefined
  std::vector<std::array<double, 2>> interval;  ///< 95 %, within the bounds; one-sided at a bound
  std::vector<int> at_bound;  ///< −1 lower, +1 upper, 0 inside; fixed there for the rest
  std::vector<Combination> combinations;  ///< worst determined first
  Eigen::Index freedom = 0;               ///< rows − directions that the data determine
  double quantile = 1.96;                 ///< of that freedom; normal where all noise is declared
  Eigen::VectorXd freedoms;               ///< with which each variance is known
  Eigen::VectorXd quantiles;              ///< Student's t of those
  /// Standard error of each value with its own bound taken away: that of the profile's curvature.
  Eigen::VectorXd released_error;
  Eigen::VectorXd beyond_bound;  ///< how far outside the optimum then lies; 0 inside
  /// Of z (n × n): the inverse of its covariance by the data along what these determine, and 12, of
  /// what is even over its bounds, along the rest; 0 for coordinates at a bound.
  Eigen::MatrixXd information;
  Eigen::VectorXd naive;  ///< variance of the values if that of r were 1
  Noise noise;
  std::vector<ChannelScore> channels;
};

/// Covariance H⁻¹ (Jᵀ Ω J) H⁻¹, H = JᵀJ (Huber 1967): right also where weights are not 1/variance.
/// Ω is the noise of noise.hpp: a channel's variance is its declared noise, or that of its
/// residuals where none is declared or their misfit is more (99 %); neighbours correlate as a
/// first-order autoregression, channels of one experiment row by row. The intervals take Student's
/// t of the degrees of freedom with which each variance is known, and end where the excess reaches
/// critical_excess(). A direction along which the whole of the bounds changes the residuals by less
/// than a tenth of their scatter is not determined: it widens no other interval than by what the
/// bounds allow. With a robust loss r and J are those of Problem::linearise, and σ is theirs,
/// declared or not: the covariance is that of Huber (1981, §7.6).
/// simulator_error: a typical error of the simulator in r (empty: none), one standard deviation of
/// unknown sign; what it moves the parameters by, J⁺ error, is added as s sᵀ to the covariance.
Uncertainty uncertainty(const Problem& problem, const Eigen::VectorXd& z,
                        const Eigen::VectorXd& simulator_error = {});

/// The weights of the priors beside the data as these are at z: the variance of the residuals
/// (correlation included) along the direction in which each prior's parameter moves,
/// dᵀJᵀΩJd/dᵀJᵀJd, so that a prior and data of the same standard error count alike.
Eigen::VectorXd weighed_priors(const Problem& problem, const Eigen::VectorXd& z);

/// The objective with one value held, all others fitted again; for a ratio it is the value, not the
/// ratio, that is held.
struct Profile {
  int parameter = 0;
  /// Twice the rise of the objective over the variance, on the scale on which 95 % end at 3.84.
  std::vector<double> value, excess;
  double lower = 0.0, upper = 0.0;              ///< 95 %
  bool lower_open = false, upper_open = false;  ///< the bound is reached first
  bool better = false;  ///< a point of it fits better than the optimum it belongs to
};
Profile profile(const Problem& problem, const Uncertainty& at, const Eigen::VectorXd& z,
                int parameter, int points_per_side = 6);

/// One point of it: the excess with the parameter's value held, infinite where no values within the
/// bounds reach it. The 95 % interval is where this is at most 3.84.
double profile_excess(const Problem& problem, const Uncertainty& at, const Eigen::VectorXd& z,
                      int parameter, double value);

/// Refits to the fitted curve plus errors made anew: the residuals' innovations drawn with
/// replacement, row by row for all channels of an experiment, scaled and correlated as the noise
/// of `at`; priors are drawn from their distributions, simulator_error with a random sign and size.
/// Rows of the result are the refitted values. Deterministic in the seed.
Eigen::MatrixXd bootstrap(const Problem& problem, const Uncertainty& at, const Eigen::VectorXd& z,
                          int repeats, std::uint64_t seed,
                          const Eigen::VectorXd& simulator_error = {});

/// 95 % of one parameter's draws, widened about the value by Student's t over the normal quantile.
std::array<double, 2> bootstrap_interval(const Eigen::VectorXd& draws, double value,
                                         double quantile);

/// The interval to quote.
struct Recommendation {
  std::array<double, 2> interval{};
  bool lower_is_bound = false, upper_is_bound = false;  ///< the bound ends it, not the data
  std::string_view kind;                                ///< "profile", "linear" or "bounds"
  std::string reason;
};
/// One per parameter: the profile's where there is one, the linear one otherwise, the bounds where
/// the data say nothing.
std::vector<Recommendation> recommend(const Problem& problem, const Uncertainty& at,
                                      const std::vector<Profile>& profiles);

}  // namespace repose::calibration

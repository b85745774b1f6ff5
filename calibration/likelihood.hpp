#pragma once
/// \file
/// How likely the data are under a fitted law, with one model of errors for every law: Akaike's and
/// Schwarz's criteria. docs/comparison.md derives it.

#include "calibration/problem.hpp"

namespace repose::calibration {

/// What the residuals of a channel are taken for: white noise, or an autoregression along the rows.
enum class Errors : std::uint8_t { white, correlated };

/// The most likely errors of a channel's residuals r (in units of r, `least` at least): white, or
/// of variance τ² with neighbours that correlate by ρ,
///     ln p = −n/2 ln τ² − Q(ρ)/(2τ²) − (n − 1)/2 ln(1 − ρ²),  Q = ‖L(ρ)⁻¹ r‖²,
/// where τ² = Q/n is the most likely for any ρ (L: noise.hpp). 0 ≤ ρ ≤ (n − 1)/(n + 1), the most
/// that n rows can show, and 0 for fewer than four.
struct LikelyErrors {
  CurveError error;
  double rho = 0.0;
  double log_density = 0.0;  ///< ln p(r), with its constant
  /// n (1 − ρ)/(1 + ρ): as many independent rows tell as much of a constant.
  double effective_rows = 0.0;
};
LikelyErrors likely_errors(const Eigen::VectorXd& r, double least, Errors errors);
/// Of every fitted channel at z, as Problem::blocks(). The least is the declared noise, or 1e-4 of
/// the channel's range where none is declared: a few rows that are met exactly must not outweigh
/// all others.
std::vector<LikelyErrors> likely_errors(const Problem& problem, const Eigen::VectorXd& z,
                                        Errors errors);

struct Likelihood {
  Eigen::VectorXd z;            ///< the most likely parameters
  double log_likelihood = 0.0;  ///< of the data in their own units
  Eigen::Index rows = 0;
  Eigen::Index parameters = 0;  ///< free ones and those of the errors: one or two per channel
  double effective_rows = 0.0;  ///< of all channels
  bool at_the_fit = false;      ///< z is the one given: simulations without derivatives

  /// −2 ln L + 2k (Akaike 1974).
  double aic() const;
  /// The same with 2k(k + 1)/(n − k − 1) on top (Hurvich & Tsai 1989); NaN for n ≤ k + 1.
  double aicc() const;
  /// −2 ln L + k ln n (Schwarz 1978).
  double bic() const;
};

/// The largest likelihood that can be reached from z: errors and parameters are made most likely
/// for each other by turns, which raises it at every turn. Weights and balance play no part; priors
/// hold the parameters, but are no data.
Likelihood most_likely(const Problem& problem, const Eigen::VectorXd& z, Errors errors);

/// Weights exp(−Δ/2)/Σ exp(−Δ/2) of criteria by their differences from the least (Akaike 1978);
/// NaN has the weight 0.
std::vector<double> akaike_weights(const std::vector<double>& criteria);

}  // namespace repose::calibration

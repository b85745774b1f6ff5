#pragma once
/// \file
/// What a measured curve differs from the true law's by: noise, and what the law itself leaves out.
///
/// Row i of n has the error δ_i + ε_i: ε white with the standard deviation σ w_i (w: the row's
/// share of the channel's noise), δ a stationary autoregression of variance τ² whose neighbours
/// correlate by ρ = exp(−1/(ℓ (n − 1))), so that it hangs together over the share ℓ of the curve's
/// rows. It is the Gaussian process with the covariance τ² exp(−|s − s'|/ℓ) at s = i/(n − 1), a
/// discrepancy in the sense of Kennedy & O'Hagan, J. R. Stat. Soc. B 63 (2001) 425.

#include <array>
#include <random>

#include <Eigen/Core>

namespace repose::calibration {

struct CurveError {
  double noise = 1.0;        ///< σ
  double discrepancy = 0.0;  ///< τ; 0: the law is taken to be right
  double length = 1.0;       ///< ℓ, in shares of the rows
};

/// ln p(e) without its constant −n/2 ln 2π, and its derivatives.
struct CurveLikelihood {
  double value = 0.0;
  Eigen::VectorXd by_row;                ///< ∂/∂e_i
  std::array<double, 3> by_logarithm{};  ///< ∂/∂ln σ, ∂/∂ln τ, ∂/∂ln ℓ
};
/// By the Kalman filter, in a time proportional to the rows; w as above, one per row.
CurveLikelihood likelihood(const CurveError& error, const Eigen::VectorXd& e,
                           const Eigen::VectorXd& w);

/// The filter's innovations over their standard deviations, of each column: errors with the
/// covariance above become white of unit variance (rows × columns).
Eigen::MatrixXd innovations(const CurveError& error, const Eigen::MatrixXd& columns,
                            const Eigen::VectorXd& w);

/// An error drawn anew.
Eigen::VectorXd drawn_error(const CurveError& error, const Eigen::VectorXd& w,
                            std::mt19937_64& random);

}  // namespace repose::calibration

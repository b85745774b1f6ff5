#pragma once
/// \file
/// What scatter the residuals show: its size per channel, its correlation along the curve and
/// between the channels of an experiment. Every interval is made from this one model.
///
/// In units of r, channel c of a target has errors ε_c = σ_c L(ρ_c) η_c with L the filter of a
/// first-order autoregression of unit variance,
///     ε_1 = η_1,  ε_i = ρ ε_{i−1} + √(1 − ρ²) η_i,
/// and η white, correlated between channels of the same row by h: Ω = S L (h ⊗ 1) Lᵀ S.

#include "calibration/problem.hpp"

namespace repose::calibration {

/// One fitted channel; `block` is its place in Problem::blocks().
struct ChannelNoise {
  Block block;
  double sd = 0.0;        ///< σ in units of r
  double white_sd = 0.0;  ///< the same if neighbours and channels had nothing in common
  double rho = 0.0;       ///< 0 where no more than chance: ρ ≤ 1/√freedom
  bool declared = false;  ///< σ is that of the user and the misfit keeps to it
  bool beyond = false;    ///< σ was declared and the misfit is more than that (1 %)
  double freedom = 1.0;   ///< rows less what the fit has used of them
};

struct Noise {
  std::vector<ChannelNoise> channels;
  Eigen::MatrixXd between;       ///< h, channels × channels
  Eigen::VectorXd priors;        ///< variance of each prior's row
  Eigen::Index first_prior = 0;  ///< row of r

  /// (h-less) root of Ω from the right: Bᵀ h B = Aᵀ Ω A blockwise; A has a row per residual.
  Eigen::MatrixXd filtered(const Eigen::MatrixXd& A) const;
  /// Aᵀ Ω A.
  Eigen::MatrixXd variance(const Eigen::MatrixXd& A) const;
  /// The same if all errors were white.
  Eigen::MatrixXd white_variance(const Eigen::MatrixXd& A) const;
  /// The degrees of freedom with which aᵀ Ω a is known: mixed_freedom() of the scatter of the
  /// estimated σ (2/Var ln aᵀΩa, Satterthwaite 1946) and of ρ and h; infinite where all is declared
  /// and nothing correlated. `more` is a known variance that comes on top.
  double freedom(const Eigen::VectorXd& a, double more) const;
  /// Mean variance of a data row.
  double mean_variance() const;
};

/// The noise that explains the residuals r of a fit that uses the directions U (rows × m,
/// orthonormal) of them: r = (1 − UUᵀ) ε, so that the sums of squares and of neighbours' products
/// are those expected of (1 − UUᵀ) Ω (1 − UUᵀ).
Noise estimate_noise(const Problem& problem, const Eigen::VectorXd& r, const Eigen::MatrixXd& U);

/// ε to η of one channel and back, for a unit σ.
Eigen::VectorXd whitened(const Eigen::VectorXd& errors, double rho);
Eigen::VectorXd coloured(const Eigen::VectorXd& white, double rho);

}  // namespace repose::calibration

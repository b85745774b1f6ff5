#pragma once
/// \file
/// How well a fit foretells a test that it has not seen: targets that are held out, and fitted ones
/// left out in turn.

#include "calibration/likelihood.hpp"
#include "calibration/optimise.hpp"

namespace repose::calibration {

/// One channel of a target that the fit has not seen.
struct UnseenChannel {
  std::size_t target = 0, channel = 0;
  Eigen::Index rows = 0;
  double rms = 0.0;           ///< of simulated − observed, in the channel's unit
  double relative_rms = 0.0;  ///< over the range of the data
  double log_score = 0.0;     ///< ln of the predictive density of its rows, in its unit
  bool own_error = false;     ///< its error is that of the prediction itself: nothing else tells
};
struct UnseenTest {
  std::vector<UnseenChannel> channels;
  double log_score = 0.0;  ///< of all rows together
  bool failed = false;     ///< the path broke off
};

/// Scores targets that `fitted`, at its optimum z, holds out. The predictive density is normal:
/// errors as the fitted channels of the same name have them (likely_errors, correlated; of several
/// the mean variance and the mean ρ), else the declared noise, else as large as the prediction is
/// off; and on top what is not known of the parameters, J C Jᵀ, C⁻¹ = J̃ᵀJ̃ + priors + 12 with J̃ the
/// whitened Jacobian of what was fitted: what the data leave open is even over its bounds, of
/// variance 1/12.
UnseenTest score_unseen(const Problem& fitted, const Eigen::VectorXd& z,
                        const std::vector<std::size_t>& targets);

/// A fit without some of its targets, from the optimum z of all, and what it says of them.
struct LeftOut {
  Optimum optimum;
  UnseenTest test;
  std::vector<std::size_t> unknown;  ///< parameters that the other targets do not determine
};
/// algorithm: of optimise().
LeftOut leave_out(const Problem& problem, const Eigen::VectorXd& z,
                  const std::vector<std::size_t>& targets, std::string_view algorithm,
                  const OptimiseOptions& options);
/// The same with the optimum known already.
LeftOut left_out(const Problem& problem, Optimum optimum, const std::vector<std::size_t>& targets);

}  // namespace repose::calibration

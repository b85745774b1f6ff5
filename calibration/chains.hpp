#pragma once
/// \file
/// Draws from a posterior by the no-U-turn sampler (Hoffman & Gelman, J. Mach. Learn. Res. 15
/// (2014) 1593) with multinomial weights along the trajectory (Betancourt, arXiv:1701.02434, 2017).
/// All chains walk in the coordinates w in which the mode's curvature is the identity: u = mode + L
/// w, L Lᵀ = curvature⁻¹. A quarter and a half into the warm-up each chain takes the covariance of
/// its own draws for its inverse mass matrix: a posterior need not be as wide as it is at its mode.
///
/// Every draw has random numbers of its own, from the seed, its chain and its place in it, so that
/// a chain can stop after any draw and go on later, elsewhere, with the same bits.

#include <functional>

#include "calibration/posterior.hpp"

namespace repose::calibration {

/// One step of a chain, with all that the next one needs.
struct Draw {
  int chain = 0;
  int iteration = 0;  ///< 0: where the chain begins; 1 … warmup + draws
  Eigen::VectorXd w;
  double log_density = 0.0;
  double accept = 0.0;  ///< mean acceptance along the trajectory
  int leapfrogs = 0;
  bool divergent = false;  ///< the energy was off by more than 1000
  bool longest = false;    ///< the trajectory was cut off before it turned
  int broken = 0;          ///< trials whose path broke off: outside what the law can do
  /// Of the step's adaptation: ln step, its running mean, the mean lack of acceptance.
  std::array<double, 3> adaptation{};
};

/// Where chains walk.
struct Walk {
  Eigen::VectorXd mode;
  Eigen::MatrixXd root;  ///< L, upper triangular
  Eigen::VectorXd u(const Eigen::VectorXd& w) const { return mode + root * w; }
};
/// Errors: InputError (key "posterior") if the density is nowhere finite around z.
Walk walk_from(const Posterior& posterior, const Eigen::VectorXd& z);

/// Runs this share's chains to their ends, in parallel, each from its last draw in `done`; returns
/// all draws, chain after chain. after: called under a lock as each draw ends (to save it). An
/// interrupted problem stops after the present draws.
std::vector<Draw> run_chains(const Posterior& posterior, const Walk& walk,
                             const PosteriorOptions& options, std::uint64_t seed,
                             const std::vector<Draw>& done = {},
                             const std::function<void(const Draw&)>& after = {});

}  // namespace repose::calibration

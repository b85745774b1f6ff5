#pragma once
/// \file
/// Which test to make next: how much narrower the parameters would be known with each of some
/// candidates (Fedorov 1972; Atkinson, Donev & Tobias, Optimum Experimental Designs, 2007).

#include "calibration/uncertainty.hpp"

namespace repose::calibration {

/// What a test would add to what is known.
struct Taught {
  std::size_t candidate = 0;
  bool failed = false;  ///< its path breaks off at the best parameters
  /// ½ ln det M₁/det M₀, in nats: what it is expected to tell of all parameters together. M is the
  /// information of z before and after, M₁ = M₀ + JᵀJ with J in units of the candidate's noise.
  double gain = 0.0;
  /// Width of each parameter's 95 % interval after over before; 1 for one at its bound.
  Eigen::VectorXd narrower;
  std::size_t most = 0;  ///< the parameter of the least of these
};

struct Design {
  std::vector<Taught> candidates;  ///< each alone, by falling gain (D-optimal first)
  /// The best next test, the best one after that, and so on; a candidate may come again. Each is
  /// compared with what is known before it.
  std::vector<Taught> sequence;
};

/// `at`: the uncertainty at the optimum z of `problem`. candidates: targets without data, with a
/// declared noise in every channel. Rows are independent; what a test is expected to tell is that
/// of the curves' slopes at z.
Design design(const Problem& problem, const Uncertainty& at, const Eigen::VectorXd& z,
              const std::vector<Target>& candidates, int tests = 3);

}  // namespace repose::calibration

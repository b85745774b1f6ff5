#pragma once
/// \file
/// The posterior of a fit: chains from its best end, what they say of every quantity and curve.

#include "calibration/chains.hpp"
#include "calibration/convergence.hpp"
#include "calibration/predictive.hpp"
#include "input/read_fit.hpp"

namespace repose::study {

struct SampleRequest {
  std::vector<calibration::Draw> done;  ///< draws that need no repetition
  /// Hears of every draw, one at a time.
  std::function<void(const calibration::Draw&)> after_draw;
};

/// A quantity's draws in numbers.
struct QuantitySummary {
  std::string name, unit;
  double mean = 0.0, sd = 0.0, median = 0.0;
  std::array<double, 2> interval_90{}, interval_95{};  ///< equal tails
  calibration::Convergence convergence;
};

struct PosteriorResult {
  std::vector<calibration::Draw> draws;  ///< the warm-up too
  int chains = 0;                        ///< that came to their end
  bool complete = false;  ///< all chains of the fit did; what follows is empty otherwise
  std::vector<QuantitySummary> summary;
  Eigen::MatrixXd quantities;  ///< kept draws, chain after chain, × quantities
  Eigen::MatrixXd correlation;
  std::vector<calibration::PredictiveBand> bands;  ///< one per target
  int kept = 0, divergent = 0, longest = 0;        ///< of the kept draws
  long leapfrogs = 0, broken = 0;  ///< trials of all draws; of those, paths that broke off
  double accept = 0.0;
  bool converged = true;  ///< every R-hat ≤ 1.01 and effective size ≥ 100 per chain
  std::vector<std::string> complaints;  ///< what there is to say against the draws, in words
};

/// What the chains are drawn from, and where they walk.
struct Sampler {
  /// z: of the best end. Errors: as Posterior's and walk_from()'s.
  Sampler(const input::FitFile& file, const calibration::Problem& problem,
          const Eigen::VectorXd& z);
  calibration::Posterior posterior;
  calibration::Walk walk;
  std::string fingerprint;  ///< of all that a draw depends on
};

PosteriorResult sample(const input::FitFile& file, const Sampler& sampler,
                       const SampleRequest& request);

}  // namespace repose::study

#pragma once
/// \file
/// A fit from many starts: a global search and local refinements, each start independent of the
/// others and of the number of threads, so that a campaign can be split, interrupted and merged.

#include "calibration/optimise.hpp"

namespace repose::calibration {

struct FitOptions {
  std::string global = "none";  ///< algorithm of the search from start 0, or "none"
  long global_evaluations = 2000;
  std::string local = std::string(levenberg_marquardt_name);  ///< or "none"
  long local_evaluations = 1000;
  /// 0: the given start; others: low-discrepancy points, drawn towards the given start by halves
  /// as long as their paths break off.
  int starts = 16;
  int starts_from = 0;  ///< this machine's share: [starts_from, starts_to)
  int starts_to = -1;   ///< −1: all
  std::uint64_t seed = 1;
  double x_tolerance = 1e-9;
};

/// What came of one start.
struct StartResult {
  int index = 0;
  Eigen::VectorXd from;
  Optimum global;   ///< of start 0 with a global search; else empty
  Optimum optimum;  ///< the best of it
};

/// Runs the starts of this share that are not in `done`, in parallel, and returns all of them by
/// index. after: called under a lock as each start ends (to save it).
std::vector<StartResult> run_starts(const Problem& problem, const FitOptions& options,
                                    const std::vector<StartResult>& done = {},
                                    const std::function<void(const StartResult&)>& after = {});

/// The start with the lowest objective; ties go to the lower index.
const StartResult& best_of(const std::vector<StartResult>& starts);

/// Weighs the priors beside the noise that the best start's residuals show (weighed_priors), and
/// with a robust loss takes the scales of channels without a declared noise from them
/// (settled_scale); fits from every end again and repeats until both stay; `problem` keeps them.
/// Without priors and such a loss nothing happens. Objectives are then of the last weights.
void settle(Problem& problem, const FitOptions& options, std::vector<StartResult>& starts);

/// Did the best start, or one that ended at the same optimum, end by itself? False where the limit
/// of evaluations stopped them all.
bool converged(const Problem& problem, const std::vector<StartResult>& starts);

/// Starts that ended at the same place.
struct Cluster {
  Eigen::VectorXd z;  ///< of its best member
  double objective = 0.0;
  std::vector<int> starts;
  bool same_prediction = false;  ///< fits the data like the best optimum with other parameters
};

/// Distinct optima, best first: two ends are one if all coordinates agree to 1 % of their bounds
/// and the objectives to 0.1 %.
std::vector<Cluster> clusters(const Problem& problem, const std::vector<StartResult>& starts);

}  // namespace repose::calibration

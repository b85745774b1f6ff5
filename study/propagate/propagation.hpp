#pragma once
/// \file
/// What `repose propagate` computes: draws of a fit's posterior through a scene, with coarse cells
/// for all of them and the scene's own for a few.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "input/read_scene.hpp"
#include "input/read_sweep.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "models/registry.hpp"
#include "study/propagate/control_variate.hpp"
#include "study/run/scene_sweep.hpp"

namespace repose::study {

/// The posterior that a fit has left in its folder.
struct FittedPosterior {
  std::string name;                     ///< of the fit
  LawSpec law;                          ///< at the optimum
  std::vector<std::string> parameters;  ///< of the law, that were free
  std::vector<std::string> others;      ///< free, but of the tests: "p", "K0"
  Eigen::MatrixXd draws;                ///< a kept draw per row, the parameters in SI
  bool converged = true;
  std::string fingerprint;  ///< of posterior.csv
};

/// Errors: BadInput for a folder that is no fit's or has no posterior, with what makes one; IoError
/// for files that cannot be read.
FittedPosterior read_posterior(const std::filesystem::path& folder);

struct PropagationOptions {
  int runs = 100;      ///< coarse ones
  int fine = 12;       ///< with the scene's own cells
  double coarsen = 2;  ///< width of the coarse cells over that of the fine ones
  std::vector<std::string>
      outputs;  ///< figures of summary.json, or columns of series.csv at the end
};

/// The runs, decided before the first.
struct PropagationPlan {
  PropagationOptions asked;
  std::vector<Eigen::Index> draws;  ///< of the posterior, of every coarse run
  std::vector<Eigen::Index> fine;   ///< which of these are run again with fine cells
  input::ParameterSets coarse_sets, fine_sets;
  double h = 0.0;                     ///< of the fine cells [m]
  std::vector<std::string> warnings;  ///< what of the scene is not as in the fit
};

/// Draws evenly spaced in the order of the chains, and of them fine ones likewise. Every body whose
/// law is the fit's takes them. Errors: BadInput if there is none, for more runs than draws, and
/// for fewer fine runs than fewest_pairs.
PropagationPlan plan_propagation(const FittedPosterior& posterior, const input::SceneFile& scene,
                                 PropagationOptions options);

/// The deposit's depth along x, in the plane.
struct DepthBand {
  std::vector<double> x, lower, median, upper;  ///< 90 %
};

struct PropagationResult {
  Eigen::MatrixXd coarse, fine;  ///< a run per row, the outputs; NaN where a run has none
  std::vector<Propagated> outputs;
  std::vector<std::vector<double>> values;  ///< of the distribution, ascending
  DepthBand depth;                          ///< empty in space
  double coarse_s = 0.0, fine_s = 0.0;      ///< of one core
};

/// From the runs, whose folders lie in `coarse` and `fine`.
PropagationResult propagation(const PropagationPlan& plan, const SceneSweep& coarse_runs,
                              const SceneSweep& fine_runs, const std::filesystem::path& coarse,
                              const std::filesystem::path& fine);

/// What propagation.json says of every output.
io::Json propagation_json(const PropagationPlan& plan, const PropagationResult& result);

/// propagation.json, propagation.csv, draws.csv (a line per draw) and, in the plane,
/// depth_bands.csv. Errors: IoError.
void write_propagation(const io::ResultFolder& folder, const FittedPosterior& posterior,
                       const PropagationPlan& plan, const PropagationResult& result);

/// What is said of it, line by line.
std::vector<std::string> propagation_words(const PropagationPlan& plan,
                                           const PropagationResult& result);

}  // namespace repose::study

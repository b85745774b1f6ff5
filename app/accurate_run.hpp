#pragma once
/// \file
/// `repose run SCENE --accuracy E --for QUANTITY`: chooses kernel, transfer, step and cells, runs
/// coarse and fine ones, and gives what they tend to with an error bar.

#include <optional>

#include "io/exit_code.hpp"
#include "study/accuracy/quantity.hpp"

namespace repose::app {

struct AccuracyRequest {
  input::SceneFile file;
  std::string origin;  ///< origin_line()
  study::Quantity quantity = study::Quantity::profile;
  double target = 0.0;           ///< relative error bar
  std::optional<double> budget;  ///< CPU seconds
  std::filesystem::path folder;  ///< for the result
  std::filesystem::path runs;    ///< for the runs; those that lie there are not repeated
  int threads = 1;               ///< of each run
  std::uint64_t seed = 0;        ///< recorded
  bool resume = false;           ///< continue an interrupted run from its checkpoint
  bool quiet = false, json = false;
  bool picture = true;  ///< draw accuracy.svg
};

/// Writes input.toml, accuracy.csv (every run), estimate.csv (the quantity with its error bar),
/// accuracy.svg, advised.toml (the scene with the finest settings used) and summary.json. Throws
/// BadInput before anything is run where the target cannot be met within the budget; returns
/// numerical_failure where the runs turn out not to meet it, with what they give. Errors: IoError.
io::ExitCode run_to_accuracy(const AccuracyRequest& request);

}  // namespace repose::app

#pragma once
/// \file
/// `repose run SCENE --accuracy E --for QUANTITY`: what it writes and says of a study::AccurateRun.

#include "io/exit_code.hpp"
#include "study/accuracy/accurate_run.hpp"

namespace repose::app {

struct AccuracyRequest : study::AccuracyGoal {
  std::string origin;            ///< origin_line()
  std::filesystem::path folder;  ///< for the result
  std::uint64_t seed = 0;        ///< recorded
  bool quiet = false, json = false;
  bool picture = true;  ///< draw accuracy.svg
};

/// Writes input.toml, accuracy.csv (every run), estimate.csv (the quantity with its error bar),
/// accuracy.svg, advised.toml (the scene with the finest settings used) and summary.json. Throws
/// BadInput before anything is run where the target cannot be met within the budget; returns
/// numerical_failure where the runs turn out not to meet it, with what they give. Errors: IoError.
io::ExitCode run_to_accuracy(const AccuracyRequest& request);

}  // namespace repose::app

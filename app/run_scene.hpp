#pragma once
/// \file
/// One run of a scene: the simulation, its result folder and what is said meanwhile.

#include "app/exit_code.hpp"
#include "app/progress.hpp"
#include "app/read_scene.hpp"

namespace repose::app {

struct RunRequest {
  SceneFile file;
  std::string input;             ///< resolved_input() of it
  std::filesystem::path folder;  ///< for the result
  int threads = 0;               ///< 0: all cores
  std::uint64_t seed = 0;        ///< recorded
  bool resume = false;           ///< continue from the folder's checkpoint
  bool picture = true;           ///< draw final.svg
  bool quiet = false;            ///< nothing but errors
  bool json = false;             ///< progress and outcome as JSON lines
};

/// Runs a scene and writes its result: input.toml, series.csv, frames, and at the end profile.csv,
/// final.svg and, last of all, summary.json. An interrupted run (SIGINT, SIGTERM) and one that
/// fails leave a checkpoint and a summary that says so. Throws InputError (keys are paths of the
/// scene), BadInput (resuming with another input) and IoError.
ExitCode run_scene(const RunRequest& request);

}  // namespace repose::app

#pragma once
/// \file
/// One run of a scene: the simulation, its result folder and what is said meanwhile.

#include <cmath>
#include <functional>

#include "input/read_scene.hpp"
#include "io/exit_code.hpp"
#include "io/progress.hpp"
#include "mpm/step/simulation.hpp"

namespace repose::study {

struct RunRequest {
  input::SceneFile file;
  std::string input;             ///< resolved_input() of it
  std::filesystem::path folder;  ///< for the result
  int threads = 0;               ///< 0: all cores
  std::uint64_t seed = 0;        ///< recorded
  bool resume = false;           ///< continue from the folder's checkpoint
  /// Draws how the run ended into a file; false if there was nothing to draw. A runtime_error that
  /// it throws becomes a warning. Empty: no picture.
  std::function<bool(const input::SceneFile&, const mpm::Simulation&,
                     const std::filesystem::path& file)>
      picture{};
  /// CPU seconds after which it stops as if interrupted, with a checkpoint
  double cpu_limit_s = HUGE_VAL;
  bool quiet = false;  ///< nothing but errors
  bool json = false;   ///< progress and outcome as JSON lines
};

/// Runs a scene and writes its result: input.toml, series.csv, frames, and at the end profile.csv,
/// final.svg and, last of all, summary.json. An interrupted run (SIGINT, SIGTERM) and one that
/// fails leave a checkpoint and a summary that says so. Throws InputError (keys are paths of the
/// scene), BadInput (resuming with another input) and IoError.
io::ExitCode run_scene(const RunRequest& request);

}  // namespace repose::study

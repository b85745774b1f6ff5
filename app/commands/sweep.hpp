#pragma once
/// \file
/// `repose point` and `repose run` on a file with [sweep].

#include <string>

#include "app/commands/command.hpp"
#include "input/read_sweep.hpp"

namespace repose::app {

/// Drives every test, or runs every scene, of the sweep. path: as the command line has it.
io::ExitCode run_point_sweep(const std::string& path, const input::InputFile& file,
                             const input::ParameterSets& sets, const CommonOptions& options);
io::ExitCode run_scene_sweep(const std::string& path, const input::InputFile& file,
                             const input::ParameterSets& sets, const CommonOptions& options);

}  // namespace repose::app

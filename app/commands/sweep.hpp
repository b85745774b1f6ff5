#pragma once
/// \file
/// `repose point` and `repose run` on a file with [sweep].

#include <string>

#include "app/commands/command.hpp"
#include "input/read_sweep.hpp"

namespace repose::app {

/// Drives every test, or runs every scene, of the sweep. path: as the command line has it; file: as
/// it was opened, before anything was read of it.
io::ExitCode run_point_sweep(const std::string& path, const input::InputFile& file,
                             const input::ParameterSets& sets, const CommonOptions& options);
io::ExitCode run_scene_sweep(const std::string& path, const input::InputFile& file,
                             const input::ParameterSets& sets, const CommonOptions& options);

/// Reads every run of the sweep, as they are read before the first is begun, and tells how many can
/// be used and what is wrong with the first that cannot. Throws BadInput if none can.
void check_sweep(const std::string& path, const input::ParameterSets& sets, bool is_scene,
                 const CommonOptions& options);

}  // namespace repose::app

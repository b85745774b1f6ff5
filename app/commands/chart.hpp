#pragma once
/// \file
/// The charts of `repose chart`, one file each.

#include "app/commands/command.hpp"

namespace repose::app {

/// Work-precision of the point driver's integrators and one-step error maps.
ExitCode chart_point(const CommonOptions& options);

}  // namespace repose::app

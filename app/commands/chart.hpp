#pragma once
/// \file
/// The charts of `repose chart`, one file each.

#include "app/commands/command.hpp"

namespace repose::app {

/// Work-precision of the point driver's integrators and one-step error maps.
ExitCode chart_point(const CommonOptions& options);

/// Every algorithm of calibration/optimise.hpp on one fit, from one start: objective against trials
/// and time. `file` is a fit file; empty: a twin experiment.
ExitCode chart_fit(const CommonOptions& options, const std::string& file, long evaluations);

}  // namespace repose::app

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

/// A scene with every transfer, kernel, cell size and step that is asked for: run-out, energies and
/// cost against the step. `file` is a scene; empty: the flat column of data/scenes/flat_mu_i.toml.
/// What is varied comes as overrides of [chart] (read_chart.hpp) in options.sets; quick: in
/// seconds.
ExitCode chart_mpm(const CommonOptions& options, const std::string& file, bool quick);

}  // namespace repose::app

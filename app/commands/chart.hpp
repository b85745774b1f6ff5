#pragma once
/// \file
/// The charts of `repose chart`, one file each. What a chart varies comes from the [chart] table of
/// its file and from overrides of that table in options.sets (read_chart.hpp). With options.resume
/// a chart whose result is there already, from the same input by the same version, is kept.

#include "app/commands/command.hpp"
#include "report/plot/figure.hpp"

namespace repose::app {

struct ChartEnd {
  io::ExitCode code = io::ExitCode::done;
  bool kept = false;  ///< the result was there already
};
/// Says so where a chart was kept; returns its code.
io::ExitCode told(const ChartEnd& end, const CommonOptions& options);

/// Draws a figure into a file; where it cannot be made or drawn (no gnuplot, nothing to draw) it
/// warns and returns false: what it shows is in the tables. Errors: IoError.
bool drawn(const report::Figure& figure, const std::filesystem::path& file);
bool drawn(const std::function<report::Figure()>& figure, const std::filesystem::path& file);

/// Work-precision of the point driver's integrators, one-step error maps and the convergence of the
/// laws' tangents. `file` has a [chart] table or is empty; quick: few settings, coarse maps.
ChartEnd chart_point(const CommonOptions& options, const std::string& file, bool quick);

/// Every algorithm of calibration/optimise.hpp on one fit, from one start: objective against trials
/// and time. `file` is a fit file; empty, or with nothing but a [chart] table: a twin experiment.
/// quick: 200 trials each, unless the table says how many.
ChartEnd chart_fit(const CommonOptions& options, const std::string& file, bool quick);

/// A scene with every transfer, kernel, cell size, step and further key that is asked for: run-out,
/// energies and cost against the step, errors against cost. `file` is a scene or the name of a
/// shipped one; empty: flat_mu_i. quick: in seconds, unless the table lists cells and steps.
ChartEnd chart_mpm(const CommonOptions& options, const std::string& file, bool quick);
/// Reads what chart_mpm would, and returns how many runs it takes. Errors: BadInput.
std::size_t check_chart_mpm(const CommonOptions& options, const std::string& file, bool quick);

/// The maps of `repose stability`: `file` has a [law] or [stability] table, or is empty.
ChartEnd stability_maps(const CommonOptions& options, const std::string& file, bool quick);

/// Every chart of a set (read_chart_set.hpp), each in a sub-folder, and a page of them all that
/// grows meanwhile. `file` empty: the shipped set. A chart that fails is told and the others go on;
/// the exit code is then that of the first that failed.
io::ExitCode chart_set(const CommonOptions& options, const std::string& file, bool quick);

/// Reads a set as chart_set would, and returns a line per chart. Errors: BadInput.
std::vector<std::string> check_chart_set(const CommonOptions& options, const std::string& file);

}  // namespace repose::app

#pragma once
/// \file
/// Many runs of one scene that differ in transfer, kernel, points per cell, cell size and step, and
/// what their results say of the step's influence.

#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "input/read_chart.hpp"
#include "study/run/finished_result.hpp"
#include "study/run/run_scene.hpp"

namespace repose::study {

/// What a chart holds at most: 2000 runs are days, and a longer list is a slip of the pen.
inline constexpr std::size_t most_chart_scenes = 500;
inline constexpr int most_chart_runs = 2000;

/// What is not given: every transfer that the scene admits (a note tells of the others), the
/// scene's kernel and points per cell, cells of 8, 4 and 2 times the scene's h (three, so that
/// there is a reference: mpm_errors.hpp), Courant numbers of 0.8, 0.4, 0.2, 0.1 unless there are
/// fixed steps. quick: cells of 4 h alone and Courant numbers of 0.8 and 0.4, so that the whole
/// chart takes seconds.
input::Sweep with_defaults(input::Sweep sweep, const mpm::Scene& scene, bool quick,
                           std::vector<std::string>& notes);

/// A scene with one value of every key of Sweep::vary.
struct SceneVariant {
  input::SceneFile file;
  std::vector<std::pair<std::string, std::string>> values;  ///< key and value, in that order
};

/// One run of a sweep and, once it is there, its result. Figures keep the names of summary.json.
struct SweepRun {
  input::SceneFile file;  ///< named after what is varied, with 60 rows of series
  std::vector<std::pair<std::string, std::string>> varied;  ///< as in SceneVariant
  RunSummary summary;
  NumberTable series;                ///< series.csv
  std::vector<double> x_m, depth_m;  ///< profile.csv

  const mpm::Scene& scene() const { return file.scene; }
  /// "pressure_averaging 50"; "" where nothing but what has a list of its own is varied.
  std::string variation() const;
  /// "" as long as there is no result.
  const std::string& status() const { return summary.status; }
  bool done() const { return status() == "done"; }
  /// A number of summary.json, under its name in the plane (named()); NaN where there is none.
  double figure(std::string_view key) const;
  /// A column of series.csv, likewise; empty where there is none.
  const std::vector<double>& column(std::string_view key) const;
  /// Mean step [s].
  double mean_dt() const { return figure("time_s") / figure("steps"); }
  double point_steps() const { return figure("point_steps_per_s") * figure("wall_s"); }
  double point_steps_per_cpu_s() const { return point_steps() / figure("cpu_s"); }
  double bytes_per_point() const { return 1e6 * figure("state_memory_MB") / figure("points"); }
};

/// A run of a scene in a sweep: h, transfer, kernel, points per cell and the step as in `scene`,
/// rows of its series evenly over the time, no frames; named after what differs.
SweepRun run_of(const input::SceneFile& base, mpm::Scene scene);

/// Every combination, in the order transfer, kernel, points per cell, cell size, step, with longer
/// steps first; then those of Sweep::reference. A transfer's own settings are the scene's. Errors:
/// InputError, key "chart.cells" or "chart.transfers".
std::vector<SweepRun> runs_of(const input::SceneFile& scene, const input::Sweep& sweep);
/// The same for every variant of a scene, one after the other; Sweep::reference with the first.
std::vector<SweepRun> runs_of(std::span<const SceneVariant> variants, const input::Sweep& sweep);

/// Runs of one variant, transfer, kernel, points per cell and cell size: what only the step tells
/// apart.
struct SweepSeries {
  std::vector<const SweepRun*> runs;  ///< all of them, as in the sweep
  const mpm::Scene& scene() const { return runs.front()->scene(); }
  /// "relaxed", and what of points per cell and Sweep::vary is not the scene's usual.
  std::string name() const;
  /// The finished run with the shortest mean step; null as long as a run has no result.
  const SweepRun* finest() const;
  /// The finished ones, longest mean step first.
  std::vector<const SweepRun*> done_runs() const;
};
std::vector<SweepSeries> series_of(std::span<const SweepRun> runs);

/// How far the end of one run is from that of another with the same cells.
struct SweepChange {
  double front;         ///< front_m, relative
  double front_99;      ///< front_99_m, relative
  double height;        ///< height_m, relative
  double profile_mean;  ///< ∫|Δdepth| dx over front × H_0
  double profile_max;   ///< max |Δdepth|/H_0
};
/// Absent unless both runs are done and reached an end with material in the box.
std::optional<SweepChange> change_between(const SweepRun& run, const SweepRun& reference);

/// The largest changes when the step is quartered, over all pairs of runs of a series whose nominal
/// steps differ by a factor of 4; absent if there is no such pair or one of its runs is missing.
std::optional<SweepChange> change_when_quartered(const SweepSeries& series);

/// Runs it as `repose run` would, in folder/NAME. What lies there already is not repeated if it
/// came to its end (or failed) from the same input (its text is compared, not a hash of it) by the
/// same solver (solver_digest of repose_version.hpp), be it of another version of repose; with
/// `resume`, an interrupted run goes on from its checkpoint. Returns interrupted if it was, or
/// stopped by cpu_limit_s; a run that failed is kept as such. Errors: IoError.
io::ExitCode carry_out(SweepRun& run, const std::filesystem::path& folder, int threads, bool resume,
                       double cpu_limit_s = HUGE_VAL);

}  // namespace repose::study

#pragma once
/// \file
/// Many runs of one scene that differ in transfer, kernel, cell size and step, and what their
/// results say of the step's influence.

#include <map>
#include <span>

#include <nlohmann/json.hpp>

#include "app/read_chart.hpp"
#include "app/run_scene.hpp"

namespace repose::app {

/// What is not given: every transfer that the scene admits (a note tells of the others), the
/// scene's kernel, cells of 4 and 2 times the scene's h, Courant numbers of 0.8, 0.4, 0.2, 0.1
/// unless there are fixed steps. quick: cells of 4 h alone and Courant numbers of 0.8 and 0.4, so
/// that the whole chart takes seconds.
Sweep with_defaults(Sweep sweep, const mpm::Scene& scene, bool quick,
                    std::vector<std::string>& notes);

/// One run of a sweep and, once it is there, its result. Figures keep the names of summary.json.
struct SweepRun {
  SceneFile file;          ///< named after what is varied, with 60 rows of series
  nlohmann::json summary;  ///< null: no result yet
  std::map<std::string, std::vector<double>, std::less<>> series;  ///< columns of series.csv
  std::vector<double> x_m, depth_m;                                ///< profile.csv

  const mpm::Scene& scene() const { return file.scene; }
  /// "" as long as there is no result.
  std::string status() const { return summary.is_object() ? summary.value("status", "") : ""; }
  bool done() const { return status() == "done"; }
  /// A number of summary.json; NaN where there is none.
  double figure(std::string_view key) const;
  /// Mean step [s].
  double mean_dt() const { return figure("time_s") / figure("steps"); }
  double point_steps() const { return figure("point_steps_per_s") * figure("wall_s"); }
  double point_steps_per_cpu_s() const { return point_steps() / figure("cpu_s"); }
  double bytes_per_point() const { return 1e6 * figure("state_memory_MB") / figure("points"); }
};

/// Every combination, in the order transfer, kernel, cell size, step, with longer steps first. A
/// transfer's own settings are the scene's. Errors: InputError, key "chart.cells" or
/// "chart.transfers".
std::vector<SweepRun> runs_of(const SceneFile& scene, const Sweep& sweep);

/// Runs of one transfer, kernel and cell size: what only the step tells apart.
struct SweepSeries {
  std::vector<const SweepRun*> runs;  ///< all of them, as in the sweep
  const mpm::Scene& scene() const { return runs.front()->scene(); }
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

/// Runs it as `repose run` would, in folder/NAME, or with `resume` takes what lies there: a
/// finished run of the same input as it is, an interrupted one from its checkpoint. Returns
/// interrupted if it was; a run that failed is kept as such. Errors: IoError.
ExitCode carry_out(SweepRun& run, const std::filesystem::path& folder, int threads, bool resume);

}  // namespace repose::app

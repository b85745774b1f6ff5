#pragma once
/// \file
/// What a run leaves in words and figures: the columns of series.csv and summary.json.

#include <optional>

#include <toml++/toml.h>

#include "io/result_folder.hpp"
#include "mpm/step/simulation.hpp"

namespace repose::study {

/// The name of a figure or column of the plane in the scene's dimensions: what the plane has per
/// metre of depth is whole in space, kinetic_J_per_m and kinetic_J.
std::string named(std::string_view name, std::size_t dimensions);

/// The columns of series.csv, in order, for a scene in the plane or in space, over a terrain with
/// those of the flow's extent last; and their values now, of which `row` are the diagnostics.
std::vector<std::string> series_columns(const mpm::Scene& scene);
std::vector<double> series_values(const mpm::SeriesRow& row, const mpm::Simulation& simulation);

/// Resources used by the process so far.
struct Usage {
  double wall_s = 0.0;  ///< since an arbitrary moment
  double cpu_s = 0.0;   ///< user and system, all threads
  double peak_memory_MB = 0.0;
};
Usage usage();

/// Figures of a run that no single moment tells; carried through a resumption by summary.json.
struct RunRecord {
  std::size_t dimensions = 2;
  double initial_potential_J_per_m = 0.0;
  double initial_mass_kg_per_m = 0.0;
  double peak_kinetic_J_per_m = 0.0;  ///< over the rows of the series
  std::int64_t initial_points = 0;
  double wall_s = 0.0, cpu_s = 0.0;  ///< of the sessions before this one
  int sessions = 1;

  explicit RunRecord(const mpm::Simulation& start);
  void include(const mpm::SeriesRow& row);
  /// Takes over what an interrupted run noted. Errors: IoError if it is not there or not JSON.
  void continue_from(const std::filesystem::path& summary);

  /// |what the ledger does not account for| over the potential energy lost, or over the peak
  /// kinetic energy if that is larger; 0 if nothing ever moved.
  double energy_error(const mpm::SeriesRow& last) const;
  /// Points that are neither there nor have left through an open edge; 0 in a sound run.
  std::int64_t lost_points(std::int64_t present, const mpm::SeriesRow& last) const;
};

/// The status that a summary.json tells; "" if there is none or it cannot be read.
std::string noted_status(const std::filesystem::path& summary);

/// What is known about a run beside its figures.
struct RunFacts {
  std::string status;  ///< done | interrupted | failed
  std::string reason;  ///< of a failure
  toml::table input;   ///< resolved
  std::uint64_t seed = 0;
  std::vector<std::string> warnings;
};

/// The text of summary.json. Values that are not finite become null.
std::string summary_text(const RunFacts& facts, const RunRecord& record,
                         const mpm::Simulation& simulation, const Usage& spent);

}  // namespace repose::study

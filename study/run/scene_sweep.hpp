#pragma once
/// \file
/// Many runs of a scene, each a result folder, and one table of their figures.

#include <functional>
#include <optional>
#include <set>

#include <Eigen/Core>

#include "study/run/finished_result.hpp"
#include "study/run/run_scene.hpp"
#include "study/run/sweep_cases.hpp"

namespace repose::study {

/// One run of a sweep.
struct SceneCase {
  std::vector<std::string> values;       ///< of the varied keys, as the table shows them
  std::optional<input::SceneFile> file;  ///< none: the input was refused
  std::string input;                     ///< resolved_input() of it
  std::string refusal;                   ///< why
  RunSummary summary{};                  ///< once it is there; status "refused" without a run
};

class SceneSweep {
 public:
  /// All runs, read from the file. table: what asks for them, "sweep". level: a word for several
  /// sweeps of a file, "coarse"; of those, and wherever frames are too many, without frames.
  SceneSweep(const input::InputFile& file, const input::ParameterSets& sets, std::string_view table,
             bool frames, const std::string& level = "");

  /// Runs one after the other in folder/runs/0001, ..., and writes sweep.csv after each. With
  /// `resume` what came to its end from the same input is kept, and an interrupted run goes on.
  /// `told` is called after each with its number, from 1. Returns `interrupted` if it was.
  /// Errors: IoError; InputError of a scene that cannot be begun.
  io::ExitCode run(const io::ResultFolder& folder, int threads, std::uint64_t seed, bool resume,
                   const std::function<void(std::size_t)>& told);

  /// The same runs side by side, each on one thread, for many small ones: no sweep.csv, `told` one
  /// at a time but in any order, and what cannot be begun counts as refused.
  io::ExitCode run_side_by_side(const io::ResultFolder& folder, int threads, std::uint64_t seed,
                                bool resume, const std::function<void(std::size_t)>& told);

  /// sweep.csv: a row per run with the varied keys, status and the numbers of its summary.json.
  std::string table() const;
  std::size_t count(std::string_view status) const;
  SweepCounts counts() const;
  const std::vector<std::string>& keys() const { return keys_; }
  const std::vector<SceneCase>& cases() const { return cases_; }
  /// "0001": of a run, from 1.
  static std::string folder_name(std::size_t run);

 private:
  io::ExitCode run_one(std::size_t k, const io::ResultFolder& folder, int threads,
                       std::uint64_t seed, bool resume);

  std::vector<std::string> keys_;
  std::string level_;
  std::vector<SceneCase> cases_;
};

/// The figures of every run that is done, a column each; NaN where a run has none. A name that
/// summary.json does not have is that of a column of series.csv. runs: where their folders lie.
Eigen::MatrixXd outputs_of(const SceneSweep& sweep, const std::vector<std::string>& names,
                           const std::filesystem::path& runs);
/// The names that the runs of a scene will have. Errors: InputError for a scene that cannot be
/// begun.
std::set<std::string> output_names(const input::SceneFile& scene);

}  // namespace repose::study

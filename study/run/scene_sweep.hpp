#pragma once
/// \file
/// Many runs of a scene, each a result folder, and one table of their figures.

#include <functional>
#include <optional>

#include "study/run/finished_result.hpp"
#include "study/run/run_scene.hpp"

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
  SceneSweep(std::vector<std::string> keys, std::vector<SceneCase> cases)
      : keys_(std::move(keys)),
        cases_(std::move(cases)) {}

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
  const std::vector<std::string>& keys() const { return keys_; }
  const std::vector<SceneCase>& cases() const { return cases_; }
  /// "0001": of a run, from 1.
  static std::string folder_name(std::size_t run);

 private:
  io::ExitCode run_one(std::size_t k, const io::ResultFolder& folder, int threads,
                       std::uint64_t seed, bool resume);

  std::vector<std::string> keys_;
  std::vector<SceneCase> cases_;
};

}  // namespace repose::study

#pragma once
/// \file
/// Many point tests in one process: one table of their figures, one of their curves.

#include <optional>

#include "io/exit_code.hpp"
#include "io/result_folder.hpp"
#include "study/point/test_result.hpp"
#include "study/run/sweep_cases.hpp"

namespace repose::study {

/// One test of a sweep.
struct PointCase {
  std::vector<std::string> values;           ///< of the varied keys, as the table shows them
  std::optional<input::PointTestFile> test;  ///< none: the input was refused
  std::string refusal;                       ///< why
};

/// What is kept of a finished one.
struct PointFigures {
  std::string status;  ///< done | failed | refused
  std::string reason;
  std::size_t rows = 0;
  double wall_s = 0.0;     ///< of driving
  io::Json figures;        ///< numbers and words under the names of summary.json
  std::string checksum{};  ///< of its rows of curves.csv, or of the figures where there is none
};

class PointSweep {
 public:
  /// All tests, read from the file. table: what asks for them, "sweep".
  PointSweep(const input::InputFile& file, const input::ParameterSets& sets,
             std::string_view table);

  /// Drives what is not done yet and leaves curves.csv (run, then the columns of curve.csv) and,
  /// while it goes on, finished.jsonl, by which it is taken up again with `resume`. Returns
  /// `interrupted` if it was (SIGINT, SIGTERM), otherwise `done`. threads: 0 for all cores; the
  /// result does not depend on it. with_curves: false leaves no curves.csv, of many runs whose
  /// figures alone count. Errors: IoError.
  io::ExitCode run(const io::ResultFolder& folder, int threads, bool resume,
                   bool with_curves = true);

  /// sweep.csv: a row per run with the varied keys, status and figures.
  std::string table() const;

  std::size_t runs() const { return cases_.size(); }
  std::size_t kept() const { return kept_; }  ///< were there already
  std::size_t count(std::string_view status) const;
  SweepCounts counts() const;
  double driving_s() const;  ///< spent in the integrators, over all threads
  const std::vector<std::string>& keys() const { return keys_; }
  const std::vector<PointCase>& cases() const { return cases_; }
  const std::vector<PointFigures>& finished() const { return finished_; }

 private:
  void take_up(const io::ResultFolder& folder, bool with_curves);
  std::string log_line(std::size_t run) const;

  std::vector<std::string> keys_;
  std::vector<PointCase> cases_;
  std::vector<PointFigures> finished_;  ///< of the first so many runs
  std::size_t kept_ = 0;
};

}  // namespace repose::study

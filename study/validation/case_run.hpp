#pragma once
/// \file
/// A validation case carried out: every figure of every law, and what it is worth.

#include <functional>
#include <vector>

#include "io/exit_code.hpp"
#include "study/validation/curve_distance.hpp"
#include "study/validation/verdict.hpp"

namespace repose::study {

/// A figure with one law.
struct FigureResult {
  Verdict verdict = Verdict::not_run;
  std::string reason;          ///< why it failed, is absent or has no error bar
  Estimated estimated;         ///< in the figure's unit
  std::vector<double> values;  ///< by cell size; of a point test: as it is, and refined
  PlainCurve curve;            ///< of a figure that compares curves, at the finest size; SI
};

/// All figures of one law.
struct LawResult {
  std::vector<FigureResult> figures;  ///< as Benchmark::figures
  double cpu_s = 0.0;                 ///< of its runs, those that were kept included

  std::size_t count(Verdict verdict) const;
  /// Were there runs, or are there to be none?
  bool ran() const { return count(Verdict::absent) + count(Verdict::not_run) < figures.size(); }
};

struct ValidationOptions {
  int threads = 0;                   ///< 0: all cores
  bool resume = false;               ///< interrupted runs go on
  bool coarse = false;               ///< the coarsest size alone, without error bars
  std::vector<std::size_t> columns;  ///< of input::benchmark_columns; none: all
};

struct CaseResult {
  input::Benchmark benchmark;
  std::array<LawResult, input::benchmark_columns.size()> laws;

  /// Nothing run yet; absent laws are told.
  CaseResult(input::Benchmark the_case, const ValidationOptions& options);
  /// "h_0.01_m" for each cell size, or "as_it_is" and "refined": what FigureResult::values are of.
  std::vector<std::string> sizes() const;
  std::size_t count(Verdict verdict) const;
  double cpu_s() const;
};

/// Carries the case out, law by law; `told` is called after each with its column. Runs of scenes
/// are result folders in folder/runs, NAME being COLUMN_hH, and are not repeated as long as input
/// and solver are the same; curves of point tests lie there as well. A law whose run fails has no
/// figures, and the others go on. Returns interrupted if it was, else done. Errors: IoError.
io::ExitCode run_case(CaseResult& result, const std::filesystem::path& folder,
                      const ValidationOptions& options,
                      const std::function<void(std::size_t column)>& told);

}  // namespace repose::study

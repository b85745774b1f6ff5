#pragma once
/// \file
/// The rule of `repose run --accuracy`: what the runs so far amount to, whether that may be
/// promised, and what to run next. No run is made here.

#include <string>

#include "study/accuracy/error_model.hpp"

namespace repose::study {

/// What is asked for.
struct Question {
  double target = 0.0;       ///< relative error bar
  double budget = HUGE_VAL;  ///< of all runs together, in the unit of their costs
  /// Why the error model does not speak for the scene, in words; empty where it does.
  std::vector<std::string> reasons{};
};

/// What an answer's error bar rests on.
enum class Basis {
  measured,  ///< the errors of scenes of its kind, and nothing in its own runs says otherwise
  own_runs,  ///< what its own runs show (own_runs.hpp), and nothing else
};
constexpr std::array<std::string_view, 2> basis_names{"measured", "own runs"};
constexpr std::string_view name_of(Basis basis) {
  return basis_names[static_cast<std::size_t>(basis)];
}

struct Answer {
  Estimate estimate;  ///< its error is HUGE_VAL where there is only one size
  Basis basis = Basis::measured;
  std::vector<std::string> reasons;  ///< why not `measured`
  bool met = false;  ///< the bar is at most the target, and own runs have three sizes to show it
  /// Of own runs: the part of the bar that more runs of the same sizes would make smaller.
  double scattered = 0.0;
};

/// From the runs so far, of which there must be one. The model speaks where the question has no
/// reasons against it and the runs do not contradict it: their pairs of sizes differ by at most
/// most_shown times what it expects, and where three sizes (own_runs.hpp) give an estimate of their
/// own, that and the model's lie within each other's error bars.
Answer answer_of(const Convergence& so_far, const Question& question);
inline constexpr double most_shown = 2.0;

/// The size to run next: the next of the cheapest plan, or for own runs the next finer one that is
/// a half or a third of a coarser, unless scatter makes most of the bar; then the finest once more.
/// Absent where the sizes, the budget or the plans are at their end.
std::optional<Level> next_run(const Convergence& so_far, const Question& question,
                              const std::vector<double>& sizes, const std::vector<double>& seconds);

/// What an answer from own runs will take, as the error model expects it: the sizes down to the
/// first whose bias, cautiously, is the target; down to the finest where none is.
Plan expected_own_runs(const Convergence& nothing_yet, double target,
                       const std::vector<double>& sizes, const std::vector<double>& seconds);

enum class Outcome {
  met,           ///< the answer meets the target
  out_of_reach,  ///< no further run is worth while or within the budget
  stopped,       ///< a run gave nothing
};
/// Runs what comes next until the answer meets the target. run(level) makes one run with cells of
/// level.h, of which there are level.runs so far; it may change `seconds` on the way, and the
/// question's reasons.
Outcome run_to_target(Convergence& so_far, const Question& question,
                      const std::vector<double>& sizes, const std::vector<double>& seconds,
                      const std::function<std::optional<Eigen::VectorXd>(const Level&)>& run);

}  // namespace repose::study

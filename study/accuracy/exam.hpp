#pragma once
/// \file
/// Answers of `repose run --accuracy` against references that they do not know: what counts as
/// right, and the tables that say so. The rules stand in docs/accuracy.md.

#include <span>
#include <string>
#include <vector>

#include "study/accuracy/decision.hpp"

namespace repose::study {

/// The reference of two kernels, each extrapolated: their mean. Its error bar is the root of the
/// squares of the mean of theirs and of half the distance between them.
Reference reference_of_both(const Reference& a, const Reference& b);

/// An answer to one question about one scene.
struct Graded {
  std::string scene;
  bool shipped = false;  ///< a scene of data/scenes at its own end time
  std::string quantity;  ///< one of advised_names
  double target = 0.0;
  bool promised = false;       ///< the program said that the target is met
  std::string basis;           ///< one of basis_names
  double bar = 0.0;            ///< the program's error bar, relative; HUGE_VAL for none
  double error = 0.0;          ///< distance from the reference, relative
  double reference_bar = 0.0;  ///< of the reference, relative
  double cpu_s = 0.0;          ///< of all runs of the answer
  double finest_h = 0.0;       ///< [m]
};

enum class Verdict {
  within,       ///< promised, and at most 1.5 targets off
  beyond,       ///< promised, and further off
  bar_holds,    ///< not promised, and at most the bar off
  bar_broken,   ///< not promised, and further off than the bar
  undecidable,  ///< the reference's bar is more than half of the target, or of the wide bar
};
constexpr std::size_t verdict_count = 5;
Verdict verdict_of(const Graded& answer);

/// Answers counted by their verdicts.
struct Marks {
  std::array<int, verdict_count> count{};
  void add(const Graded& answer);
  int operator[](Verdict v) const { return count[static_cast<std::size_t>(v)]; }
  int questions() const;
  /// Of the promised ones that can be decided, those within; NaN where there are none.
  double share_within() const;
  /// Of all questions, those that were not promised, undecidable ones included.
  double share_not_promised() const;
  int not_promised = 0;
};

/// The tables of docs/accuracy.md in Markdown: the sum, by quantity and target, by basis, the
/// shipped scenes, and every answer that is beyond, broken or undecidable.
std::string exam_tables(std::span<const Graded> answers);

/// One answer as a line of JSON, and back. Errors: std::invalid_argument for a line that is none.
std::string line_of(const Graded& answer);
Graded graded_of(std::string_view line);

}  // namespace repose::study

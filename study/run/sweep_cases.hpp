#pragma once
/// \file
/// The runs of one file that differ in keys of it.

#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "input/read_sweep.hpp"
#include "study/run/run_record.hpp"

namespace repose::study {

/// Every run, read and checked before the first is begun: `read` fills a case from the file with
/// what the run sets. One that cannot be used is a row of the table; if none can, the first one's
/// mistakes are the file's.
/// table: what asks for the runs, "sweep". seconds: after so many no further run is read.
template <class Case, class Read>
std::vector<Case> cases_of(const input::InputFile& file, const input::ParameterSets& sets,
                           std::string_view table, const Read& read, double seconds = HUGE_VAL) {
  std::vector<Case> cases;
  std::size_t refused = 0;
  const double begun = usage().wall_s;
  for (std::size_t k = 0; k < sets.values.size(); ++k) {
    if (k > 0 && usage().wall_s - begun > seconds) break;
    Case& one = cases.emplace_back();
    one.values = sets.shown(k);
    try {
      input::InputFile run = file.with(sets.sets(k));
      read(one, run, k + 1);
    } catch (const input::BadInput& error) {
      one.refusal = fmt::format("{}", fmt::join(error.problems(), "; "));
      ++refused;
    }
  }
  if (refused == cases.size())
    throw input::BadInput({fmt::format("{}: [{}]: none of its {} runs can be used; the first:",
                                       to_string(file.origin(table)), table, cases.size()),
                           cases.front().refusal});
  return cases;
}

/// How runs ended.
struct SweepCounts {
  std::size_t runs = 0, done = 0, failed = 0, refused = 0;
  /// Which are not done, and why: "run 7".
  std::vector<std::pair<std::string, std::string>> reasons{};

  std::size_t ended() const { return done + failed + refused; }
  /// status: "" of one that has not been run.
  void add(const std::string& run, std::string_view status, const std::string& reason);
  SweepCounts& operator+=(const SweepCounts& other);
};

/// Complains of outputs that are none of the names that a run has. place: where they are asked for.
/// Errors: BadInput, with the nearest name.
void require_outputs(const std::vector<std::string>& outputs, const std::set<std::string>& names,
                     const std::string& place);

/// The file with what the command line changed, so that it makes the same runs again, under a
/// comment.
std::string sweep_text(const input::InputFile& file, const std::string& comment);

}  // namespace repose::study

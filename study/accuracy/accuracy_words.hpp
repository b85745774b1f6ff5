#pragma once
/// \file
/// What is said of an AccurateRun, in words: its plan, its runs, its answer, and why a goal is
/// refused. Each sentence ends with a line break, apart from a refusal.

#include <string>

#include "study/accuracy/accurate_run.hpp"

namespace repose::study {

/// "2 %", to two digits.
std::string percent(double x);
/// "2 %" of an error bar, or that there is none.
std::string bar_words(double error);

/// Why a goal is refused before anything is run, and what could be asked for instead.
std::string refusal(const AccurateRun& work);
/// What will be run, and what it is expected to give.
std::string plan_words(const AccurateRun& work);
/// A run that came to its end.
std::string run_words(Quantity quantity, const SweepRun& run);
/// The value with its error bar, what is promised of it, and what it took.
std::string answer_words(const AccurateRun& work, const Answer& answer);
/// What summary.json calls promise: kept_to is the target, or null where it cannot be promised.
io::Json promise_json(const AccurateRun& work, const Answer& answer);

}  // namespace repose::study

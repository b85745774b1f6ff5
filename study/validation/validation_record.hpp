#pragma once
/// \file
/// What validation leaves in words and figures: result.csv, and the cases of summary.json.

#include "io/json.hpp"
#include "study/validation/case_run.hpp"

namespace repose::study {

/// A row per figure and column: value, error bar, value by size, measured, band, verdict, reason,
/// cpu_s (of all runs of the law).
std::string result_csv(const CaseResult& result);

/// summary.json: of each case "name", "title", the number of figures of each verdict, "cpu_s" and
/// "laws", which has each figure of each column. sets: overrides of every scene and test.
io::Json validation_json(std::span<const CaseResult> cases, const std::string& status,
                         const ValidationOptions& options, const std::vector<std::string>& sets);

/// input.toml: what was asked for.
std::string validation_input(std::span<const CaseResult> cases, const ValidationOptions& options,
                             const std::vector<std::string>& sets);

/// "3 of 4 inside, 1 undecided", "absent", "not run": a law's figures in a few words.
std::string verdict_words(const LawResult& law);

/// The reason that all figures of a law share; "" if they do not.
std::string shared_reason(const LawResult& law);

}  // namespace repose::study

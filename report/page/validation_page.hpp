#pragma once

#include <span>
#include <string>

#include "study/validation/case_run.hpp"

namespace repose::report {

/// The page of `repose validate`, Markdown: a table of cases and laws, then every case with its
/// source, figures and picture. note: a line below the title; may be empty. pictures: whether the
/// cases have one, NAME/result.svg.
std::string validation_page(std::span<const study::CaseResult> cases, const std::string& note,
                            bool pictures);

/// Its first table: what each law makes of each case, no cell blank.
std::string validation_table(std::span<const study::CaseResult> cases);

}  // namespace repose::report

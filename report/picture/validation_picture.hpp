#pragma once

#include "report/plot/figure.hpp"
#include "study/validation/case_run.hpp"

namespace repose::report {

/// A validation case, a panel per figure: what was measured and the laws' curves at their finest
/// size, or, of a number, each law's value with its error bar in the band. Laws without a result
/// are left out. Throws std::logic_error where there is none at all.
Figure validation_picture(const study::CaseResult& result);

}  // namespace repose::report

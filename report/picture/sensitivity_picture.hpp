#pragma once

#include <string>
#include <vector>

#include "report/plot/figure.hpp"
#include "study/sensitivity/sensitivity.hpp"

namespace repose::report {

/// A panel for each output that has indices: bars of the first and the total share of every input
/// with their intervals, or by Morris the plane of μ* and σ with both. Throws std::logic_error if
/// none has any.
Figure sensitivity_picture(const study::SensitivityPlan& plan,
                           const std::vector<study::OutputSensitivity>& outputs,
                           const std::string& name);

}  // namespace repose::report

#pragma once
/// \file
/// The picture of `repose chart fit`.

#include "report/plot/figure.hpp"
#include "study/chart/fit_chart.hpp"

namespace repose::report {

/// Best objective so far over the first one, over trials and over time; two panels per group of
/// algorithms. task: what is fitted.
Figure fit_chart_figure(const std::vector<study::AlgorithmRun>& runs, const std::string& task,
                        double first);

}  // namespace repose::report

#pragma once
/// \file
/// The picture of `repose run --accuracy`.

#include "report/plot/figure.hpp"
#include "report/plot/gnuplot.hpp"
#include "study/accuracy/error_model.hpp"
#include "study/accuracy/quantity.hpp"

namespace repose::report {

/// A number over the cell size: every run, the means, and the extrapolation to cells of size 0 with
/// its error bar. A curve: of every cell size, and extrapolated. bin: as for shares_of().
Figure accuracy_picture(const std::vector<study::SweepRun>& runs, study::Quantity q,
                        const study::Convergence& so_far, const study::Estimate& estimate,
                        double target, double bin);

}  // namespace repose::report

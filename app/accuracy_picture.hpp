#pragma once
/// \file
/// The picture of `repose run --accuracy`.

#include "app/mpm_quantity.hpp"
#include "app/plot/figure.hpp"
#include "app/plot/gnuplot.hpp"
#include "calibration/error_model.hpp"

namespace repose::app {

/// A number over the cell size: every run, the means, and the extrapolation to cells of size 0 with
/// its error bar. A curve: of every cell size, and extrapolated. bin: as for shares_of().
Figure accuracy_picture(const std::vector<SweepRun>& runs, Quantity q,
                        const calibration::Convergence& so_far,
                        const calibration::Estimate& estimate, double target, double bin);

}  // namespace repose::app

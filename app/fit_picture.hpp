#pragma once
/// \file
/// The pictures of a fit.

#include "app/fit_record.hpp"
#include "app/plot/figure.hpp"

namespace repose::app {

/// Data against the best fit with its 95 % band (from the parameters' covariance), residuals below;
/// a pair of panels per target and channel, held-out targets named as such.
Figure fit_picture(const FitFile& file, const calibration::Problem& problem,
                   const FitResult& result);

/// Convergence of every start, profile likelihoods and the parameters' correlation.
Figure fit_diagnostics(const FitFile& file, const FitResult& result);

}  // namespace repose::app

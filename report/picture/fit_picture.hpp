#pragma once
/// \file
/// The pictures of a fit.

#include "report/plot/figure.hpp"
#include "study/fit/fit_record.hpp"

namespace repose::report {

/// Data against the best fit with its 95 % band (from the parameters' covariance), residuals below;
/// a pair of panels per target and channel, held-out targets named as such.
Figure fit_picture(const input::FitFile& file, const calibration::Problem& problem,
                   const study::FitResult& result);

/// Convergence of every start, profile likelihoods and the parameters' correlation.
Figure fit_diagnostics(const input::FitFile& file, const study::FitResult& result);

}  // namespace repose::report

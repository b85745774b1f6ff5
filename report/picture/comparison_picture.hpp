#pragma once
/// \file
/// The picture of a comparison of fits.

#include "report/plot/figure.hpp"
#include "study/fit/comparison.hpp"

namespace repose::report {

/// What the criteria of each fit lie above the least, with both kinds of errors, and the error and
/// the log score per row of every test that the fit has not seen.
Figure comparison_picture(const study::Comparison& comparison);

}  // namespace repose::report

#pragma once
/// \file
/// The pictures of a posterior.

#include "report/plot/figure.hpp"
#include "study/fit/sampling.hpp"

namespace repose::report {

/// Every curve with the 90 % bands of the curve and of its repetition, held-out targets named as
/// such.
Figure posterior_bands_picture(const input::FitFile& file, const study::PosteriorResult& result);

/// The draws of every parameter, and of every two of them.
Figure posterior_corner_picture(const input::FitFile& file, const study::PosteriorResult& result);

}  // namespace repose::report

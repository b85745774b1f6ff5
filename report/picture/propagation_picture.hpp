#pragma once
/// \file
/// What a posterior leaves of a scene's results.

#include "report/plot/figure.hpp"
#include "study/propagate/propagation.hpp"

namespace repose::report {

/// The distribution of every output beside that of the coarse runs, and the band of the depth.
Figure propagation_picture(const study::PropagationPlan& plan,
                           const study::PropagationResult& result, const std::string& name);

}  // namespace repose::report

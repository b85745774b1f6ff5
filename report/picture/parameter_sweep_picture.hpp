#pragma once
/// \file
/// The pictures of many tests, or runs, that differ in keys of their file (sweep.svg).

#include "report/plot/figure.hpp"
#include "study/point/point_sweep.hpp"
#include "study/run/scene_sweep.hpp"

namespace repose::report {

/// All curves in the two panels that the users of such a test look at first: triaxial q–ε_a and
/// q–p′, simple shear τ–γ and τ–σ′_yy, oedometer e–log σ′_a and K0, isotropic v–ln p′; named after
/// the varied keys as long as there are few. curves: the sweep's curves.csv.
Figure point_sweep_picture(const study::PointSweep& sweep, const std::string& name,
                           const std::filesystem::path& curves);

/// Front of 99 % of the mass and height over time, and the profiles at the end, of all runs that
/// are done. runs: the folder with theirs.
Figure scene_sweep_picture(const study::SceneSweep& sweep, const std::string& name,
                           const std::filesystem::path& runs);

}  // namespace repose::report

#pragma once
/// \file
/// Flows of a layer in a strip that is periodic along the flow, of which the exact solution is
/// known (docs/physics.md, "Exact flows").

#include "study/accuracy/quantity.hpp"

namespace repose::study {

/// The exact momentum (momentum_x) or the kinetic energy over time of the flow that a
/// scene sets up, as shares like those of its runs; absent for other quantities. The layer is the
/// scene's only body.
///
///   couette         from rest between a fixed floor and a top that slides at V from t = 0 on,
///                   without gravity
///   inclined_layer  from rest on a fixed floor, with a free surface, pulled by g sin(tilt)
///   bagnold         the same of μ(I) grains (grain_layer.hpp)
///
/// Errors: InputError, key "chart.exact", where the scene sets up another flow.
std::optional<Eigen::VectorXd> exact_shares(input::ExactFlow flow, const mpm::Scene& scene,
                                            Quantity q);

}  // namespace repose::study

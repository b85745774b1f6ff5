#pragma once

#include "mpm/step/simulation.hpp"
#include "mpm/study/estimate.hpp"
#include "report/plot/figure.hpp"

namespace repose::report {

/// A scene before it is run: bodies by colour with their points, the box with its edges, what is
/// rigid and what moves, where material comes in, probes and tracers; in space the section of
/// final.svg (heap_picture.hpp), of a terrain the plan. start: the scene laid out, before its first
/// step; null where it has too many points for that, and bodies are then drawn as shapes.
Figure scene_picture(const mpm::Scene& scene, const mpm::Estimate& estimate,
                     const mpm::Simulation* start);

}  // namespace repose::report

#pragma once

#include <span>
#include <string>

#include "io/json.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::report {

/// What the animation of a run shows beside its points, in the plane that its frames are seen in
/// (in space along z; over a terrain from above):
///     {"bodies": ["sand (mu_i)"],
///      "plan": false, "plan_height": 0,   whether it is seen from above, and then plan_height()
///      "edges": [{"kind": "open", "from": [x, y], "to": [x, y]}],  closed, open, periodic, inflow
///      "surfaces": [{"name": "gate", "hollow": false,   outlines for each of `times`, or for all:
///                    "outlines": [[[[x, y], …], …], …]}],  rings, of which one in another is a
///                    hole
///      "probes": [{"name": "toe", "place": [x, y]}],
///      "tracers": ["block"],
///      "lines": [{"kind": "contour", "places": [[x, y], …]}]}        contour, release
io::Json scene_marks(const mpm::Scene& scene, std::span<const double> times);

/// Over a terrain frames are seen from above: the height of the map in the page, up to which y =
/// height − z; 0 for other scenes, which are seen along z.
double plan_height(const mpm::Scene& scene);

}  // namespace repose::report

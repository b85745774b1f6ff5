#include "mpm/step/flow_maps.hpp"

#include <algorithm>
#include <cmath>

namespace repose::mpm {

FlowMaps::FlowMaps(const Scene& scene)
    : columns(static_cast<std::size_t>(std::llround(scene.domain[0] / scene.h)) + 1),
      rows(static_cast<std::size_t>(std::llround(scene.domain[2] / scene.h)) + 1),
      h(scene.h),
      least_depth(scene.terrain->least_depth.value_or(0.25 * scene.h)),
      depth_max(columns * rows, 0.0),
      speed_max(columns * rows, 0.0),
      arrival(columns * rows, HUGE_VAL) {}

/// Every point's mass goes to the four nearest nodes (bilinear hats: the depth is continuous in the
/// points' positions); half a hat lies over a node on an edge of the box.
FlowMaps::Columns FlowMaps::columns_of(const std::vector<PointsOf<3>>& bodies,
                                       bool with_momentum) const {
  using F = Layout<3>;
  Columns found;
  found.solid.assign(columns * rows, 0.0);
  if (with_momentum) {
    found.mass.assign(columns * rows, 0.0);
    found.momentum.assign(columns * rows, {});
  }
  for (const PointsOf<3>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double mass = points[F::mass][s];
      std::array<std::size_t, 2> first;
      std::array<std::array<double, 2>, 2> share;
      for (std::size_t a = 0; a < 2; ++a) {
        const std::size_t last = (a == 0 ? columns : rows) - 1;
        const double xi = std::clamp(points[F::x + 2 * a][s] / h, 0.0, static_cast<double>(last));
        first[a] = std::min(static_cast<std::size_t>(xi), last - 1);
        share[a][1] = xi - static_cast<double>(first[a]);
        share[a][0] = 1.0 - share[a][1];
      }
      for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t i = 0; i < 2; ++i) {
          const std::size_t node = (first[1] + k) * columns + first[0] + i;
          const double part = share[0][i] * share[1][k] * mass;
          found.solid[node] += part / points.rho_0;
          if (!with_momentum) continue;
          found.mass[node] += part;
          for (std::size_t a = 0; a < 3; ++a) found.momentum[node][a] += part * points[F::v + a][s];
        }
    }
  for (std::size_t k = 0; k < rows; ++k)
    for (std::size_t i = 0; i < columns; ++i) {
      double area = h * h;
      if (i == 0 || i + 1 == columns) area *= 0.5;
      if (k == 0 || k + 1 == rows) area *= 0.5;
      found.solid[k * columns + i] /= area;
    }
  return found;
}

void FlowMaps::observe(const std::vector<PointsOf<3>>& bodies, double time, double way) {
  gone += way;
  if (gone < 0.5 * h) return;
  gone = 0.0;
  const Columns now = columns_of(bodies, true);
  for (std::size_t n = 0; n < now.solid.size(); ++n) {
    depth_max[n] = std::max(depth_max[n], now.solid[n]);
    if (!(now.solid[n] >= least_depth)) continue;
    arrival[n] = std::min(arrival[n], time);
    const std::array<double, 3>& p = now.momentum[n];
    speed_max[n] = std::max(speed_max[n], std::hypot(p[0], p[1], p[2]) / now.mass[n]);
  }
}

std::vector<double> FlowMaps::depth(const std::vector<PointsOf<3>>& bodies) const {
  return columns_of(bodies, false).solid;
}

}  // namespace repose::mpm

#include "mpm/step/flow_maps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace repose::mpm {
namespace {

/// The squared distances along a line of nodes 0, 1, 2, … in which f holds those across it:
/// min over q of (p − q)² + f(q), the lower envelope of parabolas. HUGE_VAL: no place at all.
/// Felzenszwalb & Huttenlocher (2012), Theory of Computing 8, 415-428, algorithm 1.
void spread(std::vector<double>& f) {
  std::vector<std::size_t> lowest;  ///< nodes whose parabolas are the envelope, from left to right
  std::vector<double> from;         ///< where each begins to be
  const auto square = [](std::size_t q) { return static_cast<double>(q) * static_cast<double>(q); };
  for (std::size_t q = 0; q < f.size(); ++q) {
    if (!(f[q] < HUGE_VAL)) continue;
    double start = -HUGE_VAL;
    while (!lowest.empty()) {
      const std::size_t v = lowest.back();
      start = (f[q] + square(q) - f[v] - square(v)) / (2.0 * static_cast<double>(q - v));
      if (start > from.back()) break;
      lowest.pop_back();
      from.pop_back();
      start = -HUGE_VAL;
    }
    lowest.push_back(q);
    from.push_back(start);
  }
  if (lowest.empty()) return;
  std::vector<double> found(f.size());
  for (std::size_t p = 0, k = 0; p < f.size(); ++p) {
    const double at = static_cast<double>(p);
    while (k + 1 < lowest.size() && from[k + 1] < at) ++k;
    const double way = at - static_cast<double>(lowest[k]);
    found[p] = way * way + f[lowest[k]];
  }
  f = std::move(found);
}

}  // namespace

/// The corners of a cell that holds a point are at distance 0, and the place of such cells nearest
/// to a node is always a corner: the distances are exact.
FlowMaps::FlowMaps(const Scene& scene, const std::vector<PointsOf<3>>& bodies)
    : columns(static_cast<std::size_t>(std::llround(scene.domain[0] / scene.h)) + 1),
      rows(static_cast<std::size_t>(std::llround(scene.domain[2] / scene.h)) + 1),
      h(scene.h),
      least_depth(scene.terrain->least_depth.value_or(0.25 * scene.h)),
      depth_max(columns * rows, 0.0),
      speed_max(columns * rows, 0.0),
      arrival(columns * rows, HUGE_VAL),
      distance_(columns * rows, HUGE_VAL) {
  using F = Layout<3>;
  const auto cell_of = [&](double x, std::size_t nodes) {
    return std::min(static_cast<std::size_t>(std::max(x / h, 0.0)), nodes - 2);
  };
  for (const PointsOf<3>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const std::size_t i = cell_of(points[F::x][s], columns);
      const std::size_t k = cell_of(points[F::x + 2][s], rows);
      for (const std::size_t corner : {k * columns + i, (k + 1) * columns + i})
        distance_[corner] = distance_[corner + 1] = 0.0;
    }
  std::vector<double> line;
  for (std::size_t i = 0; i < columns; ++i) {
    line.clear();
    for (std::size_t k = 0; k < rows; ++k) line.push_back(distance_[k * columns + i]);
    spread(line);
    for (std::size_t k = 0; k < rows; ++k) distance_[k * columns + i] = line[k];
  }
  for (std::size_t k = 0; k < rows; ++k) {
    const auto row = distance_.begin() + static_cast<std::ptrdiff_t>(k * columns);
    line.assign(row, row + static_cast<std::ptrdiff_t>(columns));
    spread(line);
    std::transform(line.begin(), line.end(), row, [&](double d2) { return h * std::sqrt(d2); });
  }
}

/// Linear between the nodes.
double FlowMaps::distance_at(double x, double z) const {
  const auto split = [&](double at, std::size_t nodes) {
    const double xi = std::clamp(at / h, 0.0, static_cast<double>(nodes - 1));
    const std::size_t first = std::min(static_cast<std::size_t>(xi), nodes - 2);
    return std::pair{first, xi - static_cast<double>(first)};
  };
  const auto [i, u] = split(x, columns);
  const auto [k, w] = split(z, rows);
  const double* const d = &distance_[k * columns + i];
  return (1.0 - w) * ((1.0 - u) * d[0] + u * d[1]) +
         w * ((1.0 - u) * d[columns] + u * d[columns + 1]);
}

Simulation::FlowExtent FlowMaps::extent(const std::vector<PointsOf<3>>& bodies) const {
  using F = Layout<3>;
  Simulation::FlowExtent found;
  std::vector<std::pair<double, double>> ways;  // of each point, with its mass
  double mass = 0.0, momentum = 0.0;
  for (const PointsOf<3>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double m = points[F::mass][s];
      mass += m;
      momentum += m * std::hypot(points[F::v][s], points[F::v + 1][s], points[F::v + 2][s]);
      ways.emplace_back(distance_at(points[F::x][s], points[F::x + 2][s]), m);
    }
  if (ways.empty()) return found;
  found.speed_mean = momentum / mass;
  std::sort(ways.begin(), ways.end());
  found.runout_max_m = ways.back().first;
  double beyond = 0.0;
  for (auto way = ways.rbegin(); way != ways.rend(); ++way) {
    beyond += way->second;
    found.runout_99_m = way->first;
    if (beyond >= 0.01 * mass) break;
  }
  const Columns now = columns_of(bodies, true);
  double solid = 0.0;
  for (std::size_t k = 0; k < rows; ++k)
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t n = k * columns + i;
      const double area = area_of(i, k);
      if (arrival[n] < HUGE_VAL || now.solid[n] >= least_depth) found.reached_m2 += area;
      if (!(now.solid[n] >= least_depth)) continue;
      found.area_m2 += area;
      solid += area * now.solid[n];
      found.depth_max_m = std::max(found.depth_max_m, now.solid[n]);
      const std::array<double, 3>& p = now.momentum[n];
      found.speed_max = std::max(found.speed_max, std::hypot(p[0], p[1], p[2]) / now.mass[n]);
    }
  if (found.area_m2 > 0.0) found.depth_mean_m = solid / found.area_m2;
  return found;
}

double FlowMaps::area_of(std::size_t i, std::size_t k) const {
  double area = h * h;
  if (i == 0 || i + 1 == columns) area *= 0.5;
  if (k == 0 || k + 1 == rows) area *= 0.5;
  return area;
}

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
    for (std::size_t i = 0; i < columns; ++i) found.solid[k * columns + i] /= area_of(i, k);
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

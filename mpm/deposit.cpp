#include "mpm/deposit.hpp"

#include <algorithm>
#include <cmath>

namespace repose::mpm {
namespace {

/// A place in [0, width]: between two sortings a point may be beyond an edge.
double inside(double x, double width, bool periodic) {
  return std::clamp(periodic ? x - width * std::floor(x / width) : x, 0.0, width);
}

}  // namespace

Deposit::Deposit(const std::vector<PointSet>& bodies, double column_spacing, int columns,
                 bool periodic)
    : h(column_spacing),
      depth(static_cast<std::size_t>(columns) + 1, 0.0) {
  for (const PointSet& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double xi = inside(points[X][s] / h, static_cast<double>(columns), periodic);
      const auto i = std::min(static_cast<std::size_t>(xi), depth.size() - 2);
      const double share = xi - static_cast<double>(i);
      const double solid = points[MASS][s] / (points.rho_0 * h);
      depth[i] += (1.0 - share) * solid;
      depth[i + 1] += share * solid;
    }
  if (periodic) {
    depth.front() = depth.back() = depth.front() + depth.back();
  } else {
    depth.front() *= 2.0;
    depth.back() *= 2.0;
  }
}

double Deposit::front(double threshold) const {
  for (std::size_t i = depth.size(); i-- > 0;) {
    if (depth[i] < threshold) continue;
    if (i + 1 == depth.size()) return static_cast<double>(i) * h;
    const double beyond = (depth[i] - threshold) / (depth[i] - depth[i + 1]);
    return (static_cast<double>(i) + beyond) * h;
  }
  return 0.0;
}

double mass_front(const std::vector<PointSet>& bodies, double width, double share, bool periodic) {
  struct Piece {
    double x, mass;
    bool operator<(const Piece& o) const { return x != o.x ? x < o.x : mass < o.mass; }
  };
  std::vector<Piece> heap;
  double total = 0.0, heaviest = 0.0;
  for (const PointSet& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double mass = points[MASS][s];
      heap.push_back({inside(points[X][s], width, periodic), mass});
      total += mass;
      heaviest = std::max(heaviest, mass);
    }
  // ∫ x dm over the slice from `end` to `begin`, masses counted from the right
  const double mark = (1.0 - share) * total;
  const double begin = std::max(0.0, mark - 0.5 * heaviest);
  const double end = std::min(total, mark + 0.5 * heaviest);
  std::make_heap(heap.begin(), heap.end());
  double moment = 0.0, passed = 0.0;
  while (!heap.empty() && passed < end) {
    std::pop_heap(heap.begin(), heap.end());
    const Piece piece = heap.back();
    heap.pop_back();
    const double next = passed + piece.mass;
    moment += piece.x * std::max(0.0, std::min(next, end) - std::max(passed, begin));
    passed = next;
  }
  return total > 0.0 ? moment / (end - begin) : 0.0;
}

}  // namespace repose::mpm

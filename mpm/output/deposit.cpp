#include "mpm/output/deposit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace repose::mpm {

namespace {

/// A place in [0, width]: between two sortings a point may be beyond an edge.
double inside(double x, double width, bool periodic) {
  return std::clamp(periodic ? x - width * std::floor(x / width) : x, 0.0, width);
}

double radius(const PointsOf<3>& points, std::size_t s, const std::array<double, 2>& axis) {
  return std::hypot(points[Layout<3>::x][s] - axis[0], points[Layout<3>::x + 2][s] - axis[1]);
}

/// Spreads the points' solid volumes over `area` on hats at multiples of h of place(points, slot).
template <int dim, class Place>
std::vector<double> spread(const std::vector<PointsOf<dim>>& bodies, double h, int columns,
                           double area, bool periodic, Place&& place) {
  std::vector<double> depth(static_cast<std::size_t>(columns) + 1, 0.0);
  for (const PointsOf<dim>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double xi = inside(place(points, s) / h, static_cast<double>(columns), periodic);
      const auto i = std::min(static_cast<std::size_t>(xi), depth.size() - 2);
      const double share = xi - static_cast<double>(i);
      const double solid = points[Layout<dim>::mass][s] / (points.rho_0 * area);
      depth[i] += (1.0 - share) * solid;
      depth[i + 1] += share * solid;
    }
  return depth;
}

}  // namespace

template <int dim>
Deposit::Deposit(const std::vector<PointsOf<dim>>& bodies, double column_spacing, int columns,
                 bool periodic, double breadth)
    : h(column_spacing),
      depth(spread<dim>(
          bodies, h, columns, h * breadth, periodic,
          [](const PointsOf<dim>& points, std::size_t s) { return points[Layout<dim>::x][s]; })) {
  if (periodic) {
    depth.front() = depth.back() = depth.front() + depth.back();
  } else {
    depth.front() *= 2.0;
    depth.back() *= 2.0;
  }
}
template Deposit::Deposit(const std::vector<PointsOf<2>>&, double, int, bool, double);
template Deposit::Deposit(const std::vector<PointsOf<3>>&, double, int, bool, double);

Deposit::Deposit(const std::vector<PointsOf<3>>& bodies, double ring_spacing, int columns,
                 const std::array<double, 2>& axis, double whole)
    : h(ring_spacing),
      depth(spread<3>(
          bodies, h, columns, 1.0, false,
          [&](const PointsOf<3>& points, std::size_t s) { return radius(points, s, axis); })) {
  // ∫ hat_i 2πr dr = 2πr_i h; of the first, half a hat, πh²/3; of the last, πh²(n − 1/3)
  const double circle = 2.0 * std::numbers::pi * h * h * whole;
  const auto n = static_cast<double>(columns);
  for (std::size_t i = 1; i + 1 < depth.size(); ++i) depth[i] /= circle * static_cast<double>(i);
  depth.front() /= circle / 6.0;
  depth.back() /= circle * (0.5 * n - 1.0 / 6.0);
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

template <int dim>
double mass_front(const std::vector<PointsOf<dim>>& bodies, double width, double share,
                  bool periodic, const std::array<double, 2>* axis) {
  const auto place = [&](const PointsOf<dim>& points, std::size_t s) {
    if constexpr (dim == 3) {
      if (axis != nullptr) return radius(points, s, *axis);
    }
    return inside(points[Layout<dim>::x][s], width, periodic);
  };
  struct Piece {
    double x, mass;
    bool operator<(const Piece& o) const { return x != o.x ? x < o.x : mass < o.mass; }
  };
  std::vector<Piece> heap;
  double total = 0.0, heaviest = 0.0;
  for (const PointsOf<dim>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double mass = points[Layout<dim>::mass][s];
      heap.push_back({place(points, s), mass});
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

template double mass_front(const std::vector<PointsOf<2>>&, double, double, bool,
                           const std::array<double, 2>*);
template double mass_front(const std::vector<PointsOf<3>>&, double, double, bool,
                           const std::array<double, 2>*);

}  // namespace repose::mpm

#include "mpm/scene/poly_line.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace repose::mpm {
namespace {

using Point = std::array<double, 2>;

/// How far the ends of an open line go on, in lengths of it. A box is no farther away.
constexpr double far_away = 1e6;

/// Whether x lies left (1) or right (−1) of the way from p to q, or on it (0).
int side_of(const Point& p, const Point& q, const Point& x) {
  const double turn = (q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0]);
  return turn > 0.0 ? 1 : turn < 0.0 ? -1 : 0;
}

/// Whether x, which lies on the line through p and q, lies between them.
bool lies_between(const Point& p, const Point& q, const Point& x) {
  return x[0] >= std::min(p[0], q[0]) && x[0] <= std::max(p[0], q[0]) &&
         x[1] >= std::min(p[1], q[1]) && x[1] <= std::max(p[1], q[1]);
}

bool meet(const Point& a, const Point& b, const Point& c, const Point& d) {
  const int of_c = side_of(a, b, c), of_d = side_of(a, b, d);
  const int of_a = side_of(c, d, a), of_b = side_of(c, d, b);
  if (of_c * of_d < 0 && of_a * of_b < 0) return true;
  return (of_c == 0 && lies_between(a, b, c)) || (of_d == 0 && lies_between(a, b, d)) ||
         (of_a == 0 && lies_between(c, d, a)) || (of_b == 0 && lies_between(c, d, b));
}

double twice_the_area(const std::vector<Point>& points) {
  double twice = 0.0;
  for (std::size_t i = 2; i < points.size(); ++i)
    twice += (points[i - 1][0] - points[0][0]) * (points[i][1] - points[0][1]) -
             (points[i][0] - points[0][0]) * (points[i - 1][1] - points[0][1]);
  return twice;
}

BoxTree tree_of(const std::vector<std::pair<Point, Point>>& edges) {
  std::vector<BoxTree::Box> boxes(edges.size());
  for (std::size_t k = 0; k < edges.size(); ++k)
    for (const Point& end : {edges[k].first, edges[k].second}) boxes[k].add({end[0], end[1], 0.0});
  return BoxTree(boxes);
}

std::vector<std::pair<Point, Point>> edges_of(const std::vector<Point>& points, bool closed) {
  std::vector<std::pair<Point, Point>> edges;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) edges.emplace_back(points[i], points[i + 1]);
  if (closed) edges.emplace_back(points.back(), points.front());
  return edges;
}

}  // namespace

std::optional<PolyLine::Fault> PolyLine::fault_of(const std::vector<Point>& points, bool closed) {
  const std::size_t n = points.size(), least = closed ? 3 : 2;
  if (n < least)
    return Fault{n == 0 ? 0 : n - 1,
                 fmt::format("{} {} too few: {} takes {}", n, n == 1 ? "point is" : "points are",
                             closed ? "a closed curve" : "an open curve", least)};
  if (n > most_points)
    return Fault{most_points,
                 fmt::format("{} points are more than a curve may have ({})", n, most_points)};
  for (std::size_t i = 0; i < n; ++i)
    if (!std::isfinite(points[i][0]) || !std::isfinite(points[i][1]))
      return Fault{i, "the point is not finite"};
  const std::vector<std::pair<Point, Point>> edges = edges_of(points, closed);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const auto& [from, to] = edges[k];
    if (from == to)
      return Fault{(k + 1) % n,
                   fmt::format("the point ({:g}, {:g}) is there twice in a row", to[0], to[1])};
    if (!closed && to[0] < from[0])
      return Fault{k + 1, fmt::format("x falls from {:g} to {:g}: along an open curve, below which "
                                      "all is rigid, it rises",
                                      from[0], to[0])};
  }
  if (!closed && points.front()[0] == points.back()[0])
    return Fault{n - 1, "an open curve goes up or down only: below it there is nothing"};
  const BoxTree tree = tree_of(edges);
  std::optional<Fault> fault;
  for (std::size_t k = 0; k < edges.size() && !fault; ++k) {
    BoxTree::Box box;
    box.add({edges[k].first[0], edges[k].first[1], 0.0});
    box.add({edges[k].second[0], edges[k].second[1], 0.0});
    tree.each_meeting(box, [&](std::uint32_t other) {
      if (other <= k || fault) return;
      const auto& [a, b] = edges[k];
      const auto& [c, d] = edges[other];
      const bool follows = other == k + 1, precedes = closed && k == 0 && other == edges.size() - 1;
      // neighbours share a point, and must not turn back upon each other
      const bool bad =
          follows ? side_of(a, b, d) == 0 &&
                        (d[0] - c[0]) * (b[0] - a[0]) + (d[1] - c[1]) * (b[1] - a[1]) < 0.0
          : precedes ? side_of(c, d, b) == 0 &&
                           (b[0] - a[0]) * (d[0] - c[0]) + (b[1] - a[1]) * (d[1] - c[1]) < 0.0
                     : meet(a, b, c, d);
      if (bad)
        fault = Fault{other, fmt::format("the curve meets itself: from ({:g}, {:g}) to ({:g}, "
                                         "{:g}), and again from ({:g}, {:g}) to ({:g}, {:g})",
                                         a[0], a[1], b[0], b[1], c[0], c[1], d[0], d[1])};
    });
  }
  if (fault) return fault;
  if (closed && twice_the_area(points) == 0.0) return Fault{0, "the curve surrounds no area"};
  return {};
}

PolyLine::PolyLine(std::vector<Point> points, bool closed)
    : points_(std::move(points)),
      closed_(closed) {
  std::vector<std::pair<Point, Point>> edges = edges_of(points_, closed_);
  if (!closed_) {
    // so far that no place of a box is nearer to their ends
    const double far = far_away * (points_.back()[0] - points_.front()[0]);
    const Point first = points_.front(), last = points_.back();
    edges.insert(edges.begin(), {{first[0] - far, first[1]}, first});
    edges.emplace_back(last, Point{last[0] + far, last[1]});
  }
  // within lies on the left of one that runs counterclockwise, and below what runs to the right
  const double sign = closed_ && twice_the_area(points_) > 0.0 ? 1.0 : -1.0;
  for (const auto& [from, to] : edges) {
    const Point e{to[0] - from[0], to[1] - from[1]};
    const double length = std::hypot(e[0], e[1]);
    edges_.push_back({from, to, {sign * e[1] / length, -sign * e[0] / length}});
  }
  tree_ = tree_of(edges);
}

/// Where along an edge the nearest of its points lies, from 0 to 1.
double PolyLine::Edge::along(const Position& x) const {
  const Point e{to[0] - from[0], to[1] - from[1]}, r{x[0] - from[0], x[1] - from[1]};
  return std::clamp((r[0] * e[0] + r[1] * e[1]) / (e[0] * e[0] + e[1] * e[1]), 0.0, 1.0);
}

PolyLine::Foot PolyLine::foot_of(const Position& x) const {
  Foot found;
  double best = HUGE_VAL;
  tree_.near_to({x[0], x[1], 0.0}, best, [&](std::uint32_t k, double& least) {
    const Edge& edge = edges_[k];
    const Point e{edge.to[0] - edge.from[0], edge.to[1] - edge.from[1]};
    const Point r{x[0] - edge.from[0], x[1] - edge.from[1]};
    const double along = edge.along(x);
    const Point d = along == 1.0 ? Point{x[0] - edge.to[0], x[1] - edge.to[1]}
                                 : Point{r[0] - along * e[0], r[1] - along * e[1]};
    const double across = r[0] * edge.outward[0] + r[1] * edge.outward[1];
    const double d2 = along > 0.0 && along < 1.0 ? across * across : d[0] * d[0] + d[1] * d[1];
    if (d2 >= least) return;
    least = d2;
    found = {k, along, d2};
  });
  return found;
}

Nearest PolyLine::nearest(const Position& x) const {
  const Foot foot = foot_of(x);
  const Edge& edge = edges_[foot.edge];
  const Point &n = edge.outward, r{x[0] - edge.from[0], x[1] - edge.from[1]};
  if (foot.along > 0.0 && foot.along < 1.0) return {r[0] * n[0] + r[1] * n[1], {n[0], n[1], 0.0}};
  // at a corner, the side is that of the sum of both normals (Baerentzen & Aanaes 2005)
  const std::size_t count = edges_.size();
  const Edge& other =
      foot.along == 0.0 ? edges_[(foot.edge + count - 1) % count] : edges_[(foot.edge + 1) % count];
  const Point& corner = foot.along == 0.0 ? edge.from : edge.to;
  const Point sum{n[0] + other.outward[0], n[1] + other.outward[1]};
  const Point d{x[0] - corner[0], x[1] - corner[1]};
  const double sign = d[0] * sum[0] + d[1] * sum[1] < 0.0 ? -1.0 : 1.0;
  const double distance = std::hypot(d[0], d[1]);
  // a place on the line could not tell its normal from its distance
  if (distance <= 1e-9 * std::max(std::abs(x[0]), std::abs(x[1])))
    return {sign * distance, {n[0], n[1], 0.0}};
  return {sign * distance, {sign * d[0] / distance, sign * d[1] / distance, 0.0}};
}

bool PolyLine::is_beyond(const Position& x, double radius) const {
  double best = radius * radius * (1.0 + 1e-12);
  bool beyond = true;
  tree_.near_to({x[0], x[1], 0.0}, best, [&](std::uint32_t k, double& least) {
    const Edge& edge = edges_[k];
    const Point e{edge.to[0] - edge.from[0], edge.to[1] - edge.from[1]};
    const Point r{x[0] - edge.from[0], x[1] - edge.from[1]};
    const double along = edge.along(x);
    const double dx = r[0] - along * e[0], dy = r[1] - along * e[1];
    if (dx * dx + dy * dy > least) return;
    beyond = false;
    least = 0.0;
  });
  return beyond;
}

bool PolyLine::holds(const Position& x) const {
  return closed_ ? nearest(x).distance < 0.0 : x[1] < height(x[0]);
}

double PolyLine::height(double x) const {
  const auto after = std::upper_bound(points_.begin(), points_.end(), x,
                                      [](double at, const Point& p) { return at < p[0]; });
  if (after == points_.begin()) return points_.front()[1];
  if (after == points_.end()) return points_.back()[1];
  const Point &a = *(after - 1), &b = *after;
  return a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1]);
}

}  // namespace repose::mpm

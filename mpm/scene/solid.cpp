#include "mpm/scene/solid.hpp"

#include <algorithm>
#include <cmath>

namespace repose::mpm {
namespace {

Nearest nearest_of(const HalfSpace& plane, const Position& x) {
  const Position& n = plane.normal;
  const double length = std::hypot(n[0], n[1], n[2]);
  Nearest found;
  for (std::size_t i = 0; i < 3; ++i) {
    found.normal[i] = n[i] / length;
    found.distance += found.normal[i] * (x[i] - plane.point[i]);
  }
  return found;
}

Nearest nearest_of(const Ball& ball, const Position& x) {
  const Position r{x[0] - ball.centre[0], x[1] - ball.centre[1], x[2] - ball.centre[2]};
  const double length = std::hypot(r[0], r[1], r[2]);
  // at the centre every direction is as good
  if (length == 0.0) return {-ball.radius, {0.0, 1.0, 0.0}};
  return {length - ball.radius, {r[0] / length, r[1] / length, r[2] / length}};
}

/// Distance to the nearest edge; inside where a ray to the right meets an odd number of edges.
Nearest nearest_of(const Polygon& polygon, const Position& x) {
  double nearest2 = HUGE_VAL, turn = 0.0;
  std::array<double, 2> away{}, normal{};
  bool inside = false;
  const auto& corners = polygon.corners;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const std::array<double, 2> e{corners[i][0] - corners[j][0], corners[i][1] - corners[j][1]};
    const std::array<double, 2> r{x[0] - corners[j][0], x[1] - corners[j][1]};
    turn += corners[j][0] * corners[i][1] - corners[i][0] * corners[j][1];
    if ((corners[i][1] > x[1]) != (corners[j][1] > x[1]) &&
        x[0] < corners[j][0] + e[0] * (x[1] - corners[j][1]) / e[1])
      inside = !inside;
    const double length2 = e[0] * e[0] + e[1] * e[1];
    const double along = std::clamp((r[0] * e[0] + r[1] * e[1]) / length2, 0.0, 1.0);
    const std::array<double, 2> d{r[0] - along * e[0], r[1] - along * e[1]};
    const double d2 = d[0] * d[0] + d[1] * d[1];
    if (d2 >= nearest2) continue;
    nearest2 = d2;
    away = d;
    normal = {e[1] / std::sqrt(length2), -e[0] / std::sqrt(length2)};
  }
  if (turn < 0.0) normal = {-normal[0], -normal[1]};
  const double distance = std::sqrt(nearest2);
  // on the edge itself only the edge knows its normal
  if (distance > 0.0) {
    const double sign = inside ? -1.0 : 1.0;
    normal = {sign * away[0] / distance, sign * away[1] / distance};
  }
  return {inside ? -distance : distance, {normal[0], normal[1], 0.0}};
}

}  // namespace

Piece piece_of(const Polygon& polygon) {
  // about the first corner, for the sake of the last digits of a small piece far from the origin
  const auto& corners = polygon.corners;
  double twice = 0.0;
  std::array<double, 2> moment{};
  for (std::size_t i = 2; i < corners.size(); ++i) {
    std::array<double, 2> a, b;
    for (std::size_t k = 0; k < 2; ++k) {
      a[k] = corners[i - 1][k] - corners[0][k];
      b[k] = corners[i][k] - corners[0][k];
    }
    const double part = a[0] * b[1] - a[1] * b[0];
    twice += part;
    for (std::size_t k = 0; k < 2; ++k) moment[k] += part * (a[k] + b[k]) / 3.0;
  }
  if (twice == 0.0) return {};
  return {0.5 * std::abs(twice),
          {corners[0][0] + moment[0] / twice, corners[0][1] + moment[1] / twice}};
}

/// Sutherland & Hodgman (1974): cut by one side of the rectangle after the other.
Polygon clipped(const Polygon& polygon, const std::array<double, 2>& low,
                const std::array<double, 2>& high) {
  Polygon rest = polygon;
  for (const std::size_t axis : {0U, 1U})
    for (const double sign : {1.0, -1.0}) {
      const double limit = sign > 0.0 ? low[axis] : high[axis];
      Polygon kept;
      for (std::size_t i = 0; i < rest.corners.size(); ++i) {
        const auto& from = rest.corners[i == 0 ? rest.corners.size() - 1 : i - 1];
        const auto& to = rest.corners[i];
        const double before = sign * (from[axis] - limit), after = sign * (to[axis] - limit);
        if ((before < 0.0) != (after < 0.0)) {
          const double t = before / (before - after);
          std::array<double, 2> cut{from[0] + t * (to[0] - from[0]),
                                    from[1] + t * (to[1] - from[1])};
          cut[axis] = limit;
          kept.corners.push_back(cut);
        }
        if (!(after < 0.0)) kept.corners.push_back(to);
      }
      rest = std::move(kept);
    }
  return rest;
}

Nearest nearest(const Solid& solid, const Position& x) {
  Nearest found = std::visit([&](const auto& shape) { return nearest_of(shape, x); }, solid.shape);
  if (solid.hollow) {
    found.distance = -found.distance;
    for (double& n : found.normal) n = -n;
  }
  return found;
}

bool Surface::moves() const {
  return (spin != 0.0 || velocity != std::array<double, 3>{}) && stops > starts;
}

double Surface::moved_for(double time) const { return std::clamp(time, starts, stops) - starts; }

Nearest Surface::nearest_at(double time, const Position& x) const {
  const double t = moved_for(time);
  if (t == 0.0 || !moves()) return nearest(solid, x);
  // in axes that move along: x = pivot + velocity t + R (x_0 − pivot)
  const double c = std::cos(spin * t), s = std::sin(spin * t);
  const double dx = x[0] - pivot[0] - velocity[0] * t, dy = x[1] - pivot[1] - velocity[1] * t;
  Nearest found = nearest(
      solid, {pivot[0] + c * dx + s * dy, pivot[1] - s * dx + c * dy, x[2] - velocity[2] * t});
  const Position n = found.normal;
  found.normal = {c * n[0] - s * n[1], s * n[0] + c * n[1], n[2]};
  return found;
}

std::array<double, 3> Surface::velocity_at(double time, const Position& x) const {
  if (!moves() || time < starts || time >= stops) return {};
  const double t = moved_for(time);
  return {velocity[0] - spin * (x[1] - pivot[1] - velocity[1] * t),
          velocity[1] + spin * (x[0] - pivot[0] - velocity[0] * t), velocity[2]};
}

}  // namespace repose::mpm

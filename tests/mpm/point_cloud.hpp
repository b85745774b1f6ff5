#pragma once
/// \file
/// Point sets made by hand or by chance, without a scene.

#include <random>

#include "mpm/grid/points.hpp"
#include "tests/mpm/reference_grid.hpp"

namespace repose::mpm {

inline PointSet no_points(std::size_t state_fields = 0) {
  PointSet points;
  points.fields = STATE + state_fields;
  return points;
}

/// Adds one point, zero in all fields but these; its name is the number of points before it.
inline void add_point(PointSet& points, double x, double y, double mass = 1.0) {
  for (std::size_t f = 0; f < points.fields; ++f) points.field[f].push_back(0.0);
  points.field[X].back() = x;
  points.field[Y].back() = y;
  points.field[MASS].back() = mass;
  points.field[RHO].back() = 1000.0;
  points.id.push_back(static_cast<std::int64_t>(points.count));
  ++points.count;
}

/// n points anywhere in a box, all fields of order one.
inline PointSet random_points(std::size_t n, const std::array<double, 2>& from,
                              const std::array<double, 2>& to, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0), sign(-1.0, 1.0);
  PointSet points = no_points();
  for (std::size_t k = 0; k < n; ++k) {
    add_point(points, from[0] + share(random) * (to[0] - from[0]),
              from[1] + share(random) * (to[1] - from[1]), 0.5 + share(random));
    for (std::size_t f = VX; f <= SXY; ++f) points.field[f].back() = sign(random);
    points.field[RHO].back() = 0.5 + share(random);
  }
  return points;
}

inline reference::Particle particle(const PointSet& points, std::size_t slot) {
  const auto at = [&](std::size_t f) { return points[f][slot]; };
  reference::Particle p;
  p.x = {at(X), at(Y)};
  p.v = {at(VX), at(VY)};
  p.L = {{{at(LXX), at(LXY)}, {at(LYX), at(LYY)}}};
  p.stress = {{{at(SXX), at(SXY)}, {at(SXY), at(SYY)}}};
  p.mass = at(MASS);
  p.volume = at(MASS) / at(RHO);
  return p;
}

}  // namespace repose::mpm

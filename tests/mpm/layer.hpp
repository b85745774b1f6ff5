#pragma once
/// \file
/// Layers of shear flow and what their exact solutions are made of.

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {

constexpr double pi = std::numbers::pi;

/// A layer on a no-slip floor, 0.8 m long and H high, n cells over its height, free at both ends;
/// one body per row of points, so that any velocity profile u(y) can be given.
template <class Profile>
Scene layer(double H, int n, const LawSpec& law, Profile&& u) {
  Scene scene = empty_box(1.2, 1.5 * H, H / n);
  scene.floor = {Wall::Kind::no_slip};
  const double spacing = point_spacing(scene);
  for (int j = 0; j < 2 * n; ++j) {
    scene.bodies.push_back(block(0.2, j * spacing, 0.8, spacing, law));
    scene.bodies.back().velocity = {u((j + 0.5) * spacing), 0.0};
  }
  return scene;
}

/// The points within ± H of the middle of the layer, which has moved by `shift`.
inline std::vector<PointState> middle(const Simulation& simulation, double H, double shift = 0.0) {
  std::vector<PointState> points = points_of(simulation);
  std::erase_if(points, [&](const PointState& p) { return std::abs(p[X] - 0.6 - shift) > H; });
  return points;
}

template <class Exact>
double largest_error(const std::vector<PointState>& points, Exact&& u) {
  double largest = 0.0;
  for (const PointState& p : points) largest = std::max(largest, std::abs(p[VX] - u(p[Y])));
  return largest;
}

/// Σ over odd m of weight(m) sin(mπy/2H) e^{−m²t/τ}: the modes between a fixed floor and a free
/// top.
template <class Weight>
double modes(double y, double H, double t, double tau, Weight&& weight) {
  double sum = 0.0;
  for (int m = 1; m < 100; m += 2)
    sum += weight(m) * std::sin(m * pi * y / (2 * H)) * std::exp(-m * m * t / tau);
  return sum;
}

}  // namespace repose::mpm

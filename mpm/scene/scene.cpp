#include "mpm/scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace repose::mpm {

bool is_whole_multiple(double x, double unit) {
  const double n = std::round(x / unit);
  return n >= 1.0 && std::abs(x - n * unit) <= lattice_tolerance * unit;
}

int points_per_edge(const Scene& scene) {
  return static_cast<int>(std::lround(scene.dimensions() == 2 ? std::sqrt(scene.points_per_cell)
                                                              : std::cbrt(scene.points_per_cell)));
}

double default_relaxation_time(const Scene& scene) {
  return scene.gravity > 0.0 ? 0.03 * std::sqrt(scene.h / scene.gravity) : HUGE_VAL;
}

double point_spacing(const Scene& scene) { return scene.h / points_per_edge(scene); }

std::array<std::int64_t, 3> point_lattice(const Scene& scene, const Body& body) {
  const double spacing = point_spacing(scene);
  std::array<std::int64_t, 3> points{1, 1, 1};
  for (std::size_t k = 0; k < scene.dimensions(); ++k)
    points[k] = std::llround(body.size[k] / spacing);
  return points;
}

void set_disc(Body& body, const Disc& disc) {
  body.disc = disc;
  for (std::size_t k = 0; k < 2; ++k) {
    body.origin[k] = disc.centre[k] - disc.radius;
    body.size[k] = 2.0 * disc.radius;
  }
}

void set_cylinder(Body& body, const Disc& disc, double base, double height) {
  body.disc = disc;
  for (const std::size_t k : {0U, 2U}) {
    const double centre = disc.centre[k / 2];
    body.origin[k] = centre == 0.0 ? 0.0 : centre - disc.radius;
    body.size[k] = centre == 0.0 ? disc.radius : 2.0 * disc.radius;
  }
  body.origin[1] = base;
  body.size[1] = height;
}

void set_polygon(Body& body, const Polygon& polygon) {
  body.polygon = polygon;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto [least, most] =
        std::minmax_element(polygon.corners.begin(), polygon.corners.end(),
                            [k](const auto& a, const auto& b) { return a[k] < b[k]; });
    body.origin[k] = (*least)[k];
    body.size[k] = (*most)[k] - (*least)[k];
  }
}

bool seeks_equilibrium(const Scene& scene) {
  if (scene.equilibrium) return *scene.equilibrium;
  const auto& bodies = scene.bodies;
  return scene.tilt_deg == 0.0 &&
         (bodies.size() > 1 || std::any_of(bodies.begin(), bodies.end(),
                                           [](const Body& b) { return b.polygon.has_value(); })) &&
         std::all_of(bodies.begin(), bodies.end(), [](const Body& b) { return b.lithostatic; });
}

bool raise_top_to_cells(Scene& scene) {
  if (is_whole_multiple(scene.domain[1], scene.h)) return false;
  // 12 digits: 0.575, not 0.5750000000000001
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", std::ceil(scene.domain[1] / scene.h) * scene.h);
  scene.domain[1] = std::stod(text);
  return true;
}

}  // namespace repose::mpm

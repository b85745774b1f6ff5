#include "mpm/scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

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

void set_release(Body& body, const Terrain& terrain) {
  body.release = true;
  const Release& release = *terrain.release;
  double bottom = HUGE_VAL, top = -HUGE_VAL;
  constexpr int places = 200;  // along each side; the box only bounds what is filled
  for (int i = 0; i <= places; ++i)
    for (int k = 0; k <= places; ++k) {
      const double y = terrain.ground->height(
          release.low()[0] + (release.high()[0] - release.low()[0]) * i / places,
          release.low()[1] + (release.high()[1] - release.low()[1]) * k / places);
      bottom = std::min(bottom, y);
      top = std::max(top, y);
    }
  body.origin = {release.low()[0], bottom, release.low()[1]};
  body.size = {release.high()[0] - release.low()[0], top + release.deepest() - bottom,
               release.high()[1] - release.low()[1]};
}

void fit_to_terrain(Scene& scene) {
  Terrain& terrain = *scene.terrain;
  const auto [lowest, highest] =
      std::minmax_element(terrain.ground_map.values.begin(), terrain.ground_map.values.end());
  const double h = scene.h;
  if (!terrain.base) terrain.base = h * (std::floor(*lowest / h) - 4.0);
  terrain.place();
  const double deepest = terrain.release ? terrain.release->deepest() : 0.0;
  const auto whole = [&](double length) { return h * std::floor(length / h + lattice_tolerance); };
  if (scene.domain[0] == 0.0) scene.domain[0] = whole(terrain.ground_map.width());
  if (scene.domain[2] == 0.0) scene.domain[2] = whole(terrain.ground_map.height());
  // what flows may be thrown up by about as much as it is deep; eight cells for what is shallow
  if (scene.domain[1] == 0.0)
    scene.domain[1] = h * std::ceil((*highest - *terrain.base + 2.0 * deepest) / h + 8.0);
  for (Body& body : scene.bodies)
    if (body.release && terrain.release) set_release(body, terrain);
}

std::vector<Surface> rigid_surfaces(const Scene& scene) {
  std::vector<Surface> all = scene.surfaces;
  if (scene.terrain) all.push_back(scene.terrain->surface());
  return all;
}

double expected_points(const Scene& scene, const Body& body) {
  const double spacing = point_spacing(scene);
  if (body.release) return scene.terrain->release->volume() / (spacing * spacing * spacing);
  double points = 1.0;
  for (std::size_t k = 0; k < scene.dimensions(); ++k) points *= body.size[k] / spacing;
  if (body.disc)
    points *= std::numbers::pi / 4.0 * (1.0 - std::pow(body.disc->hole / body.disc->radius, 2.0));
  return points;
}

Stretch stretch_of(const Scene& scene, const Inflow& inflow) {
  Stretch stretch{{0.0, 0.0}, {1.0, 1.0}};
  std::size_t k = 0;
  for (std::size_t axis = 0; axis < scene.dimensions(); ++axis) {
    if (axis == inflow.edge / 2) continue;
    stretch.from[k] = std::max(inflow.from[k], 0.0);
    stretch.to[k] = std::min(inflow.to[k], scene.domain[axis]);
    ++k;
  }
  return stretch;
}

double speed_of(const Scene& scene, const Inflow& inflow, double density) {
  return inflow.speed ? *inflow.speed : *inflow.rate / (density * stretch_of(scene, inflow).area());
}

bool has_edges_in_parts(const Scene& scene) {
  for (std::size_t k = 0; k < edge_names.size(); ++k)
    if (scene.edge(k).kind == Wall::Kind::parts) return true;
  return !scene.inflows.empty();
}

bool seeks_equilibrium(const Scene& scene) {
  if (scene.equilibrium) return *scene.equilibrium;
  const auto& bodies = scene.bodies;
  return scene.tilt_deg == 0.0 && !has_edges_in_parts(scene) &&
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

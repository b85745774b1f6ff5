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

void set_solid(Body& body, const Solid& solid, const std::array<double, 3>& domain) {
  body.solid = solid;
  const auto bound = [&](const Position& low, const Position& high, std::size_t axes) {
    for (std::size_t k = 0; k < axes; ++k) {
      body.origin[k] = low[k];
      body.size[k] = high[k] - low[k];
    }
  };
  const std::size_t axes = domain[2] > 0.0 ? 3 : 2;
  if (const auto* const ball = std::get_if<Ball>(&solid.shape)) {
    const auto& [x, y, z] = ball->centre;
    const double r = ball->radius;
    bound({x - r, y - r, z - r}, {x + r, y + r, z + r}, axes);
  } else if (const auto* const cylinder = std::get_if<Cylinder>(&solid.shape)) {
    // an end is a disc, which reaches R √(1 − a_k²) along an axis
    const Position& a = cylinder->axis;
    const double length = std::hypot(a[0], a[1], a[2]);
    Position low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = a[k] / length, from = cylinder->point[k],
                   to = from + along * cylinder->length,
                   across = cylinder->radius * std::sqrt(std::max(0.0, 1.0 - along * along));
      low[k] = std::min(from, to) - across;
      high[k] = std::max(from, to) + across;
    }
    bound(low, high, axes);
  } else if (const auto* const mesh = std::get_if<Mesh>(&solid.shape)) {
    bound(mesh->mesh->bounds().low, mesh->mesh->bounds().high, axes);
  } else if (const auto* const curve = std::get_if<Curve>(&solid.shape)) {
    set_polygon(body, {curve->line->points()});
  } else if (const auto* const plane = std::get_if<HalfSpace>(&solid.shape)) {
    if (axes == 3) {
      const TriangleMesh piece = piece_of(*plane, {}, domain);
      if (piece.size() > 0) bound(piece.bounds().low, piece.bounds().high, axes);
      return;
    }
    Surface surface;
    surface.solid = solid;
    const std::vector<Outline> outlines =
        surface.outlines(0.0, 0.0, {0.0, 0.0}, {domain[0], domain[1]});
    if (!outlines.empty()) set_polygon(body, outlines.front().front());
  }
}

bool is_cut(const Body& body) {
  return body.polygon || body.solid || !body.within.empty() || !body.without.empty();
}

bool is_plain_polygon(const Body& body) {
  return body.polygon && body.within.empty() && body.without.empty();
}

bool is_box(const Body& body) { return !body.disc && !body.release && !is_cut(body); }

double volume_of(const Scene& scene, const Body& body) {
  using std::numbers::pi;
  const bool space = scene.dimensions() == 3;
  if (body.release) return scene.terrain->release->volume();
  if (body.polygon) return piece_of(*body.polygon).area;
  if (body.solid) {
    const auto& shape = body.solid->shape;
    if (const auto* const ball = std::get_if<Ball>(&shape))
      return space ? 4.0 / 3.0 * pi * std::pow(ball->radius, 3) : pi * std::pow(ball->radius, 2);
    if (const auto* const cylinder = std::get_if<Cylinder>(&shape))
      return pi * std::pow(cylinder->radius, 2) * cylinder->length;
    if (const auto* const mesh = std::get_if<Mesh>(&shape)) return mesh->mesh->volume();
    if (const auto* const plane = std::get_if<HalfSpace>(&shape))
      return piece_of(*plane, {}, scene.domain).volume();
  }
  double volume = 1.0;
  for (std::size_t k = 0; k < scene.dimensions(); ++k) volume *= body.size[k];
  if (body.disc) volume *= pi / 4.0 * (1.0 - std::pow(body.disc->hole / body.disc->radius, 2.0));
  return volume;
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
  return volume_of(scene, body) /
         std::pow(point_spacing(scene), static_cast<double>(scene.dimensions()));
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
         (bodies.size() > 1 ||
          std::any_of(bodies.begin(), bodies.end(), [](const Body& b) { return is_cut(b); })) &&
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

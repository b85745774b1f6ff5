#include <algorithm>
#include <cmath>

#include "mpm/scene/scene_checks.hpp"
#include "mpm/scene/spans.hpp"

namespace repose::mpm {
namespace {

Polygon outline(const Body& body) {
  if (body.polygon) return *body.polygon;
  const auto& o = body.origin;
  const double right = o[0] + body.size[0], top = o[1] + body.size[1];
  return {{{o[0], o[1]}, {right, o[1]}, {right, top}, {o[0], top}}};
}

/// A place that two bodies have in common in the box between two corners, more than a tenth of a
/// cell along an upright line: looked for on 100 lines along each level axis.
std::optional<Position> common_place(const Scene& scene, const Body& a, const Body& b,
                                     const Position& from, const Position& to) {
  constexpr int lines = 100;
  const int rows = scene.dimensions() == 3 ? lines : 1;
  const auto between = [&](std::size_t axis, int n, int count) {
    return from[axis] + (to[axis] - from[axis]) * (n + 0.5) / count;
  };
  for (int i = 0; i < lines; ++i)
    for (int k = 0; k < rows; ++k) {
      const double x = between(0, i, lines), z = between(2, k, rows);
      const Spans of_b = spans_over(scene, b, x, z);
      if (of_b.empty()) continue;
      for (const Span& p : spans_over(scene, a, x, z))
        for (const Span& q : of_b) {
          const double low = std::max(p.low, q.low), high = std::min(p.high, q.high);
          if (high - low > 0.1 * scene.h) return Position{x, 0.5 * (low + high), z};
        }
    }
  return {};
}

std::string words(const Position& x, std::size_t axes) {
  return "(" + number(x[0], 4) + ", " + number(x[1], 4) +
         (axes == 3 ? ", " + number(x[2], 4) : std::string()) + ") m";
}

/// Whether two edges of a polygon that are no neighbours meet.
bool crosses_itself(const Polygon& polygon) {
  const auto& c = polygon.corners;
  const std::size_t n = c.size();
  const auto left = [&](std::size_t p, std::size_t q, std::size_t x) {
    return (c[q][0] - c[p][0]) * (c[x][1] - c[p][1]) - (c[q][1] - c[p][1]) * (c[x][0] - c[p][0]);
  };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      const std::size_t a = (i + 1) % n, b = (j + 1) % n;
      if (left(i, a, j) * left(i, a, b) < 0.0 && left(j, b, i) * left(j, b, a) < 0.0) return true;
    }
  return false;
}

void check_polygon(const Polygon& polygon, const std::string& key) {
  if (polygon.corners.size() < 3) throw InputError(key, "a polygon has three corners at least");
  for (std::size_t i = 0, j = polygon.corners.size() - 1; i < polygon.corners.size(); j = i++)
    if (polygon.corners[i] == polygon.corners[j])
      throw InputError(key, "two neighbouring corners are the same: [" +
                                number(polygon.corners[i][0]) + ", " +
                                number(polygon.corners[i][1]) + "]");
  if (crosses_itself(polygon)) throw InputError(key, "the polygon crosses itself");
  if (!(piece_of(polygon).area > 0.0)) throw InputError(key, "the polygon has no area");
}

/// A rigid region, or one that cuts a body; `path`: of its table, with a dot.
void check_solid(const Scene& scene, const Solid& solid, const std::string& path) {
  const bool space = scene.dimensions() == 3;
  const auto has_direction = [&](const Position& x) {
    return x[0] * x[0] + x[1] * x[1] + (space ? x[2] * x[2] : 0.0) > 0.0;
  };
  if (const auto* const plane = std::get_if<HalfSpace>(&solid.shape))
    if (!has_direction(plane->normal))
      throw InputError(path + "normal", "a normal of length 0 has no direction");
  if (const auto* const polygon = std::get_if<Polygon>(&solid.shape))
    check_polygon(*polygon, path + "corners");
  if (const auto* const ball = std::get_if<Ball>(&solid.shape))
    require(ball->radius, positive, (path + "radius").c_str(), "radius");
  if (const auto* const curve = std::get_if<Curve>(&solid.shape)) {
    if (!curve->line) throw InputError(path + "file", "a curve without points");
    if (const auto fault = PolyLine::fault_of(curve->line->points(), curve->line->closed()))
      throw InputError(path + "file", fault->what);
  }
  if (const auto* const cylinder = std::get_if<Cylinder>(&solid.shape)) {
    if (!space) throw InputError(path + "shape", "a cylinder is a shape of space");
    if (!has_direction(cylinder->axis))
      throw InputError(path + "axis", "an axis of length 0 has no direction");
    require(cylinder->radius, positive, (path + "radius").c_str(), "radius");
    if (cylinder->length < HUGE_VAL)
      require(cylinder->length, positive, (path + "length").c_str(), "length");
  }
  if (const auto* const mesh = std::get_if<Mesh>(&solid.shape)) {
    if (!space) throw InputError(path + "shape", "a mesh is a shape of space");
    if (!mesh->mesh || mesh->mesh->size() == 0)
      throw InputError(path + "file", "a mesh without triangles");
  }
}

}  // namespace

void check_solids(const Scene& scene) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (body.solid) {
      check_solid(scene, *body.solid, path_of(i, ""));
      if (body.solid->hollow) throw InputError(path_of(i, "shape"), "a body is not hollow");
      if (const auto* const cylinder = std::get_if<Cylinder>(&body.solid->shape);
          cylinder != nullptr && cylinder->length == HUGE_VAL)
        throw InputError(path_of(i, "length"), "a cylinder that is a body has a length");
      if (const auto* const curve = std::get_if<Curve>(&body.solid->shape);
          curve != nullptr && (!curve->line->closed() || scene.dimensions() == 3))
        throw InputError(path_of(i, "closed"),
                         "a curve that is a body is closed, and in the plane");
    }
    if (body.release && is_cut(body))
      throw InputError(path_of(i, body.within.empty() ? "without" : "within"),
                       "what a terrain releases is cut by nothing else");
    for (const auto& [list, key] : {std::pair{&body.within, "within"}, {&body.without, "without"}})
      for (std::size_t k = 0; k < list->size(); ++k)
        check_solid(scene, (*list)[k], path_of(i, key) + "[" + std::to_string(k) + "].");
  }
}

void check_discs(const Scene& scene) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (!body.disc) continue;
    const Disc& disc = *body.disc;
    if (!(disc.hole >= 0.0 && disc.hole < disc.radius))
      throw InputError(path_of(i, "hole"),
                       "hole = " + number(disc.hole) +
                           " is out of range: must be [0, radius = " + number(disc.radius) + ")");
    const double thickness = disc.radius - disc.hole;
    if (thickness < 2.0 * point_spacing(scene))
      throw InputError(path_of(i, "radius"), "the disc is " + number(thickness) +
                                                 " m thick, less than two points " +
                                                 number(point_spacing(scene)) + " m apart");
    if (body.lithostatic && scene.dimensions() == 2)
      throw InputError(path_of(i, "initial.lithostatic"),
                       "a disc has no level surface: only a box or a polygon can be lithostatic");
    if (scene.dimensions() == 2) continue;
    const auto cuts = [&](std::size_t axis, double centre, const Wall& wall, const char* key) {
      if (body.size[axis] < 2.0 * disc.radius * (1.0 - lattice_tolerance) &&
          wall.kind != Wall::Kind::slip)
        throw InputError(key, "the wall cuts body[" + std::to_string(i) + "], whose axis lies at " +
                                  number(centre) +
                                  " m: only a slip wall is a plane of symmetry to its other half");
    };
    cuts(0, disc.centre[0], scene.left, "domain.left");
    cuts(2, disc.centre[1], scene.near, "domain.near");
  }
}

void check_polygons(const Scene& scene) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (!body.polygon || body.solid) continue;
    check_polygon(*body.polygon, path_of(i, "corners"));
    if (scene.dimensions() == 3)
      throw InputError(path_of(i, "corners"), "a polygon is a body of the plane");
  }
}

void check_overlap(const Scene& scene) {
  const auto name = [&](std::size_t i) {
    const std::string& given = scene.bodies[i].name;
    return "body[" + std::to_string(i) + "]" + (given.empty() ? "" : " \"" + given + "\"");
  };
  const double slack = lattice_tolerance * scene.h;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Body &a = scene.bodies[i], &b = scene.bodies[j];
      std::array<double, 3> from{}, to{};
      for (std::size_t k = 0; k < 3; ++k) {
        from[k] = std::max(a.origin[k], b.origin[k]);
        to[k] = std::min(a.origin[k] + a.size[k], b.origin[k] + b.size[k]);
      }
      if (to[0] - from[0] <= slack || to[1] - from[1] <= slack ||
          (scene.dimensions() == 3 && to[2] - from[2] <= slack))
        continue;
      if (a.release || b.release) continue;         // the box around it is not what it fills
      const auto is_plain = [](const Body& body) {  // what overlap() knows
        return !is_cut(body) || is_plain_polygon(body);
      };
      if (!is_plain(a) || !is_plain(b)) {
        if (const auto place = common_place(scene, a, b, from, to))
          throw InputError(path_of(i, "shape"), name(i) + " overlaps " + name(j) + " around " +
                                                    words(*place, scene.dimensions()));
        continue;
      }
      if ((a.polygon || b.polygon) && !overlap(outline(a), outline(b), slack)) continue;
      throw InputError(path_of(i, "origin"), name(i) + " overlaps " + name(j) + " in x = [" +
                                                 number(from[0]) + ", " + number(to[0]) +
                                                 "] m, y = [" + number(from[1]) + ", " +
                                                 number(to[1]) + "] m");
    }
}

void check_surfaces(const Scene& scene) {
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    const Surface& surface = scene.surfaces[i];
    const std::string path = "surface[" + std::to_string(i) + "].";
    check_solid(scene, surface.solid, path);
    if (surface.contact == Surface::Contact::friction)
      require(surface.friction, not_negative, (path + "friction").c_str(), "friction");
    for (const double x : {surface.velocity[0], surface.velocity[1], surface.velocity[2],
                           surface.spin, surface.pivot[0], surface.pivot[1]})
      require(x, {}, (path + "velocity").c_str(), "velocity, spin or pivot");
    require(surface.starts, not_negative, (path + "starts").c_str(), "starts");
    if (surface.stops < surface.starts)
      throw InputError(path + "stops", "it would come to rest at " + number(surface.stops) +
                                           " s, before it begins to move at " +
                                           number(surface.starts) + " s");
  }
  if (scene.surfaces.empty() && !scene.terrain) return;
  if (scene.transfer == Transfer::xpic || scene.transfer == Transfer::fmpm)
    throw InputError("step.transfer", "rigid surfaces do not go with transfer = \"" +
                                          std::string(name_of(scene.transfer)) +
                                          "\" yet; any other transfer does");
  if (scene.viscosity == Viscosity::implicit_solve)
    throw InputError("step.viscosity",
                     "rigid surfaces do not go with viscosity = \"implicit\" yet");
  if (scene.left.kind == Wall::Kind::periodic)
    throw InputError("domain.left", "rigid surfaces do not go with periodic edges yet");
}

}  // namespace repose::mpm

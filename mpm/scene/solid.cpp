#include "mpm/scene/solid.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "io/level_lines.hpp"

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
/// Along an edge the normal is the edge's own, which a place on it could not tell from its
/// distance.
Nearest nearest_of(const Polygon& polygon, const Position& x) {
  double nearest2 = HUGE_VAL, turn = 0.0;
  std::array<double, 2> away{}, outward{};
  bool inside = false, at_corner = false;
  const auto& corners = polygon.corners;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const std::array<double, 2> e{corners[i][0] - corners[j][0], corners[i][1] - corners[j][1]};
    const std::array<double, 2> r{x[0] - corners[j][0], x[1] - corners[j][1]};
    turn += corners[j][0] * corners[i][1] - corners[i][0] * corners[j][1];
    if ((corners[i][1] > x[1]) != (corners[j][1] > x[1]) &&
        x[0] < corners[j][0] + e[0] * (x[1] - corners[j][1]) / e[1])
      inside = !inside;
    const double length2 = e[0] * e[0] + e[1] * e[1], length = std::sqrt(length2);
    const double along = std::clamp((r[0] * e[0] + r[1] * e[1]) / length2, 0.0, 1.0);
    const std::array<double, 2> n{e[1] / length, -e[0] / length};
    const bool of_corner = along == 0.0 || along == 1.0;
    const std::array<double, 2> d{r[0] - along * e[0], r[1] - along * e[1]};
    const double across = r[0] * n[0] + r[1] * n[1];
    const double d2 = of_corner ? d[0] * d[0] + d[1] * d[1] : across * across;
    if (d2 >= nearest2) continue;
    nearest2 = d2;
    at_corner = of_corner;
    away = d;
    outward = n;
  }
  const double distance = std::sqrt(nearest2), sign = turn < 0.0 ? -1.0 : 1.0;
  const double size = std::max(std::abs(x[0]), std::abs(x[1]));
  if (at_corner && distance > 1e-9 * size) {
    const double towards = inside ? -1.0 / distance : 1.0 / distance;
    return {inside ? -distance : distance, {towards * away[0], towards * away[1], 0.0}};
  }
  return {inside ? -distance : distance, {sign * outward[0], sign * outward[1], 0.0}};
}

/// Of a place, in a cylinder's own directions: along the axis from its point, and away from it.
struct Round {
  double along = 0.0, away = 0.0;
  Position axis{}, outward{};  ///< of length 1
};
Round around(const Cylinder& cylinder, const Position& x) {
  const Position& a = cylinder.axis;
  const double length = std::hypot(a[0], a[1], a[2]);
  Round at;
  for (std::size_t i = 0; i < 3; ++i) {
    at.axis[i] = a[i] / length;
    at.along += at.axis[i] * (x[i] - cylinder.point[i]);
  }
  for (std::size_t i = 0; i < 3; ++i)
    at.outward[i] = x[i] - cylinder.point[i] - at.along * at.axis[i];
  at.away = std::hypot(at.outward[0], at.outward[1], at.outward[2]);
  if (at.away > 0.0) {
    for (double& n : at.outward) n /= at.away;
    return at;
  }
  // on the axis every direction across it is as good: that of the axis least along it
  const std::size_t k = static_cast<std::size_t>(
      std::min_element(at.axis.begin(), at.axis.end(),
                       [](double p, double q) { return std::abs(p) < std::abs(q); }) -
      at.axis.begin());
  const double across = std::sqrt(1.0 - at.axis[k] * at.axis[k]);
  for (std::size_t i = 0; i < 3; ++i)
    at.outward[i] = ((i == k ? 1.0 : 0.0) - at.axis[k] * at.axis[i]) / across;
  return at;
}

/// How far beyond its end a place along the axis lies, negative within; and which way that end
/// looks.
std::pair<double, double> beyond_end(const Cylinder& cylinder, double along) {
  const double half = 0.5 * cylinder.length;
  return {std::abs(along - half) - half, along < half ? -1.0 : 1.0};
}

/// The nearer of side and end, or beyond both their common edge.
Nearest nearest_of(const Cylinder& cylinder, const Position& x) {
  const Round at = around(cylinder, x);
  const double out = at.away - cylinder.radius;
  if (cylinder.length == HUGE_VAL) return {out, at.outward};
  const auto [over, sense] = beyond_end(cylinder, at.along);
  if (out > 0.0 && over > 0.0) {
    Nearest edge{std::hypot(out, over), {}};
    for (std::size_t i = 0; i < 3; ++i)
      edge.normal[i] = (out * at.outward[i] + sense * over * at.axis[i]) / edge.distance;
    return edge;
  }
  if (out >= over) return {out, at.outward};
  return {over, {sense * at.axis[0], sense * at.axis[1], sense * at.axis[2]}};
}

Nearest nearest_of(const Curve& curve, const Position& x) { return curve.line->nearest(x); }
Nearest nearest_of(const Mesh& mesh, const Position& x) { return mesh.mesh->nearest(x); }

/// The foot of the perpendicular, by Gauss and Newton's steps on the squared distance.
Nearest nearest_of(const Ground& ground, const Position& x) {
  const HeightMap& map = *ground.map;
  std::array<double, 2> foot{x[0], x[2]};
  HeightMap::Sample at = map.at(foot[0], foot[1]);
  const double above = x[1] - at.height;
  const double steep = std::hypot(1.0, at.gradient[0], at.gradient[1]);
  const Nearest straight{above / steep,
                         {-at.gradient[0] / steep, 1.0 / steep, -at.gradient[1] / steep}};
  constexpr int rounds = 4;  // the map is curved by little over the few cells that matter
  for (int k = 0; k < rounds; ++k) {
    const auto& g = at.gradient;
    const double rise = x[1] - at.height;
    const std::array<double, 2> slope{x[0] - foot[0] + rise * g[0], x[2] - foot[1] + rise * g[1]};
    const double along = (g[0] * slope[0] + g[1] * slope[1]) / (1.0 + g[0] * g[0] + g[1] * g[1]);
    for (std::size_t i = 0; i < 2; ++i) foot[i] += slope[i] - g[i] * along;
    at = map.at(foot[0], foot[1]);
  }
  const double length = std::hypot(x[0] - foot[0], x[1] - at.height, x[2] - foot[1]);
  // the place straight below is never nearer than the foot
  if (!(length <= std::abs(above))) return straight;
  const double n = std::hypot(1.0, at.gradient[0], at.gradient[1]);
  return {above < 0.0 ? -length : length, {-at.gradient[0] / n, 1.0 / n, -at.gradient[1] / n}};
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

/// Its corners are those of the box behind the plane, and where the plane cuts the box's edges;
/// each face of the box goes around what is left of it, and a lid closes it.
TriangleMesh piece_of(const HalfSpace& plane, const Position& low, const Position& high) {
  const auto corner = [&](std::size_t n) {
    return Position{(n & 1U) != 0 ? high[0] : low[0], (n & 2U) != 0 ? high[1] : low[1],
                    (n & 4U) != 0 ? high[2] : low[2]};
  };
  const double size = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  std::array<double, 8> above{};
  for (std::size_t n = 0; n < 8; ++n) {
    above[n] = nearest_of(plane, corner(n)).distance;
    if (std::abs(above[n]) < 1e-12 * size) above[n] = 0.0;
  }
  std::vector<Position> vertices;
  std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> known;  // by the ends of its edge
  const auto vertex = [&](std::size_t a, std::size_t b) {
    const auto [at, is_new] =
        known.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(vertices.size()));
    if (is_new) {
      const auto [from, to] = at->first;
      Position x = corner(from);
      const double share = from == to ? 0.0 : above[from] / (above[from] - above[to]);
      for (std::size_t k = 0; k < 3; ++k) x[k] += share * (corner(to)[k] - x[k]);
      vertices.push_back(x);
    }
    return at->second;
  };
  std::vector<TriangleMesh::Triangle> triangles;
  std::map<std::uint32_t, std::uint32_t> rim;  // the lid's edges, each against a face's own
  constexpr std::array<std::array<std::size_t, 4>, 6> faces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& face : faces) {
    std::vector<std::uint32_t> around;
    std::vector<bool> on_plane;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t a = face[k], b = face[(k + 1) % 4];
      if (above[a] <= 0.0) {
        around.push_back(vertex(a, a));
        on_plane.push_back(above[a] == 0.0);
      }
      if ((above[a] < 0.0 && above[b] > 0.0) || (above[a] > 0.0 && above[b] < 0.0)) {
        around.push_back(vertex(a, b));
        on_plane.push_back(true);
      }
    }
    const std::size_t n = around.size();
    if (n < 3 || std::all_of(on_plane.begin(), on_plane.end(), [](bool on) { return on; }))
      continue;
    for (std::size_t k = 2; k < n; ++k) triangles.push_back({around[0], around[k - 1], around[k]});
    for (std::size_t k = 0; k < n; ++k)
      if (on_plane[k] && on_plane[(k + 1) % n]) rim[around[(k + 1) % n]] = around[k];
  }
  if (triangles.empty()) return {};
  if (rim.size() > 2) {
    const std::uint32_t first = rim.begin()->first;
    for (std::uint32_t last = rim[first], next = rim[last]; next != first;
         last = next, next = rim[next])
      triangles.push_back({first, last, next});
  }
  return {std::move(vertices), std::move(triangles)};
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

bool overlap(const Polygon& a, const Polygon& b, double slack) {
  // an edge of one passes through one of the other, or one holds a corner or the middle of an edge
  // of the other
  using Point = std::array<double, 2>;
  const auto each_edge = [](const Polygon& polygon, auto&& f) {
    for (std::size_t i = 0, j = polygon.corners.size() - 1; i < polygon.corners.size(); j = i++)
      if (f(polygon.corners[j], polygon.corners[i])) return true;
    return false;
  };
  /// Distance of x from the line through p and q, positive on its left.
  const auto left = [](const Point& p, const Point& q, const Point& x) {
    return ((q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0])) /
           std::hypot(q[0] - p[0], q[1] - p[1]);
  };
  const auto apart = [&](double x, double y) {
    return (x > slack && y < -slack) || (x < -slack && y > slack);
  };
  const auto holds = [&](const Polygon& outer, const Polygon& inner) {
    const auto deep = [&](double x, double y) {
      return nearest_of(outer, {x, y, 0.0}).distance < -slack;
    };
    return each_edge(inner, [&](const Point& p, const Point& q) {
      return deep(p[0], p[1]) || deep(0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]));
    });
  };
  return holds(a, b) || holds(b, a) || each_edge(a, [&](const Point& p, const Point& q) {
           return each_edge(b, [&](const Point& r, const Point& s) {
             return apart(left(p, q, r), left(p, q, s)) && apart(left(r, s, p), left(r, s, q));
           });
         });
}

Nearest nearest(const Solid& solid, const Position& x) {
  Nearest found = std::visit([&](const auto& shape) { return nearest_of(shape, x); }, solid.shape);
  if (solid.hollow) {
    found.distance = -found.distance;
    for (double& n : found.normal) n = -n;
  }
  return found;
}

bool is_beyond(const Solid& solid, const Position& x, double radius) {
  if (const auto* const ground = std::get_if<Ground>(&solid.shape)) {
    const double above = std::abs(x[1] - ground->map->height(x[0], x[2]));
    return above > radius * std::hypot(1.0, ground->map->steepest());
  }
  if (const auto* const curve = std::get_if<Curve>(&solid.shape))
    return curve->line->is_beyond(x, radius);
  if (const auto* const mesh = std::get_if<Mesh>(&solid.shape))
    return mesh->mesh->is_beyond(x, radius);
  return std::abs(nearest(solid, x).distance) > radius;
}

bool holds(const Solid& solid, const Position& x) {
  if (const auto* const ground = std::get_if<Ground>(&solid.shape))
    return (x[1] < ground->map->height(x[0], x[2])) != solid.hollow;
  if (const auto* const curve = std::get_if<Curve>(&solid.shape))
    return curve->line->holds(x) != solid.hollow;
  if (const auto* const mesh = std::get_if<Mesh>(&solid.shape))
    return mesh->mesh->holds(x) != solid.hollow;
  return nearest(solid, x).distance < 0.0;
}

Bending bending(const Solid& solid, const Position& x, double over) {
  Bending S{};
  if (const auto* const ball = std::get_if<Ball>(&solid.shape)) {
    // φ = r − R: S = (I − n⊗n)/r
    const Nearest at = nearest(solid, x);
    const double r = std::abs(at.distance + (solid.hollow ? -ball->radius : ball->radius));
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        S[i][j] = (solid.hollow ? -1.0 : 1.0) *
                  ((i == j ? 1.0 : 0.0) - at.normal[i] * at.normal[j]) / std::max(r, 1e-300);
  } else if (const auto* const cylinder = std::get_if<Cylinder>(&solid.shape)) {
    // φ = r − R about the axis a: S = (I − a⊗a − n⊗n)/r; of the edge around an end, whose sharp
    // turn is no bend as a polygon's is none, the share of its normal that points outwards
    const Round at = around(*cylinder, x);
    const double end = beyond_end(*cylinder, at.along).first;
    const double out = at.away - cylinder->radius;
    double share = 1.0;
    if (cylinder->length < HUGE_VAL && out < end && !(out > 0.0)) share = 0.0;
    if (cylinder->length < HUGE_VAL && out > 0.0 && end > 0.0) share = out / std::hypot(out, end);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        S[i][j] = (solid.hollow ? -share : share) *
                  ((i == j ? 1.0 : 0.0) - at.axis[i] * at.axis[j] - at.outward[i] * at.outward[j]) /
                  std::max(at.away, 1e-300);
  } else if (std::holds_alternative<Ground>(solid.shape) ||
             std::holds_alternative<Curve>(solid.shape) ||
             std::holds_alternative<Mesh>(solid.shape)) {
    for (std::size_t j = 0; j < 3; ++j) {
      Position ahead = x, behind = x;
      ahead[j] += over;
      behind[j] -= over;
      const Position n = nearest(solid, ahead).normal, m = nearest(solid, behind).normal;
      for (std::size_t i = 0; i < 3; ++i) S[i][j] = (n[i] - m[i]) / (2.0 * over);
    }
  }
  return S;
}

bool Surface::moves() const {
  return (spin != 0.0 || velocity != std::array<double, 3>{}) && stops > starts;
}

bool Surface::is_complex() const {
  return std::holds_alternative<Curve>(solid.shape) || std::holds_alternative<Mesh>(solid.shape);
}

double Surface::moved_for(double time) const { return std::clamp(time, starts, stops) - starts; }

/// x = pivot + velocity t + R (x_0 − pivot).
Position Surface::at_start(double time, const Position& x) const {
  const double t = moved_for(time);
  if (t == 0.0 || !moves()) return x;
  const double c = std::cos(spin * t), s = std::sin(spin * t);
  const double dx = x[0] - pivot[0] - velocity[0] * t, dy = x[1] - pivot[1] - velocity[1] * t;
  return {pivot[0] + c * dx + s * dy, pivot[1] - s * dx + c * dy, x[2] - velocity[2] * t};
}

Nearest Surface::nearest_at(double time, const Position& x) const {
  const double t = moved_for(time);
  Nearest found = nearest(solid, at_start(time, x));
  if (t == 0.0 || !moves()) return found;
  const double c = std::cos(spin * t), s = std::sin(spin * t);
  const Position n = found.normal;
  found.normal = {c * n[0] - s * n[1], s * n[0] + c * n[1], n[2]};
  return found;
}

bool Surface::is_beyond_at(double time, const Position& x, double radius) const {
  return is_beyond(solid, at_start(time, x), radius);
}

bool Surface::holds_at(double time, const Position& x) const {
  return holds(solid, at_start(time, x));
}

Bending Surface::bending_at(double time, const Position& x, double over) const {
  const Bending start = bending(solid, at_start(time, x), over);
  const double t = moves() ? moved_for(time) : 0.0;
  if (t == 0.0 || spin == 0.0) return start;
  const double c = std::cos(spin * t), s = std::sin(spin * t);
  const std::array<std::array<double, 3>, 3> R{{{c, -s, 0.0}, {s, c, 0.0}, {0.0, 0.0, 1.0}}};
  Bending turned{};  // R S Rᵀ
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t l = 0; l < 3; ++l) turned[i][j] += R[i][k] * start[k][l] * R[j][l];
  return turned;
}

double Surface::friction_at(const Position& x) const {
  if (!friction_map) return friction;
  // between cells of a map, cubic convolution overshoots
  return std::clamp(friction_map->height(x[0], x[2]), friction_map->lowest(),
                    friction_map->highest());
}

std::array<double, 3> Surface::velocity_at(double time, const Position& x) const {
  if (!moves() || time < starts || time >= stops) return {};
  const double t = moved_for(time);
  return {velocity[0] - spin * (x[1] - pivot[1] - velocity[1] * t),
          velocity[1] + spin * (x[0] - pivot[0] - velocity[0] * t), velocity[2]};
}

std::vector<Outline> outlines_of(const std::function<double(double, double)>& distance,
                                 const std::array<double, 2>& low,
                                 const std::array<double, 2>& high) {
  constexpr double places = 400.0;
  const double width = high[0] - low[0], height = high[1] - low[1];
  const double step = std::max(width, height) / places, size = width + height;
  io::Lattice lattice;
  lattice.x = low[0];
  lattice.y = low[1];
  lattice.columns = static_cast<std::size_t>(std::ceil(width / step)) + 1;
  lattice.rows = static_cast<std::size_t>(std::ceil(height / step)) + 1;
  lattice.dx = width / static_cast<double>(lattice.columns - 1);
  lattice.dy = height / static_cast<double>(lattice.rows - 1);
  std::vector<double> values;
  for (std::size_t k = 0; k < lattice.rows; ++k)
    for (std::size_t i = 0; i < lattice.columns; ++i)
      values.push_back(std::max(0.0, 1.0 - distance(low[0] + lattice.dx * static_cast<double>(i),
                                                    low[1] + lattice.dy * static_cast<double>(k)) /
                                               size));
  lattice.values = values;
  std::vector<Outline> outlines;
  for (const io::Region& region : io::regions_above(lattice, 1.0)) {
    Outline outline{clipped({region.outer}, low, high)};
    for (const io::Ring& hole : region.holes) outline.push_back(clipped({hole}, low, high));
    if (outline.front().corners.size() > 2) outlines.push_back(std::move(outline));
  }
  return outlines;
}

std::vector<Outline> Surface::outlines(double time, double z, const std::array<double, 2>& low,
                                       const std::array<double, 2>& high) const {
  if (std::holds_alternative<Cylinder>(solid.shape) || std::holds_alternative<Mesh>(solid.shape))
    return outlines_of(
        [&](double x, double y) {
          const double distance = nearest_at(time, {x, y, z}).distance;
          return solid.hollow ? -distance : distance;
        },
        low, high);
  Polygon shape;
  if (const auto* const polygon = std::get_if<Polygon>(&solid.shape)) {
    shape = *polygon;
  } else if (const auto* const curve = std::get_if<Curve>(&solid.shape)) {
    shape.corners = curve->line->points();
    if (!curve->line->closed()) {
      // with room for all that it may have moved and turned, down to below what is looked at
      double far = std::abs(shape.corners.front()[0]) + std::abs(shape.corners.back()[0]);
      for (std::size_t k = 0; k < 2; ++k)
        far += 2.0 * (std::abs(low[k]) + std::abs(high[k]) + std::abs(pivot[k]) +
                      std::abs(velocity[k]) * moved_for(time));
      const double deep = std::min(low[1], curve->line->lowest()) - far;
      const double left = shape.corners.front()[1], right = shape.corners.back()[1];
      shape.corners.insert(shape.corners.begin(), {-far, left});
      shape.corners.push_back({far, right});
      shape.corners.push_back({far, deep});
      shape.corners.push_back({-far, deep});
    }
  } else if (const auto* const ball = std::get_if<Ball>(&solid.shape)) {
    const double dz = z - ball->centre[2], r2 = ball->radius * ball->radius - dz * dz;
    constexpr int corners = 180;
    for (int k = 0; k < corners && r2 > 0.0; ++k) {
      const double a = 2.0 * std::numbers::pi * k / corners;
      shape.corners.push_back({ball->centre[0] + std::sqrt(r2) * std::cos(a),
                               ball->centre[1] + std::sqrt(r2) * std::sin(a)});
    }
  } else if (const auto* const ground = std::get_if<Ground>(&solid.shape)) {
    constexpr int places = 400;
    for (int k = 0; k <= places; ++k) {
      const double x = low[0] + (high[0] - low[0]) * k / places;
      shape.corners.push_back({x, ground->map->height(x, z)});
    }
    const double deep = std::min(low[1], ground->map->lowest()) - 1.0;
    shape.corners.push_back({high[0], deep});
    shape.corners.push_back({low[0], deep});
  } else {
    // a rectangle on the line's rigid side, larger than what is looked at
    const auto& plane = std::get<HalfSpace>(solid.shape);
    const double in_plane = std::hypot(plane.normal[0], plane.normal[1]);
    if (in_plane == 0.0) return {};
    const std::array<double, 2> n{plane.normal[0] / in_plane, plane.normal[1] / in_plane};
    const double shift = -plane.normal[2] / in_plane * (z - plane.point[2]);
    const std::array<double, 2> on{plane.point[0] + shift * n[0], plane.point[1] + shift * n[1]};
    double size = 0.0;
    for (std::size_t k = 0; k < 2; ++k)
      size += 2.0 * (high[k] - low[k]) + std::abs(on[k] - low[k]) +
              std::abs(velocity[k]) * moved_for(time);
    for (const auto& [along, across] :
         {std::pair{-size, 0.0}, {-size, -size}, {size, -size}, {size, 0.0}})
      shape.corners.push_back(
          {on[0] + along * n[1] + across * n[0], on[1] - along * n[0] + across * n[1]});
  }
  const double t = moves() ? moved_for(time) : 0.0, c = std::cos(spin * t), s = std::sin(spin * t);
  for (auto& [x, y] : shape.corners) {
    const double dx = x - pivot[0], dy = y - pivot[1];
    x = pivot[0] + velocity[0] * t + c * dx - s * dy;
    y = pivot[1] + velocity[1] * t + s * dx + c * dy;
  }
  shape = clipped(shape, low, high);
  if (shape.corners.size() < 3) return {};
  return {{std::move(shape)}};
}

}  // namespace repose::mpm

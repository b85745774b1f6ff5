#include "mpm/scene/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fmt/core.h>

namespace repose::mpm {
namespace {

Position minus(const Position& a, const Position& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Position& a, const Position& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Position cross(const Position& a, const Position& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Position& a) { return std::sqrt(dot(a, a)); }
Position scaled(const Position& a, double factor) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}
void add(Position& to, double factor, const Position& x) {
  for (std::size_t k = 0; k < 3; ++k) to[k] += factor * x[k];
}
Position unit(const Position& a) {
  const double size = length(a);
  return size > 0.0 ? scaled(a, 1.0 / size) : Position{};
}

/// An edge between two vertices in either sense.
std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32U | std::max(a, b);
}

/// Six times the volume between a triangle and the first vertex.
double six_volumes(const std::vector<Position>& v, const TriangleMesh::Triangle& t) {
  return dot(minus(v[t[0]], v[0]), cross(minus(v[t[1]], v[0]), minus(v[t[2]], v[0])));
}

std::string words(const Position& x) { return fmt::format("({:g}, {:g}, {:g})", x[0], x[1], x[2]); }

/// The place of a triangle nearest to x, and the part that it lies on: 0 to 2 a corner, 3 to 5 the
/// edge from that corner on, 6 the face. Ericson, Real-Time Collision Detection (2005), 5.1.5.
struct Foot {
  Position place{};
  int part = 6;
};
Foot foot_on(const Position& a, const Position& b, const Position& c, const Position& x) {
  const Position ab = minus(b, a), ac = minus(c, a), ax = minus(x, a);
  const double d1 = dot(ab, ax), d2 = dot(ac, ax);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, 0};
  const Position bx = minus(x, b);
  const double d3 = dot(ab, bx), d4 = dot(ac, bx);
  if (d3 >= 0.0 && d4 <= d3) return {b, 1};
  const auto along = [](const Position& from, const Position& way, double share) {
    Position place = from;
    add(place, share, way);
    return place;
  };
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {along(a, ab, d1 / (d1 - d3)), 3};
  const Position cx = minus(x, c);
  const double d5 = dot(ab, cx), d6 = dot(ac, cx);
  if (d6 >= 0.0 && d5 <= d6) return {c, 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {along(a, ac, d2 / (d2 - d6)), 5};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return {along(b, minus(c, b), (d4 - d3) / ((d4 - d3) + (d5 - d6))), 4};
  const double whole = va + vb + vc;
  Position place = along(a, ab, vb / whole);
  add(place, vc / whole, ac);
  return {place, 6};
}

/// A flat piece of surface.
using Facet = std::vector<Position>;

/// What of a flat piece lies where sign · (x_axis − limit) >= 0 (Sutherland & Hodgman 1974).
void cut(Facet& piece, std::size_t axis, double limit, double sign, Facet& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const Position& from = piece[i == 0 ? piece.size() - 1 : i - 1];
    const Position& to = piece[i];
    const double before = sign * (from[axis] - limit), after = sign * (to[axis] - limit);
    if ((before < 0.0) != (after < 0.0)) {
      Position place = from;
      add(place, before / (before - after), minus(to, from));
      place[axis] = limit;
      scratch.push_back(place);
    }
    if (!(after < 0.0)) scratch.push_back(to);
  }
  piece.swap(scratch);
}

/// ∫ dA and ∫ (x, y, z) dA over a piece seen from above, and with u = y − base of ∫ u dA, ∫ u (x,
/// z) dA and ∫ u² dA; of triangles, ∫ f g dA = A/12 (Σ f_i g_i + Σ f_i Σ g_i) for linear f and g.
struct Integrals {
  double area = 0.0, x = 0.0, z = 0.0, u = 0.0, ux = 0.0, uz = 0.0, uu = 0.0;
};
Integrals integrals(const Facet& piece, double base) {
  Integrals sum;
  for (std::size_t k = 2; k < piece.size(); ++k) {
    const std::array<const Position*, 3> c{&piece[0], &piece[k - 1], &piece[k]};
    const double area = 0.5 * (((*c[1])[2] - (*c[0])[2]) * ((*c[2])[0] - (*c[0])[0]) -
                               ((*c[1])[0] - (*c[0])[0]) * ((*c[2])[2] - (*c[0])[2]));
    double sx = 0.0, sz = 0.0, su = 0.0, ux = 0.0, uz = 0.0, uu = 0.0;
    for (const Position* const p : c) {
      const double u = (*p)[1] - base;
      sx += (*p)[0];
      sz += (*p)[2];
      su += u;
      ux += u * (*p)[0];
      uz += u * (*p)[2];
      uu += u * u;
    }
    sum.area += area;
    sum.x += area / 3.0 * sx;
    sum.z += area / 3.0 * sz;
    sum.u += area / 3.0 * su;
    sum.ux += area / 12.0 * (ux + su * sx);
    sum.uz += area / 12.0 * (uz + su * sz);
    sum.uu += area / 12.0 * (uu + su * su);
  }
  return sum;
}

}  // namespace

std::optional<std::string> TriangleMesh::fault_of(const std::vector<Position>& vertices,
                                                  const std::vector<Triangle>& triangles) {
  if (triangles.empty()) return "there is no triangle";
  if (triangles.size() > most_triangles)
    return fmt::format("{} triangles are more than a mesh may have ({})", triangles.size(),
                       most_triangles);
  for (const Position& x : vertices)
    for (const double coordinate : x)
      if (!std::isfinite(coordinate)) return "a vertex is not finite";
  struct Use {
    std::size_t first = 0, last = 0;  ///< triangles
    std::uint32_t forth = 0, back = 0;
  };
  std::unordered_map<std::uint64_t, Use> uses;
  uses.reserve(triangles.size() * 2);
  for (std::size_t n = 0; n < triangles.size(); ++n)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[n][k], b = triangles[n][(k + 1) % 3];
      Use& use = uses[edge_key(a, b)];
      if (use.forth + use.back == 0) use.first = n;
      use.last = n;
      ++(a < b ? use.forth : use.back);
    }
  // in the order of the file, not of the table of edges
  for (std::size_t n = 0; n < triangles.size(); ++n)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[n][k], b = triangles[n][(k + 1) % 3];
      const Use& use = uses[edge_key(a, b)];
      if (use.forth == use.back && use.forth == 1) continue;
      const std::string where = fmt::format("the edge from {} to {} of triangle {}",
                                            words(vertices[a]), words(vertices[b]), n + 1);
      if (use.forth + use.back == 1)
        return where + " belongs to no other triangle: the surface has a hole there";
      if (use.forth + use.back == 2)
        return where + fmt::format(
                           " is run along in the same sense by triangle {}: one of the two "
                           "faces the other way",
                           (use.first == n ? use.last : use.first) + 1);
      return where +
             fmt::format(" belongs to {} triangles: two meet in an edge of a closed surface",
                         use.forth + use.back);
    }
  double volume = 0.0;
  for (const Triangle& t : triangles) volume += six_volumes(vertices, t) / 6.0;
  if (!(volume > 0.0))
    return fmt::format("the surface faces inwards: its volume comes out as {:g} m³", volume);
  return {};
}

TriangleMesh::TriangleMesh(std::vector<Position> vertices, std::vector<Triangle> triangles)
    : vertices_(std::move(vertices)),
      triangles_(std::move(triangles)) {
  std::vector<BoxTree::Box> boxes(triangles_.size());
  vertex_normals_.resize(vertices_.size());
  std::unordered_map<std::uint64_t, Position> along_edges;
  along_edges.reserve(triangles_.size() * 2);
  for (std::size_t n = 0; n < triangles_.size(); ++n) {
    const Triangle& t = triangles_[n];
    const Position normal = unit(
        cross(minus(vertices_[t[1]], vertices_[t[0]]), minus(vertices_[t[2]], vertices_[t[0]])));
    normals_.push_back(normal);
    volume_ += six_volumes(vertices_, t) / 6.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t at = t[k], next = t[(k + 1) % 3], last = t[(k + 2) % 3];
      boxes[n].add(vertices_[at]);
      add(along_edges[edge_key(at, next)], 1.0, normal);
      const Position e = minus(vertices_[next], vertices_[at]),
                     f = minus(vertices_[last], vertices_[at]);
      add(vertex_normals_[at], std::atan2(length(cross(e, f)), dot(e, f)), normal);
    }
  }
  for (const Triangle& t : triangles_) {
    std::array<Position, 3>& of_triangle = edge_normals_.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      of_triangle[k] = along_edges[edge_key(t[k], t[(k + 1) % 3])];
  }
  tree_ = BoxTree(boxes);
}

Nearest TriangleMesh::nearest(const Position& x) const {
  double best = HUGE_VAL;
  std::uint32_t of = 0;
  Foot foot;
  tree_.near_to(x, best, [&](std::uint32_t n, double& least) {
    const Triangle& t = triangles_[n];
    const Foot here = foot_on(vertices_[t[0]], vertices_[t[1]], vertices_[t[2]], x);
    const Position d = minus(x, here.place);
    const double d2 = dot(d, d);
    if (!(d2 < least)) return;
    least = d2;
    of = n;
    foot = here;
  });
  const Position& normal = normals_[of];
  const Triangle& t = triangles_[of];
  if (foot.part == 6) return {dot(minus(x, vertices_[t[0]]), normal), normal};
  const auto part = static_cast<std::size_t>(foot.part);
  const Position& sum = part < 3 ? vertex_normals_[t[part]] : edge_normals_[of][part - 3];
  const Position d = minus(x, foot.place);
  const double distance = length(d), sign = dot(d, sum) < 0.0 ? -1.0 : 1.0;
  const double size = std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])});
  // a place on the surface could not tell its normal from its distance
  if (distance <= 1e-9 * size) return {sign * distance, unit(sum)};
  return {sign * distance, scaled(d, sign / distance)};
}

bool TriangleMesh::is_beyond(const Position& x, double radius) const {
  double best = radius * radius * (1.0 + 1e-12);
  bool beyond = true;
  tree_.near_to(x, best, [&](std::uint32_t n, double& least) {
    const Triangle& t = triangles_[n];
    const Position d =
        minus(x, foot_on(vertices_[t[0]], vertices_[t[1]], vertices_[t[2]], x).place);
    if (dot(d, d) > least) return;
    beyond = false;
    least = 0.0;
  });
  return beyond;
}

bool TriangleMesh::holds(const Position& x) const {
  return tree_.bounds().distance2(x) == 0.0 && nearest(x).distance < 0.0;
}

std::vector<double> TriangleMesh::crossings(double x, double z) const {
  BoxTree::Box line;
  line.add({x, -HUGE_VAL, z});
  line.add({x, HUGE_VAL, z});
  std::vector<double> heights;
  tree_.each_meeting(line, [&](std::uint32_t n) {
    const Triangle& t = triangles_[n];
    // a ray along x from the line's place in the plan meets an odd number of edges; an edge is
    // looked at from the same end by both triangles that share it
    bool within = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = std::min(t[k], t[(k + 1) % 3]),
                          to = std::max(t[k], t[(k + 1) % 3]);
      const Position &a = vertices_[from], &b = vertices_[to];
      if ((a[2] > z) != (b[2] > z) && x < a[0] + (b[0] - a[0]) * (z - a[2]) / (b[2] - a[2]))
        within = !within;
    }
    const Position& normal = normals_[n];
    if (!within || normal[1] == 0.0) return;
    const Position& a = vertices_[t[0]];
    const double y = a[1] - (normal[0] * (x - a[0]) + normal[2] * (z - a[2])) / normal[1];
    const auto [low, high] =
        std::minmax({a[1], vertices_[t[1]][1], vertices_[t[2]][1]});  // of one that stands upright
    heights.push_back(std::clamp(y, low, high));
  });
  std::sort(heights.begin(), heights.end());
  return heights;
}

void TriangleMesh::add_shares(const Column& column, std::vector<Share>& cells) const {
  const auto count = static_cast<std::int64_t>(cells.size());
  // moments are taken about the middle of the column's base, for the sake of the last digits
  const Position origin{0.5 * (column.low[0] + column.high[0]), column.base,
                        0.5 * (column.low[1] + column.high[1])};
  const double h = column.height;
  std::vector<Integrals> whole(cells.size());  // of what lies above the cell and none above it
  std::vector<Share> added(cells.size());
  BoxTree::Box box;
  box.add({column.low[0], -HUGE_VAL, column.low[1]});
  box.add({column.high[0], HUGE_VAL, column.high[1]});
  Facet piece, slice, scratch;
  tree_.each_meeting(box, [&](std::uint32_t n) {
    piece.clear();
    for (const std::uint32_t vertex : triangles_[n]) piece.push_back(vertices_[vertex]);
    for (std::size_t k = 0; k < 2; ++k) {
      cut(piece, 2 * k, column.low[k], 1.0, scratch);
      cut(piece, 2 * k, column.high[k], -1.0, scratch);
    }
    if (piece.size() < 3) return;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (Position& place : piece) {
      place = minus(place, origin);
      low = std::min(low, place[1]);
      high = std::max(high, place[1]);
    }
    const auto row = [&](double y) {
      return std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(
                                          std::clamp(y / h, -1.0, static_cast<double>(count)))),
                                      -1, count);
    };
    for (std::int64_t j = std::max<std::int64_t>(row(low), 0); j <= row(high) && j < count; ++j) {
      const double base = h * static_cast<double>(j);
      slice = piece;
      cut(slice, 1, base, 1.0, scratch);
      const Integrals all = integrals(slice, base);
      cut(slice, 1, base + h, -1.0, scratch);
      const Integrals part = integrals(slice, base);  // what is left of all lies above the cell
      Share& share = added[static_cast<std::size_t>(j)];
      share.volume += part.u + h * (all.area - part.area);
      share.moment[0] += part.ux + h * (all.x - part.x);
      share.moment[1] +=
          base * part.u + 0.5 * part.uu + h * (base + 0.5 * h) * (all.area - part.area);
      share.moment[2] += part.uz + h * (all.z - part.z);
    }
    if (const std::int64_t below = std::min(row(low), count) - 1; below >= 0) {
      const Integrals all = integrals(piece, 0.0);
      Integrals& sum = whole[static_cast<std::size_t>(below)];
      sum.area += all.area;
      sum.x += all.x;
      sum.z += all.z;
    }
  });
  Integrals above;
  for (std::size_t j = cells.size(); j-- > 0;) {
    above.area += whole[j].area;
    above.x += whole[j].x;
    above.z += whole[j].z;
    Share& share = added[j];
    share.volume += h * above.area;
    share.moment[0] += h * above.x;
    share.moment[1] += h * h * (static_cast<double>(j) + 0.5) * above.area;
    share.moment[2] += h * above.z;
    cells[j].volume += share.volume;
    for (std::size_t k = 0; k < 3; ++k)
      cells[j].moment[k] += share.moment[k] + share.volume * origin[k];
  }
}

}  // namespace repose::mpm

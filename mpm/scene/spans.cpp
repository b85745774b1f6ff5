#include "mpm/scene/spans.hpp"

#include <algorithm>
#include <cmath>

namespace repose::mpm {
namespace {

Spans of_heights(std::vector<double> heights) {
  std::sort(heights.begin(), heights.end());
  Spans spans;
  for (std::size_t k = 0; k + 1 < heights.size(); k += 2)
    if (heights[k + 1] > heights[k]) spans.push_back({heights[k], heights[k + 1]});
  return spans;
}

Spans intersection(const Spans& a, const Spans& b) {
  Spans common;
  for (const Span& p : a)
    for (const Span& q : b) {
      const double low = std::max(p.low, q.low), high = std::min(p.high, q.high);
      if (high > low) common.push_back({low, high});
    }
  return common;
}

Spans complement(const Spans& spans) {
  Spans rest;
  double low = -HUGE_VAL;
  for (const Span& span : spans) {
    if (span.low > low) rest.push_back({low, span.low});
    low = span.high;
  }
  if (low < HUGE_VAL) rest.push_back({low, HUGE_VAL});
  return rest;
}

/// Where a t² + 2 b t + c < 0.
Spans below_zero(double a, double b, double c) {
  if (!(a > 1e-14)) return c < 0.0 ? Spans{{-HUGE_VAL, HUGE_VAL}} : Spans{};
  const double root2 = b * b - a * c;
  if (!(root2 > 0.0)) return {};
  const double root = std::sqrt(root2);
  return {{(-b - root) / a, (-b + root) / a}};
}

/// Where from <= a t + b <= to.
Spans within_slab(double a, double b, double from, double to) {
  if (a == 0.0) return b >= from && b <= to ? Spans{{-HUGE_VAL, HUGE_VAL}} : Spans{};
  const double p = (from - b) / a, q = (to - b) / a;
  return {{std::min(p, q), std::max(p, q)}};
}

Spans spans_in(const HalfSpace& plane, double x, double z) {
  const Position& n = plane.normal;
  const double across = n[0] * (x - plane.point[0]) + n[2] * (z - plane.point[2]);
  if (n[1] == 0.0) return across < 0.0 ? Spans{{-HUGE_VAL, HUGE_VAL}} : Spans{};
  const double y = plane.point[1] - across / n[1];
  return n[1] > 0.0 ? Spans{{-HUGE_VAL, y}} : Spans{{y, HUGE_VAL}};
}

Spans spans_in(const Ball& ball, double x, double z) {
  const double dx = x - ball.centre[0], dz = z - ball.centre[2];
  Spans spans = below_zero(1.0, 0.0, dx * dx + dz * dz - ball.radius * ball.radius);
  for (Span& span : spans) span = {ball.centre[1] + span.low, ball.centre[1] + span.high};
  return spans;
}

Spans spans_in(const Polygon& polygon, double x, double) {
  std::vector<double> heights;
  const auto& c = polygon.corners;
  for (std::size_t i = 0, j = c.size() - 1; i < c.size(); j = i++)
    if ((c[i][0] > x) != (c[j][0] > x))
      heights.push_back(c[j][1] + (x - c[j][0]) / (c[i][0] - c[j][0]) * (c[i][1] - c[j][1]));
  return of_heights(std::move(heights));
}

Spans spans_in(const Curve& curve, double x, double z) {
  if (curve.line->closed()) return spans_in(Polygon{curve.line->points()}, x, z);
  return {{-HUGE_VAL, curve.line->height(x)}};
}

Spans spans_in(const Cylinder& cylinder, double x, double z) {
  // (x, t, z) seen from the point on the axis: m + t e_y, along the axis s = m·a + t a_y
  const double size = std::hypot(cylinder.axis[0], cylinder.axis[1], cylinder.axis[2]);
  const Position a{cylinder.axis[0] / size, cylinder.axis[1] / size, cylinder.axis[2] / size};
  const Position m{x - cylinder.point[0], 0.0, z - cylinder.point[2]};
  const double s = m[0] * a[0] + m[2] * a[2];
  Spans spans = below_zero(1.0 - a[1] * a[1], -s * a[1],
                           m[0] * m[0] + m[2] * m[2] - s * s - cylinder.radius * cylinder.radius);
  if (cylinder.length < HUGE_VAL)
    spans = intersection(spans, within_slab(a[1], s, 0.0, cylinder.length));
  for (Span& span : spans) span = {cylinder.point[1] + span.low, cylinder.point[1] + span.high};
  return spans;
}

Spans spans_in(const Mesh& mesh, double x, double z) {
  return of_heights(mesh.mesh->crossings(x, z));
}

Spans spans_in(const Ground& ground, double x, double z) {
  return {{-HUGE_VAL, ground.map->height(x, z)}};
}

/// Of what a body is before other shapes cut it.
Spans whole_spans(const Scene& scene, const Body& body, double x, double z) {
  const auto reaches = [&](std::size_t axis, double at) {
    return at >= body.origin[axis] && at < body.origin[axis] + body.size[axis];
  };
  const bool space = scene.dimensions() == 3;
  if (!reaches(0, x) || (space && !reaches(2, z))) return {};
  if (body.release) {
    const double half = 0.5 * point_spacing(scene);
    const double depth =
        scene.terrain->release->volume_over({x - half, z - half}, {x + half, z + half}) /
        (4.0 * half * half);
    const double ground = scene.terrain->ground->height(x, z);
    return depth > 0.0 ? Spans{{ground, ground + depth}} : Spans{};
  }
  if (body.polygon) return spans_in(*body.polygon, x, z);
  const Span box{body.origin[1], body.origin[1] + body.size[1]};
  if (body.solid) return intersection(spans_of(*body.solid, x, z), {box});
  if (!body.disc) return {box};
  const Disc& disc = *body.disc;
  if (!space) {
    const Position centre{disc.centre[0], disc.centre[1], 0.0};
    const Spans around = spans_in(Ball{centre, disc.radius}, x, 0.0);
    if (disc.hole == 0.0) return around;
    return intersection(around, complement(spans_in(Ball{centre, disc.hole}, x, 0.0)));
  }
  const double r = std::hypot(x - disc.centre[0], z - disc.centre[1]);
  return r < disc.hole || r >= disc.radius ? Spans{} : Spans{box};
}

}  // namespace

Spans spans_of(const Solid& solid, double x, double z) {
  Spans spans = std::visit([&](const auto& shape) { return spans_in(shape, x, z); }, solid.shape);
  return solid.hollow ? complement(spans) : spans;
}

Spans spans_over(const Scene& scene, const Body& body, double x, double z) {
  Spans spans = whole_spans(scene, body, x, z);
  for (const Solid& shape : body.within) spans = intersection(spans, spans_of(shape, x, z));
  for (const Solid& shape : body.without)
    spans = intersection(spans, complement(spans_of(shape, x, z)));
  return spans;
}

}  // namespace repose::mpm

#include "mpm/scene/cut_body.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/scene/spans.hpp"

namespace repose::mpm {
namespace {

/// Nodes and weights of Gauss and Legendre on [0, 1]; the roots by Newton's method.
template <std::size_t n>
struct GaussRule {
  std::array<double, n> place{}, weight{};
  GaussRule() {
    for (std::size_t i = 0; i < n; ++i) {
      double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) /
                          (static_cast<double>(n) + 0.5));
      double slope = 0.0;
      for (int round = 0; round < 8; ++round) {
        double p = 1.0, before = 0.0;  // P_k of Bonnet's recursion
        for (std::size_t k = 1; k <= n; ++k) {
          const double of = static_cast<double>(k);
          const double next = ((2.0 * of - 1.0) * x * p - (of - 1.0) * before) / of;
          before = p;
          p = next;
        }
        slope = static_cast<double>(n) * (x * p - before) / (x * x - 1.0);
        x -= p / slope;
      }
      place[i] = 0.5 * (1.0 - x);
      weight[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
  }
};

/// The cells of the grid's own lattice of points around a body.
struct LatticeAround {
  double spacing = 0.0;
  std::array<std::int64_t, 3> first{}, count{1, 1, 1};
  LatticeAround(const Scene& scene, const Body& body) : spacing(point_spacing(scene)) {
    for (std::size_t k = 0; k < scene.dimensions(); ++k) {
      first[k] = std::llround(std::floor(body.origin[k] / spacing + lattice_tolerance));
      const double end = (body.origin[k] + body.size[k]) / spacing - lattice_tolerance;
      count[k] = std::llround(std::ceil(end)) - first[k];
    }
  }
  double low(std::size_t axis, std::int64_t n) const {
    return spacing * static_cast<double>(first[axis] + n);
  }
};

/// Adds what a line that stands for `width` holds to the cells over it.
void add_line(const Spans& spans, double x, double z, double width, const LatticeAround& lattice,
              std::vector<Share>& cells) {
  const std::int64_t rows = lattice.count[1];
  for (const Span& span : spans) {
    const auto row = [&](double y) {
      return static_cast<std::int64_t>(
          std::floor(std::clamp(y / lattice.spacing - static_cast<double>(lattice.first[1]), -1.0,
                                static_cast<double>(rows))));
    };
    const std::int64_t last = std::min(row(span.high), rows - 1);
    for (std::int64_t j = std::max<std::int64_t>(row(span.low), 0); j <= last; ++j) {
      const double low = std::max(span.low, lattice.low(1, j));
      const double high = std::min(span.high, lattice.low(1, j + 1));
      if (!(high > low)) continue;
      Share& share = cells[static_cast<std::size_t>(j)];
      const double part = width * (high - low);
      share.volume += part;
      share.moment[0] += part * x;
      share.moment[1] += part * 0.5 * (low + high);
      share.moment[2] += part * z;
    }
  }
}

using Point = std::array<double, 2>;

/// The straight lines and circles that bound shapes of the plane.
class Outlines {
 public:
  void add(const Polygon& polygon) {
    const auto& c = polygon.corners;
    for (std::size_t i = 0, j = c.size() - 1; i < c.size(); j = i++) lines_.push_back({c[j], c[i]});
  }
  void add_circle(const Point& centre, double radius) {
    if (radius > 0.0) circles_.push_back({centre, radius});
  }
  /// Lines without end become longer than all of the box.
  void add(const Solid& solid, const std::array<double, 3>& domain) {
    if (const auto* const polygon = std::get_if<Polygon>(&solid.shape)) {
      add(*polygon);
    } else if (const auto* const ball = std::get_if<Ball>(&solid.shape)) {
      add_circle({ball->centre[0], ball->centre[1]}, ball->radius);
    } else if (const auto* const curve = std::get_if<Curve>(&solid.shape)) {
      const auto& points = curve->line->points();
      if (curve->line->closed()) return add(Polygon{points});
      for (std::size_t i = 1; i < points.size(); ++i) lines_.push_back({points[i - 1], points[i]});
      lines_.push_back({{-domain[0], points.front()[1]}, points.front()});
      lines_.push_back({points.back(), {2.0 * domain[0], points.back()[1]}});
    } else if (const auto* const plane = std::get_if<HalfSpace>(&solid.shape)) {
      const double length = std::hypot(plane->normal[0], plane->normal[1]);
      const Point along{plane->normal[1] / length, -plane->normal[0] / length};
      const double far =
          2.0 * (domain[0] + domain[1]) + std::abs(plane->point[0]) + std::abs(plane->point[1]);
      lines_.push_back({{plane->point[0] - far * along[0], plane->point[1] - far * along[1]},
                        {plane->point[0] + far * along[0], plane->point[1] + far * along[1]}});
    }
  }

  /// x of all places between two where outlines end, stand upright, meet each other or a row.
  std::vector<double> breaks(const LatticeAround& lattice) const {
    std::vector<double> found;
    for (std::int64_t i = 0; i <= lattice.count[0]; ++i) found.push_back(lattice.low(0, i));
    const double low = found.front(), high = found.back();
    const auto add_break = [&](double x) {
      if (x > low && x < high) found.push_back(x);
    };
    for (const Line& line : lines_) {
      add_break(line.from[0]);
      add_break(line.to[0]);
    }
    for (const Circle& circle : circles_)
      for (const double side : {-1.0, 1.0}) add_break(circle.centre[0] + side * circle.radius);
    for (std::int64_t j = 0; j <= lattice.count[1]; ++j) {
      const double y = lattice.low(1, j);
      const Line row{{low, y}, {high, y}};
      for (const Line& line : lines_) meet(row, line, add_break);
      for (const Circle& circle : circles_) meet(row, circle, add_break);
    }
    for (std::size_t a = 0; a < lines_.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) meet(lines_[a], lines_[b], add_break);
      for (const Circle& circle : circles_) meet(lines_[a], circle, add_break);
    }
    for (std::size_t a = 0; a < circles_.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) meet(circles_[a], circles_[b], add_break);
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  struct Line {
    Point from, to;
  };
  struct Circle {
    Point centre;
    double radius;
  };

  template <class F>
  static void meet(const Line& a, const Line& b, F&& at) {
    const auto apart = [](const Line& p, const Line& q, std::size_t k) {
      return std::max(p.from[k], p.to[k]) < std::min(q.from[k], q.to[k]) ||
             std::max(q.from[k], q.to[k]) < std::min(p.from[k], p.to[k]);
    };
    if (apart(a, b, 0) || apart(a, b, 1)) return;
    const Point p{a.to[0] - a.from[0], a.to[1] - a.from[1]};
    const Point q{b.to[0] - b.from[0], b.to[1] - b.from[1]};
    const double turn = p[0] * q[1] - p[1] * q[0];
    if (turn == 0.0) return;
    const double share = ((b.from[0] - a.from[0]) * q[1] - (b.from[1] - a.from[1]) * q[0]) / turn;
    at(a.from[0] + share * p[0]);
  }
  template <class F>
  static void meet(const Line& line, const Circle& circle, F&& at) {
    const Point p{line.to[0] - line.from[0], line.to[1] - line.from[1]};
    const Point r{line.from[0] - circle.centre[0], line.from[1] - circle.centre[1]};
    const double a = p[0] * p[0] + p[1] * p[1], b = p[0] * r[0] + p[1] * r[1];
    const double root2 = b * b - a * (r[0] * r[0] + r[1] * r[1] - circle.radius * circle.radius);
    if (!(root2 > 0.0)) return;
    for (const double side : {-1.0, 1.0})
      at(line.from[0] + (-b + side * std::sqrt(root2)) / a * p[0]);
  }
  template <class F>
  static void meet(const Circle& a, const Circle& b, F&& at) {
    const double dx = b.centre[0] - a.centre[0], dy = b.centre[1] - a.centre[1];
    const double d2 = dx * dx + dy * dy;
    if (d2 == 0.0) return;
    // along the line between the centres, and across it
    const double share = 0.5 * (d2 + a.radius * a.radius - b.radius * b.radius) / d2;
    const double across2 = a.radius * a.radius / d2 - share * share;
    if (!(across2 > 0.0)) return;
    for (const double side : {-1.0, 1.0})
      at(a.centre[0] + share * dx - side * std::sqrt(across2) * dy);
  }

  std::vector<Line> lines_;
  std::vector<Circle> circles_;
};

/// Between two neighbouring breaks the length of a line in a cell is smooth but for square roots at
/// the ends, which x = a + (b − a)(3t² − 2t³) takes away; 16 nodes integrate what is linear, and
/// its moments, exactly.
std::vector<Share> in_plane(const Scene& scene, const Body& body, const LatticeAround& lattice) {
  Outlines outlines;
  if (body.polygon) {
    outlines.add(*body.polygon);
  } else if (body.solid) {
    outlines.add(*body.solid, scene.domain);
  } else if (body.disc) {
    for (const double radius : {body.disc->radius, body.disc->hole})
      outlines.add_circle(body.disc->centre, radius);
  } else {
    const double right = body.origin[0] + body.size[0], top = body.origin[1] + body.size[1];
    outlines.add(Polygon{{{body.origin[0], body.origin[1]},
                          {right, body.origin[1]},
                          {right, top},
                          {body.origin[0], top}}});
  }
  for (const auto* const list : {&body.within, &body.without})
    for (const Solid& solid : *list) outlines.add(solid, scene.domain);
  static const GaussRule<16> gauss;
  const std::vector<double> breaks = outlines.breaks(lattice);
  std::vector<Share> shares(static_cast<std::size_t>(lattice.count[0] * lattice.count[1]));
  std::vector<Share> cells(static_cast<std::size_t>(lattice.count[1]));
  std::size_t next = 0;
  for (std::int64_t i = 0; i < lattice.count[0]; ++i) {
    std::fill(cells.begin(), cells.end(), Share{});
    for (; next + 1 < breaks.size() && breaks[next] < lattice.low(0, i + 1); ++next) {
      const double from = breaks[next], width = breaks[next + 1] - from;
      for (std::size_t k = 0; width > 0.0 && k < gauss.place.size(); ++k) {
        const double t = gauss.place[k];
        const double x = from + width * t * t * (3.0 - 2.0 * t);
        add_line(spans_over(scene, body, x, 0.0), x, 0.0,
                 width * 6.0 * t * (1.0 - t) * gauss.weight[k], lattice, cells);
      }
    }
    std::copy(cells.begin(), cells.end(), shares.begin() + i * lattice.count[1]);
  }
  return shares;
}

std::vector<Share> in_space(const Scene& scene, const Body& body, const LatticeAround& lattice) {
  static const GaussRule<16> gauss;
  const bool alone = body.within.empty() && body.without.empty();
  const Mesh* const mesh = body.solid && alone ? std::get_if<Mesh>(&body.solid->shape) : nullptr;
  const HalfSpace* const plane =
      body.solid && alone ? std::get_if<HalfSpace>(&body.solid->shape) : nullptr;
  const TriangleMesh behind =
      plane != nullptr ? piece_of(*plane, {}, scene.domain) : TriangleMesh();
  const TriangleMesh* const triangles = mesh != nullptr    ? mesh->mesh.get()
                                        : plane != nullptr ? &behind
                                                           : nullptr;
  std::vector<Share> shares;
  std::vector<Share> cells(static_cast<std::size_t>(lattice.count[1]));
  const double size = lattice.spacing;
  for (std::int64_t i = 0; i < lattice.count[0]; ++i)
    for (std::int64_t k = 0; k < lattice.count[2]; ++k) {
      std::fill(cells.begin(), cells.end(), Share{});
      const double x = lattice.low(0, i), z = lattice.low(2, k);
      if (triangles != nullptr) {
        triangles->add_shares(
            {{x, z}, {lattice.low(0, i + 1), lattice.low(2, k + 1)}, lattice.low(1, 0), size},
            cells);
      } else {
        for (std::size_t p = 0; p < gauss.place.size(); ++p)
          for (std::size_t q = 0; q < gauss.place.size(); ++q) {
            const double at = x + size * gauss.place[p], across = z + size * gauss.place[q];
            add_line(spans_over(scene, body, at, across), at, across,
                     size * size * gauss.weight[p] * gauss.weight[q], lattice, cells);
          }
      }
      for (const Share& share : cells)
        if (share.volume > 0.0) shares.push_back(share);
    }
  if (triangles != nullptr || !alone) return shares;
  const double full = size * size * size;
  double filled = 0.0, cut = 0.0;
  const auto is_full = [&](const Share& share) { return share.volume > full * (1.0 - 1e-12); };
  for (const Share& share : shares) (is_full(share) ? filled : cut) += share.volume;
  const double factor = cut > 0.0 ? (volume_of(scene, body) - filled) / cut : 1.0;
  for (Share& share : shares) {
    if (is_full(share)) continue;
    share.volume *= factor;
    for (double& moment : share.moment) moment *= factor;
  }
  return shares;
}

}  // namespace

std::vector<Share> shares_of(const Scene& scene, const Body& body) {
  const LatticeAround lattice(scene, body);
  std::vector<Share> shares =
      scene.dimensions() == 3 ? in_space(scene, body, lattice) : in_plane(scene, body, lattice);
  const double least = 1e-12 * std::pow(lattice.spacing, static_cast<double>(scene.dimensions()));
  std::erase_if(shares, [&](const Share& share) { return !(share.volume >= least); });
  return shares;
}

}  // namespace repose::mpm

#pragma once
/// \file
/// Surfaces of triangles for tests.

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "mpm/scene/solid.hpp"

namespace repose::mpm {

struct Triangulation {
  std::vector<Position> vertices;
  std::vector<TriangleMesh::Triangle> triangles;

  Solid solid() const {
    Mesh mesh;
    mesh.mesh = std::make_shared<const TriangleMesh>(vertices, triangles);
    return {mesh, false};
  }
};

/// A box between two corners, turned about z through its low corner [rad].
inline Triangulation box_mesh(const Position& low, const Position& high, double turned = 0.0) {
  Triangulation box;
  const double c = std::cos(turned), s = std::sin(turned);
  for (unsigned n = 0; n < 8; ++n) {
    const Position at{(n & 1U) != 0 ? high[0] : low[0], (n & 2U) != 0 ? high[1] : low[1],
                      (n & 4U) != 0 ? high[2] : low[2]};
    const double dx = at[0] - low[0], dy = at[1] - low[1];
    box.vertices.push_back({low[0] + c * dx - s * dy, low[1] + s * dx + c * dy, at[2]});
  }
  for (const auto& [a, b, c4, d] : std::vector<std::array<std::uint32_t, 4>>{
           {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}) {
    box.triangles.push_back({a, b, c4});
    box.triangles.push_back({a, c4, d});
  }
  return box;
}

/// An icosahedron whose triangles are quartered `rounds` times, with its vertices on a sphere: 20 ·
/// 4^rounds triangles.
inline Triangulation sphere_mesh(const Position& centre, double radius, int rounds) {
  const double t = 0.5 * (1.0 + std::sqrt(5.0));
  Triangulation sphere;
  sphere.vertices = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                     {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  sphere.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int round = 0; round < rounds; ++round) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] =
          known.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(sphere.vertices.size()));
      if (is_new) {
        Position x = sphere.vertices[a];
        for (std::size_t k = 0; k < 3; ++k) x[k] = 0.5 * (x[k] + sphere.vertices[b][k]);
        sphere.vertices.push_back(x);
      }
      return at->second;
    };
    std::vector<TriangleMesh::Triangle> finer;
    for (const auto& [a, b, c] : sphere.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const TriangleMesh::Triangle& quarter :
           {TriangleMesh::Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}})
        finer.push_back(quarter);
    }
    sphere.triangles = std::move(finer);
    for (Position& x : sphere.vertices) {
      const double length = std::hypot(x[0], x[1], x[2]);
      for (double& along : x) along /= length;
    }
  }
  for (Position& x : sphere.vertices)
    for (std::size_t k = 0; k < 3; ++k) x[k] = centre[k] + radius * x[k];
  return sphere;
}

inline Curve curve_of(std::vector<std::array<double, 2>> points, bool closed) {
  Curve curve;
  curve.line = std::make_shared<const PolyLine>(std::move(points), closed);
  return curve;
}

}  // namespace repose::mpm

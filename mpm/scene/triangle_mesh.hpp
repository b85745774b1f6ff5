#pragma once
/// \file
/// A closed surface of triangles in space.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mpm/scene/box_tree.hpp"
#include "mpm/scene/nearest.hpp"

namespace repose::mpm {

/// What of a body lies in a cell of a lattice.
struct Share {
  double volume = 0.0;  ///< [m³], in the plane [m²]
  Position moment{};    ///< ∫ x dV [m⁴]
  Position centroid() const { return {moment[0] / volume, moment[1] / volume, moment[2] / volume}; }
};

/// The cells of a lattice over one place (x, z), one upon the other.
struct Column {
  std::array<double, 2> low{}, high{};  ///< x and z of its sides [m]
  double base = 0.0, height = 0.0;      ///< y of the lowest cell, height of each [m]
};

class TriangleMesh {
 public:
  using Triangle = std::array<std::uint32_t, 3>;  ///< of vertices, counterclockwise from outside
  static constexpr std::size_t most_triangles = 20000000;

  /// Why triangles are no closed surface: an edge that not just two of them share, or that both run
  /// along in the same sense; a vertex that is not finite; a surface that faces inwards. Nothing if
  /// they are one. Whether it passes through itself is not looked at.
  static std::optional<std::string> fault_of(const std::vector<Position>& vertices,
                                             const std::vector<Triangle>& triangles);

  TriangleMesh() = default;
  /// Of triangles without a fault.
  TriangleMesh(std::vector<Position> vertices, std::vector<Triangle> triangles);

  std::size_t size() const { return triangles_.size(); }
  double volume() const { return volume_; }  ///< [m³]
  const BoxTree::Box& bounds() const { return tree_.bounds(); }

  /// By the nearest triangle; on which side of it a place lies that is nearest to one of its edges
  /// or corners, the normals of all that meet there tell, weighted by their angles (Baerentzen &
  /// Aanaes 2005).
  Nearest nearest(const Position& x) const;
  bool is_beyond(const Position& x, double radius) const;
  bool holds(const Position& x) const;

  /// The heights y at which the upright line through (x, z) passes through the surface, in pairs
  /// between which it is within, rising.
  std::vector<double> crossings(double x, double z) const;
  /// Adds to each cell of a column what of the mesh's inside lies in it; exact to round-off: every
  /// triangle is cut by the sides of the cells, and what lies below it added or, of one that faces
  /// down, taken away.
  void add_shares(const Column& column, std::vector<Share>& cells) const;

 private:
  std::vector<Position> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<Position> normals_;  ///< of triangles, of length 1; 0 of those without area
  std::vector<std::array<Position, 3>> edge_normals_;  ///< sums, of the edges from corner k on
  std::vector<Position> vertex_normals_;               ///< sums, weighted by angles
  BoxTree tree_;
  double volume_ = 0.0;
};

}  // namespace repose::mpm

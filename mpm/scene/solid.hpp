#pragma once
/// \file
/// Rigid regions by their signed distance, and surfaces made of them.

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "mpm/scene/height_map.hpp"
#include "mpm/scene/nearest.hpp"
#include "mpm/scene/poly_line.hpp"
#include "mpm/scene/triangle_mesh.hpp"

namespace repose::mpm {

/// All that lies behind a plane (in the plane a line), on the side its normal points away from.
struct HalfSpace {
  Position point{};                ///< on the plane [m]
  Position normal{0.0, 1.0, 0.0};  ///< of any length
};

/// A sphere, in the plane a disc.
struct Ball {
  Position centre{};    ///< [m]
  double radius = 0.0;  ///< [m]
};

/// In space, a prism along z without end.
struct Polygon {
  std::vector<std::array<double, 2>> corners;  ///< in either sense of rotation [m]
};

/// Round about a line, in space.
struct Cylinder {
  Position point{};              ///< on the axis; of one with a length, the middle of an end [m]
  Position axis{0.0, 1.0, 0.0};  ///< of any length, from there towards the other end
  double radius = 0.0;           ///< [m]
  double length = HUGE_VAL;      ///< endless to both sides without one [m]
};

/// What a line from a table surrounds or, open, all that lies below it; in space a prism along z
/// without end.
struct Curve {
  std::shared_ptr<const PolyLine> line;
  SourceFile file{};
  std::string x = "x", y = "y";  ///< columns of the table
  std::string unit{};            ///< of both, where the table names none
};

/// What a surface of triangles from a file surrounds, in space.
struct Mesh {
  std::shared_ptr<const TriangleMesh> mesh;
  SourceFile file{};
  double scale = 1.0;  ///< of the file's lengths [m]
  Position shift{};    ///< of what is scaled [m]
};

/// All that lies below a surface of heights, in space.
struct Ground {
  std::shared_ptr<const HeightMap> map;
};

/// Area of a polygon and its centroid.
struct Piece {
  double area = 0.0;                 ///< [m²]
  std::array<double, 2> centroid{};  ///< [m]
};
Piece piece_of(const Polygon& polygon);
/// What of a polygon lies in the rectangle from `low` to `high`; for one that is not convex, pieces
/// that do not hang together count as one.
Polygon clipped(const Polygon& polygon, const std::array<double, 2>& low,
                const std::array<double, 2>& high);

/// What of a half-space lies in the box between two corners; without triangles if that is nothing.
TriangleMesh piece_of(const HalfSpace& plane, const Position& low, const Position& high);

/// Whether two polygons have more in common than their edges, deeper than `slack` [m].
bool overlap(const Polygon& a, const Polygon& b, double slack);

struct Solid {
  std::variant<HalfSpace, Ball, Polygon, Curve, Cylinder, Mesh, Ground> shape;
  bool hollow = false;  ///< rigid is what lies outside
};

Nearest nearest(const Solid& solid, const Position& x);
/// Whether the surface is certainly farther from x than `radius` [m]; quicker than nearest().
bool is_beyond(const Solid& solid, const Position& x, double radius);
/// Whether x lies in the rigid part; quicker than nearest().
bool holds(const Solid& solid, const Position& x);

/// How the normal turns from place to place: dn = S dx, S_ij = ∂²φ/∂x_i∂x_j [1/m]. 0 of planes,
/// polygons and the ends of a cylinder; of curves, meshes and ground, whose points stand for
/// something that bends between them, over a length of `over` to either side.
using Bending = std::array<std::array<double, 3>, 3>;
Bending bending(const Solid& solid, const Position& x, double over);

/// Of a part of something: the outline around it, and those of holes in it.
using Outline = std::vector<Polygon>;
/// Where a signed distance is negative in the rectangle from `low` to `high`, by its level line on
/// a lattice of about 400 places along the longer side.
std::vector<Outline> outlines_of(const std::function<double(double, double)>& distance,
                                 const std::array<double, 2>& low,
                                 const std::array<double, 2>& high);

/// A rigid surface, at rest or moving as one.
struct Surface {
  enum class Contact {
    no_slip,   ///< no motion against it
    slip,      ///< no motion through it nor away from it, free motion along it
    friction,  ///< unilateral Coulomb contact: no tension, |shear| <= friction × pressure
  };
  std::string name;
  Solid solid;  ///< where it is at the start
  Contact contact = Contact::no_slip;
  double friction = 0.0;  ///< Coulomb coefficient, for Contact::friction
  /// The same from place to place, over the whole of the box; takes the place of `friction`.
  std::shared_ptr<const HeightMap> friction_map{};
  std::array<double, 3> velocity{};  ///< [m/s]
  double spin = 0.0;                 ///< about z, through `pivot` [rad/s]
  std::array<double, 2> pivot{};     ///< at the start; moves with the surface [m]
  double starts = 0.0;               ///< moves from this time on [s]
  double stops = HUGE_VAL;           ///< and until this one [s]

  bool moves() const;
  /// Whether a look at it costs more than a few operations: a curve or a mesh.
  bool is_complex() const;
  /// At x and a time: the distance and normal, and the velocity of what is rigid there.
  Nearest nearest_at(double time, const Position& x) const;
  bool is_beyond_at(double time, const Position& x, double radius) const;
  bool holds_at(double time, const Position& x) const;
  double friction_at(const Position& x) const;
  Bending bending_at(double time, const Position& x, double over) const;
  std::array<double, 3> velocity_at(double time, const Position& x) const;
  /// Its outlines in the plane z at a time, closed, within the rectangle from `low` to `high`; none
  /// where there is nothing of it. A hollow one has those of its hole.
  std::vector<Outline> outlines(double time, double z, const std::array<double, 2>& low,
                                const std::array<double, 2>& high) const;

 private:
  double moved_for(double time) const;
  /// Of a place, where it was in the surface's own axes at the start.
  Position at_start(double time, const Position& x) const;
};

}  // namespace repose::mpm

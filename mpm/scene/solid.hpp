#pragma once
/// \file
/// Rigid regions by their signed distance, and surfaces made of them.

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "mpm/scene/height_map.hpp"

namespace repose::mpm {

using Position = std::array<double, 3>;  ///< x, y and in space z [m]

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

/// Whether two polygons have more in common than their edges, deeper than `slack` [m].
bool overlap(const Polygon& a, const Polygon& b, double slack);

struct Solid {
  std::variant<HalfSpace, Ball, Polygon, Ground> shape;
  bool hollow = false;  ///< rigid is what lies outside
};

/// Distance from the surface, negative in the rigid part, and its gradient, which points away from
/// the rigid part.
struct Nearest {
  double distance = 0.0;  ///< [m]
  Position normal{};
};
Nearest nearest(const Solid& solid, const Position& x);
/// Whether the surface is certainly farther from x than `radius` [m]; quicker than nearest().
bool is_beyond(const Solid& solid, const Position& x, double radius);
/// Whether x lies in the rigid part; quicker than nearest().
bool holds(const Solid& solid, const Position& x);

/// How the normal turns from place to place: dn = S dx, S_ij = ∂²φ/∂x_i∂x_j [1/m]. 0 of planes and
/// polygons; of ground, over a length of `over` to either side.
using Bending = std::array<std::array<double, 3>, 3>;
Bending bending(const Solid& solid, const Position& x, double over);

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
  /// At x and a time: the distance and normal, and the velocity of what is rigid there.
  Nearest nearest_at(double time, const Position& x) const;
  bool is_beyond_at(double time, const Position& x, double radius) const;
  bool holds_at(double time, const Position& x) const;
  double friction_at(const Position& x) const;
  Bending bending_at(double time, const Position& x, double over) const;
  std::array<double, 3> velocity_at(double time, const Position& x) const;
  /// Its outline in the plane z at a time, closed, within the rectangle from `low` to `high`; empty
  /// where there is none of it. A hollow one has the outline of its hole.
  Polygon outline(double time, double z, const std::array<double, 2>& low,
                  const std::array<double, 2>& high) const;

 private:
  double moved_for(double time) const;
  /// Of a place, where it was in the surface's own axes at the start.
  Position at_start(double time, const Position& x) const;
};

}  // namespace repose::mpm

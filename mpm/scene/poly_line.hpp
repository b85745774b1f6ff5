#pragma once
/// \file
/// A line of many points in the plane: an outline, or a profile of ground.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mpm/scene/box_tree.hpp"
#include "mpm/scene/nearest.hpp"

namespace repose::mpm {

/// Straight between its points. Closed, it goes back from the last to the first, in either sense of
/// rotation, and what it surrounds is within; open, its x never falls, all below it is within, and
/// beyond its ends it goes on level.
class PolyLine {
 public:
  /// Why points are no such line.
  struct Fault {
    std::size_t point;  ///< of those given, from 0
    std::string what;
  };
  static constexpr std::size_t most_points = 100000;
  /// Too few or too many points, some that are not finite, two neighbours that are the same, a line
  /// that crosses or touches itself, one without area, or x that falls.
  static std::optional<Fault> fault_of(const std::vector<std::array<double, 2>>& points,
                                       bool closed);

  PolyLine() = default;
  /// Of points without a fault.
  PolyLine(std::vector<std::array<double, 2>> points, bool closed);

  const std::vector<std::array<double, 2>>& points() const { return points_; }
  bool closed() const { return closed_; }
  double lowest() const { return tree_.bounds().low[1]; }  ///< y of its lowest point [m]

  Nearest nearest(const Position& x) const;
  bool is_beyond(const Position& x, double radius) const;
  bool holds(const Position& x) const;
  /// Of an open one, its height over x [m].
  double height(double x) const;

 private:
  struct Edge {
    std::array<double, 2> from, to;
    std::array<double, 2> outward;  ///< of length 1
    double along(const Position& x) const;
  };
  /// The edge nearest to x, the place on it, from 0 to 1, and the square of the distance.
  struct Foot {
    std::size_t edge = 0;
    double along = 0.0, distance2 = HUGE_VAL;
  };
  Foot foot_of(const Position& x) const;

  std::vector<std::array<double, 2>> points_;
  bool closed_ = true;
  std::vector<Edge> edges_;
  BoxTree tree_;
};

}  // namespace repose::mpm

#pragma once
/// \file
/// What a flow over a terrain leaves to be told of each place: the largest depth and speed, and
/// when it was reached.

#include <vector>

#include "mpm/grid/points.hpp"
#include "mpm/scene/scene.hpp"
#include "mpm/step/simulation.hpp"

namespace repose::mpm {

/// The plan of a scene in space, a column of cells at each node (i h, k h); x first.
class FlowMaps {
 public:
  /// Of a scene with a terrain, whose bodies are as they start.
  FlowMaps(const Scene& scene, const std::vector<PointsOf<3>>& bodies);

  /// Looks at the points, if they may have gone half a cell since the last time that it did: no
  /// point has gone farther than `way` since the last call [m].
  void observe(const std::vector<PointsOf<3>>& bodies, double time, double way);

  /// How far the flow has come and how much of the ground it covers, as the points are now.
  Simulation::FlowExtent extent(const std::vector<PointsOf<3>>& bodies) const;

  /// Solid depth, column mass over ρ_0, measured along y, as the points are now [m].
  std::vector<double> depth(const std::vector<PointsOf<3>>& bodies) const;

  std::size_t columns = 0, rows = 0;  ///< nodes along x and z
  double h = 0.0;                     ///< [m]
  double least_depth = 0.0;           ///< from which on a node counts as reached [m]
  std::vector<double> depth_max;      ///< [m]
  /// Of the mean velocity of the column, where it is at least that deep [m/s]
  std::vector<double> speed_max;
  std::vector<double> arrival;  ///< when it first was that deep; HUGE_VAL: never [s]
  double gone = HUGE_VAL;       ///< farthest that a point may have gone since it looked [m]

 private:
  struct Columns {
    std::vector<double> solid;                    ///< volume over area [m]
    std::vector<double> mass;                     ///< [kg]
    std::vector<std::array<double, 3>> momentum;  ///< [kg m/s]
  };
  Columns columns_of(const std::vector<PointsOf<3>>& bodies, bool with_momentum) const;
  double distance_at(double x, double z) const;
  double area_of(std::size_t i, std::size_t k) const;  ///< of a node's column [m²]

  /// Of each node from the cells that held a point at the start, in the plan [m]
  std::vector<double> distance_;
};

}  // namespace repose::mpm

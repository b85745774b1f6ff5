#pragma once
/// \file
/// What a frame carries of the grid.

#include "io/frame_writer.hpp"
#include "mpm/step/simulation.hpp"

namespace repose::mpm {

/// Turns the nodes of a run's last step (Simulation::node_fields()) into frames: an image of the
/// whole box, with zeros where no point is near, and all over before the first step.
class GridFrame {
 public:
  /// mass_kg_per_m, in space mass_kg: gathered from the points where the step found them, so that
  ///                                 the sum is theirs, but for what hangs over an open edge
  /// velocity_m_per_s                after forces and walls
  /// Refers to this object, until the next call.
  io::GridView view(const Simulation& simulation);

 private:
  std::vector<double> mass_, vx_, vy_, vz_;
};

}  // namespace repose::mpm

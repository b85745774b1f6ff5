#pragma once
/// \file
/// What a scene takes of a machine, counted from its numbers alone: nothing is allocated, whatever
/// they say.

#include "mpm/scene/scene.hpp"

namespace repose::mpm {

struct Needs {
  double points = 0.0;
  double box_cells = 0.0;
  double memory_MB = 0.0;  ///< of points, grid and tables, with what sorting and spreading takes
  double grid_frames_MB = 0.0;  ///< what of it writing a frame of the grid takes for a moment
};

/// Of a scene that validate() accepts.
Needs needs_of(const Scene& scene);

/// Memory of this machine [MB]; HUGE_VAL where it does not tell.
double machine_memory_MB();

/// Throws InputError where the scene takes more memory than there is.
void require_memory(const Scene& scene, double available_MB = machine_memory_MB());

}  // namespace repose::mpm

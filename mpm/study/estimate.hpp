#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "mpm/scene/scene.hpp"

namespace repose::mpm {

/// What a run will take, before it runs.
struct Estimate {
  bool measured = false;  ///< on the scene as it is laid out; else counted from its numbers
  std::int64_t points = 0;
  double volume = 0.0;          ///< of all bodies, less what surfaces cut [m³], in the plane [m²]
  std::int64_t live_cells = 0;  ///< at the start
  double first_dt_s = 0.0;
  /// Longest steps expected on the way [s]: by the fastest signal, which goes with h, and by an
  /// explicit viscosity, which goes with h² (HUGE_VAL where nothing is viscous or the solve is
  /// implicit). A fixed step is neither.
  double wave_dt_s = HUGE_VAL, viscous_dt_s = HUGE_VAL;
  double steps = 0.0;  ///< end_time over a typical step: the shorter of the two, or the fixed one
  double memory_MB = 0.0;
  double seconds = 0.0;  ///< wall time with `threads`
  std::vector<std::string> warnings;
};

/// Points, cells, steps, memory and time of a scene, from a few measured steps (< 1 s); counted
/// where it has more than a million points. Errors: InputError if it is not sound, takes more
/// memory than this machine has or more steps than anybody waits for.
Estimate estimate(const Scene& scene, int threads = 0);

/// The same from its numbers alone: nothing is laid out, and no step is taken.
Estimate count_estimate(const Scene& scene);

}  // namespace repose::mpm

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mpm/scene/scene.hpp"

namespace repose::mpm {

/// What a run will take, before it runs.
struct Estimate {
  std::int64_t points = 0;
  std::int64_t live_cells = 0;  ///< at the start
  double first_dt_s = 0.0;
  double steps = 0.0;  ///< end_time over a typical step (fastest signal expected on the way)
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

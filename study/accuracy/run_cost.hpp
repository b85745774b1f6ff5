#pragma once
/// \file
/// What runs of a scene cost with other cells.

#include <cstddef>

namespace repose::study {

/// A run as it was estimated, with cells of h and a Courant number of 1.
struct EstimatedCost {
  double h = 0.0;             ///< [m]
  double seconds = 0.0;       ///< CPU seconds, at the shorter of the two steps
  double wave_dt_s = 0.0;     ///< the step by the fastest signal
  double viscous_dt_s = 0.0;  ///< by an explicit viscosity; HUGE_VAL where there is none
  std::size_t dimensions = 2;
};

/// CPU seconds of a run with cells of h [m]: points go with h^−dimensions, the step by the signal
/// with courant·h, that by the viscosity with h²; whichever is shorter at that h counts. So halved
/// cells take 8 times as long in the plane, and 16 times where viscosity bounds the step.
double seconds_with(const EstimatedCost& estimated, double h, double courant);

}  // namespace repose::study

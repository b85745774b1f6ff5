#pragma once
/// \file
/// Numerical failures of the method as numbers, each in the smallest problem that shows it.

#include "mpm/output/rest_pressure.hpp"
#include "mpm/step/simulation.hpp"

namespace repose::mpm {

/// What a failure is measured with.
struct Discretisation {
  Kernel kernel = Kernel::cubic;
  Transfer transfer = Transfer::relaxed;
  int points_per_cell = 4;
  double cells = 8.0;  ///< across the problem: its length over h
};

/// Cell crossing: an elastic block is drawn out by its own motion, x = (1 + εt)X, with a wave speed
/// of ε h, so that its points stand ever differently in their cells while they carry stress; the
/// largest root mean square of ρ(1 + εt)/ρ_0 − 1 until it is half as long again, without the ends.
/// 0 is exact. (A block moved without strain keeps a regular lattice, of which splines carry
/// uniform stress exactly.)
double cell_crossing_error(const Discretisation& d);

/// Numerical fracture: the same block, too soft for its stress to matter. The stretch at which that
/// measure reaches a tenth: beyond it points do not see each other. At most 8.
double fracture_stretch(const Discretisation& d);

/// Locking: an elastic block (ν given) on a rough floor bulges under its weight; the farthest that
/// its side ever gets in the first swing, over its half width. To be compared with fine cells.
double bulge(const Discretisation& d, double nu);

/// Ringing: the pressure of a scene's deposit at its end.
RestPressure rest_pressure_after(const Scene& scene);

}  // namespace repose::mpm

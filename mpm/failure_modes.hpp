#pragma once
/// \file
/// Numerical failures of the method as numbers, each in the smallest problem that shows it.

#include "mpm/simulation.hpp"

namespace repose::mpm {

/// What a failure is measured with.
struct Discretisation {
  Kernel kernel = Kernel::cubic;
  Transfer transfer = Transfer::relaxed;
  int points_per_cell = 4;
  double cells = 8.0;  ///< across the problem: its length over h
};

/// Cell crossing: a uniformly compressed elastic block that fills a periodic strip moves through
/// two cells at a tenth of its wave speed; the largest root mean square of (p − p_0)/p_0 on the
/// way. 0 is exact.
double cell_crossing_error(const Discretisation& d);

/// Numerical fracture: an elastic block too soft to matter is drawn out by its own motion, x = (1 +
/// εt)X. The stretch at which the points' densities are first off by a tenth (root mean square,
/// without the outermost ones): beyond it they do not see each other. At most 8.
double fracture_stretch(const Discretisation& d);

/// Locking: an elastic block (ν given) on a rough floor bulges under its weight; the farthest that
/// its side ever gets in the first swing, over its half width. To be compared with fine cells.
double bulge(const Discretisation& d, double nu);

/// Ringing: the pressure of a scene's deposit at its end.
RestPressure rest_pressure_after(const Scene& scene);

}  // namespace repose::mpm

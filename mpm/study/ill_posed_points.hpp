#pragma once
/// \file
/// Which points of a flow are where the incompressible equations of its law are ill-posed
/// (models/ill_posedness.hpp).

#include "mpm/step/simulation.hpp"

namespace repose::mpm {

/// C of every point, in the snapshot's order; NaN where there is none: no pressure, no motion, a
/// law without a flow curve, or a point that does not flow (its shear stress is less than 0.99 of
/// what steady shear at its rate would need: elastic, or at rest).
std::vector<double> ill_posedness(const Scene& scene, const Simulation::Snapshot& points);

/// Shares of the mass.
struct IllPosedShare {
  double flowing;    ///< has a C
  double ill_posed;  ///< has a C > 0
};
IllPosedShare ill_posed_share(const Simulation::Snapshot& points, std::span<const double> C);

}  // namespace repose::mpm

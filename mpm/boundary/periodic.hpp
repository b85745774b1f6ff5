#pragma once
/// \file
/// Periodic edges in x: what leaves on the right comes in on the left.
///
/// Points keep the place that their last sorting gave them, up to one cell beyond an edge, and the
/// next sorting brings them back into the box. Nodes i and i + n_x, i = −2 … 2, are one node in two
/// places: all that points put on either is added up, m = Σm, m v = Σm v.

#include "mpm/grid/grid.hpp"
#include "mpm/grid/points.hpp"

namespace repose::mpm {

/// Kinetic energy of nodes before and after forces, ΔtΣ(f + mg)·u [J/m], as the energy ledger
/// counts it.
struct NodeSums {
  double before = 0.0, after = 0.0, impulse_work = 0.0;
  double extension_work = 0.0;  ///< ½ΔtΣ(f + mg)·(v_k − v), see extended_pic.hpp
};

/// Joins the nodes of the left edge with those of the right one (before any wall is applied).
/// Returns the change of the sums: two halves of a node that move apart hold energy that the whole
/// does not.
NodeSums join_periodic_edges(Grid& grid);

/// Does to the velocities after forces the transposed of what the joining did.
void transpose_periodic_edges(Grid& grid);

/// Brings points back into [0, width) of x. Returns the change of −Σ m g_x x, the work of gravity
/// on what comes in again where it started.
double wrap_points(PointSet& points, double width, double gravity_x);

}  // namespace repose::mpm

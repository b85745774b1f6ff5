#pragma once
/// \file
/// Bodies cut by their surfaces: what of them lies in each cell of a lattice.

#include <vector>

#include "mpm/scene/scene.hpp"

namespace repose::mpm {

/// What lies of a body that is_cut() in the cells of the grid's own lattice of points
/// (point_spacing()), rigid surfaces aside, in the order of x, z and y; cells with less than 1e-12
/// of their own volume are left out.
///
/// In the plane the lengths of upright lines (spans.hpp) are integrated from one to the next of all
/// places where two outlines, or an outline and the lattice, meet or end: of straight lines
/// exactly, of circles to 1e-12. In space meshes and half-spaces are exact
/// (TriangleMesh::add_shares()). Of anything else, 16 × 16 lines in each column of cells stand for
/// it; of a ball or a cylinder that nothing else cuts, the cells that it does not fill are then
/// scaled by one factor, so that their sum is its volume to round-off.
std::vector<Share> shares_of(const Scene& scene, const Body& body);

}  // namespace repose::mpm

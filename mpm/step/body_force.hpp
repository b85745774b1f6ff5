#pragma once
/// \file
/// Body forces of points on the grid, f_i = Σ w m_p b_p.

#include <span>

#include "mpm/grid/grid.hpp"

namespace repose::mpm {

/// Adds the force of the accelerations (ax, ay), one per point of the range, to the tile of its
/// block. `origin` is the index of the tile's first node.
template <class Kernel>
void body_force_to_tile(const PointSet& points, const SlotRange& range, std::span<const double> ax,
                        std::span<const double> ay, double h, std::array<int, 2> origin,
                        Tile& tile);

}  // namespace repose::mpm

#pragma once
/// \file
/// What every loop over blocks shares: threads, and how the tile of a block of points overlaps the
/// blocks of nodes around it.

#include <algorithm>
#include <array>
#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "mpm/grid.hpp"

namespace repose::mpm {

/// Calls f(k) for k in [0, n) on the arena's threads; f must only write what belongs to k.
template <class F>
void for_each_block(tbb::task_arena& arena, std::size_t n, F&& f) {
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n), [&](const auto& part) {
      for (std::size_t k = part.begin(); k != part.end(); ++k) f(k);
    });
  });
}

/// Index of the first node of a block's tile.
inline std::array<int, 2> tile_origin(const PointBlock& pb) {
  return {Grid::first_x(pb.bx) - tile_margin_x, Grid::first_y(pb.by) - tile_margin_y};
}

/// Calls f(node of the block, entry of the tile, columns) for the rows that a tile and a node block
/// share, `columns` (8 or 4) being known to the compiler. dx, dy = tile's block − node block.
template <class F>
void for_each_shared_row(int dx, int dy, F&& f) {
  const int begin = std::max(0, dy * block_ny - tile_margin_y);
  const int end = std::min(block_ny, dy * block_ny + tile_rows - tile_margin_y);
  for (int j = begin; j < end; ++j) {
    const auto node = static_cast<std::size_t>(j * block_nx);
    const auto entry = static_cast<std::size_t>((j + tile_margin_y - dy * block_ny) * tile_stride);
    using Four = std::integral_constant<std::size_t, tile_margin_x>;
    using Eight = std::integral_constant<std::size_t, block_nx>;
    if (dx == 0)
      f(node, entry + tile_margin_x, Eight{});
    else if (dx < 0)
      f(node, entry + tile_margin_x + block_nx, Four{});
    else
      f(node + block_nx - tile_margin_x, entry, Four{});
  }
}

}  // namespace repose::mpm

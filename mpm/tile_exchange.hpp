#pragma once
/// \file
/// How tiles and node blocks exchange their rows, block by block on any number of threads.

#include <algorithm>
#include <type_traits>

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

/// Index of a tile's first node.
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

/// Channels of the tiles around a node block, summed at its nodes.
template <std::size_t channels>
using NodeTotals = std::array<std::array<double, block_nodes>, channels>;

/// Own every node: sums what the tiles around put on it, always in the same order, into sums that
/// lie on cache lines.
template <std::size_t channels>
void add_tiles(const Grid& grid, const NodeBlock& nb,
               const std::array<TileChannel, channels>& channel, NodeTotals<channels>& sum) {
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const std::int32_t source = nb.point_block[static_cast<std::size_t>((dy + 1) * 3 + dx + 1)];
      if (source < 0) continue;
      const Tile& tile = grid.tiles[static_cast<std::size_t>(source)];
      for_each_shared_row(dx, dy, [&](std::size_t node, std::size_t entry, auto columns) {
        for (std::size_t c = 0; c < channels; ++c) {
          const double* from = tile[channel[c]].data() + entry;
          double* to = sum[c].data() + node;
          for (std::size_t i = 0; i < columns; i += Row::size)
            (Row::load_aligned(to + i) + Row::load_aligned(from + i)).store_aligned(to + i);
        }
      });
    }
}

/// Fills a tile's field from the node blocks around; from(node block) is where that block's nodes
/// have it.
template <class From>
void fill_tile(const PointBlock& pb, std::array<double, tile_nodes>& field, From&& from) {
  field.fill(0.0);
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const std::int32_t source = pb.node_block[static_cast<std::size_t>((dy + 1) * 3 + dx + 1)];
      if (source < 0) continue;
      const double* nodes = from(static_cast<std::size_t>(source));
      // seen from the node block, this tile's block lies at (−dx, −dy)
      for_each_shared_row(-dx, -dy, [&](std::size_t node, std::size_t entry, auto columns) {
        for (std::size_t i = 0; i < columns; i += Row::size)
          Row::load_aligned(nodes + node + i).store_aligned(field.data() + entry + i);
      });
    }
}

}  // namespace repose::mpm

#pragma once
/// \file
/// How tiles and node blocks exchange their rows.

#include "mpm/block_loops.hpp"

namespace repose::mpm {

/// Channels of the tiles around a node block, summed at its nodes.
template <std::size_t channels>
using NodeTotals = std::array<std::array<double, block_nodes>, channels>;

/// Own every node: sums what the tiles around put on it, always in the same order, into sums that
/// lie on cache lines. Only the first `count` channels, the others stay as they are, and only of
/// the blocks of points that are wanted.
template <std::size_t channels, class Wanted>
void add_tiles(const Grid& grid, const NodeBlock& nb,
               const std::array<TileChannel, channels>& channel, NodeTotals<channels>& sum,
               std::size_t count, Wanted&& wanted) {
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const std::int32_t source = nb.point_block[static_cast<std::size_t>((dy + 1) * 3 + dx + 1)];
      if (source < 0 || !wanted(grid.point_blocks[static_cast<std::size_t>(source)])) continue;
      const Tile& tile = grid.tiles[static_cast<std::size_t>(source)];
      for_each_shared_row(dx, dy, [&](std::size_t node, std::size_t entry, auto columns) {
        for (std::size_t c = 0; c < count; ++c) {
          const double* from = tile[channel[c]].data() + entry;
          double* to = sum[c].data() + node;
          for (std::size_t i = 0; i < columns; i += Row::size)
            (Row::load_aligned(to + i) + Row::load_aligned(from + i)).store_aligned(to + i);
        }
      });
    }
}

template <std::size_t channels>
void add_tiles(const Grid& grid, const NodeBlock& nb,
               const std::array<TileChannel, channels>& channel, NodeTotals<channels>& sum,
               std::size_t count = channels) {
  add_tiles<channels>(grid, nb, channel, sum, count, [](const PointBlock&) { return true; });
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

#pragma once
/// \file
/// How tiles and node blocks exchange their rows.

#include "mpm/block_loops.hpp"

namespace repose::mpm {

/// Channels of the tiles around a node block, summed at its nodes.
template <std::size_t channels>
using NodeTotals = std::array<std::array<double, block_nodes>, channels>;

/// Rows of nodes that may be absent: then there is one row of zeros in place of all.
struct RowsOrZeros {
  const double* first;
  std::size_t stride;

  static RowsOrZeros zeros() {
    alignas(64) static constexpr std::array<double, tile_stride> nothing{};
    return {nothing.data(), 0};
  }
  Row at(std::size_t row, std::size_t column) const {
    return Row::load_aligned(first + row * stride + column);
  }
};

/// Calls f(integral_constant<dy>, first node row, first tile row, number of rows) for the three
/// strips of rows that a tile shares with the node blocks below, beside and above it: dy = node
/// block − tile's block.
template <class F>
[[gnu::always_inline]] inline void for_each_strip(F&& f) {
  constexpr int below = tile_margin_y, above = tile_rows - tile_margin_y - block_ny;
  f(std::integral_constant<int, -1>{}, block_ny - below, 0, below);
  f(std::integral_constant<int, 0>{}, 0, below, block_ny);
  f(std::integral_constant<int, 1>{}, 0, below + block_ny, above);
}

/// Own every node: sums what the tiles around put on it, always in the same order, into sums that
/// lie on cache lines. Only the first `count` channels, the others stay as they are, and only of
/// the blocks of points that are wanted.
template <std::size_t channels, class Wanted>
void add_tiles(const Grid& grid, const NodeBlock& nb,
               const std::array<TileChannel, channels>& channel, NodeTotals<channels>& sum,
               std::size_t count, Wanted&& wanted) {
  static_assert(tile_margin_x == Row::size && block_nx == 2 * Row::size);
  std::array<const Tile*, 9> around{};
  for (std::size_t k = 0; k < 9; ++k) {
    const std::int32_t source = nb.point_block[k];
    if (source >= 0 && wanted(grid.point_blocks[static_cast<std::size_t>(source)]))
      around[k] = &grid.tiles[static_cast<std::size_t>(source)];
  }
  for (std::size_t c = 0; c < count; ++c) {
    double* const total = sum[c].data();
    std::fill_n(total, block_nodes, 0.0);
    for_each_strip([&](auto node_from_tile, int node_row, int tile_row, int rows) {
      // seen from the node block, the tile lies on the other side
      const auto rows_of = [&](int dx) {
        const Tile* tile = around[static_cast<std::size_t>((1 - node_from_tile) * 3 + dx + 1)];
        return tile != nullptr ? RowsOrZeros{(*tile)[channel[c]].data(), tile_stride}
                               : RowsOrZeros::zeros();
      };
      const RowsOrZeros left = rows_of(-1), own = rows_of(0), right = rows_of(1);
      for (int j = 0; j < rows; ++j) {
        double* const to = total + (node_row + j) * block_nx;
        const auto r = static_cast<std::size_t>(tile_row + j);
        const Row low =
            Row::load_aligned(to) + left.at(r, tile_margin_x + block_nx) + own.at(r, tile_margin_x);
        const Row high = Row::load_aligned(to + Row::size) + own.at(r, tile_margin_x + Row::size) +
                         right.at(r, 0);
        low.store_aligned(to);
        high.store_aligned(to + Row::size);
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
  for_each_strip([&](auto dy, int node_row, int tile_row, int rows) {
    const auto rows_of = [&](int dx) {
      const std::int32_t source = pb.node_block[static_cast<std::size_t>((dy + 1) * 3 + dx + 1)];
      return source >= 0 ? RowsOrZeros{from(static_cast<std::size_t>(source)), block_nx}
                         : RowsOrZeros::zeros();
    };
    const RowsOrZeros left = rows_of(-1), own = rows_of(0), right = rows_of(1);
    for (int j = 0; j < rows; ++j) {
      double* const to = field.data() + (tile_row + j) * tile_stride;
      const auto r = static_cast<std::size_t>(node_row + j);
      left.at(r, block_nx - tile_margin_x).store_aligned(to);
      own.at(r, 0).store_aligned(to + tile_margin_x);
      own.at(r, Row::size).store_aligned(to + tile_margin_x + Row::size);
      right.at(r, 0).store_aligned(to + tile_margin_x + block_nx);
    }
  });
}

}  // namespace repose::mpm

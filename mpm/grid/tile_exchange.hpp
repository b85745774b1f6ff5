#pragma once
/// \file
/// How tiles and node blocks exchange their rows.

#include "mpm/grid/block_loops.hpp"
#include "mpm/grid/lanes.hpp"

namespace repose::mpm {

/// Channels of the tiles around a node block, summed at its nodes.
template <std::size_t channels, int dim = 2>
using NodeTotals = std::array<std::array<double, Shape<dim>::nodes>, channels>;

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

/// Calls f(d, first node, first in the tile, how many) along an axis for what a tile shares with
/// the node blocks before, beside and after it: d = node block − tile's block.
template <int dim, class F>
[[gnu::always_inline]] inline void for_each_strip_along(std::size_t axis, F&& f) {
  using S = Shape<dim>;
  const int before = S::margin[axis], beside = S::cells[axis];
  f(-1, beside - before, 0, before);
  f(0, 0, before, beside);
  f(1, 0, before + beside, S::tile[axis] - before - beside);
}

/// Calls f(k, first node row, first tile row, number of rows) for the strips of rows that a tile
/// shares with the node blocks around it; the k-th of these (Shape::neighbour) lies beside it in x.
template <int dim, class F>
[[gnu::always_inline]] inline void for_each_strip(F&& f) {
  if constexpr (dim == 2) {
    for_each_strip_along<2>(
        1, [&](int dy, int node, int tile, int rows) __attribute__((always_inline)) {
          f(static_cast<std::size_t>((dy + 1) * 3 + 1), node, tile, rows);
        });
  } else {
    for_each_strip_along<3>(2, [&](int dz, int node_plane, int tile_plane, int planes) {
      for (int k = 0; k < planes; ++k)
        for_each_strip_along<3>(1, [&](int dy, int node, int tile, int rows) {
          f(static_cast<std::size_t>((dz + 1) * 9 + (dy + 1) * 3 + 1),
            (node_plane + k) * Shape<3>::cells[1] + node,
            (tile_plane + k) * Shape<3>::tile[1] + tile, rows);
        });
    });
  }
}

/// Own every node: sums what the tiles around put on it, always in the same order, into sums that
/// lie on cache lines. Only the first `count` channels, the others stay as they are, and only of
/// the blocks of points that are wanted.
template <std::size_t channels, int dim, class Wanted>
void add_tiles(const GridOf<dim>& grid, const NodeBlockOf<dim>& nb,
               const std::array<std::size_t, channels>& channel, NodeTotals<channels, dim>& sum,
               std::size_t count, Wanted&& wanted) {
  using S = Shape<dim>;
  static_assert(S::margin[0] == Row::size && S::cells[0] == 2 * Row::size);
  std::array<const TileOf<dim>*, S::around> around{};
  for (std::size_t k = 0; k < S::around; ++k) {
    const std::int32_t source = nb.point_block[k];
    if (source >= 0 && wanted(grid.point_blocks[static_cast<std::size_t>(source)]))
      around[k] = &grid.tiles[static_cast<std::size_t>(source)];
  }
  for (std::size_t c = 0; c < count; ++c) {
    double* const total = sum[c].data();
    std::fill_n(total, S::nodes, 0.0);
    for_each_strip<dim>([&](std::size_t k, int node_row, int tile_row, int rows) {
      // seen from the node block, the tile lies on the other side
      const auto rows_of = [&](std::size_t tile_at) {
        const TileOf<dim>* tile = around[tile_at];
        return tile != nullptr ? RowsOrZeros{(*tile)[channel[c]].data(), S::tile[0]}
                               : RowsOrZeros::zeros();
      };
      const std::size_t beside = S::around - 1 - k;
      const RowsOrZeros left = rows_of(beside - 1), own = rows_of(beside),
                        right = rows_of(beside + 1);
      for (int j = 0; j < rows; ++j) {
        double* const to = total + (node_row + j) * S::cells[0];
        const auto r = static_cast<std::size_t>(tile_row + j);
        const Row low = Row::load_aligned(to) + left.at(r, S::margin[0] + S::cells[0]) +
                        own.at(r, S::margin[0]);
        const Row high = Row::load_aligned(to + Row::size) + own.at(r, S::margin[0] + Row::size) +
                         right.at(r, 0);
        low.store_aligned(to);
        high.store_aligned(to + Row::size);
      }
    });
  }
}

template <std::size_t channels, int dim>
void add_tiles(const GridOf<dim>& grid, const NodeBlockOf<dim>& nb,
               const std::array<std::size_t, channels>& channel, NodeTotals<channels, dim>& sum,
               std::size_t count = channels) {
  add_tiles<channels>(grid, nb, channel, sum, count, [](const PointBlockOf<dim>&) { return true; });
}

/// Fills a tile's field from the node blocks around; from(node block) is where that block's nodes
/// have it.
template <int dim, class From>
void fill_tile(const PointBlockOf<dim>& pb, TileField<dim>& field, From&& from) {
  using S = Shape<dim>;
  for_each_strip<dim>([&](std::size_t k, int node_row, int tile_row, int rows) {
    const auto rows_of = [&](std::size_t block) {
      const std::int32_t source = pb.node_block[block];
      return source >= 0 ? RowsOrZeros{from(static_cast<std::size_t>(source)), S::cells[0]}
                         : RowsOrZeros::zeros();
    };
    const RowsOrZeros left = rows_of(k - 1), own = rows_of(k), right = rows_of(k + 1);
    for (int j = 0; j < rows; ++j) {
      double* const to = field.data() + (tile_row + j) * S::tile[0];
      const auto r = static_cast<std::size_t>(node_row + j);
      left.at(r, S::cells[0] - S::margin[0]).store_aligned(to);
      own.at(r, 0).store_aligned(to + S::margin[0]);
      own.at(r, Row::size).store_aligned(to + S::margin[0] + Row::size);
      right.at(r, 0).store_aligned(to + S::margin[0] + S::cells[0]);
    }
  });
}

}  // namespace repose::mpm

#pragma once
/// \file
/// How tiles and node blocks exchange their rows.

#include <bitset>

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

/// What a tile shares along an axis with the node block before, beside or after it.
struct Strip {
  int node = 0, tile = 0;  ///< the first in either
  int rows = 0;            ///< none: 0 or less
};
/// d = node block − tile's block, −1, 0 or 1; no more of it than is wanted of the tile.
template <int dim>
Strip strip_along(std::size_t axis, int d, const TileRows& wanted) {
  using S = Shape<dim>;
  const int before = S::margin[axis], beside = S::cells[axis];
  Strip strip{0, before, beside};
  if (d < 0) strip = {beside - before, 0, before};
  if (d > 0) strip = {0, before + beside, S::tile[axis] - before - beside};
  const int skipped = std::max(0, wanted.begin - strip.tile);
  const int rows = std::min(strip.rows, wanted.end - strip.tile) - skipped;
  return {strip.node + skipped, strip.tile + skipped, rows};
}

/// Calls f(k, first node row, first tile row, number of rows) for the strips of rows that a tile
/// shares with the node blocks around it; the k-th of these (Shape::neighbour) lies beside it in x.
/// wanted(k): of the tile, along every axis; what it says of x does not count.
template <int dim, class Wanted, class F>
[[gnu::always_inline]] inline void for_each_strip(Wanted&& wanted, F&& f) {
  if constexpr (dim == 2) {
    for (int dy = -1; dy <= 1; ++dy) {
      const auto k = static_cast<std::size_t>((dy + 1) * 3 + 1);
      const TilePart<2> part = wanted(k);
      const Strip y = strip_along<2>(1, dy, part[1]);
      if (y.rows > 0) f(k, y.node, y.tile, y.rows);
    }
  } else {
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy) {
        const auto k = static_cast<std::size_t>((dz + 1) * 9 + (dy + 1) * 3 + 1);
        const TilePart<3> part = wanted(k);
        const Strip z = strip_along<3>(2, dz, part[2]), y = strip_along<3>(1, dy, part[1]);
        if (y.rows <= 0) continue;
        for (int plane = 0; plane < z.rows; ++plane)
          f(k, (z.node + plane) * Shape<3>::cells[1] + y.node,
            (z.tile + plane) * Shape<3>::tile[1] + y.tile, y.rows);
      }
  }
}

/// f(rows), as a constant where a strip is whole in y, for the loop over its rows to be unrolled.
template <int dim, class F>
[[gnu::always_inline]] inline void with_rows(int rows, F&& f) {
  using S = Shape<dim>;
  constexpr int before = S::margin[1], beside = S::cells[1], after = S::tile[1] - before - beside;
  if (rows == beside)
    f(std::integral_constant<int, beside>{});
  else if (rows == before)
    f(std::integral_constant<int, before>{});
  else if (rows == after)
    f(std::integral_constant<int, after>{});
  else
    f(rows);
}

/// Sets to zero what of a tile's field the points of its block touch, in whole rows.
template <int dim>
void clear_touched(const PointBlockOf<dim>& pb, TileField<dim>& field) {
  using S = Shape<dim>;
  const TileRows planes = dim == 2 ? TileRows{0, 1} : pb.touched[dim - 1], rows = pb.touched[1];
  for (int plane = planes.begin; plane < planes.end; ++plane)
    std::fill_n(field.data() + (plane * S::tile[1] + rows.begin) * S::tile[0],
                (rows.end - rows.begin) * S::tile[0], 0.0);
}

/// Which nodes of a block may be touched by points before they are sorted again.
template <int dim>
std::bitset<Shape<dim>::nodes> touched_nodes(const GridOf<dim>& grid, const NodeBlockOf<dim>& nb) {
  using S = Shape<dim>;
  std::bitset<S::nodes> touched;
  for (std::size_t k = 0; k < S::around; ++k) {
    if (nb.point_block[k] < 0) continue;
    const auto& part = grid.point_blocks[static_cast<std::size_t>(nb.point_block[k])].touched;
    // block of nodes − block of points, seen from the points
    const std::array<int, S::axes> offset = S::neighbour(S::around - 1 - k);
    for (int n = 0; n < S::nodes; ++n) {
      bool inside = true;
      int rest = n;
      for (std::size_t a = 0; a < S::axes; ++a) {
        const int in_tile = S::margin[a] + offset[a] * S::cells[a] + rest % S::cells[a];
        rest /= S::cells[a];
        inside = inside && in_tile >= part[a].begin && in_tile < part[a].end;
      }
      if (inside) touched.set(static_cast<std::size_t>(n));
    }
  }
  return touched;
}

/// Own every node: sums what the tiles around put on it, always in the same order, into sums that
/// lie on cache lines. Only the first `count` channels, the others stay as they are.
template <std::size_t channels, int dim>
void add_tiles(const GridOf<dim>& grid, const NodeBlockOf<dim>& nb,
               const std::array<std::size_t, channels>& channel, NodeTotals<channels, dim>& sum,
               std::size_t count = channels) {
  using S = Shape<dim>;
  static_assert(S::margin[0] == Row::size && S::cells[0] == 2 * Row::size);
  std::array<const TileOf<dim>*, S::around> around{};
  std::array<const TilePart<dim>*, S::around> touched{};
  for (std::size_t k = 0; k < S::around; ++k) {
    const std::int32_t source = nb.point_block[k];
    if (source < 0) continue;
    around[k] = &grid.tiles[static_cast<std::size_t>(source)];
    touched[k] = &grid.point_blocks[static_cast<std::size_t>(source)].touched;
  }
  // seen from the node block, the tile lies on the other side
  const auto beside = [](std::size_t k) { return S::around - 1 - k; };
  /// What the three tiles side by side touch together.
  const auto part_of = [&](std::size_t k) {
    TilePart<dim> part;
    for (std::size_t a = 0; a < part.size(); ++a) part[a] = {S::tile[a], 0};
    for (const std::size_t tile : {beside(k) - 1, beside(k), beside(k) + 1})
      for (std::size_t a = 0; touched[tile] != nullptr && a < part.size(); ++a) {
        part[a].begin = std::min(part[a].begin, (*touched[tile])[a].begin);
        part[a].end = std::max(part[a].end, (*touched[tile])[a].end);
      }
    return part;
  };
  struct Rows {
    std::size_t tile;
    int node_row, tile_row, count;
  };
  // as many as there are planes of a tile, each with the blocks before, beside and after it in y
  std::array<Rows, (dim == 2 ? 1 : S::tile[dim - 1]) * 3> strips;
  std::size_t strip_count = 0;
  for_each_strip<dim>(part_of, [&](std::size_t k, int node_row, int tile_row, int rows) {
    strips[strip_count++] = {beside(k), node_row, tile_row, rows};
  });
  for (std::size_t c = 0; c < count; ++c) {
    double* const total = sum[c].data();
    std::fill_n(total, S::nodes, 0.0);
    for (std::size_t s = 0; s < strip_count; ++s) {
      const Rows& strip = strips[s];
      const auto rows_of = [&](std::size_t tile_at) {
        const TileOf<dim>* tile = around[tile_at];
        return tile != nullptr ? RowsOrZeros{(*tile)[channel[c]].data(), S::tile[0]}
                               : RowsOrZeros::zeros();
      };
      const RowsOrZeros left = rows_of(strip.tile - 1), own = rows_of(strip.tile),
                        right = rows_of(strip.tile + 1);
      with_rows<dim>(
          strip.count, [&](auto row_count) __attribute__((always_inline)) {
            for (int j = 0; j < row_count; ++j) {
              double* const to = total + (strip.node_row + j) * S::cells[0];
              const auto r = static_cast<std::size_t>(strip.tile_row + j);
              const Row low = Row::load_aligned(to) + left.at(r, S::margin[0] + S::cells[0]) +
                              own.at(r, S::margin[0]);
              const Row high = Row::load_aligned(to + Row::size) +
                               own.at(r, S::margin[0] + Row::size) + right.at(r, 0);
              low.store_aligned(to);
              high.store_aligned(to + Row::size);
            }
          });
    }
  }
}

/// Fills the rows of a tile's field that the points of its block touch from the node blocks around;
/// from(node block) is where that block's nodes have it.
template <int dim, class From>
void fill_tile(const PointBlockOf<dim>& pb, TileField<dim>& field, From&& from) {
  using S = Shape<dim>;
  const auto touched = [&](std::size_t) { return pb.touched; };
  for_each_strip<dim>(touched, [&](std::size_t k, int node_row, int tile_row, int rows) {
    const auto rows_of = [&](std::size_t block) {
      const std::int32_t source = pb.node_block[block];
      return source >= 0 ? RowsOrZeros{from(static_cast<std::size_t>(source)), S::cells[0]}
                         : RowsOrZeros::zeros();
    };
    const RowsOrZeros left = rows_of(k - 1), own = rows_of(k), right = rows_of(k + 1);
    with_rows<dim>(
        rows, [&](auto row_count) __attribute__((always_inline)) {
          for (int j = 0; j < row_count; ++j) {
            double* const to = field.data() + (tile_row + j) * S::tile[0];
            const auto r = static_cast<std::size_t>(node_row + j);
            left.at(r, S::cells[0] - S::margin[0]).store_aligned(to);
            own.at(r, 0).store_aligned(to + S::margin[0]);
            own.at(r, Row::size).store_aligned(to + S::margin[0] + Row::size);
            right.at(r, 0).store_aligned(to + S::margin[0] + S::cells[0]);
          }
        });
  });
}

}  // namespace repose::mpm

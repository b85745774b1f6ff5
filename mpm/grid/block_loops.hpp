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

#include "mpm/grid/grid.hpp"

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
template <int dim>
std::array<int, Shape<dim>::axes> tile_origin(const PointBlockOf<dim>& pb) {
  std::array<int, Shape<dim>::axes> origin{};
  for (std::size_t a = 0; a < origin.size(); ++a)
    origin[a] = GridOf<dim>::first(a, pb.at[a]) - Shape<dim>::margin[a];
  return origin;
}

/// Calls f(node of the block, entry of the tile, columns) for the rows that a tile and a node block
/// share, `columns` (8 or 4) being known to the compiler. offset = tile's block − node block.
template <int dim, class F>
void for_each_shared_row(const std::array<int, Shape<dim>::axes>& offset, F&& f) {
  using S = Shape<dim>;
  /// Calls g(index in the block, index in the tile) for the nodes that the two share along an axis.
  const auto along = [&](std::size_t axis, auto&& g) {
    const int shift = S::margin[axis] - offset[axis] * S::cells[axis];
    const int begin = std::max(0, -shift);
    const int end = std::min(S::cells[axis], S::tile[axis] - shift);
    for (int j = begin; j < end; ++j) g(j, j + shift);
  };
  const auto row = [&](int j, int tile_j) {
    const auto node = static_cast<std::size_t>(j * S::cells[0]);
    const auto entry = static_cast<std::size_t>(tile_j * S::tile[0]);
    using Four = std::integral_constant<std::size_t, S::margin[0]>;
    using Eight = std::integral_constant<std::size_t, S::cells[0]>;
    if (offset[0] == 0)
      f(node, entry + Four{}, Eight{});
    else if (offset[0] < 0)
      f(node, entry + Four{} + Eight{}, Four{});
    else
      f(node + Eight{} - Four{}, entry, Four{});
  };
  if constexpr (dim == 2)
    along(1, row);
  else
    along(2, [&](int k, int tile_k) {
      along(1, [&](int j, int tile_j) { row(k * S::cells[1] + j, tile_k * S::tile[1] + tile_j); });
    });
}

}  // namespace repose::mpm

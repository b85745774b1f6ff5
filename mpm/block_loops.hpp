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
  return {Grid::first_x(pb.bx) - tile_margin, Grid::first_y(pb.by) - tile_margin};
}

/// The part of a tile that overlaps a node block in one direction: nodes [begin, end) of the block,
/// node n being tile entry n + shift. `offset` = tile's block − node block, −1, 0 or 1.
struct Overlap {
  int begin, end, shift;
  Overlap(int offset, int block_size)
      : begin(std::max(0, offset * block_size - tile_margin)),
        end(std::min(block_size, offset * block_size + block_size + 5 - tile_margin)),
        shift(tile_margin - offset * block_size) {}
};

}  // namespace repose::mpm

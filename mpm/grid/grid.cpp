#include "mpm/grid/grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "models/scalar.hpp"

namespace repose::mpm {

template <int dim>
GridOf<dim>::GridOf(double h, const Index& cells) : h_(h),
                                                    cells_(cells) {
  std::size_t count = 1;
  for (std::size_t a = 0; a < cells.size(); ++a) {
    blocks_[a] = (cells[a] + 2) / Shape<dim>::cells[a] + 3;
    count *= static_cast<std::size_t>(blocks_[a]);
  }
  point_table_.assign(count, -1);
  node_table_.assign(count, -1);
}

template <int dim>
std::size_t GridOf<dim>::table_index(const Index& block) const {
  std::size_t index = 0;
  for (std::size_t a = block.size(); a-- > 0;)
    index = index * static_cast<std::size_t>(blocks_[a]) + static_cast<std::size_t>(block[a]);
  return index;
}

template <int dim>
typename GridOf<dim>::Index GridOf<dim>::block_at(std::size_t table_index) const {
  Index block{};
  for (std::size_t a = 0; a < block.size(); ++a) {
    const auto n = static_cast<std::size_t>(blocks_[a]);
    block[a] = static_cast<int>(table_index % n);
    table_index /= n;
  }
  return block;
}

template <int dim>
int GridOf<dim>::place_in(const Index& block, const Index& index) {
  int place = 0;
  for (std::size_t a = block.size(); a-- > 0;)
    place = place * Shape<dim>::cells[a] + index[a] - first(a, block[a]);
  return place;
}

template <int dim>
bool GridOf<dim>::inside(const Index& block) const {
  for (std::size_t a = 0; a < block.size(); ++a)
    if (block[a] < 0 || block[a] >= blocks_[a]) return false;
  return true;
}

/// Widens what a block's points touch by what one with this anchor does: one of the four nodes of a
/// stencil, the second, after a cell of drift.
template <int dim>
void include_anchor(TilePart<dim>& touched, std::size_t place) {
  for (std::size_t a = 0; a < touched.size(); ++a) {
    const auto anchors = static_cast<std::size_t>(Shape<dim>::cells[a] + 1);
    const int at = Shape<dim>::margin[a] + static_cast<int>(place % anchors);
    place /= anchors;
    touched[a].begin = std::min(touched[a].begin, at - 2);
    touched[a].end = std::max(touched[a].end, std::min(at + 4, Shape<dim>::tile[a]));
  }
}

template <int dim>
void GridOf<dim>::sort(std::vector<PointsOf<dim>>& bodies, double anchor_offset) {
  // the anchors of a block's points: its own nodes and, with an offset, the first ones behind it
  constexpr auto anchors = [] {
    std::size_t all = 1;
    for (const int cells : Shape<dim>::cells) all *= static_cast<std::size_t>(cells + 1);
    return all;
  }();
  const double inv_h = 1.0 / h_;
  // key of a point: block, then anchor within the block
  std::vector<std::vector<std::uint64_t>> keys(bodies.size());
  std::vector<std::size_t> per_block(point_table_.size(), 0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const PointsOf<dim>& points = bodies[b];
    keys[b].assign(points.slots(), 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.slots(), 4096), [&](const auto& r) {
      for (std::size_t k = r.begin(); k != r.end(); ++k) {
        if (points.id[k] < 0) continue;
        Index at{};
        std::size_t place = 0;
        for (std::size_t a = at.size(); a-- > 0;) {
          const double xi = points[Layout<dim>::x + a][k] * inv_h;
          at[a] = block_of_cell(a, static_cast<int>(std::floor(xi)));
          const int anchor = static_cast<int>(std::floor(xi + anchor_offset)) - first(a, at[a]);
          place = place * static_cast<std::size_t>(Shape<dim>::cells[a] + 1) +
                  static_cast<std::size_t>(anchor);
        }
        keys[b][k] = table_index(at) * anchors + place;
      }
    });
    for (std::size_t k = 0; k < points.slots(); ++k)
      if (points.id[k] >= 0) ++per_block[keys[b][k] / anchors];
  }

  point_blocks.clear();
  for (std::size_t block = 0; block < per_block.size(); ++block) {
    point_table_[block] = -1;
    if (per_block[block] == 0) continue;
    point_table_[block] = static_cast<std::int32_t>(point_blocks.size());
    PointBlockOf<dim>& fresh = point_blocks.emplace_back();
    fresh.at = block_at(block);
    fresh.range.resize(bodies.size());
    for (std::size_t a = 0; a < fresh.touched.size(); ++a)
      fresh.touched[a] = {Shape<dim>::tile[a], 0};
  }

  const auto anchor_slot = [&](std::uint64_t key) {
    return static_cast<std::size_t>(point_table_[key / anchors]) * anchors + key % anchors;
  };
  std::vector<std::size_t> start(point_blocks.size() * anchors);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    PointsOf<dim>& points = bodies[b];
    // counting sort with the ranges of the blocks rounded up to whole packs
    std::fill(start.begin(), start.end(), 0);
    for (std::size_t k = 0; k < points.slots(); ++k)
      if (points.id[k] >= 0) ++start[anchor_slot(keys[b][k])];
    std::size_t next = 0;
    for (std::size_t block = 0; block < point_blocks.size(); ++block) {
      const std::size_t first_key = block * anchors;
      SlotRange& range = point_blocks[block].range[b];
      range.begin = next;
      for (std::size_t key = first_key; key < first_key + anchors; ++key) {
        const std::size_t there = start[key];
        start[key] = next;
        next += there;
        if (there > 0) include_anchor<dim>(point_blocks[block].touched, key - first_key);
      }
      range.count = next - range.begin;
      next = range.begin + padded(range.count);
    }
    std::vector<std::uint32_t> order(next, 0);
    std::vector<bool> is_padding(next, true);
    for (std::size_t k = 0; k < points.slots(); ++k) {
      if (points.id[k] < 0) continue;
      const std::size_t slot = start[anchor_slot(keys[b][k])]++;
      order[slot] = static_cast<std::uint32_t>(k);
      is_padding[slot] = false;
    }
    for (const PointBlockOf<dim>& pb : point_blocks) {
      const SlotRange& range = pb.range[b];
      for (std::size_t k = range.count; k < padded(range.count); ++k)
        order[range.begin + k] = order[range.begin + range.count - 1];
    }
    rearrange(points, order, is_padding);
  }
  connect();
}

template <int dim>
void GridOf<dim>::restore(std::vector<PointBlockOf<dim>> blocks) {
  point_blocks = std::move(blocks);
  std::fill(point_table_.begin(), point_table_.end(), -1);
  for (std::size_t k = 0; k < point_blocks.size(); ++k)
    point_table_.at(table_index(point_blocks[k].at)) = static_cast<std::int32_t>(k);
  connect();
}

template <int dim>
void GridOf<dim>::connect() {
  std::fill(node_table_.begin(), node_table_.end(), -1);
  node_blocks.clear();
  /// f(which of the blocks around, its place in the tables) for those that a block's points touch.
  const auto each_touched = [&](const PointBlockOf<dim>& pb, auto&& f) {
    for (std::size_t k = 0; k < Shape<dim>::around; ++k) {
      const Index offset = Shape<dim>::neighbour(k);
      if (!pb.touches(offset)) continue;
      Index near = pb.at;
      for (std::size_t a = 0; a < near.size(); ++a) near[a] += offset[a];
      if (inside(near)) f(k, table_index(near));
    }
  };
  std::vector<char> live(node_table_.size(), 0);
  for (const PointBlockOf<dim>& pb : point_blocks)
    each_touched(pb, [&](std::size_t, std::size_t block) { live[block] = 1; });
  for (std::size_t block = 0; block < live.size(); ++block) {
    if (!live[block]) continue;
    node_table_[block] = static_cast<std::int32_t>(node_blocks.size());
    NodeBlockOf<dim>& fresh = node_blocks.emplace_back();
    fresh.at = block_at(block);
    fresh.point_block.fill(-1);
  }
  for (std::size_t p = 0; p < point_blocks.size(); ++p) {
    PointBlockOf<dim>& pb = point_blocks[p];
    pb.node_block.fill(-1);
    each_touched(pb, [&](std::size_t k, std::size_t block) {
      pb.node_block[k] = node_table_[block];
      node_blocks[static_cast<std::size_t>(node_table_[block])]
          .point_block[Shape<dim>::around - 1 - k] = static_cast<std::int32_t>(p);
    });
  }
  // nothing of them is kept: no room for old and new at once
  if (tiles.capacity() < point_blocks.size()) tiles = {};
  tiles.resize(point_blocks.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tiles.size()), [&](const auto& r) {
    for (std::size_t k = r.begin(); k != r.end(); ++k)
      for (TileField<dim>& channel : tiles[k]) channel.fill(0.0);
  });
}

template <int dim>
const PointBlockOf<dim>* GridOf<dim>::point_block(const Index& block) const {
  if (!inside(block)) return nullptr;
  const std::int32_t index = point_table_[table_index(block)];
  return index < 0 ? nullptr : &point_blocks[static_cast<std::size_t>(index)];
}

template <int dim>
typename GridOf<dim>::NodeRef GridOf<dim>::node(const Index& index) {
  Index block{};
  for (std::size_t a = 0; a < block.size(); ++a) block[a] = block_of_cell(a, index[a]);
  const std::int32_t found = node_table_[table_index(block)];
  if (found < 0) return {nullptr, 0};
  return {&node_blocks[static_cast<std::size_t>(found)],
          static_cast<std::size_t>(place_in(block, index))};
}

template class GridOf<2>;
template class GridOf<3>;

}  // namespace repose::mpm

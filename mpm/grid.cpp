#include "mpm/grid.hpp"

#include <cmath>
#include <numeric>
#include <utility>

namespace repose::mpm {

Grid::Grid(double h, int nx, int ny)
    : h_(h),
      nx_(nx),
      ny_(ny),
      blocks_x_((nx + 2) / block_nx + 3),
      blocks_y_((ny + 2) / block_ny + 3),
      point_table_(static_cast<std::size_t>(blocks_x_) * static_cast<std::size_t>(blocks_y_), -1),
      node_table_(point_table_.size(), -1) {}

void Grid::sort(std::vector<PointSet>& bodies) {
  const double inv_h = 1.0 / h_;
  // key of a point: block, then cell within the block
  std::vector<std::vector<std::uint32_t>> keys(bodies.size());
  std::vector<std::size_t> per_block(point_table_.size(), 0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const PointSet& points = bodies[b];
    keys[b].assign(points.slots(), 0);
    for (std::size_t k = 0; k < points.slots(); ++k) {
      if (points.id[k] < 0) continue;
      const int cx = static_cast<int>(std::floor(points[X][k] * inv_h));
      const int cy = static_cast<int>(std::floor(points[Y][k] * inv_h));
      const int bx = block_of_cell_x(cx);
      const int by = block_of_cell_y(cy);
      const int in_block = (cy - first_y(by)) * block_nx + (cx - first_x(bx));
      const std::size_t block = table_index(bx, by);
      keys[b][k] =
          static_cast<std::uint32_t>(block) * block_nodes + static_cast<std::uint32_t>(in_block);
      ++per_block[block];
    }
  }

  const std::vector<PointBlock> before = std::exchange(point_blocks, {});
  for (std::size_t block = 0; block < per_block.size(); ++block) {
    point_table_[block] = -1;
    if (per_block[block] == 0) continue;
    point_table_[block] = static_cast<std::int32_t>(point_blocks.size());
    PointBlock& fresh = point_blocks.emplace_back();
    fresh.bx = static_cast<int>(block % static_cast<std::size_t>(blocks_x_));
    fresh.by = static_cast<int>(block / static_cast<std::size_t>(blocks_x_));
    fresh.range.resize(bodies.size());
  }
  for (const PointBlock& old : before) {
    const std::int32_t now = point_table_[table_index(old.bx, old.by)];
    if (now >= 0) point_blocks[static_cast<std::size_t>(now)].rest = old.rest;
  }

  const auto cell_slot = [&](std::uint32_t key) {
    return static_cast<std::size_t>(point_table_[key / block_nodes]) * block_nodes +
           key % block_nodes;
  };
  std::vector<std::size_t> start(point_blocks.size() * block_nodes);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    PointSet& points = bodies[b];
    // counting sort with the ranges of the blocks rounded up to whole packs
    std::fill(start.begin(), start.end(), 0);
    for (std::size_t k = 0; k < points.slots(); ++k)
      if (points.id[k] >= 0) ++start[cell_slot(keys[b][k])];
    std::size_t next = 0;
    for (std::size_t block = 0; block < point_blocks.size(); ++block) {
      const std::size_t first_key = block * block_nodes;
      Range& range = point_blocks[block].range[b];
      range.begin = next;
      for (std::size_t key = first_key; key < first_key + block_nodes; ++key) {
        const std::size_t in_cell = start[key];
        start[key] = next;
        next += in_cell;
      }
      range.count = next - range.begin;
      next = range.begin + padded(range.count);
    }
    std::vector<std::uint32_t> order(next, 0);
    std::vector<bool> is_padding(next, true);
    for (std::size_t k = 0; k < points.slots(); ++k) {
      if (points.id[k] < 0) continue;
      const std::size_t slot = start[cell_slot(keys[b][k])]++;
      order[slot] = static_cast<std::uint32_t>(k);
      is_padding[slot] = false;
    }
    for (const PointBlock& pb : point_blocks) {
      const Range& range = pb.range[b];
      for (std::size_t k = range.count; k < padded(range.count); ++k)
        order[range.begin + k] = order[range.begin + range.count - 1];
    }
    rearrange(points, order, is_padding);
  }
  connect();
}

void Grid::restore(std::vector<PointBlock> blocks) {
  point_blocks = std::move(blocks);
  std::fill(point_table_.begin(), point_table_.end(), -1);
  for (std::size_t k = 0; k < point_blocks.size(); ++k)
    point_table_.at(table_index(point_blocks[k].bx, point_blocks[k].by)) =
        static_cast<std::int32_t>(k);
  connect();
}

void Grid::connect() {
  std::fill(node_table_.begin(), node_table_.end(), -1);
  node_blocks.clear();
  std::vector<char> live(node_table_.size(), 0);
  for (const PointBlock& pb : point_blocks)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (pb.bx + dx >= 0 && pb.bx + dx < blocks_x_ && pb.by + dy >= 0 && pb.by + dy < blocks_y_)
          live[table_index(pb.bx + dx, pb.by + dy)] = 1;
  for (std::size_t block = 0; block < live.size(); ++block) {
    if (!live[block]) continue;
    node_table_[block] = static_cast<std::int32_t>(node_blocks.size());
    NodeBlock& fresh = node_blocks.emplace_back();
    fresh.bx = static_cast<int>(block % static_cast<std::size_t>(blocks_x_));
    fresh.by = static_cast<int>(block / static_cast<std::size_t>(blocks_x_));
  }
  const auto neighbours = [&](int bx, int by, const std::vector<std::int32_t>& table) {
    std::array<std::int32_t, 9> found{};
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const bool inside =
            bx + dx >= 0 && bx + dx < blocks_x_ && by + dy >= 0 && by + dy < blocks_y_;
        found[static_cast<std::size_t>((dy + 1) * 3 + dx + 1)] =
            inside ? table[table_index(bx + dx, by + dy)] : -1;
      }
    return found;
  };
  for (PointBlock& pb : point_blocks) pb.node_block = neighbours(pb.bx, pb.by, node_table_);
  for (NodeBlock& nb : node_blocks) nb.point_block = neighbours(nb.bx, nb.by, point_table_);
  tiles.resize(point_blocks.size());
}

const PointBlock* Grid::point_block(int bx, int by) const {
  if (bx < 0 || bx >= blocks_x_ || by < 0 || by >= blocks_y_) return nullptr;
  const std::int32_t index = point_table_[table_index(bx, by)];
  return index < 0 ? nullptr : &point_blocks[static_cast<std::size_t>(index)];
}

Grid::NodeRef Grid::node(int i, int j) {
  const int bx = block_of_cell_x(i);
  const int by = block_of_cell_y(j);
  const std::int32_t index = node_table_[table_index(bx, by)];
  if (index < 0) return {nullptr, 0};
  const int place = (j - first_y(by)) * block_nx + (i - first_x(bx));
  return {&node_blocks[static_cast<std::size_t>(index)], static_cast<std::size_t>(place)};
}

}  // namespace repose::mpm

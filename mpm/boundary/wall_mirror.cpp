#include "mpm/boundary/wall_mirror.hpp"

namespace repose::mpm {

void WallMirror::connect(Grid& grid, const Walls& walls) {
  pairs_.clear();
  held_.clear();
  add_wall(grid, walls.left, true, 0, 1);
  add_wall(grid, walls.right, true, grid.nx(), -1);
  add_wall(grid, walls.floor, false, 0, 1);
  add_wall(grid, walls.top, false, grid.ny(), -1);
}

void WallMirror::add_wall(Grid& grid, const Wall& wall, bool normal_is_x, int line, int inward) {
  if (wall.kind == Wall::Kind::open) return;
  const bool sticks = wall.kind == Wall::Kind::no_slip;
  const double normal = -1.0;
  const double tangential = sticks ? -1.0 : 1.0;
  const int block = normal_is_x ? grid.block_of_cell_x(line) : grid.block_of_cell_y(line);
  for (const NodeBlock& nb : grid.node_blocks) {
    if (nb.at[normal_is_x ? 0 : 1] != block) continue;
    const int first = normal_is_x ? Grid::first_y(nb.at[1]) : Grid::first_x(nb.at[0]);
    const int count = normal_is_x ? block_ny : block_nx;
    for (int along = first; along < first + count; ++along) {
      const auto at = [&](int offset) {
        return normal_is_x ? grid.node(line + offset, along) : grid.node(along, line + offset);
      };
      const auto place = [&](const Grid::NodeRef& ref) {
        return Place{static_cast<std::size_t>(ref.block - grid.node_blocks.data()), ref.place};
      };
      const Grid::NodeRef ghost = at(-inward), on = at(0), image = at(inward);
      if (on.block != nullptr)
        held_.push_back({place(on), normal_is_x || sticks, !normal_is_x || sticks});
      if (ghost.block != nullptr && image.block != nullptr)
        pairs_.push_back({place(ghost), place(image), normal_is_x ? normal : tangential,
                          normal_is_x ? tangential : normal});
    }
  }
}

void WallMirror::extend(NodeVector& v) const {
  for (const Held& h : held_) {
    if (h.x) *component(v, h.at, false) = 0.0;
    if (h.y) *component(v, h.at, true) = 0.0;
  }
  for (const Pair& pair : pairs_) {  // x first, then y with the corners' ghosts in it
    *component(v, pair.ghost, false) = pair.sign_x * *component(v, pair.image, false);
    *component(v, pair.ghost, true) = pair.sign_y * *component(v, pair.image, true);
  }
}

void WallMirror::fold(NodeVector& f) const {
  for (auto pair = pairs_.rbegin(); pair != pairs_.rend(); ++pair) {
    *component(f, pair->image, false) += pair->sign_x * *component(f, pair->ghost, false);
    *component(f, pair->image, true) += pair->sign_y * *component(f, pair->ghost, true);
  }
  release(f);
}

void WallMirror::fold_diagonal(NodeVector& d) const {
  for (auto pair = pairs_.rbegin(); pair != pairs_.rend(); ++pair) {
    *component(d, pair->image, false) += *component(d, pair->ghost, false);
    *component(d, pair->image, true) += *component(d, pair->ghost, true);
  }
  release(d);
}

void WallMirror::release(NodeVector& f) const {
  for (const Pair& pair : pairs_)
    *component(f, pair.ghost, false) = *component(f, pair.ghost, true) = 0.0;
  for (const Held& h : held_) {
    if (h.x) *component(f, h.at, false) = 0.0;
    if (h.y) *component(f, h.at, true) = 0.0;
  }
}

}  // namespace repose::mpm

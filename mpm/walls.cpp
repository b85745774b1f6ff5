#include "mpm/walls.hpp"

#include <algorithm>
#include <cmath>

namespace repose::mpm {
namespace {

/// Velocity along and across a wall.
struct Pair {
  double n = 0.0, t = 0.0;
  friend Pair operator-(const Pair& x, const Pair& y) { return {x.n - y.n, x.t - y.t}; }
};

/// One node of the triple behind, on and inside a wall, in the wall's own axes.
struct WallNode {
  NodeBlock* block = nullptr;  // null: the node does not exist (nothing near)
  std::size_t place = 0;
  bool normal_is_x = true;
  std::int32_t index = -1;  // of the block

  double m() const { return block ? block->mirrored_mass[place] : 0.0; }
  Pair before_forces() const {
    return read(block ? &block->ux : nullptr, block ? &block->uy : nullptr);
  }
  Pair after_forces() const {
    return read(block ? &block->vx : nullptr, block ? &block->vy : nullptr);
  }
  /// A scalar that points average is even in every wall.
  static void mirror_extra(const WallNode& a, const WallNode& c) {
    const double m = a.m() + c.m();
    if (m == 0.0) return;
    const double even = (a.m() * a.extra() + c.m() * c.extra()) / m;
    if (a.block) a.block->extra[a.place] = even;
    if (c.block) c.block->extra[c.place] = even;
  }
  double real_mass() const { return block ? block->mass[place] : 0.0; }
  void set(double mirrored, const Pair& u, const Pair& v) const {
    if (!block) return;
    block->mirrored_mass[place] = mirrored;
    (normal_is_x ? block->ux : block->uy)[place] = u.n;
    (normal_is_x ? block->uy : block->ux)[place] = u.t;
    (normal_is_x ? block->vx : block->vy)[place] = v.n;
    (normal_is_x ? block->vy : block->vx)[place] = v.t;
  }

 private:
  double extra() const { return block ? block->extra[place] : 0.0; }
  using Nodes = std::array<double, block_nodes>;
  Pair read(const Nodes* x, const Nodes* y) const {
    if (!block) return {};
    return normal_is_x ? Pair{(*x)[place], (*y)[place]} : Pair{(*y)[place], (*x)[place]};
  }
};

WallNode wall_node(Grid& grid, int i, int j, bool normal_is_x) {
  const Grid::NodeRef at = grid.node(i, j);
  const auto index = at.block ? at.block - grid.node_blocks.data() : -1;
  return {at.block, at.place, normal_is_x, static_cast<std::int32_t>(index)};
}

/// The velocities of a triple, and what mirroring makes of them.
struct Triple {
  Pair a, b, c;
  friend Triple operator-(const Triple& x, const Triple& y) {
    return {x.a - y.a, x.b - y.b, x.c - y.c};
  }

  /// Seen from a wall that slides along itself.
  Triple moved(double by) const { return {{a.n, a.t + by}, {b.n, b.t + by}, {c.n, c.t + by}}; }

  /// Normal odd; tangential a mixture of even (stick = 0) and odd (stick = 1).
  Triple mirrored(double m_a, double m_c, double stick) const {
    const double share = m_a + m_c > 0.0 ? 1.0 / (m_a + m_c) : 0.0;
    const double n_c = (m_c * c.n - m_a * a.n) * share;
    const double even = (m_c * c.t + m_a * a.t) * share;
    const double odd = (m_c * c.t - m_a * a.t) * share;
    return {{-n_c, (1.0 - stick) * even - stick * odd},
            {0.0, (1.0 - stick) * b.t},
            {n_c, (1.0 - stick) * even + stick * odd}};
  }
};

/// The share φ of sticking: from the impulses of the wall on the material, that is from its
/// momentum without and with the constraint. Negative: parting, the wall cannot pull.
double coulomb_share(const Triple& v, double m_a, double m_b, double m_c, double friction,
                     double inward) {
  const Triple stuck = v.mirrored(m_a, m_c, 1.0);
  const double J_n = inward * ((m_c - m_a) * stuck.c.n - (m_a * v.a.n + m_b * v.b.n + m_c * v.c.n));
  if (!(J_n > 0.0)) return -1.0;
  const double J_t = std::abs(m_a * v.a.t + m_b * v.b.t + m_c * v.c.t - (m_c - m_a) * stuck.c.t);
  return J_t > friction * J_n ? friction * J_n / J_t : 1.0;
}

/// `inward` is +1 where the inside lies on the positive side of the wall, else −1.
WallEffect apply_to_triple(const Wall& wall, double inward, const WallNode& a, const WallNode& b,
                           const WallNode& c, std::vector<MirroredTriple>* record) {
  const double m_a = a.m();
  const double m_b = b.m();
  const double m_c = c.m();
  if (m_a + m_b + m_c == 0.0) return {};
  WallNode::mirror_extra(a, c);
  const Triple u{a.before_forces(), b.before_forces(), c.before_forces()};
  const Triple v{a.after_forces(), b.after_forces(), c.after_forces()};
  double stick = wall.kind == Wall::Kind::no_slip ? 1.0 : 0.0;
  if (wall.kind == Wall::Kind::friction) {
    stick = coulomb_share(v, m_a, m_b, m_c, wall.friction, inward);
    if (stick < 0.0) return {};
  }
  if (record != nullptr) {
    const auto place = [](const WallNode& n) {
      return MirroredTriple::Node{n.index, static_cast<std::int32_t>(n.place)};
    };
    record->push_back({{place(a), place(b), place(c)}, a.normal_is_x, m_a, m_c, stick});
  }
  const Triple u_new = u.moved(-wall.speed).mirrored(m_a, m_c, stick).moved(wall.speed);
  const Triple v_new = v.moved(-wall.speed).mirrored(m_a, m_c, stick).moved(wall.speed);
  a.set(m_a + m_c, u_new.a, v_new.a);
  b.set(2.0 * m_b, u_new.b, v_new.b);
  c.set(m_a + m_c, u_new.c, v_new.c);
  const std::array<double, 3> m{a.real_mass(), b.real_mass(), c.real_mass()};
  const auto dot = [&](const Triple& x, const Triple& y) {
    return m[0] * (x.a.n * y.a.n + x.a.t * y.a.t) + m[1] * (x.b.n * y.b.n + x.b.t * y.b.t) +
           m[2] * (x.c.n * y.c.n + x.c.t * y.c.t);
  };
  const Triple kick = v - u;  // Δt(f + mg)/m
  const auto along = [&](const Triple& x) { return m[0] * x.a.t + m[1] * x.b.t + m[2] * x.c.t; };
  return {0.5 * (dot(u_new, u_new) - dot(u, u)), 0.5 * (dot(v_new, v_new) - dot(v, v)),
          dot(kick, u_new - u), wall.speed * along(u_new - u), wall.speed * along(v_new - v)};
}

/// A wall along a line of nodes: x = const (normal_is_x) or y = const at node index `line`.
WallEffect apply_wall(Grid& grid, const Wall& wall, bool normal_is_x, int line, int inward,
                      std::vector<MirroredTriple>* record) {
  WallEffect total;
  if (wall.kind == Wall::Kind::open || wall.kind == Wall::Kind::periodic) return total;
  const int block = normal_is_x ? grid.block_of_cell_x(line) : grid.block_of_cell_y(line);
  for (const NodeBlock& nb : grid.node_blocks) {
    if ((normal_is_x ? nb.bx : nb.by) != block) continue;
    const int first = normal_is_x ? Grid::first_y(nb.by) : Grid::first_x(nb.bx);
    const int count = normal_is_x ? block_ny : block_nx;
    for (int along = first; along < first + count; ++along) {
      const auto at = [&](int offset) {
        return normal_is_x ? wall_node(grid, line + offset, along, true)
                           : wall_node(grid, along, line + offset, false);
      };
      const WallEffect here = apply_to_triple(wall, inward, at(-inward), at(0), at(inward), record);
      total += here;
    }
  }
  return total;
}

}  // namespace

WallEffect apply_walls(Grid& grid, const Walls& walls, std::vector<MirroredTriple>* record) {
  if (record != nullptr) record->clear();
  // x first; its mirrored masses make the fields exactly odd or even in x, which a following mirror
  // in y keeps, so that both conditions hold in the corners
  WallEffect total;
  total += apply_wall(grid, walls.left, true, 0, 1, record);
  total += apply_wall(grid, walls.right, true, grid.nx(), -1, record);
  total += apply_wall(grid, walls.floor, false, 0, 1, record);
  total += apply_wall(grid, walls.top, false, grid.ny(), -1, record);
  return total;
}

void mirror(const std::vector<MirroredTriple>& record, NodeVector& velocity) {
  for (const MirroredTriple& at : record) {
    const auto component = [&](std::size_t k, bool x) -> double* {
      if (at.node[k].block < 0) return nullptr;
      NodeField& nodes = velocity[static_cast<std::size_t>(at.node[k].block)];
      return &(x ? nodes.x : nodes.y)[static_cast<std::size_t>(at.node[k].place)];
    };
    const auto read = [&](std::size_t k) {
      const double* n = component(k, at.normal_is_x);
      return n != nullptr ? Pair{*n, *component(k, !at.normal_is_x)} : Pair{};
    };
    const Triple mirrored = Triple{read(0), read(1), read(2)}.mirrored(at.m_a, at.m_c, at.stick);
    const auto write = [&](std::size_t k, const Pair& v) {
      if (at.node[k].block < 0) return;
      *component(k, at.normal_is_x) = v.n;
      *component(k, !at.normal_is_x) = v.t;
    };
    write(0, mirrored.a);
    write(1, mirrored.b);
    write(2, mirrored.c);
  }
}

}  // namespace repose::mpm

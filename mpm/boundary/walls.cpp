#include "mpm/boundary/walls.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/boundary/wall_parts.hpp"

namespace repose::mpm {
namespace {

/// Velocity across a wall and along it.
template <int dim>
struct Parts {
  double n = 0.0;
  std::array<double, dim - 1> t{};
  friend Parts operator-(const Parts& x, const Parts& y) {
    Parts r{x.n - y.n, {}};
    for (std::size_t i = 0; i < r.t.size(); ++i) r.t[i] = x.t[i] - y.t[i];
    return r;
  }
  void add(double factor, const Parts& x) {
    n += factor * x.n;
    for (std::size_t i = 0; i < t.size(); ++i) t[i] += factor * x.t[i];
  }
  friend double dot(const Parts& x, const Parts& y) {
    double sum = x.n * y.n;
    for (std::size_t i = 0; i < x.t.size(); ++i) sum += x.t[i] * y.t[i];
    return sum;
  }
};

/// The i-th of the axes that lie in a wall across `normal`.
constexpr std::size_t along(std::size_t normal, std::size_t i) { return i < normal ? i : i + 1; }

/// One node of the triple behind, on and inside a wall, in the wall's own axes.
template <int dim>
struct WallNode {
  NodeBlockOf<dim>* block = nullptr;  // null: the node does not exist (nothing near)
  std::size_t place = 0;
  std::size_t normal = 0;
  std::int32_t index = -1;  // of the block

  double m() const { return block ? block->mirrored_mass[place] : 0.0; }
  Parts<dim> before_forces() const { return block ? read(block->u) : Parts<dim>{}; }
  Parts<dim> after_forces() const { return block ? read(block->v) : Parts<dim>{}; }
  /// A scalar that points average is even in every wall.
  static void mirror_extra(const WallNode& a, const WallNode& c) {
    const double m = a.m() + c.m();
    if (m == 0.0) return;
    const double even = (a.m() * a.extra() + c.m() * c.extra()) / m;
    if (a.block) a.block->extra[a.place] = even;
    if (c.block) c.block->extra[c.place] = even;
  }
  double real_mass() const { return block ? block->mass[place] : 0.0; }
  void set(double mirrored, const Parts<dim>& u, const Parts<dim>& v) const {
    if (!block) return;
    block->mirrored_mass[place] = mirrored;
    write(block->u, u);
    write(block->v, v);
  }

 private:
  using Vectors = std::array<typename NodeBlockOf<dim>::Nodes, dim>;
  double extra() const { return block ? block->extra[place] : 0.0; }
  Parts<dim> read(const Vectors& of) const {
    Parts<dim> parts{of[normal][place], {}};
    for (std::size_t i = 0; i < parts.t.size(); ++i) parts.t[i] = of[along(normal, i)][place];
    return parts;
  }
  void write(Vectors& to, const Parts<dim>& parts) const {
    to[normal][place] = parts.n;
    for (std::size_t i = 0; i < parts.t.size(); ++i) to[along(normal, i)][place] = parts.t[i];
  }
};

template <int dim>
WallNode<dim> wall_node(GridOf<dim>& grid, const typename GridOf<dim>::Index& at,
                        std::size_t normal) {
  const typename GridOf<dim>::NodeRef node = grid.node(at);
  const auto index = node.block ? node.block - grid.node_blocks.data() : -1;
  return {node.block, node.place, normal, static_cast<std::int32_t>(index)};
}

/// The velocities of a triple, and what mirroring makes of them.
template <int dim>
struct Triple {
  Parts<dim> a, b, c;
  friend Triple operator-(const Triple& x, const Triple& y) {
    return {x.a - y.a, x.b - y.b, x.c - y.c};
  }

  /// With a velocity added: seen from a wall that moves.
  Triple moved(const Parts<dim>& by, double factor) const {
    Triple r = *this;
    for (Parts<dim>* parts : {&r.a, &r.b, &r.c}) parts->add(factor, by);
    return r;
  }

  /// Normal odd; tangential a mixture of even (stick = 0) and odd (stick = 1).
  Triple mirrored(double m_a, double m_c, double stick) const {
    const double share = m_a + m_c > 0.0 ? 1.0 / (m_a + m_c) : 0.0;
    const double n_c = (m_c * c.n - m_a * a.n) * share;
    Triple r{{-n_c, {}}, {0.0, {}}, {n_c, {}}};
    for (std::size_t i = 0; i < r.a.t.size(); ++i) {
      const double even = (m_c * c.t[i] + m_a * a.t[i]) * share;
      const double odd = (m_c * c.t[i] - m_a * a.t[i]) * share;
      r.a.t[i] = (1.0 - stick) * even - stick * odd;
      r.b.t[i] = (1.0 - stick) * b.t[i];
      r.c.t[i] = (1.0 - stick) * even + stick * odd;
    }
    return r;
  }
};

/// `mirrored`, moved so that it has the momentum of `velocity`.
template <int dim>
Triple<dim> with_momentum_of(const Triple<dim>& velocity, Triple<dim> mirrored,
                             const std::array<double, 3>& m) {
  const double mass = m[0] + m[1] + m[2];
  if (mass == 0.0) return mirrored;
  const Triple<dim> lost = velocity - mirrored;
  Parts<dim> mean;
  mean.add(m[0] / mass, lost.a);
  mean.add(m[1] / mass, lost.b);
  mean.add(m[2] / mass, lost.c);
  for (Parts<dim>* parts : {&mirrored.a, &mirrored.b, &mirrored.c}) parts->add(1.0, mean);
  return mirrored;
}

/// The share φ of sticking: from the impulses of the wall on the material, that is from its
/// momentum without and with the constraint. Negative: parting, the wall cannot pull.
template <int dim>
double coulomb_share(const Triple<dim>& v, double m_a, double m_b, double m_c, double friction,
                     double inward) {
  const Triple<dim> stuck = v.mirrored(m_a, m_c, 1.0);
  const double J_n = inward * ((m_c - m_a) * stuck.c.n - (m_a * v.a.n + m_b * v.b.n + m_c * v.c.n));
  if (!(J_n > 0.0)) return -1.0;
  std::array<double, dim - 1> J{};
  for (std::size_t i = 0; i < J.size(); ++i)
    J[i] = m_a * v.a.t[i] + m_b * v.b.t[i] + m_c * v.c.t[i] - (m_c - m_a) * stuck.c.t[i];
  const double J_t = dim == 2 ? std::abs(J.front()) : std::hypot(J.front(), J.back());
  return J_t > friction * J_n ? friction * J_n / J_t : 1.0;
}

/// `inward` is +1 where the inside lies on the positive side of the wall, else −1. `OfWall` is a
/// Wall or a part of one.
template <int dim, class OfWall>
WallEffect apply_to_triple(const OfWall& wall, double inward, const WallNode<dim>& a,
                           const WallNode<dim>& b, const WallNode<dim>& c,
                           std::vector<MirroredTriple>* record) {
  const double m_a = a.m();
  const double m_b = b.m();
  const double m_c = c.m();
  if (m_a + m_b + m_c == 0.0) return {};
  WallNode<dim>::mirror_extra(a, c);
  const Triple<dim> u{a.before_forces(), b.before_forces(), c.before_forces()};
  const Triple<dim> v{a.after_forces(), b.after_forces(), c.after_forces()};
  const bool comes_in = wall.kind == Wall::Kind::inflow;
  double stick = wall.kind == Wall::Kind::no_slip || comes_in ? 1.0 : 0.0;
  if (wall.kind == Wall::Kind::friction) {
    stick = coulomb_share(v, m_a, m_b, m_c, wall.friction, inward);
    if (stick < 0.0) return {};
  }
  const std::array<double, 3> m{a.real_mass(), b.real_mass(), c.real_mass()};
  const bool gives_impulses = wall.kind == Wall::Kind::friction;
  if (record != nullptr) {
    const auto place = [](const WallNode<dim>& n) {
      return MirroredTriple::Node{n.index, static_cast<std::int32_t>(n.place)};
    };
    record->push_back({{place(a), place(b), place(c)}, a.normal, m_a, m_c, stick, {}});
    if (gives_impulses) record->back().conserves = m;
  }
  // along the first of its axes; where material comes in, across it
  Parts<dim> motion;
  const double speed = comes_in ? inward * wall.speed : wall.speed;
  (comes_in ? motion.n : motion.t[0]) = speed;
  const auto constrained = [&](const Triple<dim>& x) {
    return x.moved(motion, -1.0).mirrored(m_a, m_c, stick).moved(motion, 1.0);
  };
  const Triple<dim> u_new = constrained(u), v_new = constrained(v);
  const Triple<dim> u_left = gives_impulses ? with_momentum_of(u, u_new, m) : u_new;
  a.set(m_a + m_c, u_left.a, v_new.a);
  b.set(2.0 * m_b, u_left.b, v_new.b);
  c.set(m_a + m_c, u_left.c, v_new.c);
  const auto inner = [&](const Triple<dim>& x, const Triple<dim>& y) {
    return m[0] * dot(x.a, y.a) + m[1] * dot(x.b, y.b) + m[2] * dot(x.c, y.c);
  };
  const Triple<dim> kick = v - u;  // Δt(f + mg)/m
  const auto dragged = [&](const Triple<dim>& x) {
    const auto along_motion = [&](const Parts<dim>& of) { return comes_in ? of.n : of.t[0]; };
    return m[0] * along_motion(x.a) + m[1] * along_motion(x.b) + m[2] * along_motion(x.c);
  };
  const double kinetic_after = 0.5 * (inner(v_new, v_new) - inner(v, v));
  if (gives_impulses) {
    WallEffect effect;
    effect.kinetic_after = kinetic_after;
    effect.impulses = 0.5 * (inner(v_new - v, u) + inner(v_new - v, v_new));
    return effect;
  }
  return {0.5 * (inner(u_new, u_new) - inner(u, u)), kinetic_after, inner(kick, u_new - u),
          speed * dragged(u_new - u), speed * dragged(v_new - v)};
}

/// What binds the first nodes of an opening to a node of it that is free: a term for each node, the
/// velocity q of which is to be `share` times the master's, with the mass that q has.
struct Bound {
  double share, mass;
  double u, v;  ///< q before and after forces
};

/// Sets each q to its share of one that keeps Σ mass·share·q (wall_parts.hpp).
void bind(std::vector<Bound>& group) {
  double mass = 0.0, u = 0.0, v = 0.0;
  for (const Bound& q : group) {
    mass += q.mass * q.share * q.share;
    u += q.mass * q.share * q.u;
    v += q.mass * q.share * q.v;
  }
  for (Bound& q : group) {
    q.u = mass > 0.0 ? q.share * u / mass : 0.0;
    q.v = mass > 0.0 ? q.share * v / mass : 0.0;
  }
}

/// Binds the nodes of an opening next to its lips to the free node `index` (along the wall).
template <int dim, class TripleAt>
WallEffect bind_to(const WallParts<dim>& parts, const std::array<int, dim - 1>& index,
                   const TripleAt& triple_at) {
  constexpr int around = dim == 2 ? 3 : 9;
  struct Member {
    double share;
    std::array<WallNode<dim>, 3> node;  // behind, on and inside the wall
  };
  std::vector<Member> members;
  for (int k = 0; k < around; ++k) {
    std::array<int, dim - 1> at = index, offset{};
    int rest = k;
    for (std::size_t i = 0; i < at.size(); ++i) {
      offset[i] = rest % 3 - 1;
      at[i] += offset[i];
      rest /= 3;
    }
    const auto node = parts.node(at);
    if (node.part->kind != Wall::Kind::open || node.towards_lip != offset) continue;
    double share = 1.0;
    for (const double s : node.share) share *= s;
    members.push_back({share, triple_at(at)});
  }
  WallEffect effect;
  if (members.size() < 2) return effect;
  std::vector<Bound> on, beside;
  for (const Member& member : members) {
    const auto& [a, b, c] = member.node;
    on.push_back({member.share, b.m(), b.before_forces().n, b.after_forces().n});
    const double m_a = a.m(), m_c = c.m();
    beside.push_back({member.share, m_a + m_c > 0.0 ? m_a * m_c / (m_a + m_c) : 0.0,
                      a.before_forces().n + c.before_forces().n,
                      a.after_forces().n + c.after_forces().n});
  }
  const std::vector<Bound> on_before = on, beside_before = beside;
  bind(on);
  bind(beside);
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto& [a, b, c] = members[k].node;
    const auto change = [&](const WallNode<dim>& node, double share, const Bound& from,
                            const Bound& to) {
      Parts<dim> u = node.before_forces(), v = node.after_forces();
      const Parts<dim> u_old = u, v_old = v;
      u.n += share * (to.u - from.u);
      v.n += share * (to.v - from.v);
      node.set(node.m(), u, v);
      const double m = node.real_mass();
      effect.kinetic_before += 0.5 * m * (u.n * u.n - u_old.n * u_old.n);
      effect.kinetic_after += 0.5 * m * (v.n * v.n - v_old.n * v_old.n);
      effect.impulse_work += m * (v_old.n - u_old.n) * (u.n - u_old.n);
    };
    change(b, 1.0, on_before[k], on[k]);
    const double m_a = a.m(), m_c = c.m();
    if (!(m_a > 0.0 && m_c > 0.0)) continue;
    change(a, m_c / (m_a + m_c), beside_before[k], beside[k]);
    change(c, m_a / (m_a + m_c), beside_before[k], beside[k]);
  }
  return effect;
}

/// A wall across an axis, at the node index `line` of it.
template <int dim>
WallEffect apply_wall(GridOf<dim>& grid, const Wall& wall, std::size_t normal, int line, int inward,
                      std::vector<MirroredTriple>* record) {
  WallEffect total;
  if (wall.kind == Wall::Kind::open || wall.kind == Wall::Kind::periodic) return total;
  using Along = std::array<int, dim - 1>;
  const bool in_parts = wall.kind == Wall::Kind::parts;
  const WallParts<dim> parts(wall, normal, grid);
  std::vector<Along> free;  // nodes of openings
  const auto triple_at = [&](const Along& along_wall) {
    typename GridOf<dim>::Index index{};
    for (std::size_t i = 0; i < along_wall.size(); ++i) index[along(normal, i)] = along_wall[i];
    const auto at = [&](int offset) {
      index[normal] = line + offset;
      return wall_node(grid, index, normal);
    };
    return std::array{at(-inward), at(0), at(inward)};
  };
  const int block = grid.block_of_cell(normal, line);
  for (const NodeBlockOf<dim>& nb : grid.node_blocks) {
    if (nb.at[normal] != block) continue;
    const int count = Shape<dim>::nodes / Shape<dim>::cells[normal];
    for (int n = 0; n < count; ++n) {  // the block's nodes on the wall
      Along index{};
      int rest = n;
      for (std::size_t i = 0; i < index.size(); ++i) {
        const std::size_t axis = along(normal, i);
        index[i] = GridOf<dim>::first(axis, nb.at[axis]) + rest % Shape<dim>::cells[axis];
        rest /= Shape<dim>::cells[axis];
      }
      const auto [a, b, c] = triple_at(index);
      if (!in_parts) {
        total += apply_to_triple(wall, inward, a, b, c, record);
        continue;
      }
      if (a.m() + b.m() + c.m() == 0.0) continue;
      const auto node = parts.node(index);
      if (node.part->kind != Wall::Kind::open)
        total += apply_to_triple(*node.part, inward, a, b, c, record);
      else if (node.free())
        free.push_back(index);
    }
  }
  for (const Along& index : free) total += bind_to<dim>(parts, index, triple_at);
  return total;
}

}  // namespace

template <int dim>
WallEffect apply_walls(GridOf<dim>& grid, const Walls& walls, std::vector<MirroredTriple>* record) {
  if (record != nullptr) record->clear();
  // one axis after the other: the mirrored masses of the first make the fields exactly odd or even
  // in x, which a following mirror keeps, so that all conditions hold in the corners
  WallEffect total;
  for (std::size_t axis = 0; axis < dim; ++axis) {
    total += apply_wall(grid, walls.low(axis), axis, 0, 1, record);
    total += apply_wall(grid, walls.high(axis), axis, grid.cells()[axis], -1, record);
  }
  return total;
}

template WallEffect apply_walls(GridOf<2>&, const Walls&, std::vector<MirroredTriple>*);
template WallEffect apply_walls(GridOf<3>&, const Walls&, std::vector<MirroredTriple>*);

template <int dim>
void transpose_walls(GridOf<dim>& grid, const std::vector<MirroredTriple>& record) {
  for (auto triple = record.rbegin(); triple != record.rend(); ++triple) {
    const MirroredTriple& at = *triple;
    const auto value = [&](std::size_t k, std::size_t axis) -> double* {
      if (at.node[k].block < 0) return nullptr;
      return grid.node_blocks[static_cast<std::size_t>(at.node[k].block)].v[axis].data() +
             at.node[k].place;
    };
    const double mass = at.m_a + at.m_c, share = mass > 0.0 ? 1.0 / mass : 0.0;
    for (std::size_t axis = 0; axis < dim; ++axis) {
      std::array<double, 3> x{};  // behind, on and inside
      for (std::size_t k = 0; k < 3; ++k)
        if (const double* const there = value(k, axis)) x[k] = *there;
      // of Triple::mirrored(): even and odd parts of what a and c become
      const double stick = axis == at.normal ? 1.0 : at.stick;
      const double even = (1.0 - stick) * (x[2] + x[0]), odd = stick * (x[2] - x[0]);
      x = {at.m_a * share * (even - odd), (1.0 - stick) * x[1], at.m_c * share * (even + odd)};
      for (std::size_t k = 0; k < 3; ++k)
        if (double* const there = value(k, axis)) *there = x[k];
    }
  }
}

template void transpose_walls(GridOf<2>&, const std::vector<MirroredTriple>&);
template void transpose_walls(GridOf<3>&, const std::vector<MirroredTriple>&);

void mirror(const std::vector<MirroredTriple>& record, NodeVector& velocity) {
  for (const MirroredTriple& at : record) {
    const auto component = [&](std::size_t k, bool x) -> double* {
      if (at.node[k].block < 0) return nullptr;
      NodeField& nodes = velocity[static_cast<std::size_t>(at.node[k].block)];
      return &(x ? nodes.x : nodes.y)[static_cast<std::size_t>(at.node[k].place)];
    };
    const auto read = [&](std::size_t k) {
      const double* n = component(k, at.normal == 0);
      return n != nullptr ? Parts<2>{*n, {*component(k, at.normal != 0)}} : Parts<2>{};
    };
    const Triple<2> given{read(0), read(1), read(2)};
    Triple<2> mirrored = given.mirrored(at.m_a, at.m_c, at.stick);
    if (at.conserves) mirrored = with_momentum_of(given, mirrored, *at.conserves);
    const auto write = [&](std::size_t k, const Parts<2>& v) {
      if (at.node[k].block < 0) return;
      *component(k, at.normal == 0) = v.n;
      *component(k, at.normal != 0) = v.t[0];
    };
    write(0, mirrored.a);
    write(1, mirrored.b);
    write(2, mirrored.c);
  }
}

}  // namespace repose::mpm

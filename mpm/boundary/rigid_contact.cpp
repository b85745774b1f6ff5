#include "mpm/boundary/rigid_contact.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace repose::mpm {
namespace {

template <int dim>
using Vector = std::array<double, dim>;

template <std::size_t n>
double dot(const std::array<double, n>& a, const std::array<double, n>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}
template <std::size_t n>
void add(std::array<double, n>& to, double factor, const std::array<double, n>& x) {
  for (std::size_t i = 0; i < n; ++i) to[i] += factor * x[i];
}
template <int dim>
Vector<dim> along_axes(const std::array<double, 3>& x) {
  Vector<dim> r;
  for (std::size_t i = 0; i < dim; ++i) r[i] = x[i];
  return r;
}
template <int dim>
Position position_of(const Vector<dim>& x) {
  Position r{};
  for (std::size_t i = 0; i < dim; ++i) r[i] = x[i];
  return r;
}

template <int dim>
Vector<dim> read(const std::array<typename NodeBlockOf<dim>::Nodes, dim>& field, std::int32_t n) {
  Vector<dim> x;
  for (std::size_t i = 0; i < dim; ++i) x[i] = field[i][static_cast<std::size_t>(n)];
  return x;
}
template <int dim>
void write(std::array<typename NodeBlockOf<dim>::Nodes, dim>& field, std::int32_t n,
           const Vector<dim>& x) {
  for (std::size_t i = 0; i < dim; ++i) field[i][static_cast<std::size_t>(n)] = x[i];
}

/// Index of the n-th node of a block.
template <int dim>
typename GridOf<dim>::Index node_index(const NodeBlockOf<dim>& block, int n) {
  typename GridOf<dim>::Index index;
  for (std::size_t axis = 0; axis < dim; ++axis) {
    index[axis] = GridOf<dim>::first(axis, block.at[axis]) + n % Shape<dim>::cells[axis];
    n /= Shape<dim>::cells[axis];
  }
  return index;
}

/// What contact is to take of one velocity: odd and even (rigid_contact.hpp).
template <int dim>
struct Lacks {
  Vector<dim> odd{}, even{};
  bool parts = false;
};
template <int dim>
Lacks<dim> lacks(const Surface& surface, const Vector<dim>& ghost, const Vector<dim>& front,
                 double s, const Vector<dim>& normal, const Vector<dim>& of_surface) {
  Vector<dim> delta, difference;
  for (std::size_t i = 0; i < dim; ++i) {
    delta[i] = ghost[i] - of_surface[i] + s * (front[i] - of_surface[i]);
    difference[i] = ghost[i] - front[i];
  }
  const double delta_n = dot(delta, normal);
  if (surface.contact == Surface::Contact::friction && !(delta_n < 0.0)) return {{}, {}, true};
  add(delta, -delta_n, normal);
  add(difference, -dot(difference, normal), normal);
  double share = surface.contact == Surface::Contact::no_slip ? 1.0 : 0.0;
  if (surface.contact == Surface::Contact::friction) {
    const double most = surface.friction * -delta_n, length = std::sqrt(dot(delta, delta));
    share = length > most ? most / length : 1.0;
  }
  Lacks<dim> result;
  add(result.odd, delta_n, normal);
  add(result.odd, share, delta);
  add(result.even, 1.0 - share, difference);
  return result;
}

/// How deep behind a surface points in front of it give mass to nodes, in cells: their stencils
/// reach two cells along every axis.
template <int dim>
const double reach = 2.0 * std::sqrt(static_cast<double>(dim)) + 0.5;

}  // namespace

template <int dim>
bool RigidContact<dim>::is_near(const GridOf<dim>& grid, const PointBlockOf<dim>& block,
                                double time) const {
  Position centre{};
  double radius2 = 0.0;  // of the block with a cell of drift around it
  for (std::size_t axis = 0; axis < dim; ++axis) {
    const double half = 0.5 * Shape<dim>::cells[axis];
    centre[axis] = grid.h() * (GridOf<dim>::first(axis, block.at[axis]) + half);
    radius2 += (half + 1.0) * (half + 1.0);
  }
  const double radius = grid.h() * std::sqrt(radius2);
  return std::any_of(surfaces_.begin(), surfaces_.end(), [&](const Surface& surface) {
    return surface.nearest_at(time, centre).distance < radius;
  });
}

template <int dim>
typename RigidContact<dim>::Layer RigidContact<dim>::layer_of(const Surface& surface,
                                                              GridOf<dim>& grid,
                                                              double time) const {
  Layer layer;
  const double h = grid.h();
  double radius2 = 0.0;  // of a block of nodes
  for (const int cells : Shape<dim>::cells) radius2 += 0.25 * cells * cells;
  const double radius = h * std::sqrt(radius2);
  std::unordered_map<std::int64_t, std::int32_t> known;
  const auto donor = [&](const typename GridOf<dim>::Index& index) -> std::int32_t {
    for (std::size_t i = 0; i < dim; ++i)  // beyond, no point of the box reaches
      if (index[i] < -2 || index[i] > grid.cells()[i] + 2) return -1;
    const typename GridOf<dim>::NodeRef at = grid.node(index);
    if (at.block == nullptr) return -1;
    const auto block = static_cast<std::int32_t>(at.block - grid.node_blocks.data());
    const auto place = static_cast<std::int32_t>(at.place);
    const auto [found, is_new] =
        known.try_emplace(std::int64_t{block} * Shape<dim>::nodes + place, -1);
    if (is_new) {
      Vector<dim> x;
      for (std::size_t i = 0; i < dim; ++i) x[i] = h * index[i];
      if (surface.nearest_at(time, position_of<dim>(x)).distance > 0.0) {
        found->second = static_cast<std::int32_t>(layer.donors.size());
        layer.donors.push_back(
            {block, place, along_axes<dim>(surface.velocity_at(time, position_of<dim>(x)))});
      }
    }
    return found->second;
  };
  for (std::size_t b = 0; b < grid.node_blocks.size(); ++b) {
    const NodeBlockOf<dim>& nb = grid.node_blocks[b];
    Position centre{};
    for (std::size_t axis = 0; axis < dim; ++axis)
      centre[axis] = h * (GridOf<dim>::first(axis, nb.at[axis]) + 0.5 * Shape<dim>::cells[axis]);
    const double middle = surface.nearest_at(time, centre).distance;
    if (middle > radius || middle < -radius - reach<dim> * h) continue;
    for (int n = 0; n < Shape<dim>::nodes; ++n) {
      const typename GridOf<dim>::Index index = node_index<dim>(nb, n);
      Vector<dim> x;
      for (std::size_t i = 0; i < dim; ++i) x[i] = h * index[i];
      const Nearest at = surface.nearest_at(time, position_of<dim>(x));
      if (at.distance > 0.0 || at.distance < -reach<dim> * h) continue;
      const double d = std::max(-at.distance, h * std::sqrt(static_cast<double>(dim)));
      Ghost ghost{};
      ghost.block = static_cast<std::int32_t>(b);
      ghost.place = n;
      ghost.s = -at.distance / d;
      ghost.normal = along_axes<dim>(at.normal);
      ghost.velocity = along_axes<dim>(surface.velocity_at(time, position_of<dim>(x)));
      typename GridOf<dim>::Index cell;
      Vector<dim> part;
      for (std::size_t i = 0; i < dim; ++i) {
        const double xi = (x[i] + (d - at.distance) * at.normal[i]) / h;
        cell[i] = static_cast<int>(std::floor(xi));
        part[i] = xi - cell[i];
      }
      for (std::size_t corner = 0; corner < ghost.donor.size(); ++corner) {
        typename GridOf<dim>::Index there = cell;
        double weight = 1.0;
        for (std::size_t i = 0; i < dim; ++i) {
          const bool upper = (corner >> i & 1U) != 0;
          there[i] += upper ? 1 : 0;
          weight *= upper ? part[i] : 1.0 - part[i];
        }
        ghost.weight[corner] = weight;
        ghost.donor[corner] = weight > 0.0 ? donor(there) : -1;
      }
      layer.ghosts.push_back(ghost);
    }
  }
  return layer;
}

template <int dim>
WallEffect RigidContact<dim>::apply(const Surface& surface, Layer& layer, GridOf<dim>& grid,
                                    double& work) const {
  const bool gives_impulses = surface.contact == Surface::Contact::friction || surface.moves();
  const auto block = [&](const auto& at) -> NodeBlockOf<dim>& {
    return grid.node_blocks[static_cast<std::size_t>(at.block)];
  };
  const auto mass = [&](const auto& at) {
    return block(at).mass[static_cast<std::size_t>(at.place)];
  };
  for (Donor& donor : layer.donors) {
    donor.odd_mass = donor.even_mass = 0.0;
    donor.u_odd = donor.u_even = donor.v_odd = donor.v_even = {};
  }
  const auto each_donor = [&](Ghost& ghost, auto&& f) {
    for (std::size_t k = 0; k < ghost.donor.size(); ++k) {
      if (ghost.donor[k] < 0) continue;
      Donor& donor = layer.donors[static_cast<std::size_t>(ghost.donor[k])];
      if (mass(donor) > 0.0) f(donor, ghost.weight[k]);
    }
  };
  for (Ghost& ghost : layer.ghosts) {
    ghost.acts = false;
    const double m = mass(ghost);
    if (!(m > 0.0)) continue;
    ghost.borne = 0.0;
    Vector<dim> u{}, v{};
    each_donor(ghost, [&](const Donor& donor, double w) {
      ghost.borne += w;
      add(u, w, read<dim>(block(donor).u, donor.place));
      add(v, w, read<dim>(block(donor).v, donor.place));
    });
    const Vector<dim> u_g = read<dim>(block(ghost).u, ghost.place);
    const Vector<dim> v_g = read<dim>(block(ghost).v, ghost.place);
    double s = ghost.s;
    if (ghost.borne > 1e-9) {
      for (std::size_t i = 0; i < dim; ++i) u[i] /= ghost.borne, v[i] /= ghost.borne;
    } else {  // nothing in front of it that it could follow
      ghost.borne = s = 0.0;
      u = u_g;
      v = v_g;
    }
    const Lacks<dim> of_v = lacks<dim>(surface, v_g, v, s, ghost.normal, ghost.velocity);
    if (of_v.parts) continue;
    ghost.acts = true;
    ghost.v_odd = of_v.odd;
    ghost.v_even = of_v.even;
    ghost.u_odd = ghost.u_even = {};
    if (!gives_impulses) {
      const Lacks<dim> of_u = lacks<dim>(surface, u_g, u, s, ghost.normal, ghost.velocity);
      ghost.u_odd = of_u.odd;
      ghost.u_even = of_u.even;
    }
    if (ghost.borne == 0.0) continue;
    each_donor(ghost, [&](Donor& donor, double weight) {
      const double w = weight / ghost.borne;
      donor.odd_mass += m * w * s * s;
      donor.even_mass += m * w;
      add(donor.u_odd, -m * w * s, ghost.u_odd);
      add(donor.v_odd, -m * w * s, ghost.v_odd);
      add(donor.u_even, m * w, ghost.u_even);
      add(donor.v_even, m * w, ghost.v_even);
    });
  }
  WallEffect effect;
  const auto change = [&](const auto& at, const Vector<dim>& du, const Vector<dim>& dv) {
    const double m = mass(at);
    const Vector<dim> u = read<dim>(block(at).u, at.place), v = read<dim>(block(at).v, at.place);
    Vector<dim> u_new = u, v_new = v, both = u;
    add(u_new, 1.0, du);
    add(v_new, 1.0, dv);
    write<dim>(block(at).u, at.place, u_new);
    write<dim>(block(at).v, at.place, v_new);
    effect.kinetic_after += 0.5 * m * (dot(v_new, v_new) - dot(v, v));
    add(both, 1.0, v_new);
    if (gives_impulses) {
      effect.impulses += 0.5 * m * dot(dv, both);
    } else {
      effect.kinetic_before += 0.5 * m * (dot(u_new, u_new) - dot(u, u));
      effect.impulse_work += m * (dot(v, du) - dot(u, du));
    }
    work += m * dot(dv, at.velocity);
  };
  for (Donor& donor : layer.donors) {
    const double m = mass(donor);
    if (!(m > 0.0)) continue;
    for (std::size_t i = 0; i < dim; ++i) {
      donor.u_odd[i] /= m + donor.odd_mass;
      donor.v_odd[i] /= m + donor.odd_mass;
      donor.u_even[i] /= m + donor.even_mass;
      donor.v_even[i] /= m + donor.even_mass;
    }
    Vector<dim> du = donor.u_odd, dv = donor.v_odd;
    add(du, 1.0, donor.u_even);
    add(dv, 1.0, donor.v_even);
    change(donor, du, dv);
  }
  for (Ghost& ghost : layer.ghosts) {
    if (!ghost.acts) continue;
    Vector<dim> du{}, dv{};
    add(du, -1.0, ghost.u_odd);
    add(du, -1.0, ghost.u_even);
    add(dv, -1.0, ghost.v_odd);
    add(dv, -1.0, ghost.v_even);
    if (ghost.borne > 0.0)
      each_donor(ghost, [&](const Donor& donor, double weight) {
        const double w = weight / ghost.borne;
        add(du, -ghost.s * w, donor.u_odd);
        add(dv, -ghost.s * w, donor.v_odd);
        add(du, w, donor.u_even);
        add(dv, w, donor.v_even);
      });
    change(ghost, du, dv);
  }
  return effect;
}

template <int dim>
WallEffect RigidContact<dim>::apply(GridOf<dim>& grid, double time, bool sorted, double& work) {
  WallEffect effect;
  layers_.resize(surfaces_.size());
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    if (sorted || surfaces_[k].moves()) layers_[k] = layer_of(surfaces_[k], grid, time);
    effect += apply(surfaces_[k], layers_[k], grid, work);
  }
  return effect;
}

template <int dim>
bool RigidContact<dim>::keep_out(std::array<double, dim>& x, double time, double hair) const {
  bool moved = false;
  for (const Surface& surface : surfaces_) {
    const Nearest at = surface.nearest_at(time, position_of<dim>(x));
    if (!(at.distance < 0.0)) continue;
    for (std::size_t i = 0; i < dim; ++i) x[i] += (hair - at.distance) * at.normal[i];
    moved = true;
  }
  return moved;
}

template class RigidContact<2>;
template class RigidContact<3>;

}  // namespace repose::mpm

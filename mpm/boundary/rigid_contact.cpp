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

template <int dim>
Position position_of(const typename GridOf<dim>::Index& node, double h) {
  Position x{};
  for (std::size_t i = 0; i < dim; ++i) x[i] = h * node[i];
  return x;
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

/// Nodes up to this far in front of a surface are bound to it as those behind are [cells]
constexpr double bound = 0.5;

/// The nodes around the place that lies d in front of the surface over x, and their weights there.
template <int dim>
struct Corner {
  typename GridOf<dim>::Index index;
  double weight;
};
template <int dim>
using Corners = std::array<Corner<dim>, std::size_t{1} << dim>;
template <int dim>
Corners<dim> corners_around(const Position& x, const Nearest& at, double d, double h) {
  typename GridOf<dim>::Index cell;
  Vector<dim> part;
  for (std::size_t i = 0; i < dim; ++i) {
    const double xi = (x[i] + (d - at.distance) * at.normal[i]) / h;
    cell[i] = static_cast<int>(std::floor(xi));
    part[i] = xi - cell[i];
  }
  Corners<dim> corners;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    corners[k] = {cell, 1.0};
    for (std::size_t i = 0; i < dim; ++i) {
      const bool upper = (k >> i & 1U) != 0;
      corners[k].index[i] += upper ? 1 : 0;
      corners[k].weight *= upper ? part[i] : 1.0 - part[i];
    }
  }
  return corners;
}

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
  const auto in_front = [&](const typename GridOf<dim>::Index& index) {
    return surface.nearest_at(time, position_of<dim>(index, h)).distance > bound * h;
  };
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
    if (is_new && in_front(index)) {
      found->second = static_cast<std::int32_t>(layer.donors.size());
      Donor& made = layer.donors.emplace_back();
      made.block = block;
      made.place = place;
      made.velocity = along_axes<dim>(surface.velocity_at(time, position_of<dim>(index, h)));
    }
    return found->second;
  };
  for (std::size_t b = 0; b < grid.node_blocks.size(); ++b) {
    const NodeBlockOf<dim>& nb = grid.node_blocks[b];
    Position centre{};
    for (std::size_t axis = 0; axis < dim; ++axis)
      centre[axis] = h * (GridOf<dim>::first(axis, nb.at[axis]) + 0.5 * Shape<dim>::cells[axis]);
    const double middle = surface.nearest_at(time, centre).distance;
    if (middle > radius + bound * h || middle < -radius - reach<dim> * h) continue;
    for (int n = 0; n < Shape<dim>::nodes; ++n) {
      const Position x = position_of<dim>(node_index<dim>(nb, n), h);
      const Nearest at = surface.nearest_at(time, x);
      if (at.distance > bound * h || at.distance < -reach<dim> * h) continue;
      Ghost ghost{};
      ghost.block = static_cast<std::int32_t>(b);
      ghost.place = n;
      ghost.normal = along_axes<dim>(at.normal);
      ghost.velocity = along_axes<dim>(surface.velocity_at(time, x));
      // d: as far in front as the node lies behind, or so far that all donors are free
      const double farthest = bound + std::sqrt(static_cast<double>(dim));
      double d = std::max(-at.distance / h, bound);
      Corners<dim> corners;
      for (;; d += 0.125) {
        corners = corners_around<dim>(x, at, d * h, h);
        if (d >= farthest || std::all_of(corners.begin(), corners.end(), [&](const auto& corner) {
              return corner.weight == 0.0 || in_front(corner.index);
            }))
          break;
      }
      ghost.s = -at.distance / (d * h);
      for (std::size_t k = 0; k < corners.size(); ++k) {
        ghost.weight[k] = corners[k].weight;
        ghost.donor[k] = corners[k].weight > 0.0 ? donor(corners[k].index) : -1;
      }
      layer.ghosts.push_back(ghost);
    }
  }
  return layer;
}

template <int dim>
WallEffect RigidContact<dim>::apply(const Surface& surface, Layer& layer, GridOf<dim>& grid,
                                    double& work) const {
  const auto block = [&](const auto& at) -> NodeBlockOf<dim>& {
    return grid.node_blocks[static_cast<std::size_t>(at.block)];
  };
  const auto mass = [&](const auto& at) {
    return block(at).mass[static_cast<std::size_t>(at.place)];
  };
  const auto velocity = [&](const auto& at) { return read<dim>(block(at).v, at.place); };
  /// f(donor, weight) for the donors of a ghost that bear mass.
  const auto each_donor = [&](const Ghost& ghost, auto&& f) {
    for (std::size_t k = 0; k < ghost.donor.size(); ++k) {
      if (ghost.donor[k] < 0) continue;
      Donor& donor = layer.donors[static_cast<std::size_t>(ghost.donor[k])];
      if (donor.mass > 0.0) f(donor, ghost.weight[k] * ghost.per_borne);
    }
  };
  for (Donor& donor : layer.donors) {
    donor.mass = donor.odd_mass = donor.even_mass = mass(donor);
    donor.odd = donor.even = {};
  }
  for (Ghost& ghost : layer.ghosts) {
    ghost.mass = mass(ghost);
    ghost.acts = ghost.mass > 0.0;
    if (!ghost.acts) continue;
    ghost.per_borne = 1.0;
    double borne = 0.0;
    each_donor(ghost, [&](const Donor&, double w) { borne += w; });
    const Vector<dim> own = velocity(ghost);
    Vector<dim> front{};
    if (borne > 1e-9) {
      ghost.per_borne = 1.0 / borne;
      each_donor(ghost, [&](const Donor& donor, double w) { add(front, w, velocity(donor)); });
    } else {  // nothing in front of it that it could follow
      ghost.per_borne = 0.0;
      front = own;
    }
    const double s = ghost.per_borne > 0.0 ? ghost.s : 0.0;
    const Lacks<dim> of = lacks<dim>(surface, own, front, s, ghost.normal, ghost.velocity);
    ghost.acts = !of.parts;
    if (!ghost.acts) continue;
    ghost.odd = of.odd;
    ghost.even = of.even;
    each_donor(ghost, [&](Donor& donor, double w) {
      donor.odd_mass += ghost.mass * w * s * s;
      donor.even_mass += ghost.mass * w;
      add(donor.odd, -ghost.mass * w * s, ghost.odd);
      add(donor.even, ghost.mass * w, ghost.even);
    });
  }
  for (Donor& donor : layer.donors) {
    if (!(donor.mass > 0.0)) continue;
    for (std::size_t i = 0; i < dim; ++i) {
      donor.odd[i] /= donor.odd_mass;
      donor.even[i] /= donor.even_mass;
    }
  }
  WallEffect effect;
  const auto change = [&](const auto& at, const Vector<dim>& by) {
    const Vector<dim> v = velocity(at);
    Vector<dim> v_new = v;
    add(v_new, 1.0, by);
    write<dim>(block(at).v, at.place, v_new);
    effect.kinetic_after += 0.5 * at.mass * (dot(v_new, v_new) - dot(v, v));
    effect.impulses += 0.5 * at.mass * (dot(by, read<dim>(block(at).u, at.place)) + dot(by, v_new));
    work += at.mass * dot(by, at.velocity);
  };
  for (const Ghost& ghost : layer.ghosts) {
    if (!ghost.acts) continue;
    Vector<dim> by{};
    add(by, -1.0, ghost.odd);
    add(by, -1.0, ghost.even);
    each_donor(ghost, [&](const Donor& donor, double w) {
      add(by, -ghost.s * w, donor.odd);
      add(by, w, donor.even);
    });
    change(ghost, by);
  }
  for (const Donor& donor : layer.donors) {
    if (!(donor.mass > 0.0)) continue;
    Vector<dim> by = donor.odd;
    add(by, 1.0, donor.even);
    change(donor, by);
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

/// With o = N_o(v_g + sV), e = N_e(v_g − V) apply() is
///   v_j + a_j + b_j,  v_g − o − sΣ w a − e + Σ w b,
///   a_j = −Σ_g m_g w s o/(m_j + Σ m_g w s²),  b_j = Σ_g m_g w e/(m_j + Σ m_g w).
template <int dim>
void RigidContact<dim>::transpose(const Surface& surface, const Layer& layer, GridOf<dim>& grid) {
  const auto read_at = [&](const auto& at) {
    return read<dim>(grid.node_blocks[static_cast<std::size_t>(at.block)].v, at.place);
  };
  const auto add_at = [&](const auto& at, const Vector<dim>& by) {
    NodeBlockOf<dim>& nb = grid.node_blocks[static_cast<std::size_t>(at.block)];
    for (std::size_t i = 0; i < dim; ++i) nb.v[i][static_cast<std::size_t>(at.place)] += by[i];
  };
  const auto each_donor = [&](const Ghost& ghost, auto&& f) {
    for (std::size_t k = 0; k < ghost.donor.size(); ++k) {
      if (ghost.donor[k] < 0) continue;
      const auto n = static_cast<std::size_t>(ghost.donor[k]);
      if (layer.donors[n].mass > 0.0) f(n, ghost.weight[k] * ghost.per_borne);
    }
  };
  // of a and b, over their denominators
  std::vector<Vector<dim>> odd(layer.donors.size()), even(layer.donors.size());
  for (std::size_t n = 0; n < layer.donors.size(); ++n)
    if (layer.donors[n].mass > 0.0) odd[n] = even[n] = read_at(layer.donors[n]);
  for (const Ghost& ghost : layer.ghosts) {
    if (!ghost.acts) continue;
    const Vector<dim> x = read_at(ghost);
    each_donor(ghost, [&](std::size_t n, double w) {
      add(odd[n], -ghost.s * w, x);
      add(even[n], w, x);
    });
  }
  for (std::size_t n = 0; n < layer.donors.size(); ++n) {
    const Donor& donor = layer.donors[n];
    if (!(donor.mass > 0.0)) continue;
    for (std::size_t i = 0; i < dim; ++i) {
      odd[n][i] /= donor.odd_mass;
      even[n][i] /= donor.even_mass;
    }
  }
  for (const Ghost& ghost : layer.ghosts) {
    if (!ghost.acts) continue;
    const Vector<dim> x = read_at(ghost);
    const double s = ghost.per_borne > 0.0 ? ghost.s : 0.0;
    Vector<dim> of_odd{}, of_even{};
    add(of_odd, -1.0, x);
    add(of_even, -1.0, x);
    each_donor(ghost, [&](std::size_t n, double w) {
      add(of_odd, -ghost.mass * w * s, odd[n]);
      add(of_even, ghost.mass * w, even[n]);
    });
    if (surface.contact == Surface::Contact::slip) {
      const double n_odd = dot(of_odd, ghost.normal), n_even = dot(of_even, ghost.normal);
      for (std::size_t i = 0; i < dim; ++i) {
        of_odd[i] = n_odd * ghost.normal[i];
        of_even[i] -= n_even * ghost.normal[i];
      }
      if (!(ghost.per_borne > 0.0)) of_even = {};
    } else {
      of_even = {};
    }
    Vector<dim> both = of_odd;
    add(both, 1.0, of_even);
    add_at(ghost, both);
    each_donor(ghost, [&](std::size_t n, double w) {
      Vector<dim> back{};
      add(back, s * w, of_odd);
      add(back, -w, of_even);
      add_at(layer.donors[n], back);
    });
  }
}

template <int dim>
void RigidContact<dim>::transpose(GridOf<dim>& grid) const {
  for (std::size_t k = surfaces_.size(); k-- > 0;) transpose(surfaces_[k], layers_[k], grid);
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

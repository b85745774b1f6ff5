#include "mpm/boundary/rigid_contact.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "mpm/grid/tile_exchange.hpp"

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
/// A row of four numbers in a register, and back.
template <class Four>
Row loaded(const Four& row) {
  return Row::load_aligned(row.data());
}
template <class Four>
Four stored(const Row& row) {
  Four numbers;
  row.store_aligned(numbers.data());
  return numbers;
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
/// Of a ghost's velocity and that in front, both relative to the surface's; `even`: AV.
template <int dim>
Lacks<dim> lacks(Surface::Contact contact, double friction, const Vector<dim>& ghost,
                 const Vector<dim>& front, const Vector<dim>& even, double s,
                 const Vector<dim>& normal) {
  Vector<dim> delta, difference;
  for (std::size_t i = 0; i < dim; ++i) {
    delta[i] = ghost[i] + s * front[i];
    difference[i] = ghost[i] - even[i];
  }
  const double delta_n = dot(delta, normal);
  if (contact == Surface::Contact::friction && !(delta_n < 0.0)) return {{}, {}, true};
  add(delta, -delta_n, normal);
  add(difference, -dot(difference, normal), normal);
  double share = contact == Surface::Contact::no_slip ? 1.0 : 0.0;
  if (contact == Surface::Contact::friction) {
    const double most = friction * -delta_n, length = std::sqrt(dot(delta, delta));
    share = length > most ? most / length : 1.0;
  }
  Lacks<dim> result;
  add(result.odd, delta_n, normal);
  add(result.odd, share, delta);
  add(result.even, 1.0 - share, difference);
  return result;
}

/// How deep behind a surface points in front of it give mass to nodes, in cells: their stencils
/// reach two cells along every axis, and half a one is for the surface's bending.
double reach_along(const Position& normal) {
  return 2.0 * (std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2])) + 0.5;
}
/// The most that it can be.
template <int dim>
const double reach = 2.0 * std::sqrt(static_cast<double>(dim)) + 0.5;

/// Nodes up to this far in front of a surface are bound to it as those behind are [cells]
constexpr double bound = 0.5;

/// Most that A − I may be: beyond it a surface bends within the cells that should tell of it.
constexpr double most_turn = 1.0;

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
    return surface.holds_at(time, centre) || !surface.is_beyond_at(time, centre, radius);
  });
}

/// The ghosts of a block of nodes, as the surface lies.
template <int dim>
std::vector<typename RigidContact<dim>::Geometry> RigidContact<dim>::geometry_of(
    const Surface& surface, const NodeBlockOf<dim>& nb, double h, double time) {
  std::vector<Geometry> found;
  double radius2 = 0.0;  // of a block of nodes
  for (const int cells : Shape<dim>::cells) radius2 += 0.25 * cells * cells;
  const double radius = h * std::sqrt(radius2);
  Position centre{};
  for (std::size_t axis = 0; axis < dim; ++axis)
    centre[axis] = h * (GridOf<dim>::first(axis, nb.at[axis]) + 0.5 * Shape<dim>::cells[axis]);
  const double deep = surface.holds_at(time, centre) ? reach<dim> : bound;
  if (surface.is_beyond_at(time, centre, radius + deep * h)) return found;
  const auto in_front = [&](const typename GridOf<dim>::Index& index) {
    return surface.nearest_at(time, position_of<dim>(index, h)).distance > bound * h;
  };
  for (int n = 0; n < Shape<dim>::nodes; ++n) {
    const Position x = position_of<dim>(node_index<dim>(nb, n), h);
    const Nearest at = surface.nearest_at(time, x);
    if (at.distance > bound * h || at.distance < -reach_along(at.normal) * h) continue;
    Geometry ghost;
    ghost.place = n;
    ghost.normal = along_axes<dim>(at.normal);
    ghost.friction = surface.friction_at(x);
    // d: as far in front as the node lies behind, or so far that all donors are free
    const double farthest = bound + std::sqrt(static_cast<double>(dim));
    double d = std::max(-at.distance / h, bound);
    Corners<dim> corners;
    std::array<bool, std::size_t{1} << dim> free{};
    for (;; d += 0.125) {
      corners = corners_around<dim>(x, at, d * h, h);
      bool all_free = true;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        free[k] = corners[k].weight > 0.0 && in_front(corners[k].index);
        all_free = all_free && (free[k] || corners[k].weight == 0.0);
      }
      if (d >= farthest || all_free) break;
    }
    ghost.s = -at.distance / (d * h);
    Position front = x;  // the donors' place
    for (std::size_t i = 0; i < 3; ++i) front[i] += (d * h - at.distance) * at.normal[i];
    const Bending bending = surface.bending_at(time, front, 0.5 * h);
    for (std::size_t i = 0; i < dim; ++i)
      for (std::size_t j = 0; j < dim; ++j)
        ghost.turn[i][j] = std::clamp((at.distance - d * h) * bending[i][j], -most_turn, most_turn);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      ghost.weight[k] = corners[k].weight;
      ghost.free[k] = free[k];
      ghost.donor[k] = corners[k].index;
    }
    found.push_back(ghost);
  }
  return found;
}

template <int dim>
void RigidContact<dim>::build(const Surface& surface, Layer& layer, GridOf<dim>& grid,
                              double time) {
  layer.ghosts.clear();
  layer.donors.clear();
  const double h = grid.h();
  // the others bear no mass before the next sort
  std::vector<std::bitset<Shape<dim>::nodes>> touched;
  touched.reserve(grid.node_blocks.size());
  for (const NodeBlockOf<dim>& nb : grid.node_blocks) touched.push_back(touched_nodes(grid, nb));
  std::unordered_map<std::int64_t, std::int32_t> known;
  const auto donor = [&](const typename GridOf<dim>::Index& index) -> std::int32_t {
    for (std::size_t i = 0; i < dim; ++i)  // beyond, no point of the box reaches
      if (index[i] < -2 || index[i] > grid.cells()[i] + 2) return -1;
    const typename GridOf<dim>::NodeRef at = grid.node(index);
    if (at.block == nullptr) return -1;
    const auto block = static_cast<std::int32_t>(at.block - grid.node_blocks.data());
    if (!touched[static_cast<std::size_t>(block)][at.place]) return -1;
    const auto place = static_cast<std::int32_t>(at.place);
    const auto [found, is_new] =
        known.try_emplace(std::int64_t{block} * Shape<dim>::nodes + place, -1);
    if (is_new) {
      found->second = static_cast<std::int32_t>(layer.donors.size());
      Donor& made = layer.donors.emplace_back();
      made.block = block;
      made.place = place;
      made.velocity = along_axes<dim>(surface.velocity_at(time, position_of<dim>(index, h)));
    }
    return found->second;
  };
  const bool moves = surface.moves();
  for (std::size_t b = 0; b < grid.node_blocks.size(); ++b) {
    const NodeBlockOf<dim>& nb = grid.node_blocks[b];
    std::vector<Geometry> anew;
    const std::vector<Geometry>* geometry = &anew;
    if (moves) {
      anew = geometry_of(surface, nb, h, time);
    } else {
      const auto [found, is_new] = layer.geometry.try_emplace(nb.at);
      if (is_new) {
        found->second = geometry_of(surface, nb, h, time);
        cover(surface, layer, grid, nb);
      }
      geometry = &found->second;
    }
    for (const Geometry& as_it_lies : *geometry) {
      if (!touched[b][static_cast<std::size_t>(as_it_lies.place)]) continue;
      Ghost ghost{};
      ghost.block = static_cast<std::int32_t>(b);
      ghost.place = as_it_lies.place;
      ghost.s = as_it_lies.s;
      ghost.friction = as_it_lies.friction;
      ghost.normal = as_it_lies.normal;
      ghost.turn = as_it_lies.turn;
      const Position x = position_of<dim>(node_index<dim>(nb, ghost.place), h);
      ghost.velocity = along_axes<dim>(surface.velocity_at(time, x));
      ghost.weight = as_it_lies.weight;
      for (std::size_t k = 0; k < ghost.donor.size(); ++k)
        ghost.donor[k] = as_it_lies.free[k] ? donor(as_it_lies.donor[k]) : -1;
      layer.ghosts.push_back(ghost);
    }
  }
  list_followers(layer);
}

/// The plane is that of the map's slope over a cell, raised by twice as much as the map is found to
/// leave it at 25 places of the column and by a twentieth of a cell for what they do not show.
template <int dim>
void RigidContact<dim>::cover(const Surface& surface, Layer& layer, const GridOf<dim>& grid,
                              const NodeBlockOf<dim>& nb) {
  if constexpr (dim == 3) {
    const auto* const ground = std::get_if<Ground>(&surface.solid.shape);
    if (ground == nullptr || surface.moves() || surface.solid.hollow) return;
    const HeightMap& map = *ground->map;
    const auto columns = static_cast<std::size_t>(grid.cells()[0]);
    const double h = grid.h(), nan = std::nan("");
    if (layer.lids.empty())
      layer.lids.assign(columns * static_cast<std::size_t>(grid.cells()[2]), {nan, nan, nan});
    const auto range = [&](std::size_t axis) {
      const int first = GridOf<dim>::first(axis, nb.at[axis]);
      return std::pair{std::max(first, 0),
                       std::min(first + Shape<dim>::cells[axis], grid.cells()[axis])};
    };
    const auto [from_x, to_x] = range(0);
    const auto [from_z, to_z] = range(2);
    for (int k = from_z; k < to_z; ++k)
      for (int i = from_x; i < to_x; ++i) {
        auto& lid = layer.lids[static_cast<std::size_t>(k) * columns + static_cast<std::size_t>(i)];
        if (!std::isnan(lid.height)) continue;
        const double x = h * (i + 0.5), z = h * (k + 0.5), half = 0.5 * h;
        lid.slope_x = (map.height(x + half, z) - map.height(x - half, z)) / h;
        lid.slope_z = (map.height(x, z + half) - map.height(x, z - half)) / h;
        const double middle = map.height(x, z);
        double most = 0.0;
        for (int b = -2; b <= 2; ++b)
          for (int a = -2; a <= 2; ++a) {
            const double dx = 0.5 * half * a, dz = 0.5 * half * b;
            most = std::max(
                most, map.height(x + dx, z + dz) - middle - lid.slope_x * dx - lid.slope_z * dz);
          }
        lid.height = middle + 2.0 * most + 0.05 * h;
      }
  }
}

template <int dim>
bool RigidContact<dim>::is_above_lid([[maybe_unused]] const std::vector<Lid>& lids,
                                     [[maybe_unused]] const std::array<double*, dim>& x,
                                     [[maybe_unused]] std::size_t place) const {
  if constexpr (dim == 3) {
    // what lies below 0 wraps to the far end of the unsigned numbers
    const double at_x = x[0][place], at_z = x[2][place];
    const auto i = static_cast<std::int64_t>(at_x * per_h_ + 1.0) - 1;
    const auto k = static_cast<std::int64_t>(at_z * per_h_ + 1.0) - 1;
    const auto columns = static_cast<std::uint64_t>(cells_[0]);
    if (static_cast<std::uint64_t>(i) >= columns ||
        static_cast<std::uint64_t>(k) >= static_cast<std::uint64_t>(cells_[2]))
      return false;
    const Lid& lid = lids[static_cast<std::uint64_t>(k) * columns + static_cast<std::uint64_t>(i)];
    return x[1][place] > lid.height + lid.slope_x * (at_x - h_ * (static_cast<double>(i) + 0.5)) +
                             lid.slope_z * (at_z - h_ * (static_cast<double>(k) + 0.5));
  } else {
    return false;
  }
}

/// Every donor's sums are its own, over its ghosts in their order: the same bits for any number of
/// threads.
template <int dim>
void RigidContact<dim>::list_followers(Layer& layer) {
  layer.first_follower.assign(layer.donors.size() + 1, 0);
  const auto each = [&](auto&& f) {
    for (std::size_t g = 0; g < layer.ghosts.size(); ++g)
      for (std::size_t k = 0; k < layer.ghosts[g].donor.size(); ++k)
        if (layer.ghosts[g].donor[k] >= 0)
          f(g, k, static_cast<std::size_t>(layer.ghosts[g].donor[k]));
  };
  each([&](std::size_t, std::size_t, std::size_t donor) { ++layer.first_follower[donor + 1]; });
  std::partial_sum(layer.first_follower.begin(), layer.first_follower.end(),
                   layer.first_follower.begin());
  layer.followers.resize(layer.first_follower.back());
  std::vector<std::size_t> next(layer.first_follower.begin(), layer.first_follower.end() - 1);
  each([&](std::size_t g, std::size_t k, std::size_t donor) {
    layer.followers[next[donor]++] = {layer.ghosts[g].weight[k], static_cast<std::int32_t>(g)};
  });
}

template <int dim>
WallEffect RigidContact<dim>::apply(const Surface& surface, Layer& layer, GridOf<dim>& grid,
                                    tbb::task_arena& arena, double& work) {
  const auto block = [&](const auto& at) -> NodeBlockOf<dim>& {
    return grid.node_blocks[static_cast<std::size_t>(at.block)];
  };
  const auto mass = [&](const auto& at) {
    return block(at).mass[static_cast<std::size_t>(at.place)];
  };
  constexpr std::size_t chunk = 256;
  const auto chunks = [](std::size_t n) { return (n + chunk - 1) / chunk; };
  /// f(item, chunk) for all, a chunk a thread.
  const auto each = [&](auto& items, auto&& f) {
    for_each_block(arena, chunks(items.size()), [&](std::size_t c) {
      const std::size_t end = std::min(items.size(), (c + 1) * chunk);
      for (std::size_t n = c * chunk; n < end; ++n) f(n, c);
    });
  };
  /// Σ weight × row over the donors of a ghost, or the followers of a donor.
  const auto of_donors = [](const Ghost& ghost, auto&& row) {
    Row sum(0.0);
    for (std::size_t k = 0; k < ghost.donor.size(); ++k)
      if (ghost.donor[k] >= 0)
        sum = fma(Row(ghost.weight[k]), row(static_cast<std::size_t>(ghost.donor[k])), sum);
    return sum;
  };
  const auto of_followers = [&](std::size_t donor, const std::vector<Four>& pull) {
    Row sum(0.0);
    for (std::size_t f = layer.first_follower[donor]; f < layer.first_follower[donor + 1]; ++f) {
      const Follower& follower = layer.followers[f];
      sum = fma(Row(follower.weight), loaded(pull[static_cast<std::size_t>(follower.ghost)]), sum);
    }
    return stored<Four>(sum);
  };
  /// (f x, last).
  const auto four = [](double f, const Vector<dim>& x, double last) {
    Four row{};
    for (std::size_t i = 0; i < dim; ++i) row[i] = f * x[i];
    row.back() = last;
    return row;
  };
  for (std::vector<Four>* rows : {&layer.front, &layer.odd, &layer.even})
    rows->resize(layer.donors.size());
  for (std::vector<Four>* rows : {&layer.odd_pull, &layer.even_pull})
    rows->resize(layer.ghosts.size());
  each(layer.donors, [&](std::size_t n, std::size_t) {
    Donor& donor = layer.donors[n];
    donor.mass = mass(donor);
    Vector<dim> relative = read<dim>(block(donor).v, donor.place);
    add(relative, -1.0, donor.velocity);
    layer.front[n] = donor.mass > 0.0 ? four(1.0, relative, 1.0) : Four{};
  });
  each(layer.ghosts, [&](std::size_t n, std::size_t) {
    Ghost& ghost = layer.ghosts[n];
    layer.odd_pull[n] = layer.even_pull[n] = {};
    ghost.mass = mass(ghost);
    ghost.acts = ghost.mass > 0.0;
    if (!ghost.acts) return;
    const Four sum =
        stored<Four>(of_donors(ghost, [&](std::size_t j) { return loaded(layer.front[j]); }));
    const double borne = sum.back();  // Σ weight over those that bear mass
    Vector<dim> own = read<dim>(block(ghost).v, ghost.place), front;
    add(own, -1.0, ghost.velocity);
    // nothing in front of it that it could follow: by itself
    ghost.per_borne = borne > 1e-9 ? 1.0 / borne : 0.0;
    for (std::size_t i = 0; i < dim; ++i)
      front[i] = ghost.per_borne > 0.0 ? ghost.per_borne * sum[i] : own[i];
    const double s = ghost.per_borne > 0.0 ? ghost.s : 0.0;
    Vector<dim> even = front;
    if (ghost.per_borne > 0.0)
      for (std::size_t i = 0; i < dim; ++i) even[i] += dot(ghost.turn[i], front);
    const Lacks<dim> of =
        lacks<dim>(surface.contact, ghost.friction, own, front, even, s, ghost.normal);
    ghost.acts = !of.parts;
    ghost.odd = of.odd;
    ghost.even = of.even;
    if (!ghost.acts) return;
    const double pull = ghost.mass * ghost.per_borne;
    layer.odd_pull[n] = four(-pull * s, of.odd, pull * s * s);
    layer.even_pull[n] = four(pull, of.even, pull);
  });
  std::vector<WallEffect> effects(chunks(layer.donors.size()) + chunks(layer.ghosts.size()));
  std::vector<double> works(effects.size(), 0.0);
  /// c: of the chunk.
  const auto change = [&](const auto& at, const Vector<dim>& by, std::size_t c) {
    const Vector<dim> v = read<dim>(block(at).v, at.place);
    Vector<dim> v_new = v;
    add(v_new, 1.0, by);
    write<dim>(block(at).v, at.place, v_new);
    effects[c].kinetic_after += 0.5 * at.mass * (dot(v_new, v_new) - dot(v, v));
    effects[c].impulses +=
        0.5 * at.mass * (dot(by, read<dim>(block(at).u, at.place)) + dot(by, v_new));
    works[c] += at.mass * dot(by, at.velocity);
  };
  each(layer.donors, [&](std::size_t n, std::size_t c) {
    Donor& donor = layer.donors[n];
    layer.odd[n] = layer.even[n] = {};
    if (!(donor.mass > 0.0)) return;
    const Four odd = of_followers(n, layer.odd_pull), even = of_followers(n, layer.even_pull);
    donor.odd_mass = donor.mass + odd.back();
    donor.even_mass = donor.mass + even.back();
    Vector<dim> by;
    for (std::size_t i = 0; i < dim; ++i) {
      layer.odd[n][i] = odd[i] / donor.odd_mass;
      layer.even[n][i] = even[i] / donor.even_mass;
      by[i] = layer.odd[n][i] + layer.even[n][i];
    }
    change(donor, by, c);
  });
  each(layer.ghosts, [&](std::size_t n, std::size_t c) {
    const Ghost& ghost = layer.ghosts[n];
    if (!ghost.acts) return;
    const Row s(-ghost.s);
    const Four sum = stored<Four>(of_donors(
        ghost, [&](std::size_t j) { return fma(s, loaded(layer.odd[j]), loaded(layer.even[j])); }));
    Vector<dim> by;
    for (std::size_t i = 0; i < dim; ++i)
      by[i] = ghost.per_borne * sum[i] - ghost.odd[i] - ghost.even[i];
    change(ghost, by, chunks(layer.donors.size()) + c);
  });
  WallEffect effect;
  for (const WallEffect& of_chunk : effects) effect += of_chunk;
  work = std::accumulate(works.begin(), works.end(), work);
  return effect;
}

template <int dim>
WallEffect RigidContact<dim>::apply(GridOf<dim>& grid, double time, bool sorted,
                                    tbb::task_arena& arena, double& work) {
  WallEffect effect;
  layers_.resize(surfaces_.size());
  h_ = grid.h();
  per_h_ = 1.0 / h_;
  for (std::size_t axis = 0; axis < dim; ++axis) cells_[axis] = grid.cells()[axis];
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    if (sorted || surfaces_[k].moves()) build(surfaces_[k], layers_[k], grid, time);
    effect += apply(surfaces_[k], layers_[k], grid, arena, work);
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
    Vector<dim> turned_back = of_even;  // Aᵀ
    for (std::size_t i = 0; i < dim; ++i) add(turned_back, of_even[i], ghost.turn[i]);
    each_donor(ghost, [&](std::size_t n, double w) {
      Vector<dim> back{};
      add(back, s * w, of_odd);
      add(back, -w, turned_back);
      add_at(layer.donors[n], back);
    });
  }
}

template <int dim>
void RigidContact<dim>::transpose(GridOf<dim>& grid) const {
  for (std::size_t k = surfaces_.size(); k-- > 0;) transpose(surfaces_[k], layers_[k], grid);
}

template <int dim>
double RigidContact<dim>::keep_out(const std::array<double*, dim>& x, std::size_t count,
                                   double time, double hair) const {
  double farthest = 0.0;
  if (count == 0) return farthest;
  // one look for all, where a look is long: at the middle of the box around them
  const auto all_beyond = [&](const Surface& surface) {
    Position middle{};
    double radius2 = 0.0;
    for (std::size_t i = 0; i < dim; ++i) {
      const auto [least, most] = std::minmax_element(x[i], x[i] + count);
      middle[i] = 0.5 * (*least + *most);
      radius2 += 0.25 * (*most - *least) * (*most - *least);
    }
    return !surface.holds_at(time, middle) &&
           surface.is_beyond_at(time, middle, std::sqrt(radius2));
  };
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    const Surface& surface = surfaces_[k];
    const bool has_lids = k < layers_.size() && !layers_[k].lids.empty();
    if (surface.is_complex() && all_beyond(surface)) continue;
    for (std::size_t n = 0; n < count; ++n) {
      if (has_lids && is_above_lid(layers_[k].lids, x, n)) continue;
      Position place{};
      for (std::size_t i = 0; i < dim; ++i) place[i] = x[i][n];
      if (!surface.holds_at(time, place)) continue;
      const Nearest at = surface.nearest_at(time, place);
      for (std::size_t i = 0; i < dim; ++i) x[i][n] += (hair - at.distance) * at.normal[i];
      farthest = std::max(farthest, hair - at.distance);
    }
  }
  return farthest;
}

template class RigidContact<2>;
template class RigidContact<3>;

}  // namespace repose::mpm

#include "mpm/grid/rest.hpp"
#include "mpm/grid/tile_exchange.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {

template <int dim>
bool Simulation::Impl<dim>::sleeps() const {
  return scene.sleep_speed > 0.0 && !prescribed.acceleration;
}

template <int dim>
double Simulation::Impl<dim>::time_to_sleep() const {
  return std::sqrt(scene.h / scene.gravity);
}

template <int dim>
void Simulation::Impl<dim>::mark_sleepers() {
  // what a wall mirrors lies in the next block, and what an awake block reads in its neighbours:
  // two rings around the points awake are worth computing
  const auto around = [&](const NodeBlockOf<dim>& nb, int rings, auto&& f) {
    typename GridOf<dim>::Index near = nb.at;
    const auto along = [&](const auto& self, std::size_t axis) -> void {
      for (near[axis] = nb.at[axis] - rings; near[axis] <= nb.at[axis] + rings; ++near[axis])
        if (axis > 0)
          self(self, axis - 1);
        else if (const PointBlockOf<dim>* pb = grid.point_block(near))
          f(*pb);
    };
    along(along, dim - 1);
  };
  for (NodeBlockOf<dim>& nb : grid.node_blocks) {
    bool some_asleep = false, some_awake = false, some_near = false;
    around(nb, 1, [&](const PointBlockOf<dim>& pb) {
      (pb.rest.asleep ? some_asleep : some_awake) = true;
    });
    around(nb, 2, [&](const PointBlockOf<dim>& pb) { some_near = some_near || !pb.rest.asleep; });
    nb.asleep = !some_near;
    nb.borders = some_asleep && some_awake;
  }
}

template <int dim>
void Simulation::Impl<dim>::wake(PointBlockOf<dim>& block) {
  signals.include(block.rest.signals);
  block.rest = Rest{};
}

template <int dim>
void Simulation::Impl<dim>::wake_the_crowded() {
  for (PointBlockOf<dim>& pb : grid.point_blocks)
    if (pb.rest.asleep && pb.points() != pb.rest.count) wake(pb);
}

template <int dim>
bool Simulation::Impl<dim>::is_stirred(std::size_t block, double dt) {
  PointBlockOf<dim>& pb = grid.point_blocks[block];
  const TileOf<dim>& tile = grid.tiles[block];
  AlignedVector<double>& push = pb.rest.push;
  const double keep = std::exp(-dt / (0.1 * time_to_sleep()));
  const double limit2 = scene.sleep_speed * scene.sleep_speed;
  bool stirred = false;
  constexpr auto nodes = static_cast<std::size_t>(Shape<dim>::tile_nodes);
  for (std::size_t k = 0; k < Shape<dim>::around; ++k) {
    const std::int32_t source = pb.node_block[k];
    if (source < 0) continue;
    const NodeBlockOf<dim>& nb = grid.node_blocks[static_cast<std::size_t>(source)];
    if (!nb.borders) continue;
    if (push.empty()) push.assign(dim * nodes, 0.0);
    for_each_shared_row<dim>(Shape<dim>::neighbour(Shape<dim>::around - 1 - k),
                             [&](std::size_t node, std::size_t entry, auto columns) {
                               for (std::size_t i = 0; i < columns; ++i) {
                                 const std::size_t n = node + i;
                                 const double awake = nb.awake_mass[n];
                                 const bool counts = tile[Channels<dim>::mass][entry + i] > 0.0 &&
                                                     awake > 0.0 && 2.0 * awake <= nb.mass[n];
                                 double v2 = 0.0, push2 = 0.0;
                                 for (std::size_t c = 0; c < dim; ++c) {
                                   double& pushed = push[c * nodes + entry + i];
                                   pushed =
                                       counts ? keep * pushed + (nb.v[c][n] - nb.u[c][n]) : 0.0;
                                   v2 += nb.v[c][n] * nb.v[c][n];
                                   push2 += pushed * pushed;
                                 }
                                 if (counts && !(v2 <= limit2 && push2 <= limit2))
                                   stirred = true;  // a NaN stirs too
                               }
                             });
  }
  return stirred;
}

template <int dim>
void Simulation::Impl<dim>::sum_awake_mass(NodeBlockOf<dim>& nb) const {
  NodeTotals<1, dim> mass{};
  add_tiles<1>(grid, nb, {Channels<dim>::mass}, mass, 1,
               [](const PointBlockOf<dim>& pb) { return !pb.rest.asleep; });
  nb.awake_mass = mass[0];
}

template <int dim>
void Simulation::Impl<dim>::put_to_sleep(std::size_t block) {
  PointBlockOf<dim>& pb = grid.point_blocks[block];
  const BlockSums& sums = block_sums_[block];
  pb.rest.asleep = true;
  pb.rest.count = pb.points();
  pb.rest.signals = sums.signals;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    PointsOf<dim>& points = bodies[b];
    const SlotRange& range = pb.range[b];
    const auto stop = [&](std::size_t f) {
      for (std::size_t s = range.begin; s < range.begin + padded(range.count); ++s)
        points.set(f, s, 0.0);
    };
    using F = Layout<dim>;
    for (std::size_t i = 0; i < dim; ++i) stop(F::v + i);
    for (std::size_t i = 0; i < F::gradient; ++i) {
      stop(F::L + i);
      stop(points.affine + i);
    }
  }
  // at the whole step, as all losses between points and grid (ledger.hpp)
  ledger.transfer_loss += sums.kinetic + 0.5 * last_dt * sums.power;
  ledger.kinetic -= sums.kinetic;
  ledger.power -= sums.power;
  transfer_to_tile(block, extra(0));
  grid.tiles[block][Channels<dim>::extra].fill(0.0);  // still, they bound no step
}

template <int dim>
void Simulation::Impl<dim>::settle() {
  if (!sleeps()) return;
  bool changed = false;
  for (std::size_t k = 0; k < grid.point_blocks.size(); ++k) {
    PointBlockOf<dim>& pb = grid.point_blocks[k];
    const BlockSums& sums = block_sums_[k];
    if (pb.rest.asleep) {
      if (!sums.stirred) continue;
      wake(pb);
      changed = true;
      continue;
    }
    pb.rest.at_rest = sums.signals.speed < scene.sleep_speed ? pb.rest.at_rest + last_dt : 0.0;
    // not where its points have left the tile and wait to be sorted
    if (pb.rest.at_rest < time_to_sleep() || !sums.transferred) continue;
    put_to_sleep(k);
    changed = true;
  }
  if (changed) mark_sleepers();
}

#define REPOSE_SLEEP(DIM)                                                       \
  template void Simulation::Impl<DIM>::mark_sleepers();                         \
  template void Simulation::Impl<DIM>::wake_the_crowded();                      \
  template bool Simulation::Impl<DIM>::is_stirred(std::size_t, double);         \
  template void Simulation::Impl<DIM>::sum_awake_mass(NodeBlockOf<DIM>&) const; \
  template void Simulation::Impl<DIM>::settle();
REPOSE_SLEEP(2)
REPOSE_SLEEP(3)
#undef REPOSE_SLEEP

}  // namespace repose::mpm

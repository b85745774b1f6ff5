/// The step (transfers with moving-least-squares forces), stage by stage. P2G and G2P have files of
/// their own.

#include <numeric>

#include "mpm/grid/block_loops.hpp"
#include "mpm/grid/tile_exchange.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {

template <int dim>
void Simulation::Impl<dim>::step(double stop_at) {
  if (!(stop_at > time)) return;  // never backwards
  let_in();
  sort_if_needed();
  const double dt = choose_step(stop_at);
  if (!tiles_are_current) points_to_grid();
  update_grid(dt);
  apply_boundaries(dt);
  measure_signals();
  if constexpr (dim == 2) {
    solve_viscosity(dt);
    if (retention(dt).extended) extend_velocity();
  }
  tiles_time = time + dt >= stop_at - 1e-9 * dt ? stop_at : time + dt;
  grid_to_points(dt);
  last_dt = dt;
  dt_min = std::min(dt_min, dt);
  dt_max = std::max(dt_max, dt);
  time = tiles_time;
  ++steps;
  close_ledger();
  follow_ramp();
  observe_flow(dt * signals.speed);
}

template <int dim>
void Simulation::Impl<dim>::observe_flow(double way) {
  if constexpr (dim == 3)
    if (maps) maps->observe(bodies, time, way);
}

template <int dim>
void Simulation::Impl<dim>::sort_if_needed() {
  // a tile covers one cell around its block
  if (!must_sort && drift < reach()) return;
  if constexpr (dim == 2) {
    if (walls.periodic()) {
      const double width = grid.h() * grid.nx();
      for (PointSet& points : bodies) ledger.outflow -= wrap_points(points, width, gravity[0]);
    }
  }
  remove_outflow();
  const double anchor_offset =
      scene.kernel == Kernel::cubic ? CubicKernel::anchor_offset : QuadraticKernel::anchor_offset;
  arena.execute([&] { grid.sort(bodies, anchor_offset); });
  tiles_are_current = false;
  drift = 0.0;
  must_sort = false;
  ++sorts;
}

template <int dim>
double Simulation::Impl<dim>::choose_step(double stop_at) const {
  const double dt = scene.dt ? *scene.dt : stable_step(seen(), scene.courant, grid.h());
  // equal steps to the stop rather than a sliver at the end; 1e-9: a step that fits but for
  // round-off
  const double remaining = stop_at - time;
  if (remaining == HUGE_VAL) return dt;
  return remaining / std::max(1.0, std::ceil(remaining / dt - 1e-9));
}

template <int dim>
Retention Simulation::Impl<dim>::retention(double dt) const {
  switch (scene.transfer) {
    case Transfer::pic:
      return {false, 0.0, 0.0};
    case Transfer::flip:
      return {false, 1.0, 0.0};
    case Transfer::apic:
    case Transfer::tpic:
      return {true, 0.0, 0.0};
    case Transfer::aflip:
      return {true, 1.0, 0.0};
    case Transfer::xpic:
    case Transfer::fmpm:
      return {false, 0.0, 0.0, scene.order > 1};
    case Transfer::relaxed:
      break;
  }
  const double tau = scene.relaxation_time.value_or(default_relaxation_time(scene));
  const double keep = std::exp(-dt / tau);
  return {true, keep, keep};
}

template <int dim>
void Simulation::Impl<dim>::update_grid(double dt) {
  const Extra carries = extra(0);
  node_sums_.resize(grid.node_blocks.size());
  for_each_block(arena, grid.node_blocks.size(), [&](std::size_t k) {
    using C = Channels<dim>;
    NodeBlockOf<dim>& nb = grid.node_blocks[k];
    alignas(64) NodeTotals<C::count, dim> sum;
    std::array<std::size_t, C::count> all{};
    std::iota(all.begin(), all.end(), std::size_t{0});
    add_tiles<C::count>(grid, nb, all, sum, carries == Extra::nothing ? C::extra : C::count);
    Pack before(0.0), after(0.0), impulse_work(0.0);
    const Pack zero(0.0), half(0.5), one(1.0), step(dt);
    for (std::size_t n = 0; n < Shape<dim>::nodes; n += Pack::size) {
      const auto at = [&](std::size_t c) { return Pack::load_aligned(sum[c].data() + n); };
      const Pack m = at(C::mass);
      const auto bears = m > zero;
      const Pack inv_m = select(bears, Pack(one / select(bears, m, one)), zero);
      m.store_aligned(nb.mass.data() + n);
      m.store_aligned(nb.mirrored_mass.data() + n);
      std::array<Pack, dim> u, kick, v;
      for (std::size_t i = 0; i < dim; ++i) {
        u[i] = at(C::momentum + i) * inv_m;
        // m dv/dt = f + m g; force and mass carry the same weights, so f/m is bounded on any node
        kick[i] = step * (at(C::force + i) * inv_m + select(bears, Pack(gravity[i]), zero));
        v[i] = u[i] + kick[i];
        u[i].store_aligned(nb.u[i].data() + n);
        v[i].store_aligned(nb.v[i].data() + n);
      }
      if (carries != Extra::nothing) (at(C::extra) * inv_m).store_aligned(nb.extra.data() + n);
      before = before + half * m * dot(u, u);
      after = after + half * m * dot(v, v);
      impulse_work = impulse_work + m * dot(kick, u);
    }
    node_sums_[k] = {xsimd::hadd(before), xsimd::hadd(after), xsimd::hadd(impulse_work), 0.0};
  });
}

/// The edges come last: what they ask for holds exactly.
template <int dim>
void Simulation::Impl<dim>::apply_boundaries(double dt) {
  if constexpr (dim == 2)
    if (walls.periodic()) node_sums_.push_back(join_periodic_edges(grid));
  wall_effect_ = {};
  if (!contact.empty()) {
    const bool sorted = std::exchange(contact_sorts_, sorts) != sorts;
    wall_effect_ += contact.apply(grid, time, sorted, arena, ledger.surface_work);
  }
  wall_effect_ += apply_walls(grid, walls, retention(dt).extended ? &mirrored_ : nullptr);
}

template <int dim>
void Simulation::Impl<dim>::measure_signals() {
  if (extra(0) != Extra::signal || signals.signal == 0.0) return;
  double most = 0.0;
  for (const NodeBlockOf<dim>& nb : grid.node_blocks)
    for (const double signal2 : nb.extra) most = max_of(most, signal2);
  node_share = std::min(1.0, std::sqrt(most) / signals.signal);
}

#define REPOSE_STEP(DIM)                                            \
  template void Simulation::Impl<DIM>::step(double);                \
  template void Simulation::Impl<DIM>::observe_flow(double);        \
  template void Simulation::Impl<DIM>::sort_if_needed();            \
  template double Simulation::Impl<DIM>::choose_step(double) const; \
  template void Simulation::Impl<DIM>::update_grid(double);         \
  template Retention Simulation::Impl<DIM>::retention(double) const;
REPOSE_STEP(2)
REPOSE_STEP(3)
#undef REPOSE_STEP

}  // namespace repose::mpm

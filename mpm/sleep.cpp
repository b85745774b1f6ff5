#include "mpm/sleep.hpp"

#include "mpm/simulation_impl.hpp"
#include "mpm/tile_exchange.hpp"

namespace repose::mpm {

bool Simulation::Impl::sleeps() const {
  return scene.sleep_speed > 0.0 && !prescribed.acceleration;
}

double Simulation::Impl::time_to_sleep() const { return std::sqrt(scene.h / scene.gravity); }

void Simulation::Impl::mark_sleepers() {
  // what a wall mirrors lies in the next block, and what an awake block reads in its neighbours:
  // two rings around the points awake are worth computing
  const auto around = [&](const NodeBlock& nb, int rings, auto&& f) {
    for (int dy = -rings; dy <= rings; ++dy)
      for (int dx = -rings; dx <= rings; ++dx)
        if (const PointBlock* pb = grid.point_block(nb.bx + dx, nb.by + dy)) f(*pb);
  };
  for (NodeBlock& nb : grid.node_blocks) {
    bool some_asleep = false, some_awake = false, some_near = false;
    around(nb, 1,
           [&](const PointBlock& pb) { (pb.rest.asleep ? some_asleep : some_awake) = true; });
    around(nb, 2, [&](const PointBlock& pb) { some_near = some_near || !pb.rest.asleep; });
    nb.asleep = !some_near;
    nb.borders = some_asleep && some_awake;
  }
}

void Simulation::Impl::wake(PointBlock& block) {
  signals.include(block.rest.signals);
  block.rest = Rest{};
}

void Simulation::Impl::wake_the_crowded() {
  for (PointBlock& pb : grid.point_blocks)
    if (pb.rest.asleep && pb.points() != pb.rest.count) wake(pb);
}

bool Simulation::Impl::is_stirred(std::size_t block, double dt) {
  PointBlock& pb = grid.point_blocks[block];
  const Tile& tile = grid.tiles[block];
  AlignedVector<double>& push = pb.rest.push;
  const double keep = std::exp(-dt / (0.1 * time_to_sleep()));
  const double limit2 = scene.sleep_speed * scene.sleep_speed;
  bool stirred = false;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const std::int32_t source = pb.node_block[static_cast<std::size_t>((dy + 1) * 3 + dx + 1)];
      if (source < 0) continue;
      const NodeBlock& nb = grid.node_blocks[static_cast<std::size_t>(source)];
      if (!nb.borders) continue;
      if (push.empty()) push.assign(2 * tile_nodes, 0.0);
      for_each_shared_row(-dx, -dy, [&](std::size_t node, std::size_t entry, auto columns) {
        for (std::size_t i = 0; i < columns; ++i) {
          const std::size_t n = node + i;
          double& push_x = push[entry + i];
          double& push_y = push[tile_nodes + entry + i];
          const double awake = nb.awake_mass[n];
          if (!(tile[T_MASS][entry + i] > 0.0 && awake > 0.0 && 2.0 * awake <= nb.mass[n])) {
            push_x = push_y = 0.0;
            continue;
          }
          push_x = keep * push_x + (nb.vx[n] - nb.ux[n]);
          push_y = keep * push_y + (nb.vy[n] - nb.uy[n]);
          const double v2 = nb.vx[n] * nb.vx[n] + nb.vy[n] * nb.vy[n];
          // a NaN stirs too
          if (!(v2 <= limit2 && push_x * push_x + push_y * push_y <= limit2)) stirred = true;
        }
      });
    }
  return stirred;
}

void Simulation::Impl::sum_awake_mass(NodeBlock& nb) const {
  NodeTotals<1> mass{};
  add_tiles<1>(grid, nb, {T_MASS}, mass, 1, [](const PointBlock& pb) { return !pb.rest.asleep; });
  nb.awake_mass = mass[0];
}

void Simulation::Impl::put_to_sleep(std::size_t block) {
  PointBlock& pb = grid.point_blocks[block];
  const BlockSums& sums = block_sums_[block];
  pb.rest.asleep = true;
  pb.rest.count = pb.points();
  pb.rest.signals = sums.signals;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    PointSet& points = bodies[b];
    const Range& range = pb.range[b];
    const auto stop = [&](std::size_t f) {
      std::fill_n(points[f] + range.begin, padded(range.count), 0.0);
    };
    stop(VX);
    stop(VY);
    for (std::size_t i = 0; i < affine_fields; ++i) {
      stop(LXX + i);
      stop(points.affine + i);
    }
  }
  // at the whole step, as all losses between points and grid (ledger.hpp)
  ledger.transfer_loss += sums.kinetic + 0.5 * last_dt * sums.power;
  ledger.kinetic -= sums.kinetic;
  ledger.power -= sums.power;
  transfer_to_tile(block, extra(0));
  grid.tiles[block][T_EXTRA].fill(0.0);  // still, they bound no step
}

void Simulation::Impl::settle() {
  if (!sleeps()) return;
  bool changed = false;
  for (std::size_t k = 0; k < grid.point_blocks.size(); ++k) {
    PointBlock& pb = grid.point_blocks[k];
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

}  // namespace repose::mpm

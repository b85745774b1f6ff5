/// The explicit step (APIC with moving-least-squares forces), stage by stage.

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "mpm/body_force.hpp"
#include "mpm/simulation_impl.hpp"
#include "mpm/transfer.hpp"

namespace repose::mpm {
namespace {

/// Calls f(k) for k in [0, n) on the arena's threads; f must only write what belongs to k.
template <class F>
void for_each_block(tbb::task_arena& arena, std::size_t n, F&& f) {
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n), [&](const auto& part) {
      for (std::size_t k = part.begin(); k != part.end(); ++k) f(k);
    });
  });
}

std::array<int, 2> tile_origin(const PointBlock& pb) {
  return {Grid::first_x(pb.bx) - tile_margin, Grid::first_y(pb.by) - tile_margin};
}

/// The part of a tile that overlaps a node block in one direction: nodes [begin, end) of the block,
/// node n being tile entry n + shift. `offset` = tile's block − node block, −1, 0 or 1.
struct Overlap {
  int begin, end, shift;
  Overlap(int offset, int block_size)
      : begin(std::max(0, offset * block_size - tile_margin)),
        end(std::min(block_size, offset * block_size + block_size + 5 - tile_margin)),
        shift(tile_margin - offset * block_size) {}
};

/// What sum_up() collects, for one point or a pack of them.
template <class T>
struct PointSums {
  T kinetic = T(0.0), work = T(0.0), power = T(0.0);
  T speed = T(0.0), signal = T(0.0), viscous_rate = T(0.0);
};

template <class T>
T lanes_at(const double* from) {
  if constexpr (std::is_same_v<T, double>)
    return *from;
  else
    return T::load_unaligned(from);
}

/// The larger of two; a NaN in `x` is kept, so that it cannot slip through a maximum.
template <class T>
T max_of(const T& largest_so_far, const T& x) {
  return select(x <= largest_so_far, largest_so_far, x);
}

double largest(const Pack& x) {
  std::array<double, pack_size> lane{};
  x.store_unaligned(lane.data());
  double most = lane[0];
  for (const double y : lane) most = max_of(most, y);
  return most;
}

}  // namespace

void Simulation::Impl::step(double stop_at) {
  if (!(stop_at > time)) return;  // never backwards
  sort_if_needed();
  const double dt = choose_step(stop_at);
  points_to_grid();
  update_grid(dt);
  if (walls.periodic()) node_sums_.push_back(join_periodic_edges(grid));
  wall_effect_ = apply_walls(grid, walls);
  grid_to_points(dt);
  last_dt = dt;
  dt_min = std::min(dt_min, dt);
  dt_max = std::max(dt_max, dt);
  time = time + dt >= stop_at - 1e-9 * dt ? stop_at : time + dt;
  ++steps;
  close_ledger();
}

void Simulation::Impl::sort_if_needed() {
  // a tile covers one cell around its block; keep a little in hand for round-off
  const double reach = 0.98 * grid.h();
  if (!must_sort && drift + 2.0 * signals.speed * last_dt < reach) return;
  if (walls.periodic()) {
    const double width = grid.h() * grid.nx();
    for (PointSet& points : bodies) ledger.outflow -= wrap_points(points, width, gravity[0]);
  }
  remove_outflow();
  grid.sort(bodies);
  drift = 0.0;
  must_sort = false;
  ++sorts;
}

double Simulation::Impl::choose_step(double stop_at) const {
  const double dt = scene.dt ? *scene.dt : stable_step(signals, scene.courant, grid.h());
  // equal steps to the stop rather than a sliver at the end; 1e-9: a step that fits but for
  // round-off
  const double remaining = stop_at - time;
  if (remaining == HUGE_VAL) return dt;
  return remaining / std::max(1.0, std::ceil(remaining / dt - 1e-9));
}

Retention Simulation::Impl::retention(double dt) const {
  switch (scene.transfer) {
    case Transfer::pic:
      return {false, 0.0, 0.0};
    case Transfer::flip:
      return {false, 1.0, 0.0};
    case Transfer::apic:
      return {true, 0.0, 0.0};
    case Transfer::aflip:
      return {true, 1.0, 0.0};
    case Transfer::relaxed:
      break;
  }
  const double tau = scene.relaxation_time.value_or(default_relaxation_time(scene));
  const double keep = std::exp(-dt / tau);
  return {true, keep, keep};
}

template <class Kernel, bool affine>
void Simulation::Impl::transfer_to_tile(std::size_t block) {
  const PointBlock& pb = grid.point_blocks[block];
  Tile& tile = grid.tiles[block];
  for (auto& channel : tile) channel.fill(0.0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    points_to_tile<Kernel, affine>(bodies[b], pb.range[b], grid.h(), tile_origin(pb), tile);
    if (prescribed.acceleration)
      prescribed_force_to_tile<Kernel>(bodies[b], pb.range[b], tile_origin(pb), tile);
  }
}

template <class Kernel>
void Simulation::Impl::prescribed_force_to_tile(const PointSet& points, const Range& range,
                                                std::array<int, 2> origin, Tile& tile) const {
  if (range.count == 0) return;
  const std::size_t n = range.count;
  static thread_local std::vector<double> scratch;
  scratch.assign(4 * n, 0.0);
  const std::span<double> start[2] = {{scratch.data(), n}, {scratch.data() + n, n}};
  const std::span<double> a[2] = {{scratch.data() + 2 * n, n}, {scratch.data() + 3 * n, n}};
  for (std::size_t k = 0; k < n; ++k) {
    const auto name = static_cast<std::size_t>(points.id[range.begin + k]);
    start[0][k] = start_x[name];
    start[1][k] = start_y[name];
  }
  prescribed.acceleration(time, start[0], start[1], a[0], a[1]);
  body_force_to_tile<Kernel>(points, range, a[0], a[1], grid.h(), origin, tile);
}

void Simulation::Impl::points_to_grid() {
  for_each_block(arena, grid.point_blocks.size(), [&](std::size_t k) {
    const bool affine = retention(0.0).affine;
    if (scene.kernel == Kernel::cubic)
      affine ? transfer_to_tile<CubicKernel, true>(k) : transfer_to_tile<CubicKernel, false>(k);
    else
      affine ? transfer_to_tile<QuadraticKernel, true>(k)
             : transfer_to_tile<QuadraticKernel, false>(k);
  });
}

void Simulation::Impl::update_grid(double dt) {
  node_sums_.resize(grid.node_blocks.size());
  for_each_block(arena, grid.node_blocks.size(), [&](std::size_t k) {
    NodeBlock& nb = grid.node_blocks[k];
    // own every node: sum what the tiles around put on it, always in the same order
    std::array<std::array<double, block_nodes>, tile_channels> sum{};
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const std::int32_t source = nb.point_block[static_cast<std::size_t>((dy + 1) * 3 + dx + 1)];
        if (source < 0) continue;
        const Tile& tile = grid.tiles[static_cast<std::size_t>(source)];
        const Overlap ox(dx, block_nx);
        const Overlap oy(dy, block_ny);
        for (std::size_t c = 0; c < tile_channels; ++c)
          for (int j = oy.begin; j < oy.end; ++j) {
            const double* from = tile[c].data() + (j + oy.shift) * tile_stride + ox.shift;
            double* to = sum[c].data() + j * block_nx;
            for (int i = ox.begin; i < ox.end; ++i) to[i] += from[i];
          }
      }
    NodeSums sums;
    for (std::size_t n = 0; n < block_nodes; ++n) {
      const double m = sum[T_MASS][n];
      const double inv_m = m > 0.0 ? 1.0 / m : 0.0;
      const double ux = sum[T_PX][n] * inv_m;
      const double uy = sum[T_PY][n] * inv_m;
      // m dv/dt = f + m g; force and mass carry the same weights, so f/m is bounded on any node
      const double wx = m > 0.0 ? ux + dt * (sum[T_FX][n] * inv_m + gravity[0]) : 0.0;
      const double wy = m > 0.0 ? uy + dt * (sum[T_FY][n] * inv_m + gravity[1]) : 0.0;
      nb.mass[n] = m;
      nb.mirrored_mass[n] = m;
      nb.ux[n] = ux;
      nb.uy[n] = uy;
      nb.vx[n] = wx;
      nb.vy[n] = wy;
      sums.before += 0.5 * m * (ux * ux + uy * uy);
      sums.after += 0.5 * m * (wx * wx + wy * wy);
      sums.impulse_work += m * ((wx - ux) * ux + (wy - uy) * uy);
    }
    node_sums_[k] = sums;
  });
}

void Simulation::Impl::grid_to_points(double dt) {
  block_sums_.assign(grid.point_blocks.size(), BlockSums{});
  for_each_block(arena, grid.point_blocks.size(), [&](std::size_t k) {
    const bool keeps = retention(dt).velocity > 0.0;
    if (scene.kernel == Kernel::cubic)
      keeps ? advance_block<CubicKernel, true>(k, dt, block_sums_[k])
            : advance_block<CubicKernel, false>(k, dt, block_sums_[k]);
    else
      keeps ? advance_block<QuadraticKernel, true>(k, dt, block_sums_[k])
            : advance_block<QuadraticKernel, false>(k, dt, block_sums_[k]);
  });
}

template <class Kernel, bool keeps>
void Simulation::Impl::advance_block(std::size_t block, double dt, BlockSums& sums) {
  const PointBlock& pb = grid.point_blocks[block];
  VelocityTile tile;
  tile.vx.fill(0.0);
  tile.vy.fill(0.0);
  if (keeps) {
    tile.ux.fill(0.0);
    tile.uy.fill(0.0);
  }
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const std::int32_t source = pb.node_block[static_cast<std::size_t>((dy + 1) * 3 + dx + 1)];
      if (source < 0) continue;
      const NodeBlock& nb = grid.node_blocks[static_cast<std::size_t>(source)];
      // seen from the node block, this tile's block lies at (−dx, −dy)
      const Overlap ox(-dx, block_nx);
      const Overlap oy(-dy, block_ny);
      for (int j = oy.begin; j < oy.end; ++j)
        for (int i = ox.begin; i < ox.end; ++i) {
          const auto to = static_cast<std::size_t>((j + oy.shift) * tile_stride + i + ox.shift);
          const auto from = static_cast<std::size_t>(j * block_nx + i);
          tile.vx[to] = nb.vx[from];
          tile.vy[to] = nb.vy[from];
          if (keeps) {
            tile.ux[to] = nb.ux[from];
            tile.uy[to] = nb.uy[from];
          }
        }
    }

  static thread_local std::vector<double> scratch;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    PointSet& points = bodies[b];
    const Range& range = pb.range[b];
    if (range.count == 0) continue;
    const std::size_t n = padded(range.count);
    scratch.assign(10 * n, 0.0);
    const Motion motion{scratch.data() + 8 * n, scratch.data() + 9 * n};
    tile_to_points<Kernel, keeps>(tile, tile_origin(pb), grid.h(), range, retention(dt), points,
                                  motion);
    move(points, range, motion, dt, sums);

    // strain and spin of the step, then the law
    double* const e_xx = scratch.data();
    double* const e_yy = e_xx + n;
    double* const e_zz = e_yy + n;  // plane strain: stays 0
    double* const e_xy = e_zz + n;
    double* const spin = e_xy + n;
    double* const work = spin + n;
    double* const modulus = work + n;
    double* const viscosity = modulus + n;
    for (std::size_t k = 0; k < range.count; ++k) {
      const std::size_t s = range.begin + k;
      // The step maps x to x + Δt v(x), whose gradient is I + A, A = Δt L: its logarithm is A −
      // ½A², to third order in Δt. (A alone would make density and strain first order in Δt.)
      const double xx = dt * points[LXX][s], xy = dt * points[LXY][s];
      const double yx = dt * points[LYX][s], yy = dt * points[LYY][s];
      const double turn = 0.5 * xy * yx, half_tr = 0.5 * (xx + yy);
      const double l_xy = xy - half_tr * xy, l_yx = yx - half_tr * yx;
      e_xx[k] = xx - 0.5 * xx * xx - turn;
      e_yy[k] = yy - 0.5 * yy * yy - turn;
      e_xy[k] = 0.5 * (l_xy + l_yx);
      spin[k] = 0.5 * (l_yx - l_xy);
    }
    const bool viscous = !points.material->law().has_stress_memory;
    Batch batch = points.batch(range);
    batch.dt = dt;
    batch.strain = {e_xx, e_yy, e_zz, e_xy};
    batch.spin = spin;
    batch.work = work;
    batch.modulus = modulus;
    batch.viscosity = viscous ? viscosity : nullptr;
    const UpdateReport report = points.material->update(batch);
    if (!report.ok() && sums.failure.empty()) {
      const std::size_t k = report.failed;
      sums.failure = fmt::format(
          "the stress of {} could not be updated for the strain increment xx {:.6g}, yy {:.6g}, xy "
          "{:.6g} "
          "in {:.3g} s",
          describe(points, b, range.begin + k), e_xx[k], e_yy[k], e_xy[k], dt);
    }
    // A point alone in its stencil has the density m Σw²/h² (Σw² = 0.21 to 0.25, cubic; more,
    // quadratic); looser than that the grid cannot tell, and spray would dilate without end.
    const double inv_h2 = 1.0 / (grid.h() * grid.h());
    for (std::size_t s = range.begin; s < range.begin + range.count; ++s) {
      const double loosest = 0.2 * points[MASS][s] * inv_h2;
      if (points[RHO][s] < loosest) points[RHO][s] = loosest;
    }
    sum_up(points, range, batch, motion, viscous, sums);
  }
}

void Simulation::Impl::sum_up(const PointSet& points, const Range& range, const Batch& batch,
                              const Motion& motion, bool viscous, BlockSums& sums) const {
  const double viscous_factor = 4.0 / (grid.h() * grid.h());
  // whole packs first, the rest one by one; the order is fixed, so the sums are too
  const auto add = [&]<class T>(PointSums<T>& total, std::size_t k) {
    const std::size_t s = range.begin + k;
    const auto at = [&](Field f) { return lanes_at<T>(points[f] + s); };
    const T m = at(MASS);
    const T inv_rho = T(1.0) / at(RHO);
    const T vx = at(VX);
    const T vy = at(VY);
    const T v2 = vx * vx + vy * vy;
    const T moving_x = lanes_at<T>(motion.vx + k);
    const T moving_y = lanes_at<T>(motion.vy + k);
    const T strain_v = lanes_at<T>(batch.strain[0] + k) + lanes_at<T>(batch.strain[1] + k);
    total.kinetic = total.kinetic + T(0.5) * m * v2;
    // ∫σ:D dV over the mean volume of the step, V = m/ρ e^{−½tr Δε}
    total.work =
        total.work + m * inv_rho * (T(1.0) - T(0.5) * strain_v) * lanes_at<T>(batch.work + k);
    const T stress_power = at(SXX) * at(LXX) + at(SYY) * at(LYY) + at(SXY) * (at(LXY) + at(LYX));
    total.power = total.power + m * (T(gravity[0]) * moving_x + T(gravity[1]) * moving_y -
                                     stress_power * inv_rho);
    const T speed = sqrt(moving_x * moving_x + moving_y * moving_y);
    total.speed = max_of(total.speed, speed);
    total.signal = max_of(total.signal, T(speed + sqrt(lanes_at<T>(batch.modulus + k) * inv_rho)));
    if (viscous)
      total.viscous_rate = max_of(
          total.viscous_rate, T(T(viscous_factor) * lanes_at<T>(batch.viscosity + k) * inv_rho));
  };
  PointSums<Pack> packs;
  PointSums<double> rest;
  std::size_t k = 0;
  for (; k + pack_size <= range.count; k += pack_size) add(packs, k);
  for (; k < range.count; ++k) add(rest, k);
  sums.kinetic += xsimd::hadd(packs.kinetic) + rest.kinetic;
  sums.work += xsimd::hadd(packs.work) + rest.work;
  sums.power += xsimd::hadd(packs.power) + rest.power;
  sums.signals.include({largest(packs.speed), largest(packs.signal), largest(packs.viscous_rate)});
  sums.signals.include({rest.speed, rest.signal, rest.viscous_rate});
}

void Simulation::Impl::move(PointSet& points, const Range& range, const Motion& motion, double dt,
                            BlockSums& sums) const {
  // a closed wall is never crossed: the interpolated velocity vanishes on it, and what round-off or
  // an impact faster than one cell per step does is undone here and counted
  const double hair = 1e-9 * grid.h();
  const double width = grid.h() * grid.nx();
  const double height = grid.h() * grid.ny();
  const auto keep = [&](double& x, double lower, double upper, const Wall& low, const Wall& high) {
    if (low.kind == Wall::Kind::periodic) return;  // wrapped when points are sorted
    if (x < lower + hair) {
      if (low.kind == Wall::Kind::open) {
        sums.outflow = sums.outflow || x < lower;
      } else {
        if (x < lower) ++sums.corrections;
        x = lower + hair;
      }
    } else if (x > upper - hair) {
      if (high.kind == Wall::Kind::open) {
        sums.outflow = sums.outflow || x > upper;
      } else {
        if (x > upper) ++sums.corrections;
        x = upper - hair;
      }
    }
  };
  for (std::size_t s = range.begin; s < range.begin + range.count; ++s) {
    double x = points[X][s] + dt * motion.vx[s - range.begin];
    double y = points[Y][s] + dt * motion.vy[s - range.begin];
    keep(x, 0.0, width, walls.left, walls.right);
    keep(y, 0.0, height, walls.floor, walls.top);
    points[X][s] = x;
    points[Y][s] = y;
  }
}

void Simulation::Impl::close_ledger() {
  double kinetic = 0.0;
  double work = 0.0;
  double power = 0.0;
  Signals now;
  const std::string* failure = nullptr;
  for (const BlockSums& sums : block_sums_) {
    if (failure == nullptr && !sums.failure.empty()) failure = &sums.failure;
    kinetic += sums.kinetic;
    work += sums.work;
    power += sums.power;
    now.include(sums.signals);
    wall_corrections += sums.corrections;
    must_sort = must_sort || sums.outflow;
  }
  NodeSums nodes;
  for (const NodeSums& part : node_sums_) {
    nodes.before += part.before;
    nodes.after += part.after;
    nodes.impulse_work += part.impulse_work;
  }
  // at the whole step, with half a kick on both sides (ledger.hpp)
  const double points_to_nodes =
      (ledger.kinetic + 0.5 * last_dt * ledger.power) - (nodes.before + 0.5 * nodes.impulse_work);
  const double nodes_to_points = nodes.after + wall_effect_.kinetic_after - kinetic;
  const double mirrored = wall_effect_.kinetic_before + 0.5 * wall_effect_.impulse_work;
  const double kept = retention(last_dt).velocity;  // what points keep, no mirror takes
  ledger.transfer_loss += points_to_nodes + nodes_to_points - kept * mirrored;
  ledger.wall_loss -= (1.0 - kept) * mirrored;
  ledger.wall_loss -= wall_effect_.drag_after - kept * wall_effect_.drag_before;
  ledger.kinetic = kinetic;
  ledger.power = power;
  ledger.stress_work += work;
  drift += now.speed * last_dt;
  if (scene.dt) {
    fixed_step_excess = std::max(fixed_step_excess, last_dt * now.signal / grid.h());
    viscous_step_excess = std::max(viscous_step_excess, last_dt * now.viscous_rate);
  }
  signals = now;
  for (const PointSet& points : bodies) point_steps += static_cast<std::int64_t>(points.count);

  const char* cause = "the integration diverges (solver); try a smaller courant";
  if (scene.dt && fixed_step_excess > 0.8)
    cause =
        "the fixed step dt is too large for the wave speed (input); try a smaller dt, or courant "
        "instead of dt";
  else if (scene.dt && viscous_step_excess > 1.0)
    cause =
        "the fixed step dt is too large for the viscosity (input); try a smaller dt, or courant "
        "instead of dt";
  else if (scene.dt)
    cause = "the integration diverges (solver); try a smaller dt";
  // Divergence: kinetic energy beyond all energy that the scene can turn into motion, or a signal
  // so fast that the step shrinks to nothing (not the last step before a stop, which may be as
  // short as it likes). Also catches NaN (the comparisons are false).
  const bool sound = kinetic <= 2.0 * highest_energy &&
                     (scene.dt || stable_step(now, scene.courant, grid.h()) >= 1e-9 * first_dt);
  must_sort = must_sort || failure != nullptr || !sound;  // drift may be NaN: look at every point
  if (failure != nullptr)
    throw NumericalFailure(
        fmt::format("step {} at t = {:.6g} s: {}: {}", steps, time, *failure, cause));
  if (!sound)
    throw NumericalFailure(fmt::format(
        "step {} at t = {:.6g} s: kinetic energy {:.4g} J/m against {:.4g} J/m available, dt "
        "{:.3g} s, Courant number {:.3g}: {}",
        steps, time, kinetic, highest_energy, last_dt, last_dt * now.signal / grid.h(), cause));
}

}  // namespace repose::mpm

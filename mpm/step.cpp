/// The step (transfers with moving-least-squares forces), stage by stage.

#include <fmt/format.h>

#include "mpm/block_loops.hpp"
#include "mpm/body_force.hpp"
#include "mpm/pressure_averaging.hpp"
#include "mpm/simulation_impl.hpp"
#include "mpm/tile_exchange.hpp"
#include "mpm/transfer.hpp"

namespace repose::mpm {
namespace {

/// Calls f with the interpolation functions of a scene, and with whether points hand on an affine
/// velocity and whether pressures are averaged as constants, all chosen at run time.
template <class F>
void choose(const Scene& scene, bool affine, bool averages, F&& f) {
  using Yes = std::true_type;
  using No = std::false_type;
  const auto with = [&](auto kernel, auto is_affine) {
    averages ? f(kernel, is_affine, Yes{}) : f(kernel, is_affine, No{});
  };
  const auto with_either = [&](auto kernel) { affine ? with(kernel, Yes{}) : with(kernel, No{}); };
  const bool cubic = scene.kernel == Kernel::cubic;
  if (scene.transfer == Transfer::tpic)  // always affine
    cubic ? with(SplineGradient<CubicKernel>{}, Yes{})
          : with(SplineGradient<QuadraticKernel>{}, Yes{});
  else
    cubic ? with_either(CubicKernel{}) : with_either(QuadraticKernel{});
}

/// The larger of two; a NaN in `x` is kept, so that it cannot slip through a maximum.
template <class T>
T max_of(const T& largest_so_far, const T& x) {
  return select(x > largest_so_far || x != x, x, largest_so_far);
}

/// The smaller of two; a NaN in `x` is kept.
Pack min_of(const Pack& smallest_so_far, const Pack& x) {
  return select(x < smallest_so_far || x != x, x, smallest_so_far);
}

double largest(const Pack& x) {
  alignas(Pack) std::array<double, Pack::size> lane;
  x.store_aligned(lane.data());
  double most = lane[0];
  for (const double y : lane) most = max_of(most, y);
  return most;
}

/// 1 in the lanes that hold a point, 0 in those that hold padding.
Pack points_of_pack(std::size_t first, std::size_t count) {
  alignas(Pack) static constexpr auto one_then_zero = [] {
    std::array<double, 2 * Pack::size> x{};
    for (std::size_t k = 0; k < Pack::size; ++k) x[k] = 1.0;
    return x;
  }();
  const std::size_t points = std::min(Pack::size, count - first);
  return Pack::load_unaligned(one_then_zero.data() + Pack::size - points);
}

}  // namespace

void Simulation::Impl::step(double stop_at) {
  if (!(stop_at > time)) return;  // never backwards
  sort_if_needed();
  const double dt = choose_step(stop_at);
  if (!tiles_are_current) points_to_grid();
  update_grid(dt);
  if (walls.periodic()) node_sums_.push_back(join_periodic_edges(grid));
  const bool extends = retention(dt).extended;
  wall_effect_ = apply_walls(grid, walls, extends ? &mirrored_ : nullptr);
  measure_signals();
  solve_viscosity(dt);
  if (extends) extend_velocity();
  tiles_time = time + dt >= stop_at - 1e-9 * dt ? stop_at : time + dt;
  grid_to_points(dt);
  last_dt = dt;
  dt_min = std::min(dt_min, dt);
  dt_max = std::max(dt_max, dt);
  time = tiles_time;
  ++steps;
  close_ledger();
  settle();
}

void Simulation::Impl::sort_if_needed() {
  // a tile covers one cell around its block
  if (!must_sort && drift < reach()) return;
  if (walls.periodic()) {
    const double width = grid.h() * grid.nx();
    for (PointSet& points : bodies) ledger.outflow -= wrap_points(points, width, gravity[0]);
  }
  remove_outflow();
  grid.sort(bodies);
  wake_the_crowded();
  mark_sleepers();
  tiles_are_current = false;
  drift = 0.0;
  must_sort = false;
  ++sorts;
}

double Simulation::Impl::choose_step(double stop_at) const {
  const double dt = scene.dt ? *scene.dt : stable_step(seen(), scene.courant, grid.h());
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

template <class Kernel, bool affine, Simulation::Impl::Extra extra>
void Simulation::Impl::transfer_to_tile(std::size_t block) {
  const PointBlock& pb = grid.point_blocks[block];
  Tile& tile = grid.tiles[block];
  constexpr bool has_extra = extra != Extra::nothing;
  for (std::size_t c = 0; c < T_EXTRA + has_extra; ++c) tile[c].fill(0.0);
  static thread_local AlignedVector<double> values;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Range& range = pb.range[b];
    if constexpr (has_extra) values.resize(std::max(values.size(), padded(range.count)));
    if constexpr (extra == Extra::elastic)
      bodies[b].material->elastic_volume_strain(bodies[b].batch(range), values.data());
    if constexpr (extra == Extra::signal) square_signals(bodies[b], range, values.data());
    points_to_tile<Kernel, affine, has_extra>(bodies[b], range, grid.h(), tile_origin(pb),
                                              values.data(), tile);
    if (prescribed.acceleration)
      prescribed_force_to_tile<Kernel>(bodies[b], range, tile_origin(pb), tile);
  }
}

void Simulation::Impl::square_signals(PointSet& points, const Range& range, double* signal2) {
  points.material->modulus(points.batch(range), signal2);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const auto at = [&](Field f) { return Pack::load_aligned(points[f] + range.begin + k); };
    const Pack c = sqrt(Pack::load_aligned(signal2 + k) / at(RHO));
    const Pack signal = c + sqrt(at(VX) * at(VX) + at(VY) * at(VY));
    (signal * signal).store_aligned(signal2 + k);
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
  prescribed.acceleration(tiles_time, start[0], start[1], a[0], a[1]);
  body_force_to_tile<Kernel>(points, range, a[0], a[1], grid.h(), origin, tile);
}

void Simulation::Impl::points_to_grid() {
  tiles_time = time;
  for_each_block(arena, grid.point_blocks.size(),
                 [&](std::size_t k) { transfer_to_tile(k, extra(0)); });
}

void Simulation::Impl::transfer_to_tile(std::size_t block, Extra extra) {
  choose(scene, retention(0.0).affine, averages(), [&]<class K>(K, auto affine, auto averages) {
    if constexpr (averages.value)
      transfer_to_tile<K, affine.value, Extra::elastic>(block);
    else if (extra == Extra::signal)
      transfer_to_tile<K, affine.value, Extra::signal>(block);
    else
      transfer_to_tile<K, affine.value, Extra::nothing>(block);
  });
}

void Simulation::Impl::update_grid(double dt) {
  const Extra carries = extra(0);
  node_sums_.resize(grid.node_blocks.size());
  for_each_block(arena, grid.node_blocks.size(), [&](std::size_t k) {
    NodeBlock& nb = grid.node_blocks[k];
    if (nb.asleep) {
      for (auto* field : {&nb.mass, &nb.mirrored_mass, &nb.ux, &nb.uy, &nb.vx, &nb.vy, &nb.extra})
        field->fill(0.0);
      node_sums_[k] = {};
      return;
    }
    if (nb.borders) sum_awake_mass(nb);
    alignas(64) NodeTotals<tile_channels> sum{};
    add_tiles<tile_channels>(grid, nb, {T_MASS, T_PX, T_PY, T_FX, T_FY, T_EXTRA}, sum,
                             carries == Extra::nothing ? T_EXTRA : tile_channels);
    Pack before(0.0), after(0.0), impulse_work(0.0);
    const Pack zero(0.0), half(0.5), one(1.0), step(dt);
    for (std::size_t n = 0; n < block_nodes; n += Pack::size) {
      const auto at = [&](TileChannel c) { return Pack::load_aligned(sum[c].data() + n); };
      const Pack m = at(T_MASS);
      const auto bears = m > zero;
      const Pack inv_m = select(bears, Pack(one / select(bears, m, one)), zero);
      const Pack ux = at(T_PX) * inv_m;
      const Pack uy = at(T_PY) * inv_m;
      // m dv/dt = f + m g; force and mass carry the same weights, so f/m is bounded on any node
      const Pack ax = at(T_FX) * inv_m + select(bears, Pack(gravity[0]), zero);
      const Pack ay = at(T_FY) * inv_m + select(bears, Pack(gravity[1]), zero);
      const Pack kick_x = step * ax;
      const Pack kick_y = step * ay;
      const Pack wx = ux + kick_x;
      const Pack wy = uy + kick_y;
      m.store_aligned(nb.mass.data() + n);
      m.store_aligned(nb.mirrored_mass.data() + n);
      ux.store_aligned(nb.ux.data() + n);
      uy.store_aligned(nb.uy.data() + n);
      wx.store_aligned(nb.vx.data() + n);
      wy.store_aligned(nb.vy.data() + n);
      if (carries != Extra::nothing) (at(T_EXTRA) * inv_m).store_aligned(nb.extra.data() + n);
      before = before + half * m * (ux * ux + uy * uy);
      after = after + half * m * (wx * wx + wy * wy);
      impulse_work = impulse_work + m * (kick_x * ux + kick_y * uy);
    }
    node_sums_[k] = {xsimd::hadd(before), xsimd::hadd(after), xsimd::hadd(impulse_work), 0.0};
  });
}

void Simulation::Impl::measure_signals() {
  if (extra(0) != Extra::signal || signals.signal == 0.0) return;
  double most = 0.0;
  for (const NodeBlock& nb : grid.node_blocks)
    for (const double signal2 : nb.extra) most = max_of(most, signal2);
  node_share = std::min(1.0, std::sqrt(most) / signals.signal);
}

void Simulation::Impl::grid_to_points(double dt) {
  block_sums_.assign(grid.point_blocks.size(), BlockSums{});
  const Retention keep = retention(dt);
  const Extra carries_next = extra(1);
  const auto advance = [&]<class Kernel>(Kernel, auto affine, auto averages, std::size_t k) {
    BlockSums& sums = block_sums_[k];
    if constexpr (Kernel::spline_gradient)  // of tpic, which keeps nothing
      advance_block<Kernel, Keeps::nothing, averages.value>(k, dt, keep, sums);
    else if (keep.gradient > 0.0)
      advance_block<Kernel, Keeps::velocity_and_gradient, averages.value>(k, dt, keep, sums);
    else if (keep.velocity > 0.0)
      advance_block<Kernel, Keeps::velocity, averages.value>(k, dt, keep, sums);
    else if (keep.extended && scene.transfer == Transfer::xpic)
      advance_block<Kernel, Keeps::extension, averages.value>(k, dt, keep, sums);
    else
      advance_block<Kernel, Keeps::nothing, averages.value>(k, dt, keep, sums);
    // While the points of the block are in the cache: their way to the grid of the next step. If
    // any of them has left the tile, all blocks are sorted first (sort_if_needed), and this waits.
    sums.transferred = drift + sums.signals.speed * dt < reach() && sums.failure.empty();
    if (!sums.transferred) return;
    if constexpr (averages.value)
      transfer_to_tile<Kernel, affine.value, Extra::elastic>(k);
    else if (carries_next == Extra::signal)
      transfer_to_tile<Kernel, affine.value, Extra::signal>(k);
    else
      transfer_to_tile<Kernel, affine.value, Extra::nothing>(k);
  };
  for_each_block(arena, grid.point_blocks.size(), [&](std::size_t k) {
    if (grid.point_blocks[k].rest.asleep) {
      block_sums_[k].transferred = true;
      block_sums_[k].stirred = is_stirred(k, dt);
      return;
    }
    choose(scene, keep.affine, averages(),
           [&](auto kernel, auto affine, auto averages) { advance(kernel, affine, averages, k); });
  });
  tiles_are_current = std::all_of(block_sums_.begin(), block_sums_.end(),
                                  [](const BlockSums& sums) { return sums.transferred; });
}

template <class Kernel, Keeps keeps, bool averages>
void Simulation::Impl::advance_block(std::size_t block, double dt, const Retention& keep,
                                     BlockSums& sums) {
  const PointBlock& pb = grid.point_blocks[block];
  VelocityTile tile;
  const auto fill = [&](std::array<double, tile_nodes> VelocityTile::*field,
                        auto NodeBlock::*from) {
    fill_tile(pb, tile.*field, [&](std::size_t k) { return (grid.node_blocks[k].*from).data(); });
  };
  fill(&VelocityTile::vx, &NodeBlock::vx);
  fill(&VelocityTile::vy, &NodeBlock::vy);
  if constexpr (keeps != Keeps::nothing) {
    fill(&VelocityTile::ux, &NodeBlock::ux);
    fill(&VelocityTile::uy, &NodeBlock::uy);
  }
  if constexpr (averages) fill(&VelocityTile::elastic, &NodeBlock::extra);

  static thread_local AlignedVector<double> scratch;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Range& range = pb.range[b];
    if (range.count == 0) continue;
    const std::size_t n = padded(range.count);
    if (scratch.size() < scratch_arrays * n) scratch.resize(scratch_arrays * n);
    const Motion motion{scratch.data(), scratch.data() + n, scratch.data() + 2 * n};
    tile_to_points<Kernel, keeps, averages>(tile, tile_origin(pb), grid.h(), range, keep, bodies[b],
                                            motion);
    move(bodies[b], range, motion, dt, sums);
    strain(bodies[b], b, range, motion, dt, scratch.data() + 3 * n, sums);
  }
}

void Simulation::Impl::move(PointSet& points, const Range& range, const Motion& motion, double dt,
                            BlockSums& sums) const {
  // a closed wall is never crossed: the interpolated velocity vanishes on it, and what round-off or
  // an impact faster than one cell per step does is undone here and counted
  const double hair = 1e-9 * grid.h();
  const double width = grid.h() * grid.nx();
  const double height = grid.h() * grid.ny();
  const auto keep = [&](double& x, double upper, const Wall& low, const Wall& high, bool counts) {
    if (low.kind == Wall::Kind::periodic) return;  // wrapped when points are sorted
    if (x < hair) {
      if (low.kind == Wall::Kind::open) {
        sums.outflow = sums.outflow || x < 0.0;
      } else {
        if (x < 0.0 && counts) ++sums.corrections;
        x = hair;
      }
    } else if (x > upper - hair) {
      if (high.kind == Wall::Kind::open) {
        sums.outflow = sums.outflow || x > upper;
      } else {
        if (x > upper && counts) ++sums.corrections;
        x = upper - hair;
      }
    }
  };
  const Pack step(dt), low(hair), right(width - hair), top(height - hair);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const std::size_t s = range.begin + k;
    const Pack x = Pack::load_aligned(points[X] + s) + step * Pack::load_aligned(motion.vx + k);
    const Pack y = Pack::load_aligned(points[Y] + s) + step * Pack::load_aligned(motion.vy + k);
    x.store_aligned(points[X] + s);
    y.store_aligned(points[Y] + s);
    if (!any(x < low || x > right || y < low || y > top)) continue;
    for (std::size_t i = 0; i < Pack::size; ++i) {
      keep(points[X][s + i], width, walls.left, walls.right, k + i < range.count);
      keep(points[Y][s + i], height, walls.floor, walls.top, k + i < range.count);
    }
  }
}

void Simulation::Impl::strain(PointSet& points, std::size_t body, const Range& range,
                              const Motion& motion, double dt, double* scratch,
                              BlockSums& sums) const {
  const std::size_t n = padded(range.count);
  double* const e_xx = scratch;
  double* const e_yy = e_xx + n;
  double* const e_zz = e_yy + n;  // plane strain: 0 but for shares of a volume strain
  double* const e_xy = e_zz + n;
  double* const spin = e_xy + n;
  double* const work = spin + n;
  double* const modulus = work + n;
  double* const viscosity = modulus + n;
  // The step maps x to x + Δt v(x), whose gradient is I + A, A = Δt L: its logarithm is A − ½A², to
  // third order in Δt. (A alone would make density and strain first order in Δt.) A viscous law
  // takes only the volume from it, and the rest from D = sym L, which is what its stress follows.
  const bool follows_rate = !points.material->law().has_stress_memory;
  const Pack step(dt), half(0.5), third(1.0 / 3.0), zero(0.0);
  Pack least_volume(1.0);  // det(I + A)
  std::fill_n(e_zz, n, 0.0);
  if (n - range.count >= Pack::size)  // padding that no pack of points reaches is at rest
    for (double* const array : {e_xx, e_yy, e_xy, spin})
      std::fill_n(array + n - Pack::size, Pack::size, 0.0);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const auto at = [&](Field f) { return step * Pack::load_aligned(points[f] + range.begin + k); };
    const Pack xx = at(LXX);
    const Pack xy = at(LXY);
    const Pack yx = at(LYX);
    const Pack yy = at(LYY);
    // −½A²: xx, yy, and what the off-diagonal terms are multiplied by
    Pack c_xx = -half * (xx * xx + xy * yx);
    Pack c_yy = -half * (yy * yy + xy * yx);
    Pack c = -half * (xx + yy);
    if (follows_rate) {  // its volume only, the same in all three directions
      c_xx = c_yy = third * (c_xx + c_yy);
      c = zero;
      c_xx.store_aligned(e_zz + k);
    }
    least_volume = min_of(least_volume, (Pack(1.0) + xx) * (Pack(1.0) + yy) - xy * yx);
    (xx + c_xx).store_aligned(e_xx + k);
    (yy + c_yy).store_aligned(e_yy + k);
    const Pack share = half * (Pack(1.0) + c);
    (share * (xy + yx)).store_aligned(e_xy + k);
    (share * (yx - xy)).store_aligned(spin + k);
  }
  if (any(!(least_volume > zero)) && sums.failure.empty())
    sums.failure = fmt::format(
        "a step of {:.3g} s turns a point of {} inside out: det(I + dt grad v) = {:.3g}", dt,
        body_names[body], least(least_volume));
  Batch batch = points.batch(range);
  batch.dt = dt;
  batch.strain = {e_xx, e_yy, e_zz, e_xy};
  batch.spin = spin;
  batch.work = work;
  batch.modulus = modulus;
  const bool viscous = !points.material->law().has_stress_memory && !points.splits_stress();
  batch.viscosity = viscous ? viscosity : nullptr;
  double* const pressure_before = viscosity + n;
  if (averages())
    add_averaging_strain(*points.material, batch, scene.pressure_averaging, motion.elastic,
                         pressure_before, {e_xx, e_yy, e_zz, e_xy});
  const UpdateReport report = points.material->update(batch);
  if (!report.ok() && sums.failure.empty()) {
    const std::size_t k = report.failed;
    sums.failure = fmt::format(
        "the stress of {} could not be updated for the strain increment xx {:.6g}, yy {:.6g}, xy "
        "{:.6g} in {:.3g} s",
        describe(points, body, range.begin + k), e_xx[k], e_yy[k], e_xy[k], dt);
  }
  if (points.splits_stress()) split_stress(points, range, batch);
  if (averages()) take_back_averaging_work(batch, motion.elastic, pressure_before);
  // A point alone in its stencil has the density m Σw²/h² (Σw² = 0.21 to 0.25, cubic; more,
  // quadratic); looser than that the grid cannot tell, and spray would dilate without end.
  const Pack per_cell(0.2 / (grid.h() * grid.h()));
  for (std::size_t s = range.begin; s < range.begin + range.count; s += Pack::size) {
    const Pack loosest = per_cell * Pack::load_aligned(points[MASS] + s);
    const Pack rho = Pack::load_aligned(points[RHO] + s);
    select(rho < loosest, loosest, rho).store_aligned(points[RHO] + s);
  }
  sum_up(points, range, batch, motion, sums);
}

void Simulation::Impl::sum_up(const PointSet& points, const Range& range, const Batch& batch,
                              const Motion& motion, BlockSums& sums) const {
  const bool follows_rate = !points.material->law().has_stress_memory;
  const Pack half(0.5), third(1.0 / 3.0), one(1.0), zero(0.0), step(batch.dt), gx(gravity[0]),
      gy(gravity[1]);
  const Pack viscous_factor(4.0 / (grid.h() * grid.h()));
  Pack kinetic(0.0), work(0.0), power(0.0);
  Pack speed2(0.0), signal(0.0), viscous_rate(0.0);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const auto at = [&](Field f) { return Pack::load_aligned(points[f] + range.begin + k); };
    const Pack m = at(MASS) * points_of_pack(k, range.count);
    const Pack inv_rho = one / at(RHO);
    const Pack vx = at(VX);
    const Pack vy = at(VY);
    const Pack moving_x = Pack::load_aligned(motion.vx + k);
    const Pack moving_y = Pack::load_aligned(motion.vy + k);
    const auto strain_of = [&](std::size_t i) { return Pack::load_aligned(batch.strain[i] + k); };
    const Pack strain_v = strain_of(0) + strain_of(1) + strain_of(2);
    kinetic = kinetic + half * m * (vx * vx + vy * vy);
    // ∫σ:D dV over the mean volume of the step, V = m/ρ e^{−½tr Δε}
    work = work + m * inv_rho * (one - half * strain_v) * Pack::load_aligned(batch.work + k);
    const auto force_stress = [&](std::size_t c) {
      return Pack::load_aligned(points[points.force_stress[c]] + range.begin + k);
    };
    // Seen from where the step ends, the velocity that it moved with has the gradient L(I + ΔtL)⁻¹
    // ≈ L − ΔtL²; strain() takes its volume alone for a law that follows the rate.
    const Pack xx = at(LXX);
    const Pack xy = at(LXY);
    const Pack yx = at(LYX);
    const Pack yy = at(LYY);
    Pack c_xx = step * (xx * xx + xy * yx);
    Pack c_yy = step * (yy * yy + xy * yx);
    Pack c = step * (xx + yy);
    Pack c_zz = zero;
    if (follows_rate) {
      c_xx = c_yy = c_zz = third * (c_xx + c_yy);
      c = zero;
    }
    const Pack zz = points.splits_stress() ? force_stress(0) : at(SZZ);
    const Pack stress_power = force_stress(0) * (xx - c_xx) + force_stress(1) * (yy - c_yy) -
                              zz * c_zz + force_stress(2) * (one - c) * (xy + yx);
    power = power + m * (gx * moving_x + gy * moving_y - stress_power * inv_rho);
    const Pack v2 = moving_x * moving_x + moving_y * moving_y;
    speed2 = max_of(speed2, v2);
    const Pack c2 = Pack::load_aligned(batch.modulus + k) * inv_rho;
    signal = max_of(signal, Pack(sqrt(v2) + sqrt(c2)));
    if (batch.viscosity != nullptr)
      viscous_rate = max_of(
          viscous_rate, Pack(viscous_factor * Pack::load_aligned(batch.viscosity + k) * inv_rho));
  }
  sums.kinetic += xsimd::hadd(kinetic);
  sums.work += xsimd::hadd(work);
  sums.power += xsimd::hadd(power);
  sums.signals.include({std::sqrt(largest(speed2)), largest(signal), largest(viscous_rate)});
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
    nodes.extension_work += part.extension_work;
  }
  // at the whole step, with half a kick on both sides (ledger.hpp)
  const double points_to_nodes =
      (ledger.kinetic + 0.5 * last_dt * ledger.power) - (nodes.before + 0.5 * nodes.impulse_work);
  const double nodes_to_points =
      nodes.after + wall_effect_.kinetic_after + viscous_effect_.kinetic - kinetic;
  const double mirrored = wall_effect_.kinetic_before + 0.5 * wall_effect_.impulse_work;
  const Retention keep = retention(last_dt);
  // what points keep, no mirror takes; nor, beyond first order, what an extension gives back
  const double kept = keep.extended ? 1.0 : keep.velocity;
  ledger.transfer_loss +=
      points_to_nodes + nodes_to_points + nodes.extension_work - kept * mirrored;
  ledger.wall_loss -= (1.0 - kept) * mirrored;
  ledger.wall_loss -= wall_effect_.drag_after - wall_effect_.drag_before;
  ledger.kinetic = kinetic;
  ledger.power = power;
  ledger.stress_work += work + viscous_effect_.half_jump_work;
  drift += now.speed * last_dt;
  signals = now;
  if (scene.dt) {
    fixed_step_excess = std::max(fixed_step_excess, last_dt * seen().signal / grid.h());
    viscous_step_excess = std::max(viscous_step_excess, last_dt * now.viscous_rate);
  }
  for (const PointBlock& pb : grid.point_blocks)
    if (!pb.rest.asleep) point_steps += static_cast<std::int64_t>(pb.points());

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
  const bool sound = std::isfinite(kinetic) && kinetic <= 2.0 * highest_energy &&
                     (scene.dt || stable_step(seen(), scene.courant, grid.h()) >= 1e-9 * first_dt);
  must_sort = must_sort || failure != nullptr || !sound;  // drift may be NaN: look at every point
  if (failure != nullptr)
    throw NumericalFailure(
        fmt::format("step {} at t = {:.6g} s: {}: {}", steps, time, *failure, cause));
  if (!sound)
    throw NumericalFailure(fmt::format(
        "step {} at t = {:.6g} s: kinetic energy {:.4g} J/m against {:.4g} J/m available, dt "
        "{:.3g} s, Courant number {:.3g}: {}",
        steps, time, kinetic, highest_energy, last_dt, last_dt * seen().signal / grid.h(), cause));
}

}  // namespace repose::mpm

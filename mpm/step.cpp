/// The step (transfers with moving-least-squares forces), stage by stage.

#include <fmt/format.h>

#include "mpm/block_loops.hpp"
#include "mpm/body_force.hpp"
#include "mpm/pressure_averaging.hpp"
#include "mpm/simulation_impl.hpp"
#include "mpm/step_kinematics.hpp"
#include "mpm/tile_exchange.hpp"
#include "mpm/transfer.hpp"

namespace repose::mpm {
namespace {

/// Calls f with the interpolation functions of a scene, and with whether points hand on an affine
/// velocity and whether pressures are averaged (in the plane) as constants, all chosen at run time.
template <int dim, class F>
void choose(const Scene& scene, bool affine, bool averages, F&& f) {
  using Yes = std::true_type;
  using No = std::false_type;
  const auto with = [&](auto kernel, auto is_affine) {
    if constexpr (dim == 2) {
      if (averages) return f(kernel, is_affine, Yes{});
    }
    f(kernel, is_affine, No{});
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

template <std::size_t n>
Pack dot(const std::array<Pack, n>& a, const std::array<Pack, n>& b) {
  Pack sum = a[0] * b[0];
  for (std::size_t i = 1; i < n; ++i) sum = sum + a[i] * b[i];
  return sum;
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

template <int dim>
void Simulation::Impl<dim>::step(double stop_at) {
  if (!(stop_at > time)) return;  // never backwards
  sort_if_needed();
  const double dt = choose_step(stop_at);
  if (!tiles_are_current) points_to_grid();
  update_grid(dt);
  if constexpr (dim == 2) {
    if (walls.periodic()) node_sums_.push_back(join_periodic_edges(grid));
    const bool extends = retention(dt).extended;
    wall_effect_ = apply_walls(grid, walls, extends ? &mirrored_ : nullptr);
    measure_signals();
    solve_viscosity(dt);
    if (extends) extend_velocity();
  } else {
    wall_effect_ = apply_walls(grid, walls);
    measure_signals();
  }
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
  grid.sort(bodies);
  wake_the_crowded();
  mark_sleepers();
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
template <class Kernel, bool affine, Extra extra>
void Simulation::Impl<dim>::transfer_to_tile(std::size_t block) {
  const PointBlockOf<dim>& pb = grid.point_blocks[block];
  TileOf<dim>& tile = grid.tiles[block];
  constexpr bool has_extra = extra != Extra::nothing;
  for (std::size_t c = 0; c < Channels<dim>::extra + has_extra; ++c) tile[c].fill(0.0);
  static thread_local AlignedVector<double> values;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Range& range = pb.range[b];
    if constexpr (has_extra) values.resize(std::max(values.size(), padded(range.count)));
    if constexpr (extra == Extra::elastic)
      bodies[b].material->elastic_volume_strain(bodies[b].batch(range), values.data());
    if constexpr (extra == Extra::signal) square_signals(bodies[b], range, values.data());
    points_to_tile<Kernel, affine, has_extra>(bodies[b], range, grid.h(), tile_origin(pb),
                                              values.data(), tile);
    if constexpr (dim == 2) {
      if (prescribed.acceleration)
        prescribed_force_to_tile<Kernel>(bodies[b], range, tile_origin(pb), tile);
    }
  }
}

template <int dim>
void Simulation::Impl<dim>::square_signals(PointsOf<dim>& points, const Range& range,
                                           double* signal2) {
  using F = Layout<dim>;
  points.material->modulus(points.batch(range), signal2);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const auto at = [&](std::size_t f) { return Pack::load_aligned(points[f] + range.begin + k); };
    const Pack c = sqrt(Pack::load_aligned(signal2 + k) / at(F::rho));
    std::array<Pack, dim> v;
    for (std::size_t i = 0; i < dim; ++i) v[i] = at(F::v + i);
    const Pack signal = c + sqrt(dot(v, v));
    (signal * signal).store_aligned(signal2 + k);
  }
}

template <>
template <class Kernel>
void Simulation::Impl<2>::prescribed_force_to_tile(const PointSet& points, const Range& range,
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

template <int dim>
void Simulation::Impl<dim>::points_to_grid() {
  tiles_time = time;
  for_each_block(arena, grid.point_blocks.size(),
                 [&](std::size_t k) { transfer_to_tile(k, extra(0)); });
}

template <int dim>
void Simulation::Impl<dim>::transfer_to_tile(std::size_t block, Extra extra) {
  choose<dim>(scene, retention(0.0).affine, averages(),
              [&]<class K>(K, auto affine, auto averages) {
                if constexpr (averages.value)
                  transfer_to_tile<K, affine.value, Extra::elastic>(block);
                else if (extra == Extra::signal)
                  transfer_to_tile<K, affine.value, Extra::signal>(block);
                else
                  transfer_to_tile<K, affine.value, Extra::nothing>(block);
              });
}

template <int dim>
void Simulation::Impl<dim>::update_grid(double dt) {
  const Extra carries = extra(0);
  node_sums_.resize(grid.node_blocks.size());
  for_each_block(arena, grid.node_blocks.size(), [&](std::size_t k) {
    using C = Channels<dim>;
    NodeBlockOf<dim>& nb = grid.node_blocks[k];
    if (nb.asleep) {
      for (auto* field : {&nb.mass, &nb.mirrored_mass, &nb.extra}) field->fill(0.0);
      for (std::size_t i = 0; i < dim; ++i)
        for (auto* field : {&nb.u[i], &nb.v[i]}) field->fill(0.0);
      node_sums_[k] = {};
      return;
    }
    if (nb.borders) sum_awake_mass(nb);
    alignas(64) NodeTotals<C::count, dim> sum{};
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

template <int dim>
void Simulation::Impl<dim>::measure_signals() {
  if (extra(0) != Extra::signal || signals.signal == 0.0) return;
  double most = 0.0;
  for (const NodeBlockOf<dim>& nb : grid.node_blocks)
    for (const double signal2 : nb.extra) most = max_of(most, signal2);
  node_share = std::min(1.0, std::sqrt(most) / signals.signal);
}

template <int dim>
void Simulation::Impl<dim>::grid_to_points(double dt) {
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
    else if (dim == 2 && keep.extended && scene.transfer == Transfer::xpic) {
      if constexpr (dim == 2)
        advance_block<Kernel, Keeps::extension, averages.value>(k, dt, keep, sums);
    } else
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
    choose<dim>(scene, keep.affine, averages(), [&](auto kernel, auto affine, auto averages) {
      advance(kernel, affine, averages, k);
    });
  });
  tiles_are_current = std::all_of(block_sums_.begin(), block_sums_.end(),
                                  [](const BlockSums& sums) { return sums.transferred; });
}

template <int dim>
template <class Kernel, Keeps keeps, bool averages>
void Simulation::Impl<dim>::advance_block(std::size_t block, double dt, const Retention& keep,
                                          BlockSums& sums) {
  const PointBlockOf<dim>& pb = grid.point_blocks[block];
  VelocityTileOf<dim> tile;
  const auto fill = [&](TileField<dim>& field, auto&& of) {
    fill_tile(pb, field, [&](std::size_t k) { return of(grid.node_blocks[k]).data(); });
  };
  using Nodes = NodeBlockOf<dim>;
  for (std::size_t i = 0; i < dim; ++i) {
    fill(
        tile.v[i], [&](const Nodes& nb) -> const auto& { return nb.v[i]; });
    if constexpr (keeps != Keeps::nothing)
      fill(
          tile.u[i], [&](const Nodes& nb) -> const auto& { return nb.u[i]; });
  }
  if constexpr (averages)
    fill(
        tile.elastic, [](const Nodes& nb) -> const auto& { return nb.extra; });

  static thread_local AlignedVector<double> scratch;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Range& range = pb.range[b];
    if (range.count == 0) continue;
    const std::size_t n = padded(range.count);
    if (scratch.size() < scratch_arrays * n) scratch.resize(scratch_arrays * n);
    MotionOf<dim> motion;
    for (std::size_t i = 0; i < dim; ++i) motion.v[i] = scratch.data() + i * n;
    motion.elastic = scratch.data() + dim * n;
    tile_to_points<Kernel, keeps, averages>(tile, tile_origin(pb), grid.h(), range, keep, bodies[b],
                                            motion);
    move(bodies[b], range, motion, dt, sums);
    strain(bodies[b], b, range, motion, dt, scratch.data() + (dim + 1) * n, sums);
  }
}

template <int dim>
void Simulation::Impl<dim>::move(PointsOf<dim>& points, const Range& range,
                                 const MotionOf<dim>& motion, double dt, BlockSums& sums) const {
  // a closed wall is never crossed: the interpolated velocity vanishes on it, and what round-off or
  // an impact faster than one cell per step does is undone here and counted
  const double hair = 1e-9 * grid.h();
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
  std::array<double, dim> end;
  for (std::size_t i = 0; i < dim; ++i) end[i] = grid.h() * grid.cells()[i];
  const Pack step(dt), low(hair);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const std::size_t s = range.begin + k;
    auto near_wall = low < low;
    for (std::size_t i = 0; i < dim; ++i) {
      double* const x = points[Layout<dim>::x + i] + s;
      const Pack moved = Pack::load_aligned(x) + step * Pack::load_aligned(motion.v[i] + k);
      moved.store_aligned(x);
      near_wall = near_wall || moved < low || moved > Pack(end[i] - hair);
    }
    if (!any(near_wall)) continue;
    for (std::size_t lane = 0; lane < Pack::size; ++lane)
      for (std::size_t i = 0; i < dim; ++i)
        keep(points[Layout<dim>::x + i][s + lane], end[i], walls.low(i), walls.high(i),
             k + lane < range.count);
  }
}

template <int dim>
void Simulation::Impl<dim>::strain(PointsOf<dim>& points, std::size_t body, const Range& range,
                                   const MotionOf<dim>& motion, double dt, double* scratch,
                                   BlockSums& sums) const {
  using F = Layout<dim>;
  const std::size_t n = padded(range.count);
  double* next = scratch;
  const auto array = [&] { return std::exchange(next, next + n); };
  std::array<double*, F::components> e;
  for (double*& component : e) component = array();
  std::array<double*, dim == 2 ? 1 : 3> spin;
  for (double*& component : spin) component = array();
  double* const work = array();
  double* const modulus = array();
  double* const viscosity = array();
  double* const pressure_before = array();
  const bool follows_rate = !points.material->law().has_stress_memory;
  const Pack step(dt), zero(0.0);
  Pack least_volume(1.0);               // det(I + A)
  if (n - range.count >= Pack::size) {  // padding that no pack of points reaches is at rest
    for (double* const component : e) std::fill_n(component + n - Pack::size, Pack::size, 0.0);
    for (double* const component : spin) std::fill_n(component + n - Pack::size, Pack::size, 0.0);
  }
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    std::array<Pack, F::gradient> A;
    for (std::size_t i = 0; i < A.size(); ++i)
      A[i] = step * Pack::load_aligned(points[F::L + i] + range.begin + k);
    const StepStrain<dim> of_step = step_strain(A, follows_rate);
    least_volume = min_of(least_volume, of_step.volume);
    for (std::size_t i = 0; i < e.size(); ++i) of_step.strain[i].store_aligned(e[i] + k);
    for (std::size_t i = 0; i < spin.size(); ++i) of_step.spin[i].store_aligned(spin[i] + k);
  }
  if (any(!(least_volume > zero)) && sums.failure.empty())
    sums.failure = fmt::format(
        "a step of {:.3g} s turns a point of {} inside out: det(I + dt grad v) = {:.3g}", dt,
        body_names[body], least(least_volume));
  typename PointsOf<dim>::Batch batch = points.batch(range);
  batch.dt = dt;
  for (std::size_t i = 0; i < e.size(); ++i) batch.strain[i] = e[i];
  for (std::size_t i = 0; i < spin.size(); ++i) batch.spin[i] = spin[i];
  batch.work = work;
  batch.modulus = modulus;
  const bool viscous = !points.material->law().has_stress_memory && !points.splits_stress();
  batch.viscosity = viscous ? viscosity : nullptr;
  if constexpr (dim == 2) {
    if (averages())
      add_averaging_strain(*points.material, batch, scene.pressure_averaging, motion.elastic,
                           pressure_before, e);
  }
  const UpdateReport report = points.material->update(batch);
  if (!report.ok() && sums.failure.empty()) {
    const std::size_t k = report.failed;
    sums.failure = fmt::format(
        "the stress of {} could not be updated for the strain increment xx {:.6g}, yy {:.6g}, xy "
        "{:.6g} in {:.3g} s",
        describe(points, body, range.begin + k), e[0][k], e[1][k], e[3][k], dt);
  }
  if constexpr (dim == 2) {
    if (points.splits_stress()) split_stress(points, range, batch);
    if (averages()) take_back_averaging_work(batch, motion.elastic, pressure_before);
  }
  // A point alone in its stencil has the density m Σw²/h² (Σw² = 0.21 to 0.25, cubic; more,
  // quadratic; in space 0.097 to 0.125 over h³); looser than that the grid cannot tell, and spray
  // would dilate without end.
  const double h = grid.h();
  const Pack per_cell(dim == 2 ? 0.2 / (h * h) : 0.09 / (h * h * h));
  for (std::size_t s = range.begin; s < range.begin + range.count; s += Pack::size) {
    const Pack loosest = per_cell * Pack::load_aligned(points[F::mass] + s);
    const Pack rho = Pack::load_aligned(points[F::rho] + s);
    select(rho < loosest, loosest, rho).store_aligned(points[F::rho] + s);
  }
  sum_up(points, range, batch, motion, sums);
}

template <int dim>
void Simulation::Impl<dim>::sum_up(const PointsOf<dim>& points, const Range& range,
                                   const typename PointsOf<dim>::Batch& batch,
                                   const MotionOf<dim>& motion, BlockSums& sums) const {
  using F = Layout<dim>;
  const bool follows_rate = !points.material->law().has_stress_memory;
  const Pack half(0.5), one(1.0), step(batch.dt);
  std::array<Pack, dim> g;
  for (std::size_t i = 0; i < dim; ++i) g[i] = Pack(gravity[i]);
  const Pack viscous_factor(2.0 * dim / (grid.h() * grid.h()));
  Pack kinetic(0.0), work(0.0), power(0.0);
  Pack speed2(0.0), signal(0.0), viscous_rate(0.0);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const auto at = [&](std::size_t f) { return Pack::load_aligned(points[f] + range.begin + k); };
    const Pack m = at(F::mass) * points_of_pack(k, range.count);
    const Pack inv_rho = one / at(F::rho);
    std::array<Pack, dim> v, moving;
    for (std::size_t i = 0; i < dim; ++i) {
      v[i] = at(F::v + i);
      moving[i] = Pack::load_aligned(motion.v[i] + k);
    }
    const auto strain_of = [&](std::size_t i) { return Pack::load_aligned(batch.strain[i] + k); };
    const Pack strain_v = strain_of(0) + strain_of(1) + strain_of(2);
    kinetic = kinetic + half * m * dot(v, v);
    // ∫σ:D dV over the mean volume of the step, V = m/ρ e^{−½tr Δε}
    work = work + m * inv_rho * (one - half * strain_v) * Pack::load_aligned(batch.work + k);
    std::array<Pack, F::gradient> L;
    for (std::size_t i = 0; i < L.size(); ++i) L[i] = at(F::L + i);
    std::array<Pack, F::components> stress;
    const auto fields = force_components(points);
    for (std::size_t i = 0; i < stress.size(); ++i) stress[i] = at(fields[i]);
    power = power + m * (dot(g, moving) - stress_power(L, stress, step, follows_rate) * inv_rho);
    const Pack v2 = dot(moving, moving);
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

template <int dim>
void Simulation::Impl<dim>::close_ledger() {
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
  for (const PointBlockOf<dim>& pb : grid.point_blocks)
    if (!pb.rest.asleep) point_steps += static_cast<std::int64_t>(pb.points());

  const char* cause = "the integration diverges (solver); try a smaller courant";
  if (scene.dt && fixed_step_excess > safe_courant(scene.kernel, dim))
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
  const char* const unit = dim == 2 ? "J/m" : "J";
  if (!sound)
    throw NumericalFailure(fmt::format(
        "step {} at t = {:.6g} s: kinetic energy {:.4g} {} against {:.4g} {} available, dt "
        "{:.3g} s, Courant number {:.3g}: {}",
        steps, time, kinetic, unit, highest_energy, unit, last_dt,
        last_dt * seen().signal / grid.h(), cause));
}

#define REPOSE_STEP(DIM)                                                     \
  template void Simulation::Impl<DIM>::step(double);                         \
  template void Simulation::Impl<DIM>::sort_if_needed();                     \
  template void Simulation::Impl<DIM>::transfer_to_tile(std::size_t, Extra); \
  template double Simulation::Impl<DIM>::choose_step(double) const;          \
  template Retention Simulation::Impl<DIM>::retention(double) const;
REPOSE_STEP(2)
REPOSE_STEP(3)
#undef REPOSE_STEP

}  // namespace repose::mpm

/// G2P: the points of every block take the grid's velocities, move, and update their stress.

#include <fmt/core.h>

#include "mpm/grid/block_loops.hpp"
#include "mpm/grid/tile_exchange.hpp"
#include "mpm/step/choose_kernel.hpp"
#include "mpm/step/contact_damping.hpp"
#include "mpm/step/pressure_averaging.hpp"
#include "mpm/step/simulation_impl.hpp"
#include "mpm/step/step_kinematics.hpp"
#include "mpm/step/transfer.hpp"

namespace repose::mpm {
namespace {

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
void Simulation::Impl<dim>::grid_to_points(double dt) {
  block_sums_.assign(grid.point_blocks.size(), BlockSums{});
  const Retention keep = retention(dt);
  const Extra carries_next = extra(1);
  const auto advance = [&]<class Kernel>(Kernel, auto averages, std::size_t k) {
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
    sums.transferred =
        drift + sums.signals.speed * dt + sums.pushed < reach() && sums.failure.empty();
    if (!sums.transferred) return;
    transfer_to_tile(k, carries_next);
  };
  for_each_block(arena, grid.point_blocks.size(), [&](std::size_t k) {
    choose<dim>(scene, keep.affine, averages(),
                [&](auto kernel, auto, auto averages) { advance(kernel, averages, k); });
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

  const bool near_surface = !contact.empty() && contact.is_near(grid, pb, tiles_time);
  static thread_local AlignedVector<double> scratch;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (pb.range[b].count == 0) continue;
    const std::size_t n = padded(pb.range[b].count);
    if (scratch.size() < scratch_arrays * n) scratch.resize(scratch_arrays * n);
    MotionOf<dim> motion;
    for (std::size_t i = 0; i < dim; ++i) motion.v[i] = scratch.data() + i * n;
    motion.elastic = scratch.data() + dim * n;
    bodies[b].update(pb.range[b], [&](PointsOf<dim>& points, const SlotRange& range) {
      tile_to_points<Kernel, keeps, averages>(tile, tile_origin(pb), grid.h(), range, keep, points,
                                              motion);
      move(points, range, motion, dt, near_surface, sums);
      strain(points, b, range, motion, dt, scratch.data() + (dim + 1) * n, sums);
    });
  }
}

template <int dim>
void Simulation::Impl<dim>::move(PointsOf<dim>& points, const SlotRange& range,
                                 const MotionOf<dim>& motion, double dt, bool near_surface,
                                 BlockSums& sums) const {
  // a closed wall is never crossed: the interpolated velocity vanishes on it, and what round-off or
  // an impact faster than one cell per step does is undone here and counted
  const double hair = 1e-9 * grid.h();
  const auto place = [&](std::size_t slot) {
    std::array<double, dim> x;
    for (std::size_t i = 0; i < dim; ++i) x[i] = points.data(Layout<dim>::x + i)[slot];
    return x;
  };
  const auto is_open = [&](const Wall& wall, std::size_t axis, std::size_t slot) {
    if (wall.kind != Wall::Kind::parts) return wall.kind == Wall::Kind::open;
    return WallParts<dim>(wall, axis, grid).open_at(place(slot));
  };
  // the velocity of an opening reaches beyond its lip, where what it leads through is put back
  const auto counts_there = [&](const Wall& wall, std::size_t axis, std::size_t slot) {
    return wall.kind != Wall::Kind::parts ||
           !WallParts<dim>(wall, axis, grid).open_near(place(slot));
  };
  const auto keep = [&](std::size_t axis, std::size_t slot, double upper, bool counts) {
    double& x = points.data(Layout<dim>::x + axis)[slot];
    const Wall &low = walls.low(axis), &high = walls.high(axis);
    if (low.kind == Wall::Kind::periodic) return;  // wrapped when points are sorted
    if (x < hair) {
      if (is_open(low, axis, slot)) {
        sums.outflow = sums.outflow || x < 0.0;
      } else {
        if (x < 0.0 && counts && counts_there(low, axis, slot)) ++sums.corrections;
        x = hair;
      }
    } else if (x > upper - hair) {
      if (is_open(high, axis, slot)) {
        sums.outflow = sums.outflow || x > upper;
      } else {
        if (x > upper && counts && counts_there(high, axis, slot)) ++sums.corrections;
        x = upper - hair;
      }
    }
  };
  std::array<double, dim> end;
  for (std::size_t i = 0; i < dim; ++i) end[i] = grid.h() * grid.cells()[i];
  const Pack step(dt), low(hair);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const std::size_t s = range.begin + k;
    for (std::size_t i = 0; i < dim; ++i) {
      double* const x = points.data(Layout<dim>::x + i) + s;
      (Pack::load_aligned(x) + step * Pack::load_aligned(motion.v[i] + k)).store_aligned(x);
    }
  }
  if (near_surface) {  // the grid's velocity leads along it to second order in h
    std::array<double*, dim> x;
    for (std::size_t i = 0; i < dim; ++i) x[i] = points.data(Layout<dim>::x + i) + range.begin;
    sums.pushed = std::max(sums.pushed, contact.keep_out(x, range.count, tiles_time, hair));
  }
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const std::size_t s = range.begin + k;
    auto near_wall = low < low;  // the edges come last: a surface may push a point beyond them
    for (std::size_t i = 0; i < dim; ++i) {
      const Pack x = Pack::load_aligned(points.data(Layout<dim>::x + i) + s);
      near_wall = near_wall || x < low || x > Pack(end[i] - hair);
    }
    if (!any(near_wall)) continue;
    for (std::size_t lane = 0; lane < Pack::size; ++lane)
      for (std::size_t i = 0; i < dim; ++i) keep(i, s + lane, end[i], k + lane < range.count);
  }
}

template <int dim>
void Simulation::Impl<dim>::strain(PointsOf<dim>& points, std::size_t body, const SlotRange& range,
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
  double* const dissipated = array();
  double* const hypoelastic = array();
  double* const separation = array();
  double* const modulus = array();
  double* const viscosity = array();
  double* const pressure_before = array();
  const bool follows_rate = !points.material->law().has_stress_memory;
  const Pack step(dt), zero(0.0);
  Pack least_volume(1.0);  // det(I + A)
  // padding that no pack of points reaches is at rest
  const std::size_t reached = (range.count + Pack::size - 1) / Pack::size * Pack::size;
  for (double* const component : e) std::fill(component + reached, component + n, 0.0);
  for (double* const component : spin) std::fill(component + reached, component + n, 0.0);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    std::array<Pack, F::gradient> A;
    for (std::size_t i = 0; i < A.size(); ++i)
      A[i] = step * Pack::load_aligned(points.data(F::L + i) + range.begin + k);
    const StepStrain<dim> of_step = step_strain(A, follows_rate);
    least_volume = min_of(least_volume, of_step.volume);
    for (std::size_t i = 0; i < e.size(); ++i) of_step.strain[i].store_aligned(e[i] + k);
    for (std::size_t i = 0; i < spin.size(); ++i) of_step.spin[i].store_aligned(spin[i] + k);
    if (points.shear_strain != 0) {
      double* const gamma = points.data(points.shear_strain) + range.begin + k;
      const Pack more =
          Pack(2.0) *
          shear_norm(deviator(Sym<Pack, static_cast<int>(F::components)>{of_step.strain}));
      (Pack::load_aligned(gamma) + more).store_aligned(gamma);
    }
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
  (follows_rate ? batch.viscous : batch.plastic) = dissipated;
  if (!follows_rate) batch.hypoelastic = hypoelastic;
  batch.separation = separation;
  batch.modulus = modulus;
  const bool viscous = !points.material->law().has_stress_memory && !points.splits_stress();
  batch.viscosity = viscous ? viscosity : nullptr;
  if constexpr (dim == 2) {
    if (averages())
      add_averaging_strain(*points.material, batch, scene.pressure_averaging, motion.elastic,
                           pressure_before, e);
  }
  std::array<double*, F::components> stress_before;
  if (points.damps())
    for (std::size_t i = 0; i < F::components; ++i) {
      stress_before[i] = array();
      std::copy_n(batch.stress[i], reached, stress_before[i]);
    }
  const UpdateReport report = points.material->update(batch);
  if (!report.ok() && sums.failure.empty()) {
    const std::size_t k = report.failed;
    sums.failure = fmt::format(
        "the stress of {} could not be updated for the strain increment xx {:.6g}, yy {:.6g}, xy "
        "{:.6g} in {:.3g} s{}",
        describe(points, body, range.begin + k), e[0][k], e[1][k], e[3][k], dt,
        report.reason.empty() ? ""
                              : ": " + report.reason + ".");  // a cause of its own: close_ledger()
  }
  if constexpr (dim == 2) {
    if (points.splits_stress()) split_stress(points, range, batch);
    if (averages()) take_back_averaging_work(batch, motion.elastic, pressure_before);
  }
  if (points.damps()) {
    batch.viscous = array();
    damp_contacts(points, range, batch, stress_before, batch.viscous);
  }
  hold_density(points, range, batch, motion.elastic, pressure_before, sums);
  sum_up(points, body, range, batch, motion, sums);
}

template <int dim>
void Simulation::Impl<dim>::hold_density(PointsOf<dim>& points, const SlotRange& range,
                                         const typename PointsOf<dim>::Batch& batch,
                                         double* averaging, double* stored, BlockSums& sums) const {
  using F = Layout<dim>;
  const Pack per_mass(density_floor()), zero(0.0), one(1.0);
  double* const rho = points.data(F::rho) + range.begin;
  const double* const mass = points.data(F::mass) + range.begin;
  auto below = zero < zero;
  for (std::size_t k = 0; k < range.count; k += Pack::size)
    below = below || Pack::load_aligned(rho + k) < per_mass * Pack::load_aligned(mass + k);
  if (!any(below)) return;
  // Σ m ψ/ρ over the points of the range
  const auto stored_energy = [&] {
    points.material->stored_energy(batch, stored);
    Pack energy(0.0);
    for (std::size_t k = 0; k < range.count; k += Pack::size)
      energy = energy + Pack::load_aligned(stored + k) * points_of_pack(k, range.count) *
                            Pack::load_aligned(mass + k) / Pack::load_aligned(rho + k);
    return xsimd::hadd(energy);
  };
  const double before = stored_energy();
  Pack held(0.0);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const Pack loosest = per_mass * Pack::load_aligned(mass + k);
    const Pack now = Pack::load_aligned(rho + k);
    const auto loose = now < loosest;
    held = held + select(loose, one, zero) * points_of_pack(k, range.count);
    const Pack kept = select(loose, loosest, now);
    kept.store_aligned(rho + k);
    // the work of the step was done over the volume that it led to
    const Pack smaller = kept / now;
    smaller.store_aligned(stored + k);
    for (double* const energy :
         {batch.work, batch.plastic, batch.viscous, batch.hypoelastic, batch.separation})
      if (energy != nullptr) (smaller * Pack::load_aligned(energy + k)).store_aligned(energy + k);
    if (averages()) (smaller * Pack::load_aligned(averaging + k)).store_aligned(averaging + k);
  }
  points.material->hold_volume(batch, stored);
  sums.held += static_cast<std::int64_t>(xsimd::hadd(held));
  sums.held_energy += before - stored_energy();
}

template <int dim>
void Simulation::Impl<dim>::sum_up(const PointsOf<dim>& points, std::size_t body,
                                   const SlotRange& range,
                                   const typename PointsOf<dim>::Batch& batch,
                                   const MotionOf<dim>& motion, BlockSums& sums) const {
  using F = Layout<dim>;
  const bool follows_rate = !points.material->law().has_stress_memory;
  const Pack half(0.5), one(1.0), step(batch.dt);
  std::array<Pack, dim> g;
  for (std::size_t i = 0; i < dim; ++i) g[i] = Pack(gravity[i]);
  const Pack viscous_factor(2.0 * dim / (grid.h() * grid.h()));
  Pack kinetic(0.0), work(0.0), power(0.0);
  const double* const of_law = follows_rate ? batch.viscous : batch.plastic;
  Pack dissipated(0.0), hypoelastic(0.0), separation(0.0), averaging(0.0), damping(0.0);
  const Pack damped_signal(points.damped_signal);
  Pack speed2(0.0), signal(0.0), viscous_rate(0.0);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const auto at = [&](std::size_t f) {
      return Pack::load_aligned(points.data(f) + range.begin + k);
    };
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
    const Pack volume = m * inv_rho * (one - half * strain_v);
    work = work + volume * Pack::load_aligned(batch.work + k);
    dissipated = dissipated + volume * Pack::load_aligned(of_law + k);
    if (!follows_rate)
      hypoelastic = hypoelastic + volume * Pack::load_aligned(batch.hypoelastic + k);
    separation = separation + volume * Pack::load_aligned(batch.separation + k);
    if (points.damps()) damping = damping + volume * Pack::load_aligned(batch.viscous + k);
    if (averages()) averaging = averaging + volume * Pack::load_aligned(motion.elastic + k);
    std::array<Pack, F::gradient> L;
    for (std::size_t i = 0; i < L.size(); ++i) L[i] = at(F::L + i);
    std::array<Pack, F::components> stress;
    const auto fields = force_components(points);
    for (std::size_t i = 0; i < stress.size(); ++i) stress[i] = at(fields[i]);
    power = power + m * (dot(g, moving) - stress_power(L, stress, step, follows_rate) * inv_rho);
    if (scene.water_table) {
      const Pack borne =
          select(at(F::x + 1) < Pack(*scene.water_table), Pack(buoyant_[body]), Pack(0.0));
      power = power - m * borne * g[1] * moving[1];
    }
    const Pack v2 = dot(moving, moving);
    speed2 = max_of(speed2, v2);
    const Pack c2 = Pack::load_aligned(batch.modulus + k) * inv_rho;
    signal = max_of(signal, Pack(sqrt(v2) + damped_signal * sqrt(c2)));
    if (batch.viscosity != nullptr)
      viscous_rate = max_of(
          viscous_rate, Pack(viscous_factor * Pack::load_aligned(batch.viscosity + k) * inv_rho));
  }
  sums.kinetic += xsimd::hadd(kinetic);
  sums.work += xsimd::hadd(work);
  (follows_rate ? sums.viscous : sums.plastic) += xsimd::hadd(dissipated);
  sums.viscous += xsimd::hadd(damping);
  sums.hypoelastic += xsimd::hadd(hypoelastic);
  sums.separation += xsimd::hadd(separation);
  sums.averaging += xsimd::hadd(averaging);
  sums.power += xsimd::hadd(power);
  sums.signals.include({std::sqrt(largest(speed2)), largest(signal), largest(viscous_rate)});
}

template void Simulation::Impl<2>::grid_to_points(double);
template void Simulation::Impl<3>::grid_to_points(double);

}  // namespace repose::mpm

#include "mpm/step/ledger.hpp"

#include <fmt/core.h>

#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {

template <int dim>
void Simulation::Impl<dim>::close_ledger() {
  double kinetic = 0.0;
  double work = 0.0;
  double power = 0.0;
  Signals now;
  double pushed = 0.0;
  std::int64_t held = 0;
  const std::string* failure = nullptr;
  for (const BlockSums& sums : block_sums_) {
    if (failure == nullptr && !sums.failure.empty()) failure = &sums.failure;
    kinetic += sums.kinetic;
    work += sums.work;
    ledger.plastic += sums.plastic;
    ledger.viscous += sums.viscous;
    ledger.hypoelastic += sums.hypoelastic;
    ledger.separation += sums.separation;
    ledger.averaging += sums.averaging;
    ledger.density_floor += sums.held_energy;
    held += sums.held;
    power += sums.power;
    now.include(sums.signals);
    wall_corrections += sums.corrections;
    pushed = std::max(pushed, sums.pushed);
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
  const double kept = (keep.extended ? 1.0 : keep.velocity) * mirrored;
  ledger.transfer_loss += points_to_nodes + nodes_to_points + nodes.extension_work - kept;
  ledger.wall_loss -= mirrored - kept + wall_effect_.impulses;
  ledger.wall_loss -= wall_effect_.drag_after - wall_effect_.drag_before;
  ledger.kinetic = kinetic;
  ledger.power = power;
  ledger.stress_work += work + viscous_effect_.half_jump_work;
  ledger.viscous += viscous_effect_.half_jump_work;
  points_held = held;
  most_points_held = std::max(most_points_held, held);
  point_steps_held += held;
  drift += now.speed * last_dt + pushed;
  signals = now;
  if (scene.dt) {
    fixed_step_excess = std::max(fixed_step_excess, last_dt * seen().signal / grid.h());
    viscous_step_excess = std::max(viscous_step_excess, last_dt * now.viscous_rate);
  }
  for (const PointBlockOf<dim>& pb : grid.point_blocks)
    point_steps += static_cast<std::int64_t>(pb.points());

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
  if (failure != nullptr) {
    // a sentence that has ended has told its cause
    const bool told = failure->ends_with('.');
    throw NumericalFailure(fmt::format("step {} at t = {:.6g} s: {}{}{}", steps, time, *failure,
                                       told ? "" : ": ", told ? "" : cause));
  }
  const char* const unit = dim == 2 ? "J/m" : "J";
  if (!sound)
    throw NumericalFailure(fmt::format(
        "step {} at t = {:.6g} s: kinetic energy {:.4g} {} against {:.4g} {} available, dt "
        "{:.3g} s, Courant number {:.3g}: {}",
        steps, time, kinetic, unit, highest_energy, unit, last_dt,
        last_dt * seen().signal / grid.h(), cause));
}

template void Simulation::Impl<2>::close_ledger();
template void Simulation::Impl<3>::close_ledger();

}  // namespace repose::mpm

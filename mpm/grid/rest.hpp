#pragma once
/// \file
/// Blocks at rest. A block whose points have all been slower than v_s for the time T = √(h/g) falls
/// asleep: its points stop, keep their stress and take part in no step, and its tile keeps putting
/// their mass and force on the grid. Being still, they also no longer bound the step.
///
/// What happens at its border wakes it. At the nodes that it shares with points awake, and where
/// the sleepers hold at least half the mass, either of these does:
///   |v_i| > v_s,   |Σ_n Δt a_n e^{−(t−t_n)/T_w}| > v_s,   T_w = T/10:
/// a motion carried in, or a force that would bring them to v_s, if it lasted; the balance of
/// forces before the push is that of the moment when they fell asleep. So is a block woken into
/// which points have come. What it costs: motion slower than v_s is missed, at most v_s t of
/// displacement, and stresses below about ρ h v_s/T_w at the border are not followed.

#include "mpm/grid/aligned_vector.hpp"
#include "mpm/grid/signals.hpp"

namespace repose::mpm {

/// What a block of points knows of its rest.
struct Rest {
  double at_rest = 0.0;   ///< for how long its points have been slower than v_s [s]
  bool asleep = false;    ///< its points take part in no step
  std::size_t count = 0;  ///< of the points that fell asleep
  Signals signals;        ///< of the points that fell asleep, at rest
  /// Of a sleeper with neighbours awake: Σ Δt a e^{−(t−t_n)/T_w} at the nodes of its tile, x, then
  /// y (and z) [m/s]; empty: none since it fell asleep.
  AlignedVector<double> push;
};

}  // namespace repose::mpm

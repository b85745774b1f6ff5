#pragma once
/// \file
/// The stress that the grid can tell: that of the points, averaged over their neighbourhood.
///
/// With several points per cell there are more stresses than the nodes' momentum can tell apart.
/// Patterns whose forces cancel at the nodes meet no resistance, and flow feeds them: at rest they
/// are half of p (docs/noise.md), and say nothing of the material. What acts on it is the mean
///   (S σ)_p = Σ_i w_ip σ_i,   σ_i = Σ_q w_iq m_q σ_q / m_i,   m_i = Σ_q w_iq m_q
/// over the points q of the same body, w the cubic B-spline; shown is σ̄ = S S σ, since one S leaves
/// up to a tenth of p in the first row of a floor and in sloshing fluids, two leave 3 %.
///  - Weights are positive and add up to one: σ̄ is a convex combination, so it has no new extremes,
///    p̄ ≥ 0 where p ≥ 0, and it violates no convex yield surface that its points share.
///  - A uniform stress stays as it is up to surfaces and walls. A gradient does away from them (8 h
///    at most) and is flattened beside them; what is narrower than about 2.3 h is spread over that
///    (twice the standard deviation of four splines, √(4/3) h).
///  - Σ m σ̄ = Σ m σ: what some points gain, others lose.
/// It is for looking at: nothing of it goes back into the motion.

#include "mpm/step/simulation.hpp"

namespace repose::mpm {

/// Replaces the stresses of a snapshot, its pressure and von Mises stress by those of σ̄. `h`: cell
/// size [m].
void average_stress(Simulation::Snapshot& points, double h);

}  // namespace repose::mpm

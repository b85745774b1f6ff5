#pragma once
/// \file
/// The explicit step: physics.md, "Step limits".

#include <algorithm>
#include <cmath>

#include "mpm/grid/signals.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::mpm {

/// Up to where a fixed step is stable for every law and any point (see stable_step()); in space
/// √(2/3) of it.
inline constexpr double safe_courant(Kernel kernel, std::size_t dimensions) {
  return (kernel == Kernel::cubic ? 0.82 : 0.71) * (dimensions == 2 ? 1.0 : 0.816);
}

/// Δt = min(courant h/(c + |v|), 0.9 ρh²/4η). In one dimension the bulk is stable up to 1.93
/// (cubic) and 1.63 (quadratic) times h/c, 1/√2 of that where two directions add up. An isolated
/// point strains itself by L̇ = −(V/m) D⁻¹σ wherever it is in its cell, so that its frequency is
/// ω² = E/(ρD), D = h²/3 (cubic) or h²/4, with E the largest of 2(K + G/3), isotropic in the plane,
/// and 2G, in shear: Δt = 2/ω is 0.82 h/c for a fluid, 1.03 h/c for μ(I) with G = 4K and 1.02 h/c
/// for Cam-Clay with ν = 0.3 (cubic; quadratic: 0.87 of it). In space E is the largest of 3K and
/// 2G, Δt 0.67 h/c for a fluid, as before for μ(I) and 0.85 h/c for Cam-Clay, and the
/// bulk's 1.93/√3.
///
/// The same limits hold with the signals c + |v| of the nodes, c_i² = Σ w m c_p²/m_i, in place of
/// the points': by Cauchy and Schwarz |L_p|² ≤ D⁻¹ Σ w|v_i|² (and Σ w (x_i − x_p)² = D), so that
/// ω² = Σ_p m c_p² |L_p|²/Σ_i m_i |v_i|² ≤ D⁻¹ max c_i². What the grid sees is never more than the
/// fastest point, and half of it where the toe of a Cam-Clay column is one stiff point among softer
/// ones. Signals::signal is therefore scaled by node_share, as last measured.
inline double stable_step(const Signals& s, double courant, double h) {
  const double wave = s.signal == 0.0 ? HUGE_VAL : courant * h / s.signal;
  const double viscous = s.viscous_rate == 0.0 ? HUGE_VAL : 0.9 / s.viscous_rate;
  return std::isnan(viscous) ? viscous : std::isnan(wave) ? wave : std::min(wave, viscous);
}

}  // namespace repose::mpm

#pragma once
/// \file
/// Averaging of the points' pressures through the grid, at a rate per unit of shear strain.
///
/// A point integrates its own density. With several points per cell there are more of them than
/// the nodes' momentum can tell apart: patterns of pressure whose forces cancel on the grid meet no
/// resistance, and flow feeds them, until they are as large as the pressure itself. They are taken
/// away where they arise, in deformation: with p̄_p the pressure of the neighbourhood,
///   p_i = Σ w m_p (p_p + ρ_p g·(x_i − x_p))/m_i,   p̄_p = Σ w p_i,
///   p_p* = p_p + (1 − e^{−c γ̇ Δt}) (p̄_p − p_p),    γ̇ = √(2 D′:D′),
/// a point's strain increment gets in addition the elastic volumetric strain from p_p to p_p*
/// (isotropic), so that density, stress and history stay those of one material.
///  - Σ m p̄ = Σ m p, and a hydrostatic pressure is reproduced up to surface and floor: the affine
///    term needs no gradient but ρ g, and no condition at walls.
///  - e^{−cγ}: the same for any Δt; nothing at rest, nor in rigid motion; objective.
///  - Its work is no work of the motion: what it takes from the stored energy counts as dissipated.

#include <array>

#include "models/material.hpp"

namespace repose::mpm {

/// Adds the averaging strain to a batch's strain increments (xx, yy, zz, xy). `averaging`: in the
/// mean pressures p̄ [Pa], out the volumetric strains; `pressure_before` gets the pressures p_p.
/// `rate` = c [-].
void add_averaging_strain(const Material& material, const Batch& batch, double rate,
                          double* averaging, double* pressure_before,
                          const std::array<double*, 4>& strain);

/// Takes the part of the averaging strain out of the work that the law has reported,
/// ½(σ_n + σ_{n+1}):Δε.
void take_back_averaging_work(const Batch& batch, const double* averaging,
                              const double* pressure_before);

}  // namespace repose::mpm

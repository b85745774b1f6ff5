#pragma once
/// \file
/// Averaging of the points' pressures through the grid, at a rate per unit of shear strain.
///
/// A point integrates its own density. With several points per cell there are more of them than
/// the nodes' momentum can tell apart: patterns of pressure whose forces cancel on the grid meet no
/// resistance, and flow feeds them, until they are as large as the pressure itself. They are taken
/// away where they arise, in deformation. With e = −∫dp/K the elastic volume strain of a point, its
/// strain increment gets in addition, isotropically,
///   e_i = Σ w m_p e_p/m_i (even in walls),   ē_p = Σ w e_i,
///   tr Δε_p = (1 − e^{−c γ̇ Δt}) (ē_p − e_p),    γ̇ = √(2 D′:D′),
/// so that density, stress and history stay those of one material, whatever its pressure follows.
///  - Σ m ē = Σ m e: what some points gain in volume the others lose (exactly so where γ̇ is
///    uniform). An average of pressures would not do that, K being another at every point.
///  - e^{−cγ}: the same for any Δt; nothing at rest, nor in rigid motion; objective.
///  - A mean: no new extremes, and the wave speed, hence the stable step, is as before.
///  - Its work is no work of the motion: what it takes has a line of its own in the ledger.
/// Noise relative to p grows as (K/p)/c, hence c of the order of K/(ρ g H); 1/κ in Cam-Clay.

#include <array>

#include "models/material.hpp"

namespace repose::mpm {

/// Adds the averaging strain to a batch's strain increments (xx, yy, zz, xy). `averaging`: in the
/// means ē, out the volume strains added; `pressure_before` gets the pressures [Pa]. `rate` = c
/// [-].
void add_averaging_strain(const Material& material, const Batch& batch, double rate,
                          double* averaging, double* pressure_before,
                          const std::array<double*, 4>& strain);

/// Takes the part of the averaging strain out of the work that the law has reported,
/// ½(σ_n + σ_{n+1}):Δε. `averaging`: in the volume strains added, out the energy per mean volume
/// that they have taken from the material, ½(p_n + p_{n+1}) tr Δε [J/m³].
void take_back_averaging_work(const Batch& batch, double* averaging, const double* pressure_before);

}  // namespace repose::mpm

#pragma once
/// \file
/// Where the energy went. All in J per metre of depth, accumulated step by step:
///   kinetic + potential + elastic + dissipated + transfer_loss + wall_loss + outflow
///   + residual = start + inflow
///
/// The step is a leapfrog: velocities belong to half steps, positions and stresses to whole ones.
/// At a whole step the velocity is that of the points, u, plus half a kick, u + ½Δt F/m, and its
/// kinetic energy K(u) + ½Δt F·u to first order. Whatever changes u at that moment, the transfer or
/// a wall, therefore costs the change of K + ½Δt F·u, with the power F·u known on both sides of it:
/// on the points −ΣVσ:L + Σmg·v, on the nodes Σ(f + mg)·u. Both losses are measured so, not
/// inferred; the residual is a true check and holds what is of second order, plus ½Δt F·u of the
/// moment.

namespace repose::mpm {

struct Ledger {
  double start = 0.0;  ///< kinetic + potential + elastic at t = 0
  double start_elastic = 0.0;
  double stress_work = 0.0;  ///< ∫ σ:D dV dt at the points
  /// What of it goes where (StepWork)
  double plastic = 0.0, viscous = 0.0, hypoelastic = 0.0, separation = 0.0;
  double averaging = 0.0;      ///< taken from the stored energy by pressure averaging
  double density_floor = 0.0;  ///< taken from the stored energy by the density floor
  double transfer_loss = 0.0;  ///< kinetic energy: points → nodes and nodes → points
  double wall_loss = 0.0;      ///< taken by walls, less what moving walls put in
  double surface_work = 0.0;   ///< of moving rigid surfaces on the material, part of -wall_loss
  double outflow = 0.0;        ///< kinetic + potential + elastic energy carried out
  double outflow_elastic = 0.0;
  double outflow_mass = 0.0;  ///< [kg/m]
  double inflow = 0.0;        ///< kinetic + potential + elastic energy that came in
  double inflow_elastic = 0.0;
  double inflow_mass = 0.0;  ///< [kg/m]
  double kinetic = 0.0;      ///< Σ½mv² of the points, after the last step
  double power = 0.0;        ///< −ΣVσ:L + Σmg·v of the points, after the last step [W/m]
};

}  // namespace repose::mpm

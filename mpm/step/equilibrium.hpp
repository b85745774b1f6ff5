#pragma once
/// \file
/// A start at rest: stresses that balance gravity on the grid, node by node, in the sums that the
/// step itself takes.
///
/// A node at rest is accelerated by a = T M⁻¹(Gσ + Mg): Gσ are the forces of the points' stresses
/// (transfer.hpp), M the nodes' masses, and T what surfaces and edges leave of a velocity
/// (rigid_contact.hpp, walls.hpp; those with friction stick). From a first guess σ_0, the weight of
/// what stands over a place (fill.hpp), the least correction is sought that brings a to zero:
///     min Σ V Δσ:C⁻¹:Δσ   with   ‖T M⁻¹(G(σ_0 + Δσ) + Mg)‖_M least,
/// C that of an isotropic elasticity, as stiff as σ_v², with the Poisson number that gives K0 in a
/// column (C ∝ σ_v² makes the correction small against the stress): least squares by the method of
/// Paige & Saunders (LSQR, 1982) in y = √V C^{-1/2}Δσ from y = 0, where the residual is the
/// acceleration weighted by mass. Its products are transfers of the step:
/// points to grid for G, and the strain of a field on the grid for its transposed.
///
/// What a law does not bear is brought back and a little further, a pressure that would be tension
/// to a few thousandths of the guess, a deviator beyond friction (μ_0 or M) along itself to nine
/// tenths of it, and the search goes on from there: alternating projections on the states in
/// equilibrium and on those that the law admits, two convex sets. By the lower-bound theorem a body
/// that has a common state can stand. Density and hardening of a point are what the law gives for
/// its stress, and the weight follows.
///
/// Below a free surface across the grid the outermost nodes hang on a few points, and no stress
/// without tension balances them: what is left there is light. docs/at_rest.md has figures.

#include <cstdint>

namespace repose::mpm {

/// What a search for equilibrium came to.
struct Equilibrium {
  bool sought = false;
  double guess = 0.0;     ///< √(Σma²/Σmg²) over the nodes, of the first guess
  double residual = 0.0;  ///< of what was found
  /// The same with edges and surfaces that slide and part as in a step
  double in_step = 0.0;
  std::int64_t limited = 0;  ///< points at the limit of their strength
  int rounds = 0;            ///< projections
  int products = 0;          ///< of LSQR, each two transfers
  bool found() const { return residual <= enough && in_step <= enough; }
  /// Slopes that then stay where they are had up to 0.02, a tenth below their critical friction
  /// 0.04 and more.
  static constexpr double enough = 0.03;
  static constexpr double exact = 1e-8;  ///< what is aimed at
};

}  // namespace repose::mpm

#pragma once
/// \file
/// Extended velocities: the transfers that undo PIC's filter up to an order m.
///
/// With S the interpolation from the grid to the points (S v)_p = Σ_i w_ip v_i, and S⁺ the way
/// back, (S⁺V)_i = Σ_p w_ip m_p V_p / m_i, PIC gives a point P V = S S⁺V at every step. P is
/// symmetric in the inner product Σ m V·W, with eigenvalues from 0 (what no grid velocity can be)
/// to 1; whatever lies between is damped step by step. The filter
///   P_m = I − (I − P)^m
/// leaves 0 at 0 and brings all others towards 1. On the grid, with A = S⁺S,
///   P_m = S A_m S⁺,   A_m = Σ_{j<m} (I − A)^j,
/// since S (I − S⁺S)^j S⁺ = (I − S S⁺)^j S S⁺; and A_m → A⁻¹. So, from r = v, m − 1 times
///   r ← r − A r,   v_m ← v_m + r,
/// A being once to the points and back. By the binomial theorem the same as
///   A_m = Σ_{r=1}^{m} (−1)^{r+1} C(m, r) A^{r−1},
/// which is how it stands in the papers; the sum above has no cancellation.
///
///   XPIC(m), Hammerquist & Nairn (2017):  V ← P_m V + Δt S a = S v + S (A_m u − u);
///            points move and strain with S v, v = u + Δt a, as in PIC and FLIP.
///   FMPM(k), Nairn & Hammerquist (2021):  V ← S A_k v;  points move and strain with it too. m_i A
///   is
///            the full (consistent) mass matrix, which replaces the lumped one as k → ∞.
/// Momentum is kept exactly at any order: Σ m_i (A v)_i = Σ m_i v_i.
///
/// At walls the points' images take part: after each passage to the grid the nodes are mirrored as
/// the velocities of the step were (walls.hpp), so that A is that of the points with their images.
///
/// The energy ledger: FMPM's points move with A_k v, hence the power of the forces on the way of
/// the nodes to the points is f·A_k v, where f·v is counted. The difference
/// ½ Δt Σ (f + mg)·(A_k v − v) is added to the loss in the transfers.

#include "mpm/grid/grid.hpp"
#include "mpm/step/transfer.hpp"

namespace repose::mpm {

/// Takes the velocity `there` (vx, vy of the tile) to the points of a range and their momentum
/// m_p Σ w v_i to the tile's channels T_PX and T_PY, which it adds to. `origin` is the index of
/// both tiles' first node.
template <class Kernel>
void through_points(const PointSet& points, const SlotRange& range, double h,
                    std::array<int, 2> origin, const VelocityTile& there, Tile& back);

}  // namespace repose::mpm

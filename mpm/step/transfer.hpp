#pragma once
/// \file
/// The two transfers of the affine particle-in-cell method (APIC, Jiang et al. 2015) with the
/// affine field as velocity gradient and its adjoint as force (moving least squares MPM, Hu et al.
/// 2018):
///   m_i = Σ w m_p,   p_i = Σ w m_p (v_p + A_p (x_i − x_p)),
///   f_i = −Σ w V_p D⁻¹ σ_p (x_i − x_p),                      D = h²/4 (quadratic), h²/3 (cubic)
///   v_p = Σ w v_i,   L_p = Σ w v_i (x_i − x_p)ᵀ D⁻¹;
/// with a kernel that is a SplineGradient, f_i = −Σ V_p σ_p ∇w and L_p = Σ v_i (∇w)ᵀ instead (TPIC,
/// Nakamura, Matsumura & Mizutani 2023).
/// Where pressures are averaged (pressure_averaging.hpp), also
///   e_i = Σ w m_p e_p/m_i,   ē_p = Σ w e_i.
///
/// In space a stencil is four of the plane's, one behind the other, each with its own weight w(ζ).
///
/// To the grid, the lanes of a register are the nodes of a stencil and a point's contributions stay
/// in registers as long as the next point has the same stencil. From the grid, the lanes are
/// points, each of which looks its nodes up in registers that hold a row of the tile.

#include "mpm/grid/grid.hpp"
#include "mpm/grid/kernel.hpp"

namespace repose::mpm {

/// What a point keeps of its own when it comes back from the grid,
///   v_p ← Σ w v_i + keep (v_p − Σ w u_i),   u, v: grid velocity before and after forces,
/// and likewise its affine velocity A_p.
struct Retention {
  bool affine = true;     ///< the affine velocity goes to the grid
  double velocity = 0.0;  ///< keep, of the velocity
  double gradient = 0.0;  ///< keep, of the affine velocity
  bool extended = false;  ///< the points' velocity is extended (extended_pic.hpp)
};

/// Which of the two a point keeps at all: without, u need not be interpolated. With `extension`, u
/// stands for what an extended velocity adds (extended_pic.hpp): v_p ← Σ w v_i + Σ w u_i.
enum class Keeps : std::uint8_t { nothing, velocity, velocity_and_gradient, extension };

/// Adds the points of a range to the tile of their block. `origin` is the index of the tile's first
/// node. The momentum is that before forces; forces are kept apart for the energy ledger.
/// `averages`: `elastic`, the range's elastic volume strains, go along; else it is not read.
template <class Kernel, bool affine, bool averages, int dim>
void points_to_tile(const PointsOf<dim>& points, const SlotRange& range, double h,
                    const std::array<int, Shape<dim>::axes>& origin, const double* elastic,
                    TileOf<dim>& tile);

/// Velocity at the nodes of a tile, before (u) and after (v) forces.
template <int dim>
struct VelocityTileOf {
  alignas(64) std::array<TileField<dim>, Shape<dim>::axes> v, u;
  TileField<dim> elastic;  ///< only where pressures are averaged
};
using VelocityTile = VelocityTileOf<2>;

/// The velocity Σ w v_i that moves a range's points, from its first one on, and the mean elastic
/// volume strain around them.
template <int dim>
struct MotionOf {
  std::array<double*, Shape<dim>::axes> v;
  double* elastic = nullptr;  ///< ē; only where pressures are averaged
};
using Motion = MotionOf<2>;

/// Interpolates velocity and velocity gradient to the points of a range (their fields v and L, the
/// affine velocity) and gives the velocity that moves them, with the padding of the range treated
/// like points. Where nothing is kept, u is not read.
template <class Kernel, Keeps keeps, bool averages, int dim>
void tile_to_points(const VelocityTileOf<dim>& tile,
                    const std::array<int, Shape<dim>::axes>& origin, double h,
                    const SlotRange& range, const Retention& keep, PointsOf<dim>& points,
                    const MotionOf<dim>& motion);

}  // namespace repose::mpm

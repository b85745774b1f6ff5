#pragma once
/// \file
/// Boundary conditions by ghost nodes with mirrored values.
///
/// A wall lies on a line of nodes b; a is the ghost node behind it and c the first node inside.
/// With a velocity component odd (v_a = −v_c, v_b = 0) its spline vanishes on the wall itself; even
/// (v_a = v_c), its normal derivative does. The mass and momentum that points put on a are those of
/// their mirror image on c: m = m_c + m_a, m v_c = m_c v_c ± m_a v_a. The functions stay a
/// partition of unity to the wall and lose no mass.
///   slip:     normal odd, tangential even
///   no slip:  both odd, the tangential one about the wall's own speed
///   friction: free if nothing presses on the wall; else normal odd, tangential a mixture of even
///             and odd with the share φ = min(1, friction J_n/J_t) of the impulse J_t that would
///             stop it
///   inflow:   both odd about the velocity of what comes in
/// What lies between two parts of an edge: wall_parts.hpp.
///
/// Points that keep something of their own velocity take the increment v − u from the grid. Slip
/// and no slip hold at every moment: of u they leave what they admit, and what of the points'
/// velocity they do not admit is nobody's motion. A frictional wall gives its impulse once, and the
/// increment must carry it: here u is mirrored without loss of momentum, by a translation U of the
/// three nodes with Σm(u + U) as it was, so that Σm(v − u) is the impulse of the forces and of the
/// wall.

#include <optional>

#include "mpm/grid/grid.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::mpm {

struct Walls {
  Wall left, right, floor, top;
  Wall near{}, far{};  ///< across z, in space
  /// The walls at the low and at the high end of an axis.
  const Wall& low(std::size_t axis) const { return axis == 0 ? left : axis == 1 ? floor : near; }
  const Wall& high(std::size_t axis) const { return axis == 0 ? right : axis == 1 ? top : far; }
  bool periodic() const { return left.kind == Wall::Kind::periodic; }
};

/// What the walls do to the motion of the nodes, in the plane per metre of depth.
struct WallEffect {
  double kinetic_before = 0.0;  ///< change of ½Σmu², velocities before forces [J]
  double kinetic_after = 0.0;   ///< change of ½Σmv², velocities after forces [J]
  double impulse_work = 0.0;  ///< change of ΔtΣ(f + mg)·u: what the forces do on u in one step [J]
  /// Change of Σmu and Σmv along a wall that moves, times its speed: the work of dragging [J].
  double drag_before = 0.0, drag_after = 0.0;
  /// Σ J·½(u + v): the work of the impulses J that a frictional wall gives, which leave u alone [J]
  double impulses = 0.0;

  WallEffect& operator+=(const WallEffect& other) {
    kinetic_before += other.kinetic_before;
    kinetic_after += other.kinetic_after;
    impulse_work += other.impulse_work;
    drag_before += other.drag_before;
    drag_after += other.drag_after;
    impulses += other.impulses;
    return *this;
  }
};

/// Three nodes behind, on and inside a wall, and the mixture that mirrored them.
struct MirroredTriple {
  struct Node {
    std::int32_t block = -1;  ///< index into Grid::node_blocks; −1 where there is no node
    std::int32_t place = 0;
  };
  std::array<Node, 3> node;
  std::size_t normal = 0;       ///< axis across the wall
  double m_a = 0.0, m_c = 0.0;  ///< masses behind and inside, as they weigh here [kg/m]
  double stick = 0.0;           ///< 0: tangential even, 1: odd
  /// Of a frictional wall, which mirrors u without loss of momentum: masses as they are [kg/m]
  std::optional<std::array<double, 3>> conserves;
};

/// Applies the walls to the node velocities before and after forces. `record`, if given, is filled
/// with what they did, in its order.
template <int dim>
WallEffect apply_walls(GridOf<dim>& grid, const Walls& walls,
                       std::vector<MirroredTriple>* record = nullptr);

/// Does to the grid's velocities after forces the transposed of what slip and no-slip walls did.
template <int dim>
void transpose_walls(GridOf<dim>& grid, const std::vector<MirroredTriple>& record);

/// Does to another velocity, momentum of the points over mass of the nodes, what the walls did to
/// those of the grid: the images behind the walls take part in it, with the same share of sticking.
void mirror(const std::vector<MirroredTriple>& record, NodeVector& velocity);

}  // namespace repose::mpm

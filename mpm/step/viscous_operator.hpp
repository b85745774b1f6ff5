#pragma once
/// \file
/// The viscous forces of the points on the grid as an operator on node velocities, matrix-free:
///   K v = Σ_p V_p Bᵀ s_p,   s_p = 2η D′_p,   D_p = sym(B v) = sym Σ w v (x_i − x_p)ᵀ D⁻¹,
/// with the affine gradient B that the transfers use (transfer.hpp), so that what the grid feels is
/// what the points store. K is symmetric, positive semi-definite, and blind to rigid motion.

#include <vector>

#include "mpm/boundary/wall_mirror.hpp"
#include "mpm/grid/block_loops.hpp"
#include "mpm/grid/kernel.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::mpm {

class ViscousOperator {
 public:
  /// Takes the points of all bodies whose stress is split (points.hpp) as they stand; `dt` [s]
  /// multiplies all that follows.
  void prepare(Grid& grid, std::vector<PointSet>& bodies, const Walls& walls, Kernel kernel,
               double dt, tbb::task_arena& arena);

  /// f ← Eᵀ Δt Σ V Bᵀ s with the law's own s = 2η(γ̇)D′ at the field v = E y [kg m/s per m].
  void impulse(const NodeVector& v, NodeVector& f);

  /// Takes the state of the points after the last step, D_n and s_n, for the next linearise(). The
  /// field that the points gave to the grid has been through the transfers, and where the law is
  /// stiff its strain says little about the stress.
  void state_of_points();
  /// f ← Eᵀ Δt Σ V Bᵀ [s + C(Bv − D)], linear from the state of the last linearise(), v = E y.
  void linear_impulse(const NodeVector& v, NodeVector& f);

  /// Takes Newton's tangent at the last field given to impulse(), in the primal-dual form of Chan,
  /// Golub & Mulet (1999): the stress is an unknown of its own, s = 2ηD′, so that
  ///   C = 2η[I − ½θ(w ⊗ n + n ⊗ w)],   n = D′/|D′|,  w = s/(2η|D′|),  θ = −d ln η/d ln γ̇,
  /// where s has not caught up with D′ yet. |w| is kept <= 1, so C is positive.
  void linearise();

  /// q ← Eᵀ Δt Σ V Bᵀ C B p for a field p = E y.
  void apply(const NodeVector& p, NodeVector& q);

  /// The diagonal of apply() but for what a node and its own ghost do to each other.
  void diagonal(NodeVector& d);

  /// Finds the change of the dual stress that goes with a Newton step δ = E y of the velocity, and
  /// takes the share a of it.
  void step_stress(const NodeVector& step);
  void take_stress_step(double a);

  const WallMirror& mirror() const { return mirror_; }
  /// Node blocks that hold mass, in order; vectors stay 0 elsewhere.
  const std::vector<std::size_t>& live() const { return live_; }

 private:
  /// Symmetric tensor in the plane: xx, yy, xy (strain: 2xy).
  using Plane = std::array<double, 3>;
  struct alignas(64) PointData {
    // all that apply() reads, in three cache lines
    std::array<double, 16> weights;  ///< w, w d D⁻¹ in x, the same in y
    std::array<double, 6> tangent;   ///< Δt V C: xx·xx, xx·yy, xx·xy, yy·yy, yy·xy, xy·xy
    double eta;                      ///< [Pa s]
    std::uint32_t place;             ///< of its stencil in the tile
    // and the rest
    Plane strain;               ///< D [1/s]
    Plane stress, stress_step;  ///< s (dual) and its change, zz = −xx − yy [Pa]
    Plane load;                 ///< what goes to the tile, Δt V times a stress
    double thinning, volume_dt;
  };
  struct BodyPoints {
    std::vector<PointData> data;  ///< by slot
    PointSet* points = nullptr;
  };
  struct alignas(64) VectorTile {
    std::array<double, tile_nodes> x, y;
  };

  template <class K>
  void place_points(std::size_t block);
  template <int rows>
  void stress_to_tile(std::size_t block);
  void evaluate_law(std::size_t block);

  void gather(const NodeVector& v, std::size_t block, VectorTile& tile) const;
  void sum_tiles(NodeVector& f);
  template <class F>
  void for_points(std::size_t block, F&& f) {
    for (BodyPoints& body : bodies_) {
      if (body.points == nullptr) continue;
      const SlotRange& range = grid_->point_blocks[block].range[body_index(body)];
      for (std::size_t s = range.begin; s < range.begin + range.count; ++s) f(body.data[s]);
    }
  }
  std::size_t body_index(const BodyPoints& body) const {
    return static_cast<std::size_t>(&body - bodies_.data());
  }

  tbb::task_arena* arena_ = nullptr;
  Grid* grid_ = nullptr;
  WallMirror mirror_;
  std::vector<std::size_t> live_;
  double dt_ = 0.0;
  std::vector<BodyPoints> bodies_;
  std::vector<VectorTile> tiles_;
  Kernel kernel_ = Kernel::cubic;
};

}  // namespace repose::mpm

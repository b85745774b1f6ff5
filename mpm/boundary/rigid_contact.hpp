#pragma once
/// \file
/// Contact with rigid surfaces that lie across the grid at any angle, by their signed distance φ.
///
/// A node behind a surface, or less than half a cell in front of it, is a ghost: it has no motion
/// of its own but one that the velocity further in front implies. (A node that lies nearly on the
/// surface would be held by nothing, and the whole flow with it slip by a cell: Bagnold's flow then
/// ran 7 to 13 % too fast.) The place at φ = d over a ghost lies among 2^dim nodes in front, the
/// ghost's donors, with the mean velocity V = Σ w_j v_j; d is the least distance >= −φ_g, in
/// eighths of a cell, at which none of them is a ghost. With v relative to the surface's own motion
/// at each place and s = −φ_g/d, a field that is linear across the surface obeys
///   odd,  v_g = −sV:  it vanishes on the surface (all components: no slip; the normal one: slip),
///   even, v_g =  AV:  no shear acts on it (the tangential ones: slip), A = I + (φ_g − d)S.
/// S = ∇n is how the surface bends. Where v·n = 0 all along it, n·∂_t v = −v·St, so that the shear
/// rate ½(∂_n v_t + n·∂_t v) vanishes for ∂_n v = Sv: what slides along a bend turns with it. (With
/// A = I it was sheared by the angle that it had turned: a block on a cycloid came to rest.)
///
/// What the ghost lacks, δ = v_g + sV (odd) or v_g − AV (even), is taken from the ghost and its
/// donors as the masses share it, by Gauss' principle of least constraint with lumped masses:
///   odd:   Δv_j = −Σ_g m_g w s δ/(m_j + Σ_g m_g w s²),   Δv_g = −δ − sΣ w Δv_j,
///   even:  Δv_j =  Σ_g m_g w δ/(m_j + Σ_g m_g w),        Δv_g = −δ +  Σ w Δv_j;
/// a field that has what it should have is left as it is, and the even one keeps the momentum
/// exactly. (With the consistent mass matrix instead, solved to round-off, Bagnold's flow is the
/// same to 1e-4.) Coulomb friction: δ_n < 0 presses, δ_n >= 0 parts and is let go; the tangential
/// odd correction is that of φ δ_t, φ = min(1, friction |δ_n|/|δ_t|), hence its impulse friction
/// times the normal one, and the even one that of the share 1 − φ.
///
/// Surfaces give impulses, as frictional walls do (walls.hpp), and leave the velocities before
/// forces alone: the increment v − u carries them to points that keep a velocity of their own.

#include <cstdint>
#include <map>
#include <vector>

#include <tbb/task_arena.h>

#include "mpm/boundary/walls.hpp"
#include "mpm/grid/grid.hpp"
#include "mpm/grid/lanes.hpp"
#include "mpm/scene/solid.hpp"

namespace repose::mpm {

template <int dim>
class RigidContact {
 public:
  explicit RigidContact(std::vector<Surface> surfaces) : surfaces_(std::move(surfaces)) {}

  bool empty() const { return surfaces_.empty(); }
  /// Whether anything may come within a cell of a surface from a block of points.
  bool is_near(const GridOf<dim>& grid, const PointBlockOf<dim>& block, double time) const;
  /// Applies the surfaces, one after the other, where they are at a time, on the arena's threads.
  /// `sorted`: the grid's blocks are not those of the call before. Returns what it did to the
  /// energy, and adds to `work` that of the surfaces' own motion on the material.
  WallEffect apply(GridOf<dim>& grid, double time, bool sorted, tbb::task_arena& arena,
                   double& work);
  /// Does to the grid's velocities after forces the transposed of what the last apply() did, of
  /// surfaces at rest without friction.
  void transpose(GridOf<dim>& grid) const;
  /// Puts places that lie behind a surface on its front side, a hair away. x: of `count` places
  /// along each axis. Returns the farthest way of any [m].
  double keep_out(const std::array<double*, dim>& x, std::size_t count, double time,
                  double hair) const;

 private:
  /// A vector and, last, a number that is summed with the same weights: what ghosts and donors tell
  /// each other, a row at a time.
  struct alignas(Row) Four : std::array<double, Row::size> {};
  struct Donor {
    std::int32_t block, place;
    std::array<double, dim> velocity;  ///< of the surface
    // of the step: m_j, m_j + Σ m_g w s², m_j + Σ m_g w
    double mass, odd_mass, even_mass;
  };
  /// A ghost that follows a donor, with its weight.
  struct Follower {
    double weight;
    std::int32_t ghost;
  };
  /// Of a ghost, all that follows from where the surface lies.
  struct Geometry {
    std::int32_t place = 0;  ///< in its block
    double s = 0.0, friction = 0.0;
    std::array<double, dim> normal{};
    std::array<std::array<double, dim>, dim> turn{};  ///< A − I
    std::array<typename GridOf<dim>::Index, std::size_t{1} << dim> donor{};
    std::array<double, std::size_t{1} << dim> weight{};
    std::array<bool, std::size_t{1} << dim> free{};  ///< the donor is no ghost itself
  };
  struct Ghost {
    std::int32_t block, place;
    double s, friction;
    std::array<double, dim> normal, velocity;               ///< velocity of the surface
    std::array<std::array<double, dim>, dim> turn;          ///< A − I
    std::array<std::int32_t, std::size_t{1} << dim> donor;  ///< into donors; −1: none
    std::array<double, std::size_t{1} << dim> weight;
    // of the step: what is lacking, and 1/Σ weight over donors that bear mass
    double mass, per_borne;
    std::array<double, dim> odd, even;
    bool acts;
  };
  /// A plane over a column of cells that nothing of the ground reaches: what is above it needs no
  /// look at the map. NaN where no block of nodes has been yet.
  struct Lid {
    double height, slope_x, slope_z;  ///< at the column's middle
  };
  struct Layer {  ///< of one surface
    std::vector<Ghost> ghosts;
    std::vector<Donor> donors;
    /// Of the step. Donors: v_j relative to the surface and 1; −Σ_g m_g w s δ and Σ_g m_g w δ over
    /// their denominators. Zero where they bear no mass.
    std::vector<Four> front, odd, even;
    /// Of the step. Ghosts: −m_g s δ and m_g s², m_g δ and m_g, over Σ weight. Zero where they
    /// part.
    std::vector<Four> odd_pull, even_pull;
    /// Of one donor after the other, ghosts in their order; whose are the first's, the second's, …
    std::vector<Follower> followers;
    std::vector<std::size_t> first_follower;
    /// Of ground, above each column of cells, x first.
    std::vector<Lid> lids;
    /// By place of the block; of a surface at rest, for as long as the run lasts.
    std::map<std::array<std::int32_t, dim>, std::vector<Geometry>> geometry;
  };

  static std::vector<Geometry> geometry_of(const Surface& surface, const NodeBlockOf<dim>& block,
                                           double h, double time);
  static void build(const Surface& surface, Layer& layer, GridOf<dim>& grid, double time);
  static void cover(const Surface& surface, Layer& layer, const GridOf<dim>& grid,
                    const NodeBlockOf<dim>& block);
  bool is_above_lid(const std::vector<Lid>& lids, const std::array<double*, dim>& x,
                    std::size_t place) const;
  static void list_followers(Layer& layer);
  static WallEffect apply(const Surface& surface, Layer& layer, GridOf<dim>& grid,
                          tbb::task_arena& arena, double& work);
  static void transpose(const Surface& surface, const Layer& layer, GridOf<dim>& grid);

  std::vector<Surface> surfaces_;
  std::vector<Layer> layers_;
  double h_ = 0.0, per_h_ = 0.0;  ///< of the grid [m], [1/m]
  std::array<int, dim> cells_{};  ///< of the grid
};

}  // namespace repose::mpm

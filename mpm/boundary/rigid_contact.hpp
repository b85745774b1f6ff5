#pragma once
/// \file
/// Contact with rigid surfaces that lie across the grid at any angle, by their signed distance φ.
///
/// A node behind a surface (φ <= 0) to which points give mass is a ghost: it has no motion of its
/// own but one that the velocity in front of the surface implies. Let d = max(−φ, √dim h); the
/// place at φ = d over the ghost lies among 2^dim nodes in front of the surface, the ghost's
/// donors, with the mean velocity V = Σ w_j v_j. With v relative to the surface's own motion and s
/// = −φ/d, a field that is linear across the surface obeys
///   odd,  v_g = −sV:  it vanishes on the surface (all components: no slip; the normal one: slip),
///   even, v_g =   V:  its normal derivative does (the tangential ones: slip),
/// so that the surface stays where it is, between the nodes, to second order in h.
///
/// What the ghost lacks, δ = v_g + sV (odd) or v_g − V (even), is taken from the ghost and its
/// donors as the masses share it, by Gauss' principle of least constraint with lumped masses:
///   odd:   Δv_j = −Σ_g m_g w s δ/(m_j + Σ_g m_g w s²),   Δv_g = −δ − sΣ w Δv_j,
///   even:  Δv_j =  Σ_g m_g w δ/(m_j + Σ_g m_g w),        Δv_g = −δ +  Σ w Δv_j;
/// a field that has what it should have is left as it is, and the even one keeps the momentum
/// exactly. Coulomb friction: δ_n < 0 presses, δ_n >= 0 parts and is let go; the tangential odd
/// correction is that of φ δ_t, φ = min(1, friction |δ_n|/|δ_t|), hence its impulse friction times
/// the normal one, and the even one that of the share 1 − φ.
///
/// Without friction and at rest, a surface does the same to velocities before forces (as walls do,
/// walls.hpp). With it, or in motion, it gives impulses, and leaves those alone: the increment v −
/// u then carries the impulses to points that keep a velocity of their own.

#include <cstdint>
#include <vector>

#include "mpm/boundary/walls.hpp"
#include "mpm/grid/grid.hpp"
#include "mpm/scene/solid.hpp"

namespace repose::mpm {

template <int dim>
class RigidContact {
 public:
  explicit RigidContact(std::vector<Surface> surfaces) : surfaces_(std::move(surfaces)) {}

  bool empty() const { return surfaces_.empty(); }
  /// Whether anything may come within a cell of a surface from a block of points.
  bool is_near(const GridOf<dim>& grid, const PointBlockOf<dim>& block, double time) const;
  /// Applies the surfaces, one after the other, where they are at a time. `sorted`: the grid's
  /// blocks are not those of the call before. Returns what it did to the energy, and adds to `work`
  /// that of the surfaces' own motion on the material.
  WallEffect apply(GridOf<dim>& grid, double time, bool sorted, double& work);
  /// Puts a place that lies behind a surface on its front side, a hair away. Returns whether it
  /// did.
  bool keep_out(std::array<double, dim>& x, double time, double hair) const;

 private:
  struct Donor {
    std::int32_t block, place;
    std::array<double, dim> velocity;  ///< of the surface
    // sums over its ghosts: Σ m w s², Σ m w, and the corrections of u and v
    double odd_mass = 0.0, even_mass = 0.0;
    std::array<double, dim> u_odd{}, u_even{}, v_odd{}, v_even{};
  };
  struct Ghost {
    std::int32_t block, place;
    double s;
    std::array<double, dim> normal, velocity;               ///< of the surface
    std::array<std::int32_t, std::size_t{1} << dim> donor;  ///< into donors; −1: none
    std::array<double, std::size_t{1} << dim> weight;
    // of the step: what is lacking in u and v, and the weights' sum over donors that bear mass
    std::array<double, dim> u_odd, u_even, v_odd, v_even;
    double borne;
    bool acts;
  };
  struct Layer {  ///< of one surface
    std::vector<Ghost> ghosts;
    std::vector<Donor> donors;
  };

  Layer layer_of(const Surface& surface, GridOf<dim>& grid, double time) const;
  WallEffect apply(const Surface& surface, Layer& layer, GridOf<dim>& grid, double& work) const;

  std::vector<Surface> surfaces_;
  std::vector<Layer> layers_;
};

}  // namespace repose::mpm

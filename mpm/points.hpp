#pragma once
/// \file
/// The material points of one body, as a structure of arrays sorted by grid block.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "models/material.hpp"
#include "mpm/lanes.hpp"

namespace repose::mpm {

/// What a point carries in the plane; a field per array. State variables of the law follow the last
/// one.
enum Field : std::size_t {
  X,
  Y,  ///< position [m]
  VX,
  VY,  ///< velocity [m/s]
  LXX,
  LXY,
  LYX,
  LYY,  ///< velocity gradient = affine velocity field of APIC [1/s]
  SXX,
  SYY,
  SZZ,
  SXY,    ///< Cauchy stress, tension positive [Pa]
  RHO,    ///< density [kg/m³]
  MASS,   ///< per metre of depth [kg/m]
  STATE,  ///< first state variable of the law
};
constexpr std::size_t max_state = 4;
constexpr std::size_t affine_fields = 4;
constexpr std::size_t split_fields = 2;

/// The same order of fields in `dim` dimensions: where each group begins. L is row by row, stresses
/// come as in Sym (xx, yy, zz, xy and, in space, yz, zx).
template <int dim>
struct Layout {
  static_assert(dim == 2 || dim == 3);
  static constexpr std::size_t axes = dim;
  static constexpr std::size_t components = dim == 2 ? 4 : 6;
  static constexpr std::size_t gradient = axes * axes;  ///< fields of a velocity gradient
  static constexpr std::size_t x = 0;
  static constexpr std::size_t v = x + axes;
  static constexpr std::size_t L = v + axes;
  static constexpr std::size_t stress = L + gradient;
  static constexpr std::size_t rho = stress + components;
  static constexpr std::size_t mass =
      rho + 1;  ///< per metre of depth in the plane [kg/m], else [kg]
  static constexpr std::size_t state = mass + 1;
};
static_assert(Layout<2>::v == VX && Layout<2>::L == LXX && Layout<2>::stress == SXX &&
              Layout<2>::rho == RHO && Layout<2>::mass == MASS && Layout<2>::state == STATE &&
              Layout<2>::gradient == affine_fields);

/// A contiguous run of slots: the points of one body in one block. `begin` is a multiple of the
/// pack size; the slots between count and padded(count) hold copies of the last point, valid but
/// never transferred.
struct Range {
  std::size_t begin = 0;
  std::size_t count = 0;
};

template <int dim>
struct PointsOf {
  using At = Layout<dim>;
  using Batch = BatchOf<static_cast<int>(At::components)>;

  std::shared_ptr<const Material> material;
  double rho_0 = 0.0;     ///< reference density for solid depths [kg/m³]
  std::size_t count = 0;  ///< points (without padding)
  /// state + state variables of the law + stress of the explicit forces + own affine field
  std::size_t fields = At::state;
  /// First of the fields (row by row) of the affine velocity that goes to the grid: L, or one
  /// behind the state where it is kept apart from the velocity gradient.
  std::size_t affine = At::L;
  /// The fields whose stress gives the explicit forces, xx, yy, xy in the plane and xx, yy, zz, xy,
  /// yz, zx in space: the whole stress; or in the plane two fields behind the state, −p and 0,
  /// where the viscous part acts implicitly (implicit_viscosity.hpp).
  std::array<std::size_t, dim == 2 ? 3 : 6> force_stress = whole_stress();
  std::array<AlignedVector<double>, At::state + max_state + split_fields + At::gradient> field;
  std::vector<std::int64_t> id;  ///< order of creation, the point's name for life; −1 in padding

  double* operator[](std::size_t f) { return field[f].data(); }
  const double* operator[](std::size_t f) const { return field[f].data(); }
  std::size_t slots() const { return id.size(); }
  bool splits_stress() const { return force_stress[0] != At::stress; }
  std::size_t state_fields() const {
    return (splits_stress() ? force_stress[0] : affine == At::L ? fields : affine) - At::state;
  }

  /// Views of the points of a range, for the law; strain and outputs are left to the caller.
  Batch batch(const Range& range);

 private:
  static constexpr std::array<std::size_t, dim == 2 ? 3 : 6> whole_stress() {
    constexpr std::size_t s = At::stress;
    if constexpr (dim == 2)
      return {s, s + 1, s + 3};
    else
      return {s, s + 1, s + 2, s + 3, s + 4, s + 5};
  }
};
using PointSet = PointsOf<2>;  ///< plane strain, per metre of depth

/// Moves every point to the slot that `order` gives: slot k takes the point that was in order[k]
/// (padding is filled by repeating the last point of its range).
template <int dim>
void rearrange(PointsOf<dim>& points, const std::vector<std::uint32_t>& order,
               const std::vector<bool>& is_padding);

/// v·v of a point [m²/s²].
template <int dim>
double squared_speed(const PointsOf<dim>& points, std::size_t s) {
  double v2 = 0.0;
  for (std::size_t i = 0; i < dim; ++i)
    v2 += points[Layout<dim>::v + i][s] * points[Layout<dim>::v + i][s];
  return v2;
}

}  // namespace repose::mpm

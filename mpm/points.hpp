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

/// What a point carries; a field per array. State variables of the law follow the last one.
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

/// A contiguous run of slots: the points of one body in one block. `begin` is a multiple of the
/// pack size; the slots between count and padded(count) hold copies of the last point, valid but
/// never transferred.
struct Range {
  std::size_t begin = 0;
  std::size_t count = 0;
};

struct PointSet {
  std::shared_ptr<const Material> material;
  double rho_0 = 0.0;     ///< reference density for solid depths [kg/m³]
  std::size_t count = 0;  ///< points (without padding)
  /// STATE + state variables of the law + stress of the explicit forces + own affine field
  std::size_t fields = STATE;
  /// First of the four fields (xx, xy, yx, yy) of the affine velocity that goes to the grid: LXX,
  /// or one behind the state where it is kept apart from the velocity gradient.
  std::size_t affine = LXX;
  /// The fields (xx, yy, xy) whose stress gives the explicit forces: the whole stress, or two
  /// fields behind the state, −p and 0, where the viscous part acts implicitly
  /// (implicit_viscosity.hpp).
  std::array<std::size_t, 3> force_stress{SXX, SYY, SXY};
  std::array<AlignedVector<double>, STATE + max_state + split_fields + affine_fields> field;
  std::vector<std::int64_t> id;  ///< order of creation, the point's name for life; −1 in padding

  double* operator[](std::size_t f) { return field[f].data(); }
  const double* operator[](std::size_t f) const { return field[f].data(); }
  std::size_t slots() const { return id.size(); }
  bool splits_stress() const { return force_stress[0] != SXX; }
  std::size_t state_fields() const {
    return (splits_stress() ? force_stress[0] : affine == LXX ? fields : affine) - STATE;
  }

  /// Views of the points of a range, for the law; strain and outputs are left to the caller.
  Batch batch(const Range& range);
};

/// Moves every point to the slot that `order` gives: slot k takes the point that was in order[k]
/// (padding is filled by repeating the last point of its range).
void rearrange(PointSet& points, const std::vector<std::uint32_t>& order,
               const std::vector<bool>& is_padding);

}  // namespace repose::mpm

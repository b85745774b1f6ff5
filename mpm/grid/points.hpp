#pragma once
/// \file
/// The material points of one body, as a structure of arrays sorted by grid block.

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "models/material.hpp"
#include "mpm/grid/aligned_vector.hpp"

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
constexpr std::size_t max_state = most_state_variables;
constexpr std::size_t affine_fields = 4;
constexpr std::size_t split_fields = 2;  ///< of a stress that is split (implicit_viscosity.hpp)

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

/// One field of all points, read as doubles however it is stored.
class FieldView {
 public:
  FieldView(const double* wide, const float* narrow, const float* rest)
      : wide_(wide),
        narrow_(narrow),
        rest_(rest) {}
  double operator[](std::size_t slot) const {
    if (wide_ != nullptr) return wide_[slot];
    return rest_ == nullptr ? double{narrow_[slot]} : double{narrow_[slot]} + double{rest_[slot]};
  }

 private:
  const double* wide_;
  const float* narrow_;
  const float* rest_;
};

/// A contiguous run of slots: the points of one body in one block. `begin` is a multiple of the
/// pack size; the slots between count and padded(count) hold copies of the last point, valid but
/// never transferred.
struct SlotRange {
  std::size_t begin = 0;
  std::size_t count = 0;
};

/// Points in double precision; or, `single`, in single precision between the steps that work on
/// them: then every field is rounded to 24 bits when a block is done but the position,
/// which is the sum of two floats (48 bits), or small steps would not move a point at all.
template <int dim>
struct PointsOf {
  using At = Layout<dim>;
  using Batch = BatchOf<static_cast<int>(At::components)>;
  static constexpr std::size_t force_components = dim == 2 ? 3 : 6;
  static constexpr std::size_t most_fields =
      At::state + max_state + 1 + force_components + At::gradient;

  std::shared_ptr<const Material> material;
  double rho_0 = 0.0;     ///< reference density for solid depths [kg/m³]
  std::size_t count = 0;  ///< points (without padding)
  /// state + state variables of the law + shear strain + stress of the explicit forces + own affine
  /// field
  std::size_t fields = At::state;
  std::size_t shear_strain = 0;  ///< field of ∫γ̇ dt, γ̇ = √(2D′:D′); 0: not kept
  /// First of the fields (row by row) of the affine velocity that goes to the grid: L, or one
  /// behind the state where it is kept apart from the velocity gradient.
  std::size_t affine = At::L;
  /// The fields whose stress gives the explicit forces, xx, yy, xy in the plane and xx, yy, zz, xy,
  /// yz, zx in space: the whole stress; or fields behind the state: in the plane two, −p and 0,
  /// where the viscous part acts implicitly (implicit_viscosity.hpp), or one for each, with what
  /// contacts add where they damp (contact_damping.hpp).
  std::array<std::size_t, force_components> force_stress = whole_stress();
  double damping_length = 0.0;  ///< ℓ of contact_damping.hpp [m]; 0: contacts do not damp
  double damped_signal = 1.0;   ///< what they make of the fastest signal, over it
  std::array<AlignedVector<double>, most_fields> field;  ///< empty if `single`
  std::vector<std::int64_t> id;  ///< order of creation, the point's name for life; −1 in padding

  bool single = false;
  std::array<AlignedVector<float>, most_fields> narrow;  ///< the fields, if `single`
  std::array<AlignedVector<float>, dim> rest;            ///< what `narrow` leaves of the position

  FieldView operator[](std::size_t f) const;
  void set(std::size_t f, std::size_t slot, double value);
  /// Of points in double precision, which the stages of a step work on.
  double* data(std::size_t f) { return field[f].data(); }
  const double* data(std::size_t f) const { return field[f].data(); }
  std::size_t slots() const { return id.size(); }
  bool damps() const { return damping_length > 0.0; }
  bool splits_stress() const { return force_stress[0] != At::stress && !damps(); }
  std::size_t state_fields() const {
    return (shear_strain != 0            ? shear_strain
            : splits_stress() || damps() ? force_stress[0]
            : affine == At::L            ? fields
                                         : affine) -
           At::state;
  }
  std::size_t bytes_per_slot() const {
    return fields * (single ? sizeof(float) : sizeof(double)) + (single ? dim : 0) * sizeof(float) +
           sizeof(std::int64_t);
  }

  /// Views of the points of a range, for the law; strain and outputs are left to the caller. Of
  /// points in double precision.
  Batch batch(const SlotRange& range);

  /// Calls f(points, range) with a range of points in double precision: these, or a copy whose
  /// changes are lost (read) or rounded and kept (update).
  template <class F>
  void read(const SlotRange& range, F&& f) {
    if (!single) return f(*this, range);
    f(unpacked(range), SlotRange{0, range.count});
  }
  template <class F>
  void update(const SlotRange& range, F&& f) {
    if (!single) return f(*this, range);
    PointsOf& copy = unpacked(range);
    f(copy, SlotRange{0, range.count});
    pack(copy, range);
  }

  /// Calls f(first slot, points, range) with copies of all slots in double precision, some
  /// thousands at a time; what f changes is lost.
  template <class F>
  void copy_in_parts(F&& f) const {
    constexpr std::size_t slots_of_part = 4096;
    for (std::size_t first = 0; first < slots(); first += slots_of_part) {
      const SlotRange range{first, std::min(slots_of_part, slots() - first)};
      f(first, unpacked(range), SlotRange{0, range.count});
    }
  }

  /// A field, and a field from its values, one per slot.
  std::vector<double> values(std::size_t f) const;
  void assign(std::size_t f, const std::vector<double>& values);
  /// Room for n points, and the value of a field of the next one.
  void reserve(std::size_t n);
  void append(std::size_t f, double value);

 private:
  PointsOf& unpacked(const SlotRange& range) const;  ///< one copy per thread
  void pack(const PointsOf& copy, const SlotRange& range);
  static constexpr std::array<std::size_t, force_components> whole_stress() {
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

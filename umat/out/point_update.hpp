#pragma once
/// \file
/// One integration point over one step, with the consistent tangent.

#include <memory>
#include <span>

#include "models/law.hpp"
#include "models/material.hpp"
#include "models/tangent.hpp"

namespace repose::umat {

/// What a step changes at a point, besides the state variables.
template <int N>
struct Point {
  Sym<double, N> stress;  ///< Cauchy, tension positive [Pa]
  double density = 0.0;   ///< [kg/m³]
  /// Energies per current volume [J/m³]: recoverable, and since the start dissipated in plastic and
  /// in viscous flow
  double stored = 0.0, plastic = 0.0, viscous = 0.0;
};

/// A law with its parameters.
class PointUpdate {
 public:
  virtual ~PointUpdate();
  PointUpdate() = default;
  PointUpdate(const PointUpdate&) = delete;
  PointUpdate& operator=(const PointUpdate&) = delete;

  /// A point at rest. Throws InputError where the law cannot start from these conditions.
  virtual InitialPoint initial(const InitialConditions& given) const = 0;

  /// Advances a point by the logarithmic strain Δε over dt [s], the stress turned with the material
  /// beforehand. `state` is in table order. `derived`, of derived_fields() size or empty, receives
  /// the variables that follow from the state. False, and nothing is changed, where the step cannot
  /// be done.
  virtual bool advance(const Sym<double, 4>& strain, double dt, Point<4>& point,
                       std::span<double> state, std::span<double> derived,
                       Tangent<4>& tangent) const = 0;
  virtual bool advance(const Sym<double, 6>& strain, double dt, Point<6>& point,
                       std::span<double> state, std::span<double> derived,
                       Tangent<6>& tangent) const = 0;
};

/// Of one of the library's own laws, `theta` complete. Throws InputError (key "name") for another.
std::unique_ptr<PointUpdate> make_point_update(const LawInfo& law, std::span<const double> theta);

}  // namespace repose::umat

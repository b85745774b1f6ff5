#pragma once
/// \file
/// What the way from a tile to points gives.

#include "models/scalar.hpp"

namespace repose::mpm {

/// A field at the points of a pack: Σ w f, and Σ w f d with the distance d in units of h or, for
/// the spline's gradient, Σ f ∂w/∂ξ.
struct Moments {
  Pack value = Pack(0.0), dx = Pack(0.0), dy = Pack(0.0);
};

/// The same in space.
struct SpaceMoments : Moments {
  Pack dz = Pack(0.0);
};

template <int dim>
using MomentsOf = std::conditional_t<dim == 2, Moments, SpaceMoments>;

/// Σ w f d along an axis.
template <std::size_t axis>
const Pack& derivative(const Moments& m) {
  static_assert(axis < 2);
  return axis == 0 ? m.dx : m.dy;
}
template <std::size_t axis>
const Pack& derivative(const SpaceMoments& m) {
  return axis == 0 ? m.dx : axis == 1 ? m.dy : m.dz;
}

}  // namespace repose::mpm

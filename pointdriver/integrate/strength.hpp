#pragma once
/// \file
/// Was a stress asked for that the material cannot carry? A path that broke off under stress
/// control is driven again by strain, which passes every peak, and the largest stress on the way is
/// the strength.

#include "pointdriver/integrate/simulate.hpp"

namespace repose::point {

/// Of the leg in which a path broke off.
struct Strength {
  Quantity quantity = Quantity::q;  ///< what was to be reached
  double asked = 0.0;               ///< value that was asked for
  double carried = 0.0;             ///< the most that is carried on this way
  double q = 0.0;                   ///< deviator stress there [Pa]
  double rate = 0.0;                ///< strain rate at which it was found, if it matters [1/s]
};

/// The strength on the way of the leg in which `curve` failed, if the stress that the leg asks for
/// lies beyond it; nullopt if it does not, or if it cannot be told (stresses and strains both
/// prescribed to change). Drives the strain by up to 5.
std::optional<Strength> strength_exceeded(const LawInfo& law, std::span<const double> theta,
                                          const PointTest& test, const Curve& curve);

}  // namespace repose::point

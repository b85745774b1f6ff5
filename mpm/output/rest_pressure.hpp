#pragma once
/// \file
/// How well a deposit at rest carries its own weight: pressure and vertical stress of the points
/// against the overburden ρ g × depth, told apart into what is smooth and what is noise.
///
/// The overburden of a point is the weight of the column of material above it per width, so that
/// no density and no surface has to be assumed:
///   P(x, y) = g Σ_q m_q N(x − x_q) A(y_q − y),
/// N the cubic B-spline of half width 2h (∫N = 1; unbiased where the depth changes linearly, with
/// images in the side walls), A the share of point q, of height √(m_q/ρ_q), that lies above y.
///
/// The local mean of a quantity is its linear least-squares fit over the neighbours, weighted with
/// m_q N(x − x_q) N(y − y_q): a fit and not an average, so that a gradient is no noise and surface
/// and floor cause no bias. With p a point's pressure, p̄ the local mean there,
///   deviation = p/P − 1,   smooth = p̄/P − 1,   noise = (p − p̄)/P.
/// The smooth part is mechanics: a heap at rest keeps stresses from its flow, and needs no
/// p = ρ g × depth (only −σ_yy integrated over a base must be its weight). The noise is not.

#include <cstdint>
#include <vector>

#include "mpm/step/simulation.hpp"

namespace repose::mpm {

/// Root mean squares over the points judged.
struct Deviation {
  double total = 0.0, smooth = 0.0, noise = 0.0;
};

struct RestPressure {
  std::int64_t points = 0;          ///< judged: deeper than min_depth, where the deposit is thick
  double largest_overburden = 0.0;  ///< [Pa]
  Deviation pressure;               ///< p = −tr σ/3, relative to the overburden of the point
  Deviation vertical;               ///< −σ_yy, likewise
  /// The same two over the points of the row of half cells on the floor; NaN if there is none
  Deviation floor_pressure, floor_vertical;
  Deviation pressure_of_largest;     ///< the same of p, all relative to the largest overburden
  Deviation vertical_of_largest;     ///< the same of −σ_yy
  double mean_ratio = 0.0;           ///< mean of p/P
  double mean_vertical_ratio = 0.0;  ///< mean of −σ_yy/P
  /// The same two means over the points of the row of half cells on the floor; NaN if there is none
  double floor_ratio = 0.0, floor_vertical_ratio = 0.0;
};

/// Judges the points that lie deeper than `min_depth` [m of solid] below the surface, and where the
/// deposit is at least `min_share` of its greatest depth thick (away from the toe). `rho_0`: of
/// every body [kg/m³], `h`: cell size [m], `width`: of the box [m], `g`: gravity along −y [m/s²].
RestPressure rest_pressure(const Simulation::Snapshot& points, const std::vector<double>& rho_0,
                           double h, double width, double g, double min_depth, double min_share);

}  // namespace repose::mpm

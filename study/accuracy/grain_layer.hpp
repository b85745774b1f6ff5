#pragma once
/// \file
/// A layer of μ(I) grains down a rough incline, from rest, as the momentum balance across it:
///     ρ ∂u/∂t = ρ g sin(tilt) + ∂τ/∂y,  u(0) = 0,  τ(H) = 0,
/// under p = ρ g cos(tilt)(H − y), with the elastic shear and the friction of the law (MUI-1 to
/// MUI-3 in one dimension; docs/physics.md, "Exact flows").

#include <cstddef>
#include <vector>

namespace repose::study {

struct GrainLayer {
  double H = 0.0;              ///< depth [m]
  double g = 0.0, tilt = 0.0;  ///< [m/s², rad]
  double mu_0 = 0.0, mu_d = 0.0, I_0 = 0.0;
  double d = 0.0, rho_p = 0.0, rho = 0.0;  ///< grains [m, kg/m³], bulk density [kg/m³]
  double G = 0.0;                          ///< [Pa]
};

/// u = U f(y/H), f = 1 − (1 − y/H)^{3/2}: what it tends to where μ_0 < tan(tilt) < μ_d. U [m/s].
double bagnold_speed(const GrainLayer& layer);

/// Means over the depth of u [m/s] and u² [m²/s²].
struct LayerMeans {
  double velocity = 0.0, square = 0.0;
};

/// At the times 0, interval, 2 interval, ... The layer has `cells` finite volumes, an interval
/// `steps` implicit steps, a hundred times as many in the first, in which it
/// yields: with the defaults right to 1e-4 of what it tends to.
std::vector<LayerMeans> starting_flow(const GrainLayer& layer, double interval, std::size_t rows,
                                      std::size_t cells = 100, std::size_t steps = 40);

}  // namespace repose::study

#pragma once
/// \file
/// The response of a law's type to steady shear, by dual numbers.

#include "models/dual.hpp"
#include "models/ill_posedness.hpp"

namespace repose {

/// Whether a law says its steady shear stress, steady_shear_stress(P, p, γ̇).
template <class L>
concept HasSteadyShear = requires(const typename L::template Params<double>& P) {
  L::steady_shear_stress(P, 1.0, 1.0);
};

/// p [Pa], γ̇ [1/s] > 0.
template <class L>
ShearResponse shear_response(std::span<const double> theta, double p, double gamma_dot) {
  using T = Dual<2>;
  std::array<T, L::parameters.size()> wide;
  for (std::size_t k = 0; k < wide.size(); ++k) wide[k] = T(theta[k]);
  const auto P = L::template Params<T>::from(std::span<const T>(wide));
  const T tau = L::steady_shear_stress(P, T(p, 0), T(gamma_dot, 1));
  return {tau.a, tau.v[1] * gamma_dot / tau.a, tau.v[0]};
}

}  // namespace repose

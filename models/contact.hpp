#pragma once
/// \file
/// Materials that press and do not pull: p > 0 from the density ρ_0 on, nothing below it.

#include "models/scalar.hpp"

namespace repose {

/// Of a step's volume strain tr Δε, the part during which a material that bears from ρ_0 on bears
/// nothing; 0 unless the step crosses ρ_0. `density`: at its end.
template <class T>
T strain_apart(const T& density, const T& rho_0, const T& strain_v) {
  using std::log;
  const auto opens = density < rho_0 && strain_v > T(0.0);
  // ρ_n = ρ e^{tr Δε} > ρ(1 + tr Δε) may have lain below it: most steps need no logarithm
  const auto closes = density > rho_0 && density * (T(1.0) + strain_v) < rho_0;
  if (!any(opens || closes)) return T(0.0);
  const T beyond = log(rho_0 / density);  // extension beyond ρ_0 at the end
  const T opened = select(beyond < strain_v, beyond, T(0.0));
  const T closed = select(beyond > strain_v, T(strain_v - beyond), T(0.0));
  return select(opens, opened, select(closes, closed, T(0.0)));
}

}  // namespace repose

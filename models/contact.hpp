#pragma once
/// \file
/// Materials that press and do not pull: p > 0 from the density ρ_0 on, nothing below it.

#include "models/law.hpp"
#include "models/scalar.hpp"

namespace repose {

/// Of the work of a step's mean pressure, the part over the strain during which ρ < ρ_0 and nothing
/// presses (StepWork::separation); 0 unless the step crosses ρ_0. `stress` before the step, `p`
/// after it. To the order of the mean pressure itself: ln(ρ_0/ρ) = 2(ρ_0 − ρ)/(ρ_0 + ρ), to third
/// order.
template <class T, int N>
T work_over_gap(const T& rho_0, const Sym<T, N>& stress, const T& p, const Increment<T, N>& inc) {
  const T strain_v = trace(inc.strain);
  // how far ρ lies beyond ρ_0, and ρ_n = ρ e^{tr Δε}, as extensions; most steps cross nothing,
  // which no division is needed to see
  const T gap = T(2.0) * (rho_0 - inc.density);
  const T sum = rho_0 + inc.density;
  const auto crosses = gap * (gap - strain_v * sum) < T(0.0);
  if (!any(crosses)) return T(0.0);
  const T beyond = gap / sum;
  const T before = beyond - strain_v;
  const T apart = select(beyond > T(0.0), beyond, T(-before));
  return select(crosses, T(T(-0.5) * (pressure(stress) + p) * apart), T(0.0));
}

}  // namespace repose

#pragma once
/// \file
/// The consistent tangent of a law's own update at one point, by dual numbers: that of the discrete
/// step, which keeps Newton's method quadratic (Simo & Taylor 1985).

#include "models/dual.hpp"
#include "models/law.hpp"
#include "models/scalar.hpp"
#include "models/tangent.hpp"

namespace repose {

/// From stress (already turned with the material), state and density before the step. False where
/// the law cannot make the step or a slope is not finite; `tangent` is then as it was.
template <class L, int N>
bool point_tangent(const typename L::template Params<Dual<N>>& P, const Sym<double, N>& strain,
                   double dt, double density, const Sym<double, N>& stress,
                   std::span<const double> state, Tangent<N>& tangent) {
  using D = Dual<N>;
  Increment<D, N> inc;
  Sym<D, N> at;
  typename L::template State<D> now{};
  // without strain an update may leave a point alone, slopes and all: then the way of unloading
  const bool none = contract(strain, strain) == 0.0;
  for (int k = 0; k < N; ++k) {
    inc.strain[k] = D(none && k < 3 ? 1e-30 : strain[k], k);
    at[k] = D(stress[k]);
  }
  for (std::size_t k = 0; k < L::state.size(); ++k) now[k] = D(state[k]);
  inc.dt = D(dt);
  inc.density = D(density) * exp_pair(D(-trace(inc.strain))).whole;
  if (L::update(P, inc, at, now)) return false;
  Tangent<N> found;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) {
      const double slope = at[i].v[j];
      if (!finite(slope)) return false;
      found[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = slope;
    }
  tangent = found;
  return true;
}

}  // namespace repose

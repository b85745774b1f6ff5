#pragma once
/// \file
/// The objective part of a stress update: the stress is carried along with the material's rotation
/// by an exactly orthogonal matrix before the law sees the (unrotated) strain increment.

#include "models/sym.hpp"

namespace repose {

/// Stress after a plane rotation by the spin of one step, `angle` = W_yx Δt = ½(∂v_y/∂x −
/// ∂v_x/∂y)Δt [rad]. The rotation is Cayley's R = (I − ½WΔt)⁻¹(I + ½WΔt) (Hughes & Winget 1980),
/// orthogonal for any step, so that the invariants of the stress change by round-off only.
template <class T, int N>
[[gnu::always_inline]] inline Sym<T, N> rotated_in_plane(const Sym<T, N>& stress, const T& angle) {
  const T h = T(0.5) * angle;
  const T inv = T(1.0) / (T(1.0) + h * h);
  const T c = (T(1.0) - h * h) * inv;
  const T s = T(2.0) * h * inv;
  // σ′ = R σ Rᵀ by mean and half-difference of the in-plane stresses (rotation by twice the angle)
  const T mean = T(0.5) * (stress[0] + stress[1]);
  const T half = T(0.5) * (stress[0] - stress[1]);
  const T cos2 = c * c - s * s;
  const T sin2 = T(2.0) * c * s;
  const T half_rotated = half * cos2 - stress[3] * sin2;
  Sym<T, N> r = stress;
  r[0] = mean + half_rotated;
  r[1] = mean - half_rotated;
  r[3] = half * sin2 + stress[3] * cos2;
  if constexpr (N == 6) {  // yz and zx turn like a vector
    r[4] = s * stress[5] + c * stress[4];
    r[5] = c * stress[5] - s * stress[4];
  }
  return r;
}

}  // namespace repose

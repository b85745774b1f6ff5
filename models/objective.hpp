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

/// Stress after a rotation in space by the spin of one step, W Δt a = θ × a with the rotation
/// vector θ = ½ rot v Δt [rad]: Cayley's rotation again, which with t = θ/2 is
///   R a = a + 2/(1 + t²) (t × a + t × (t × a)).
/// An isotropic stress comes out as it went in, to the last bit.
template <class T>
Sym<T, 6> rotated(const Sym<T, 6>& stress, const std::array<T, 3>& theta) {
  const T half(0.5), one(1.0), two(2.0);
  const T x = half * theta[0];
  const T y = half * theta[1];
  const T z = half * theta[2];
  const T f = two / (one + (x * x + y * y + z * z));
  const T R[3][3] = {{one - f * (y * y + z * z), f * (x * y - z), f * (x * z + y)},
                     {f * (x * y + z), one - f * (z * z + x * x), f * (y * z - x)},
                     {f * (x * z - y), f * (y * z + x), one - f * (x * x + y * y)}};
  const T m = mean(stress);
  const T s[3][3] = {{stress[0] - m, stress[3], stress[5]},
                     {stress[3], stress[1] - m, stress[4]},
                     {stress[5], stress[4], stress[2] - m}};
  // s′ = R s Rᵀ
  T Rs[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      Rs[i][j] = R[i][0] * s[0][j] + R[i][1] * s[1][j] + R[i][2] * s[2][j];
  const auto turned = [&](int i, int j) {
    return Rs[i][0] * R[j][0] + Rs[i][1] * R[j][1] + Rs[i][2] * R[j][2];
  };
  Sym<T, 6> r;
  for (int i = 0; i < 3; ++i) r[i] = m + turned(i, i);
  r[3] = turned(0, 1);
  r[4] = turned(1, 2);
  r[5] = turned(2, 0);
  return r;
}

}  // namespace repose

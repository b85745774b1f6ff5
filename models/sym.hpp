#pragma once
/// \file
/// Symmetric 3×3 tensors. Stress is Cauchy stress, tension positive, in Pa.

#include <array>
#include <cmath>
#include <cstddef>

#include "models/scalar_traits.hpp"

namespace repose {

/// A symmetric 3×3 tensor by its independent components.
///   N = 4: xx, yy, zz, xy          plane strain (zz is carried, yz = zx = 0)
///   N = 6: xx, yy, zz, xy, yz, zx  three dimensions
/// Off-diagonal components are tensor components (ε_xy, not γ_xy = 2ε_xy).
template <class T, int N>
struct Sym {
  static_assert(N == 4 || N == 6);
  static constexpr int size = N;
  std::array<T, static_cast<std::size_t>(N)> c{};

  T& operator[](int i) { return c[static_cast<std::size_t>(i)]; }
  const T& operator[](int i) const { return c[static_cast<std::size_t>(i)]; }

  static Sym isotropic(const T& x) {
    Sym r;
    for (int i = 0; i < 3; ++i) r[i] = x;
    for (int i = 3; i < N; ++i) r[i] = T(0.0);
    return r;
  }

  friend Sym operator+(const Sym& a, const Sym& b) {
    Sym r;
    for (int i = 0; i < N; ++i) r[i] = a[i] + b[i];
    return r;
  }
  friend Sym operator-(const Sym& a, const Sym& b) {
    Sym r;
    for (int i = 0; i < N; ++i) r[i] = a[i] - b[i];
    return r;
  }
  friend Sym operator*(const T& f, const Sym& a) {
    Sym r;
    for (int i = 0; i < N; ++i) r[i] = f * a[i];
    return r;
  }
};

template <class T, int N>
T trace(const Sym<T, N>& a) {
  return a[0] + a[1] + a[2];
}

/// tr(a)/3, exact where the three are equal (their sum over 3 is not: rest would drift).
template <class T, int N>
T mean(const Sym<T, N>& a) {
  return a[0] + ((a[1] - a[0]) + (a[2] - a[0])) / T(3.0);
}

/// a − (tr a/3) I, from differences: nothing of a large tr a is left in it.
template <class T, int N>
Sym<T, N> deviator(const Sym<T, N>& a) {
  const T third(1.0 / 3.0);
  const T xy = a[0] - a[1];
  const T yz = a[1] - a[2];
  const T zx = a[2] - a[0];
  Sym<T, N> r = a;
  r[0] = third * (xy - zx);
  r[1] = third * (yz - xy);
  r[2] = third * (zx - yz);
  return r;
}

/// a : b
template <class T, int N>
[[gnu::always_inline]] inline T contract(const Sym<T, N>& a, const Sym<T, N>& b) {
  T normal = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  T shear = a[3] * b[3];
  for (int i = 4; i < N; ++i) shear = shear + a[i] * b[i];
  return normal + T(2.0) * shear;
}

/// √(a:a)
template <int N>
double norm(const Sym<double, N>& a) {
  return std::sqrt(contract(a, a));
}

/// p = −tr(σ)/3, compression positive.
template <class T, int N>
T pressure(const Sym<T, N>& stress) {
  return -mean(stress);
}

/// √(½ s:s), the shear stress τ of a deviator s; 0 at s = 0 (also for its derivatives, which do not
/// exist there: a Dual is given the one-sided value 0 instead of a NaN).
template <class T, int N>
T shear_norm(const Sym<T, N>& dev) {
  using std::sqrt;
  const T half = T(0.5) * contract(dev, dev);
  if constexpr (ScalarTraits<T>::is_dual) {
    if (!(value(half) > 0.0)) return T(value(half));  // NaN stays NaN
  }
  return sqrt(half);
}

/// q = √(3/2 s:s) of a stress (not only of a deviator).
template <class T, int N>
T mises(const Sym<T, N>& stress) {
  return T(std::sqrt(3.0)) * shear_norm(deviator(stress));
}

}  // namespace repose

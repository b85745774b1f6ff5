#pragma once
/// \file
/// The shape of the cone of friction: how much of the strength that a law has in triaxial
/// compression, q = Mp, there is in other directions of shear (physics.md, CONE).
///
///   circle            the same in all (Drucker & Prager): a friction angle of 22° in plane
///                     strain is 17° in triaxial compression
///   matsuoka_nakai    I_1I_2/I_3 = 9 + 8 tan²φ (Matsuoka & Nakai 1974): the same friction angle φ
///                     in triaxial compression and extension, a few degrees more between them
///
/// The direction of shear is Lode's angle θ, cos 3θ = (27/2) det s/q³ with compression positive: 1
/// in triaxial compression, 0 in simple shear, −1 in triaxial extension. Flow stays along s, so
/// that a return in which s_{n+1} ∥ s_trial keeps θ, and with it the strength, from the trial state
/// on: the returns of a circle serve any shape.

#include <array>

#include "models/parameter.hpp"
#include "models/scalar.hpp"
#include "models/sym.hpp"

namespace repose::cone {

inline constexpr std::array<std::string_view, 2> shapes{"circle", "matsuoka_nakai"};
/// Last in the table of every frictional law.
inline constexpr ParamInfo shape{
    "shape",
    "g(θ)",
    "-",
    "shape of the cone of friction; matsuoka_nakai: friction is that of triaxial compression",
    Need::defaulted,
    0.0,
    Range{0.0, 1.0, false, false},
    Scale::linear,
    {},
    shapes};

/// M = q/p of a friction angle φ [°] in triaxial compression, 6 sin φ/(3 − sin φ).
double slope_of_angle(double phi_deg);
/// The same as μ = τ/p, M/√3.
double friction_of_angle(double phi_deg);
/// Throws InputError (key mu_0) where μ_0, of triaxial compression, is no friction angle: M >= 3.
void check(double shape_given, double mu_0);

template <class T>
bool is_circle(const T& shape_given) {
  return !any(shape_given > T(0.5));
}

/// cos 3θ of a deviator (tension positive); 1 at s = 0, where it has no value.
template <class T, int N>
T cos_3_theta(const Sym<T, N>& s) {
  using std::sqrt;
  const T one(1.0);
  const T q2 = T(1.5) * contract(s, s);
  const auto sheared = q2 > T(1e-290);
  const T inv_q = one / sqrt(select(sheared, q2, one));
  const Sym<T, N> n = inv_q * s;
  T det = n[2] * (n[0] * n[1] - n[3] * n[3]);
  if constexpr (N == 6)
    det = det + T(2.0) * n[3] * n[4] * n[5] - n[0] * n[4] * n[4] - n[1] * n[5] * n[5];
  const T c = T(-13.5) * det;
  return select(sheared, select(c > one, one, select(c < -one, T(-one), c)), one);
}

/// 1/g of the Matsuoka–Nakai cone, g = (q/p)/M: the largest root of
///     9z³ − (9 + b)z + b cos 3θ = 0,   b = M(3 + M)                                        CONE-2
/// By Newton's method from the lower of the tangents at triaxial extension and compression, both
/// above z (dz/d cos 3θ falls): it comes down to the root and does not pass it.
template <class T>
T inverse_share(const T& M, const T& cos_3_theta) {
  if constexpr (ScalarTraits<T>::is_dual) {
    const double z = inverse_share(value(M), value(cos_3_theta));
    const T b = M * (T(3.0) + M);
    const T rest = (T(9.0 * z * z - 9.0) - b) * z + b * cos_3_theta;
    return T(z) - (rest - T(value(rest))) / (27.0 * z * z - 9.0 - value(b));
  } else {
    using std::sqrt;
    constexpr int max_steps = 100;
    const T one(1.0), nine(9.0);
    const T b = M * (T(3.0) + M);
    const T extension = T(0.5) * (one + sqrt(T(one + T(4.0 / 9.0) * b)));
    const T above = extension - b * (cos_3_theta + one) / (T(27.0) * square(extension) - nine - b);
    const T below = one + b * (one - cos_3_theta) / (T(18.0) - b);
    T z = select(above < below, above, below);
    auto open = z > T(0.0);
    for (int step = 0; step < max_steps && any(open); ++step) {
      const T z2 = z * z;
      const T move = ((nine * z2 - nine - b) * z + b * cos_3_theta) / (T(27.0) * z2 - nine - b);
      z = select(open, T(z - move), z);
      open = open && move > T(1e-8) * z;  // the next move would be of the order of its square
    }
    return z;
  }
}

/// g, the strength in the direction of the deviator s over that in triaxial compression, M.
template <class T, int N>
T share(const T& shape_given, const T& M, const Sym<T, N>& s) {
  if (is_circle(shape_given)) return T(1.0);
  return T(1.0) / inverse_share(M, cos_3_theta(s));
}

/// d ln g/dt where the deviator s changes at s_rate.
template <class T, int N>
T share_rate(const T& shape_given, const T& M, const Sym<T, N>& s, const Sym<T, N>& s_rate) {
  using std::sqrt;
  if (is_circle(shape_given)) return T(0.0);
  const T one(1.0);
  const T q2 = T(1.5) * contract(s, s);
  const auto sheared = q2 > T(1e-290);
  const T inv_q = one / sqrt(select(sheared, q2, one));
  const Sym<T, N> n = inv_q * s;
  const Sym<T, N> n_rate = inv_q * s_rate;
  // s² : ds = d det s; components of n²
  Sym<T, N> n2;
  n2[0] = n[0] * n[0] + n[3] * n[3];
  n2[1] = n[1] * n[1] + n[3] * n[3];
  n2[2] = n[2] * n[2];
  n2[3] = n[3] * (n[0] + n[1]);
  if constexpr (N == 6) {
    n2[0] = n2[0] + n[5] * n[5];
    n2[1] = n2[1] + n[4] * n[4];
    n2[2] = n2[2] + n[4] * n[4] + n[5] * n[5];
    n2[3] = n2[3] + n[5] * n[4];
    n2[4] = n[3] * n[5] + n[4] * (n[1] + n[2]);
    n2[5] = n[3] * n[4] + n[5] * (n[0] + n[2]);
  }
  const T c = cos_3_theta(s);
  const T c_rate = T(-13.5) * contract(n2, n_rate) - T(4.5) * c * contract(n, n_rate);
  const T z = inverse_share(M, c);
  const T b = M * (T(3.0) + M);
  return select(sheared, T(b * c_rate / (z * (T(27.0) * z * z - T(9.0) - b))), T(0.0));
}

/// g in simple shear, cos 3θ = 0: 1/√(1 + b/9).
template <class T>
T shear_share(const T& shape_given, const T& M) {
  using std::sqrt;
  if (is_circle(shape_given)) return T(1.0);
  return T(1.0) / sqrt(T(T(1.0) + M * (T(3.0) + M) / T(9.0)));
}

}  // namespace repose::cone

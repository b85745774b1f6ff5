#pragma once
/// \file
/// What a template on the scalar type asks about it. A dual number is only named here: a header
/// that hands tensors on needs neither its arithmetic (dual.hpp) nor SIMD registers (scalar.hpp),
/// which take seconds to compile.

namespace ceres {
template <typename T, int N>
struct Jet;
}

namespace repose {

/// A value with n first derivatives.
template <int n>
using Dual = ceres::Jet<double, n>;

template <class T>
struct ScalarTraits {
  using Value = T;    ///< the type without derivatives
  using Mask = bool;  ///< the result of a comparison
  static constexpr bool is_dual = false;
};
template <int n>
struct ScalarTraits<Dual<n>> {
  using Value = double;
  using Mask = bool;
  static constexpr bool is_dual = true;
};

template <class T>
using Value = typename ScalarTraits<T>::Value;
template <class T>
using Mask = typename ScalarTraits<T>::Mask;

inline double value(double x) { return x; }
template <int n>
double value(const Dual<n>& x) {
  return x.a;
}

}  // namespace repose

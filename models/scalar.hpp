#pragma once
/// \file
/// The scalar types a law is instantiated with, and the few operations they share:
///   double                   one material point (point driver, tests),
///   Pack                     one SIMD register of points (Material Point Method batches),
///   Twin                     two registers of points (the same, where a law asks for it),
///   Dual<n>                  a dual number (consistent tangents, parameter sensitivities), which
///                            dual.hpp makes complete.
/// A law uses select() instead of an if, so that a Pack can take both branches lane by lane.

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <xsimd/xsimd.hpp>

#include "models/padding.hpp"
#include "models/scalar_traits.hpp"

namespace repose {

/// One SIMD register of doubles for the instruction set that this file is compiled for, which its
/// name says: code for two of them may stand in one program.
using Pack = xsimd::batch<double>;

/// Two packs that go through the same operations. A law that iterates is a chain of operations each
/// of which waits for the one before; a second chain beside it fills the waiting.
template <class P>
struct TwinOf {
  static constexpr std::size_t size = 2 * P::size;
  P a, b;

  TwinOf() = default;
  TwinOf(const P& first, const P& second) : a(first), b(second) {}
  explicit TwinOf(double x) : a(x), b(x) {}
  TwinOf(double c0, double c1, double c2, double c3) requires(P::size == 2)
      : a({c0, c1}),
        b({c2, c3}) {}
  static TwinOf load_unaligned(const double* from) {
    return {P::load_unaligned(from), P::load_unaligned(from + P::size)};
  }
  static TwinOf load_aligned(const double* from) {
    return {P::load_aligned(from), P::load_aligned(from + P::size)};
  }
  void store_unaligned(double* to) const {
    a.store_unaligned(to);
    b.store_unaligned(to + P::size);
  }
  void store_aligned(double* to) const {
    a.store_aligned(to);
    b.store_aligned(to + P::size);
  }

  /// What a comparison of two gives.
  struct Mask {
    typename P::batch_bool_type a, b;
    friend Mask operator&&(const Mask& x, const Mask& y) { return {x.a && y.a, x.b && y.b}; }
    friend Mask operator||(const Mask& x, const Mask& y) { return {x.a || y.a, x.b || y.b}; }
    [[gnu::always_inline]] friend Mask operator!(const Mask& x) { return {~x.a, ~x.b}; }
  };

  friend TwinOf operator+(const TwinOf& x, const TwinOf& y) { return {x.a + y.a, x.b + y.b}; }
  friend TwinOf operator-(const TwinOf& x, const TwinOf& y) { return {x.a - y.a, x.b - y.b}; }
  friend TwinOf operator*(const TwinOf& x, const TwinOf& y) { return {x.a * y.a, x.b * y.b}; }
  friend TwinOf operator/(const TwinOf& x, const TwinOf& y) { return {x.a / y.a, x.b / y.b}; }
  friend TwinOf operator-(const TwinOf& x) { return {-x.a, -x.b}; }
  friend Mask operator<(const TwinOf& x, const TwinOf& y) { return {x.a < y.a, x.b < y.b}; }
  friend Mask operator>(const TwinOf& x, const TwinOf& y) { return {x.a > y.a, x.b > y.b}; }
  friend Mask operator<=(const TwinOf& x, const TwinOf& y) { return {x.a <= y.a, x.b <= y.b}; }
  friend Mask operator>=(const TwinOf& x, const TwinOf& y) { return {x.a >= y.a, x.b >= y.b}; }
  friend Mask operator==(const TwinOf& x, const TwinOf& y) { return {x.a == y.a, x.b == y.b}; }
  friend TwinOf fma(const TwinOf& x, const TwinOf& y, const TwinOf& z) {
    return {xsimd::fma(x.a, y.a, z.a), xsimd::fma(x.b, y.b, z.b)};
  }
  friend TwinOf floor(const TwinOf& x) { return {xsimd::floor(x.a), xsimd::floor(x.b)}; }
  friend TwinOf sqrt(const TwinOf& x) { return {xsimd::sqrt(x.a), xsimd::sqrt(x.b)}; }
  friend TwinOf exp(const TwinOf& x) { return {xsimd::exp(x.a), xsimd::exp(x.b)}; }
  friend TwinOf expm1(const TwinOf& x) { return {xsimd::expm1(x.a), xsimd::expm1(x.b)}; }
};

using Twin = TwinOf<Pack>;
static_assert(pack_size % Twin::size == 0);

template <>
struct ScalarTraits<Pack> {
  using Value = Pack;
  using Mask = Pack::batch_bool_type;
  static constexpr bool is_dual = false;
};
template <>
struct ScalarTraits<Twin> {
  using Value = Twin;
  using Mask = Twin::Mask;
  static constexpr bool is_dual = false;
};
inline const Pack& value(const Pack& x) { return x; }
inline const Twin& value(const Twin& x) { return x; }

/// mask ? a : b, lane by lane for a Pack.
inline double select(bool mask, double a, double b) { return mask ? a : b; }
inline Pack select(const Mask<Pack>& mask, const Pack& a, const Pack& b) {
  return xsimd::select(mask, a, b);
}
inline Twin select(const Mask<Twin>& mask, const Twin& x, const Twin& y) {
  return {xsimd::select(mask.a, x.a, y.a), xsimd::select(mask.b, x.b, y.b)};
}
template <int n>
Dual<n> select(bool mask, const Dual<n>& a, const Dual<n>& b) {
  return mask ? a : b;
}

/// What `!` says of a mask. (xsimd 10 makes `!` of an AVX2 mask by comparing its halves as
/// integers: ten instructions for one.)
inline bool negated(bool mask) { return !mask; }
inline Mask<Pack> negated(const Mask<Pack>& mask) { return ~mask; }
inline Mask<Twin> negated(const Mask<Twin>& mask) { return !mask; }

inline bool any(bool mask) { return mask; }
inline bool any(const Mask<Pack>& mask) { return xsimd::any(mask); }
inline bool any(const Mask<Twin>& mask) { return xsimd::any(mask.a || mask.b); }

inline bool finite(double x) { return std::isfinite(x); }
inline Mask<Pack> finite(const Pack& x) { return (x - x) == Pack(0.0); }
inline Mask<Twin> finite(const Twin& x) { return {finite(x.a), finite(x.b)}; }
template <int n>
bool finite(const Dual<n>& x) {
  return std::isfinite(x.a);
}

/// x, but not below the bound; a NaN in x stays a NaN.
template <class T>
T floor_at(const T& x, double bound) {
  return select(x < T(bound), T(bound), x);
}

template <class T>
T square(const T& x) {
  return x * x;
}

/// 2^k from k + 1.5·2^52, whose lowest bits are those of k.
inline double power_of_two(double shifted) {
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) << 52) +
                               (std::uint64_t{1023} << 52));
}
inline Pack power_of_two(const Pack& shifted) {
  using Bits = xsimd::batch<std::uint64_t>;
  return xsimd::bitwise_cast<Pack>((xsimd::bitwise_cast<Bits>(shifted) << 52) +
                                   Bits(std::uint64_t{1023} << 52));
}

inline Twin power_of_two(const Twin& shifted) {
  return {power_of_two(shifted.a), power_of_two(shifted.b)};
}

/// ln x to 2 units in the last place (log of a Pack turns its exponents into doubles one by one
/// where there is no AVX-512): x = 2^k m with √½ <= m < √2, and with s = (m − 1)/(m + 1), |s| <=
/// 0.1716,
///   ln m = 2(s + s³/3 + … + s²¹/21), whose next term is 2e-19 of it.
/// NaN below 0, −∞ at 0, ∞ at ∞.
inline Pack ln(const Pack& x) {
  using Bits = xsimd::batch<std::uint64_t>;
  constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcd;  // of √½
  constexpr std::uint64_t one_bits = std::uint64_t{1023} << 52;
  constexpr std::uint64_t mantissa = (std::uint64_t{1} << 52) - 1;
  constexpr double smallest = std::numeric_limits<double>::min();
  const auto subnormal = x < Pack(smallest);
  const Pack normal = select(subnormal, Pack(x * Pack(0x1p54)), x);
  const Bits shifted = xsimd::bitwise_cast<Bits>(normal) + Bits(one_bits - root_half);
  const Pack m = xsimd::bitwise_cast<Pack>((shifted & Bits(mantissa)) + Bits(root_half));
  // the biased exponent as the lowest bits of 2^52 + exponent
  const Pack biased = xsimd::bitwise_cast<Pack>((shifted >> 52) | Bits(std::uint64_t{1075} << 52));
  const Pack k = biased - select(subnormal, Pack(0x1p52 + 1023.0 + 54.0), Pack(0x1p52 + 1023.0));
  const Pack f = m - Pack(1.0);
  const Pack s = f / (Pack(2.0) + f);
  const Pack s2 = s * s;
  const Pack s4 = s2 * s2;
  const auto term = [](int n) { return Pack(2.0 / (2.0 * n + 1.0)); };
  // every multiply-add is said: what the compiler would fuse depends on what stands beside it
  using xsimd::fma, xsimd::fnma;
  const Pack even =
      fma(s4, fma(s4, fma(s4, fma(s4, term(10), term(8)), term(6)), term(4)), term(2));
  const Pack odd = fma(s4, fma(s4, fma(s4, fma(s4, term(9), term(7)), term(5)), term(3)), term(1));
  // ln m = f − s(f − s²(2/3 + 2s²/5 + …)), as 2s = f − s f: its leading part has no rounding of s
  const Pack ln_m = fnma(s, fnma(s2, fma(s2, even, odd), f), f);
  constexpr double ln_2_high = 6.93147180369123816490e-01;  // 33 bits: k ln_2_high is exact
  constexpr double ln_2_low = 1.90821492927058770002e-10;
  const Pack result = fma(k, Pack(ln_2_high), fma(k, Pack(ln_2_low), ln_m));
  const Pack infinity(std::numeric_limits<double>::infinity());
  const Pack edge = select(x == Pack(0.0), Pack(-infinity),
                           select(x == infinity, infinity, Pack(infinity - infinity)));
  return select(x > Pack(0.0) && x < infinity, result, edge);
}
inline Twin ln(const Twin& x) { return {ln(x.a), ln(x.b)}; }
template <class T>
T ln(const T& x) {
  using std::log;
  return log(x);
}

/// eˣ and eˣ − 1, each to its own relative accuracy (2 units in the last place): 1 + (eˣ − 1) would
/// lose eˣ for x ≪ 0, eˣ − 1 by subtraction would lose itself near 0. ∞ above x = 709, 0 below
/// −708.
template <class T>
struct ExpPair {
  T whole, minus_one;
};

/// Both at the price of one: x = k ln 2 + r, |r| <= ½ ln 2, and the Taylor series of e^r − 1 to r¹³
/// (the next term is 1.3e-17 of the sum).
template <class T>
[[gnu::always_inline]] inline ExpPair<T> exp_pair(const T& x) {
  if constexpr (ScalarTraits<T>::is_dual) {
    const ExpPair<double> at = exp_pair(value(x));
    T whole(at.whole);
    T minus_one(at.minus_one);
    whole.v = at.whole * x.v;
    minus_one.v = whole.v;
    return {whole, minus_one};
  } else {
    constexpr double highest = 709.0;
    constexpr double lowest = -708.0;
    constexpr double ln_2_high = 6.93147180369123816490e-01;  // 33 bits: k ln_2_high is exact
    constexpr double ln_2_low = 1.90821492927058770002e-10;
    constexpr double shift = 6755399441055744.0;  // 1.5·2^52: adding it rounds to an integer
    const auto above = x > T(highest);
    const auto below = x < T(lowest);
    const T bounded = select(above, T(highest), select(below, T(lowest), x));  // NaN stays NaN
    const T shifted = bounded * T(1.44269504088896340736) + T(shift);
    const T k = shifted - T(shift);
    const T r = (bounded - k * T(ln_2_high)) - k * T(ln_2_low);
    constexpr auto c = [] {  // 1/(n + 2)!
      std::array<double, 12> inverse{};
      double factorial = 1.0;
      for (std::size_t n = 0; n < 12; ++n) {
        factorial *= static_cast<double>(n + 2);
        inverse[n] = 1.0 / factorial;
      }
      return inverse;
    }();
    const auto pair = [&](std::size_t n) { return T(c[n]) + T(c[n + 1]) * r; };
    const T r2 = r * r;
    const T r4 = r2 * r2;
    const T q = (pair(0) + r2 * pair(2)) + r4 * (pair(4) + r2 * pair(6)) +
                (r4 * r4) * (pair(8) + r2 * pair(10));
    const T m = r + r2 * q;
    const T two_k = power_of_two(shifted);
    const T infinity(std::numeric_limits<double>::infinity());
    return {select(above, infinity, select(below, T(0.0), T(two_k + two_k * m))),
            select(above, infinity, T(two_k * m + (two_k - T(1.0))))};
  }
}

/// (eˣ − 1)/x from the pair of x, continuous through x = 0. Error: a few units in the last place;
/// the derivative of a Dual near 0 comes from the series (truncated below 1e-19 for |x| < 0.02),
/// because the quotient rule would divide two cancelled numbers there.
template <class T>
[[gnu::always_inline]] inline T expm1_over(const T& x, const ExpPair<T>& of_x) {
  if constexpr (ScalarTraits<T>::is_dual) {
    if (std::abs(value(x)) < 0.02) {
      T sum(1.0);
      for (int k = 8; k >= 2; --k) sum = T(1.0) + x * sum / static_cast<double>(k);
      return sum;
    }
    return of_x.minus_one / x;
  } else {
    const auto zero = x == T(0.0);
    return select(zero, T(1.0), T(of_x.minus_one / select(zero, T(1.0), x)));
  }
}
template <class T>
[[gnu::always_inline]] inline T expm1_over(const T& x) {
  return expm1_over(x, exp_pair(x));
}

}  // namespace repose

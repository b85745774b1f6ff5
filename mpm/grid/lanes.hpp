#pragma once
/// \file
/// What the transfers do with SIMD registers beyond arithmetic: stencil rows side by side, and a
/// row of a tile as a table that lanes look their nodes up in.

#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>

#include <xsimd/xsimd.hpp>

#include "models/scalar.hpp"

namespace repose::mpm {

/// Four doubles: one row of a stencil. One register, or two where a register has two lanes (NEON).
using Row =
    std::conditional_t<Pack::size == 2, Twin, typename xsimd::make_sized_batch<double, 4>::type>;
static_assert(Row::size == 4);

/// As many points as both a register and a row can hold side by side.
using RowPoints = std::conditional_t<(Pack::size < Row::size), Pack, Row>;

/// Whole numbers below 2^32 held as doubles, to be stored where whole_number() reads them: adding
/// 2^52 leaves them in the lowest bits.
template <class T>
T as_bits(const T& whole) {
  return whole + T(0x1p52);
}
inline std::uint32_t whole_number(double bits) {
  return static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(bits));
}

#if defined(__AVX512F__)
/// Stencil rows that fit side by side in one register.
constexpr std::size_t rows_per_pack = Pack::size / Row::size;
static_assert(rows_per_pack == 2);

/// A row of x and a row of y that go through the same operations: the two halves of a register.
class RowPair {
 public:
  explicit RowPair(const Pack& both) : both_(both) {}
  RowPair(double x, double y) : both_(_mm512_mask_blend_pd(0xF0, Pack(x), Pack(y))) {}
  RowPair(double c0, double c1, double c2, double c3) : both_({c0, c1, c2, c3, c0, c1, c2, c3}) {}
  friend RowPair operator-(const RowPair& a, const RowPair& b) {
    return RowPair(Pack(a.both_ - b.both_));
  }
  friend RowPair fma(const RowPair& a, const RowPair& b, const RowPair& c) {
    return RowPair(xsimd::fma(a.both_, b.both_, c.both_));
  }
  Row x() const { return half<0>(); }
  Row y() const { return half<1>(); }

  /// The row of x as often as there are rows in a register.
  Pack x_repeated() const {
    return Pack(__builtin_shufflevector(both_.data, both_.data, 0, 1, 2, 3, 0, 1, 2, 3));
  }
  /// Lane j of the row of y all over the first half, lane j + 1 all over the second.
  template <int j>
  Pack y_spread() const {
    constexpr int a = 4 + j;
    constexpr int b = 5 + j;
    return Pack(__builtin_shufflevector(both_.data, both_.data, a, a, a, a, b, b, b, b));
  }

 private:
  template <int k>
  Row half() const {
    return Row(
        __builtin_shufflevector(both_.data, both_.data, 4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3));
  }
  Pack both_;
};

/// Row k of the register.
template <int k>
Row row_of(const Pack& p) {
  return Row(__builtin_shufflevector(p.data, p.data, 4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3));
}

/// A row of 16 numbers, held in registers; each lane looks up its own.
class RowTable {
 public:
  using Index = __m512i;
  explicit RowTable(const double* row)
      : low_(_mm512_load_pd(row)),
        high_(_mm512_load_pd(row + 8)) {}
  Pack at(Index index) const { return Pack(_mm512_permutex2var_pd(low_, index, high_)); }

  /// From whole numbers 0 … 15 held as doubles; only the lowest bits count.
  static Index index(const Pack& column) { return _mm512_castpd_si512(as_bits(column)); }

 private:
  __m512d low_, high_;
};
#else
/// A row of x and a row of y that go through the same operations.
class RowPair {
 public:
  RowPair(const Row& x, const Row& y) : x_(x), y_(y) {}
  RowPair(double x, double y) : x_(x), y_(y) {}
  RowPair(double c0, double c1, double c2, double c3) : x_({c0, c1, c2, c3}), y_(x_) {}
  friend RowPair operator-(const RowPair& a, const RowPair& b) {
    return {Row(a.x_ - b.x_), Row(a.y_ - b.y_)};
  }
  friend RowPair fma(const RowPair& a, const RowPair& b, const RowPair& c) {
    return {fma(a.x_, b.x_, c.x_), fma(a.y_, b.y_, c.y_)};
  }
  Row x() const { return x_; }
  Row y() const { return y_; }

 private:
  Row x_, y_;
};
#endif

#if defined(__AVX__)
/// Columns of the rows of as many points as RowPoints has: number k is lane k of every row.
[[gnu::always_inline]] inline std::array<Row, 4> columns_of(const std::array<Row, 4>& rows) {
  const auto low_01 = __builtin_shufflevector(rows[0].data, rows[1].data, 0, 4, 2, 6);
  const auto high_01 = __builtin_shufflevector(rows[0].data, rows[1].data, 1, 5, 3, 7);
  const auto low_23 = __builtin_shufflevector(rows[2].data, rows[3].data, 0, 4, 2, 6);
  const auto high_23 = __builtin_shufflevector(rows[2].data, rows[3].data, 1, 5, 3, 7);
  return {Row(__builtin_shufflevector(low_01, low_23, 0, 1, 4, 5)),
          Row(__builtin_shufflevector(high_01, high_23, 0, 1, 4, 5)),
          Row(__builtin_shufflevector(low_01, low_23, 2, 3, 6, 7)),
          Row(__builtin_shufflevector(high_01, high_23, 2, 3, 6, 7))};
}

/// Lane i of row k and lane k of row i change places.
[[gnu::always_inline]] inline void transpose(std::array<Row, 4>& rows) { rows = columns_of(rows); }

/// Lane k of the result is the sum of row k.
inline Row sums_of(const std::array<Row, 4>& rows) { return xsimd::haddp(rows.data()); }
#else
[[gnu::always_inline]] inline std::array<Pack, 4> columns_of(const std::array<Row, 2>& rows) {
  return {xsimd::zip_lo(rows[0].a, rows[1].a), xsimd::zip_hi(rows[0].a, rows[1].a),
          xsimd::zip_lo(rows[0].b, rows[1].b), xsimd::zip_hi(rows[0].b, rows[1].b)};
}
[[gnu::always_inline]] inline void transpose(std::array<Row, 4>& rows) {
  const std::array<Pack, 4> first = columns_of({rows[0], rows[1]});
  const std::array<Pack, 4> second = columns_of({rows[2], rows[3]});
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = Row(first[k], second[k]);
}
inline Row sums_of(const std::array<Row, 4>& rows) {
  const Pack half[4] = {rows[0].a + rows[0].b, rows[1].a + rows[1].b, rows[2].a + rows[2].b,
                        rows[3].a + rows[3].b};
  return {xsimd::haddp(half), xsimd::haddp(half + 2)};
}
#endif

/// The smallest and the largest lane.
inline double least(const Pack& x) {
  alignas(Pack) double lane[Pack::size];
  x.store_aligned(lane);
  double found = lane[0];
  for (std::size_t k = 1; k < Pack::size; ++k) found = lane[k] < found ? lane[k] : found;
  return found;
}
inline double greatest(const Pack& x) { return -least(-x); }

/// The larger of two; a NaN in `x` is kept, so that it cannot slip through a maximum.
template <class T>
T max_of(const T& largest_so_far, const T& x) {
  return select(x > largest_so_far || x != x, x, largest_so_far);
}

/// The smaller of two; a NaN in `x` is kept.
inline Pack min_of(const Pack& smallest_so_far, const Pack& x) {
  return select(x < smallest_so_far || x != x, x, smallest_so_far);
}

/// The largest lane; NaN if any is.
inline double largest(const Pack& x) {
  alignas(Pack) std::array<double, Pack::size> lane;
  x.store_aligned(lane.data());
  double most = lane[0];
  for (const double y : lane) most = max_of(most, y);
  return most;
}

template <std::size_t n>
Pack dot(const std::array<Pack, n>& a, const std::array<Pack, n>& b) {
  Pack sum = a[0] * b[0];
  for (std::size_t i = 1; i < n; ++i) sum = sum + a[i] * b[i];
  return sum;
}

}  // namespace repose::mpm

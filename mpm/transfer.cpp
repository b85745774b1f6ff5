#include "mpm/transfer.hpp"

#include <utility>

namespace repose::mpm {
namespace {

constexpr std::size_t packs_per_stencil = stencil_width / rows_per_pack;

/// Sums in registers stay there only if no function that is called for them takes their address.
#define REPOSE_INLINE __attribute__((always_inline))

/// Calls f(integral_constant<k>) for k = 0 … n − 1.
template <std::size_t n, class F>
REPOSE_INLINE inline void unrolled(F&& f) {
  [&]<std::size_t... k>(std::index_sequence<k...>) REPOSE_INLINE {
    (f(std::integral_constant<std::size_t, k>{}), ...);
  }
  (std::make_index_sequence<n>{});
}

/// What a point adds to a node at the distance d = (dx, dy) h is w times a polynomial in d:
///   mass c_m,   momentum c_p + c_px dx + c_py dy,   force c_fx dx + c_fy dy.
/// The coefficients of a pack of points.
enum Coefficient : std::size_t {
  C_M,
  C_E,
  C_PX,
  C_PY,
  C_XX,
  C_XY,
  C_YX,
  C_YY,
  C_FXX,
  C_FXY,
  C_FYY,
  C_N
};

/// Sums of a stencil kept in registers while consecutive points share the same stencil: all of its
/// rows, side by side. (Every index is known to the compiler, or they would live in memory.)
template <class Kernel, bool averages>
class Accumulator {
 public:
  Accumulator() { clear(); }
  REPOSE_INLINE void clear() {
    unrolled<channels * packs_per_stencil>([&](auto k) REPOSE_INLINE { sum_[k] = Pack(0.0); });
  }

  template <bool affine>
  REPOSE_INLINE void add(const Weights& at, const double (*c)[Pack::size], std::size_t lane) {
    const Pack w_row = at.w.x_repeated();
    const Pack dx = at.d.x_repeated();
    const auto of = [&](std::size_t k) { return Pack(c[k][lane]); };
    const Pack px = affine ? xsimd::fma(of(C_XX), dx, of(C_PX)) : of(C_PX);
    const Pack py = affine ? xsimd::fma(of(C_YX), dx, of(C_PY)) : of(C_PY);
    const Pack fx = of(C_FXX) * dx;
    const Pack fy = of(C_FXY) * dx;
    unrolled<packs_per_stencil>([&](auto k) REPOSE_INLINE {
      constexpr int row = static_cast<int>(k * rows_per_pack);
      const Pack w = w_row * at.w.template y_spread<row>();
      const Pack dy = at.d.template y_spread<row>();
      const auto add = [&](auto channel, const Pack& value) REPOSE_INLINE {
        Pack& sum = sum_[channel * packs_per_stencil + k];
        sum = xsimd::fma(w, value, sum);
      };
      add(std::integral_constant<std::size_t, T_MASS>{}, of(C_M));
      add(std::integral_constant<std::size_t, T_PX>{}, affine ? xsimd::fma(of(C_XY), dy, px) : px);
      add(std::integral_constant<std::size_t, T_PY>{}, affine ? xsimd::fma(of(C_YY), dy, py) : py);
      add(std::integral_constant<std::size_t, T_FX>{}, xsimd::fma(of(C_FXY), dy, fx));
      add(std::integral_constant<std::size_t, T_FY>{}, xsimd::fma(of(C_FYY), dy, fy));
      if constexpr (averages) add(std::integral_constant<std::size_t, T_ELASTIC>{}, of(C_E));
    });
  }

  REPOSE_INLINE void add_to(Tile& tile, std::size_t node) const {
    unrolled<channels>([&](auto c) REPOSE_INLINE {
      unrolled<Kernel::rows>([&](auto row) REPOSE_INLINE {
        double* at = tile[c].data() + node + row * tile_stride;
        const Row sum =
            row_of<row % rows_per_pack>(sum_[c * packs_per_stencil + row / rows_per_pack]);
        (Row::load_unaligned(at) + sum).store_unaligned(at);
      });
    });
  }

 private:
  static constexpr std::size_t channels = averages ? tile_channels : T_ELASTIC;
  Pack sum_[channels * packs_per_stencil];
};

}  // namespace

template <class Kernel, bool affine, bool averages>
void points_to_tile(const PointSet& points, const Range& range, double h, std::array<int, 2> origin,
                    const double* elastic, Tile& tile) {
  const double inv_h = 1.0 / h;
  // −V D⁻¹ h and the affine velocity times h: distances are in units of h
  const Pack minus_D_h(-Kernel::inverse_moment * inv_h);
  const Pack cell(h);
  // the anchor of a point whose stencil begins with the tile's first node
  const Pack x_1(origin[0] + 1.0);
  const Pack y_1(origin[1] + 1.0);
  const std::size_t a = points.affine;

  Accumulator<Kernel, averages> stencil;
  constexpr std::size_t nowhere = static_cast<std::size_t>(-1);
  std::size_t current = nowhere;
  for (std::size_t first = 0; first < range.count; first += Pack::size) {
    const auto at = [&](std::size_t f) {
      return Pack::load_aligned(points[f] + range.begin + first);
    };
    alignas(64) double c[C_N][Pack::size];
    alignas(64) double tx[Pack::size], ty[Pack::size], place[Pack::size];
    const Pack m = at(MASS);
    const Pack V = m / at(RHO) * minus_D_h;
    m.store_aligned(c[C_M]);
    if constexpr (averages) (m * Pack::load_aligned(elastic + first)).store_aligned(c[C_E]);
    (m * at(VX)).store_aligned(c[C_PX]);
    (m * at(VY)).store_aligned(c[C_PY]);
    if constexpr (affine) {
      const Pack mh = m * cell;
      (mh * at(a)).store_aligned(c[C_XX]);
      (mh * at(a + 1)).store_aligned(c[C_XY]);
      (mh * at(a + 2)).store_aligned(c[C_YX]);
      (mh * at(a + 3)).store_aligned(c[C_YY]);
    }
    (V * at(points.force_stress[0])).store_aligned(c[C_FXX]);
    (V * at(points.force_stress[1])).store_aligned(c[C_FYY]);
    (V * at(points.force_stress[2])).store_aligned(c[C_FXY]);
    const Pack x = at(X) * Pack(inv_h);
    const Pack y = at(Y) * Pack(inv_h);
    const Pack anchor_x = Kernel::anchor(x);
    const Pack anchor_y = Kernel::anchor(y);
    (x - anchor_x).store_aligned(tx);
    (y - anchor_y).store_aligned(ty);
    as_bits((anchor_y - y_1) * Pack(tile_stride) + (anchor_x - x_1)).store_aligned(place);

    const std::size_t lanes = std::min(Pack::size, range.count - first);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t first_node = whole_number(place[lane]);
      if (first_node != current) {
        if (current != nowhere) stencil.add_to(tile, current);
        stencil.clear();
        current = first_node;
      }
      stencil.template add<affine>(Kernel::of_point(tx[lane], ty[lane]), c, lane);
    }
  }
  if (current != nowhere) stencil.add_to(tile, current);
}

namespace {

/// A field at the points of a pack: Σ w f, and Σ w f d with the distance d in units of h.
struct Moments {
  Pack value = Pack(0.0), dx = Pack(0.0), dy = Pack(0.0);
};

/// The stencils of a pack of points in a tile.
template <class Kernel>
class PackStencil {
 public:
  /// Positions in units of h from the tile's first node.
  PackStencil(const Pack& x, const Pack& y) : y_(y) {
    const Pack anchor_x = Kernel::anchor(x);
    const Pack anchor_y = Kernel::anchor(y);
    wx_ = Kernel::weights(Pack(x - anchor_x));
    wy_ = Kernel::weights(Pack(y - anchor_y));
    base_y_ = anchor_y - Pack(1.0);
    for (std::size_t k = 0; k < columns; ++k) {
      const Pack column = anchor_x + Pack(static_cast<double>(k) - 1.0);
      column_[k] = RowTable::index(column);
      wx_dx_[k] = wx_[k] * (column - x);
    }
    first_row_ = static_cast<std::size_t>(least(base_y_));
    last_row_ = static_cast<std::size_t>(greatest(base_y_)) + Kernel::rows - 1;
  }

  /// Calls f(row of the tile, its weight, its distance): rows in which no lane has a node are left
  /// out, lanes that have none in this row get the weight 0.
  template <class F>
  void for_each_row(F&& f) const {
    for (std::size_t row = first_row_; row <= last_row_; ++row) {
      const Pack r(static_cast<double>(row));
      const Pack k = r - base_y_;
      Pack w(0.0);
      for (std::size_t j = 0; j < Kernel::rows; ++j)
        w = select(k == Pack(static_cast<double>(j)), wy_[j], w);
      f(row, w, Pack(r - y_));
    }
  }

  /// Adds a row of a field to its moments; w_d = weight × distance.
  void add(const double* row, const Pack& w, const Pack& w_d, Moments& sum) const {
    const RowTable table(row);
    Pack s = table.at(column_[0]);
    Pack s_dx = s * wx_dx_[0];
    s = s * wx_[0];
    for (std::size_t k = 1; k < columns; ++k) {
      const Pack f = table.at(column_[k]);
      s = xsimd::fma(wx_[k], f, s);
      s_dx = xsimd::fma(wx_dx_[k], f, s_dx);
    }
    sum.value = xsimd::fma(w, s, sum.value);
    sum.dx = xsimd::fma(w, s_dx, sum.dx);
    sum.dy = xsimd::fma(w_d, s, sum.dy);
  }

  /// Its value alone.
  void add(const double* row, const Pack& w, Pack& sum) const {
    const RowTable table(row);
    Pack s = table.at(column_[0]) * wx_[0];
    for (std::size_t k = 1; k < columns; ++k) s = xsimd::fma(wx_[k], table.at(column_[k]), s);
    sum = xsimd::fma(w, s, sum);
  }

 private:
  static constexpr std::size_t columns = Kernel::rows;
  Pack y_;
  std::array<Pack, 4> wx_, wy_;
  Pack wx_dx_[columns];
  RowTable::Index column_[columns];
  Pack base_y_;
  std::size_t first_row_, last_row_;
};

}  // namespace

template <class Kernel, Keeps keeps, bool averages>
void tile_to_points(const VelocityTile& tile, std::array<int, 2> origin, double h,
                    const Range& range, const Retention& keep, PointSet& points, Motion motion) {
  const Pack inv_h(1.0 / h);
  const Pack inv_D_h(Kernel::inverse_moment / h);
  const Pack x_0(static_cast<double>(origin[0]));
  const Pack y_0(static_cast<double>(origin[1]));
  const Pack keep_v(keep.velocity);
  const Pack keep_A(keep.gradient);
  const std::size_t a = points.affine;
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const std::size_t s = range.begin + k;
    const auto at = [&](std::size_t f) { return Pack::load_aligned(points[f] + s); };
    const auto put = [&](std::size_t f, const Pack& x) { x.store_aligned(points[f] + s); };
    const PackStencil<Kernel> stencil(at(X) * inv_h - x_0, at(Y) * inv_h - y_0);
    Moments vx, vy, ux, uy;
    Pack elastic(0.0);
    stencil.for_each_row([&](std::size_t row, const Pack& w, const Pack& d) {
      const std::size_t n = row * tile_stride;
      const Pack w_d = w * d;
      stencil.add(tile.vx.data() + n, w, w_d, vx);
      stencil.add(tile.vy.data() + n, w, w_d, vy);
      if constexpr (averages) stencil.add(tile.elastic.data() + n, w, elastic);
      if constexpr (keeps == Keeps::velocity) {
        stencil.add(tile.ux.data() + n, w, ux.value);
        stencil.add(tile.uy.data() + n, w, uy.value);
      } else if constexpr (keeps == Keeps::velocity_and_gradient) {
        stencil.add(tile.ux.data() + n, w, w_d, ux);
        stencil.add(tile.uy.data() + n, w, w_d, uy);
      }
    });
    vx.value.store_aligned(motion.vx + k);
    vy.value.store_aligned(motion.vy + k);
    if constexpr (averages) elastic.store_aligned(motion.elastic + k);
    const Pack L[4] = {vx.dx * inv_D_h, vx.dy * inv_D_h, vy.dx * inv_D_h, vy.dy * inv_D_h};
    if constexpr (keeps == Keeps::nothing) {
      put(VX, vx.value);
      put(VY, vy.value);
    } else {
      put(VX, vx.value + keep_v * (at(VX) - ux.value));
      put(VY, vy.value + keep_v * (at(VY) - uy.value));
    }
    if constexpr (keeps == Keeps::velocity_and_gradient) {
      const Pack U[4] = {ux.dx * inv_D_h, ux.dy * inv_D_h, uy.dx * inv_D_h, uy.dy * inv_D_h};
      for (std::size_t i = 0; i < 4; ++i) put(a + i, L[i] + keep_A * (at(a + i) - U[i]));
    }
    for (std::size_t i = 0; i < 4; ++i) put(LXX + i, L[i]);
  }
}

#define REPOSE_TRANSFERS(KERNEL, AVERAGES)                                                         \
  template void points_to_tile<KERNEL, true, AVERAGES>(const PointSet&, const Range&, double,      \
                                                       std::array<int, 2>, const double*, Tile&);  \
  template void points_to_tile<KERNEL, false, AVERAGES>(const PointSet&, const Range&, double,     \
                                                        std::array<int, 2>, const double*, Tile&); \
  template void tile_to_points<KERNEL, Keeps::nothing, AVERAGES>(                                  \
      const VelocityTile&, std::array<int, 2>, double, const Range&, const Retention&, PointSet&,  \
      Motion);                                                                                     \
  template void tile_to_points<KERNEL, Keeps::velocity, AVERAGES>(                                 \
      const VelocityTile&, std::array<int, 2>, double, const Range&, const Retention&, PointSet&,  \
      Motion);                                                                                     \
  template void tile_to_points<KERNEL, Keeps::velocity_and_gradient, AVERAGES>(                    \
      const VelocityTile&, std::array<int, 2>, double, const Range&, const Retention&, PointSet&,  \
      Motion);
REPOSE_TRANSFERS(CubicKernel, true)
REPOSE_TRANSFERS(CubicKernel, false)
REPOSE_TRANSFERS(QuadraticKernel, true)
REPOSE_TRANSFERS(QuadraticKernel, false)
#undef REPOSE_TRANSFERS

}  // namespace repose::mpm

#include "mpm/transfer.hpp"

#include <utility>

#include "mpm/pack_stencil.hpp"

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
///   mass c_m,   momentum c_p + c_px dx + c_py dy,   force c_fx dx + c_fy dy,
/// but for the force by the spline's gradient, c_fx ∂w/∂ξ + c_fy ∂w/∂η.
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
  REPOSE_INLINE void add(double t_x, double t_y, const double (*c)[Pack::size], std::size_t lane) {
    const Weights at = Kernel::of_point(t_x, t_y);
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
      if constexpr (!Kernel::spline_gradient) {
        add(std::integral_constant<std::size_t, T_FX>{}, xsimd::fma(of(C_FXY), dy, fx));
        add(std::integral_constant<std::size_t, T_FY>{}, xsimd::fma(of(C_FYY), dy, fy));
      }
      if constexpr (averages) add(std::integral_constant<std::size_t, T_EXTRA>{}, of(C_E));
    });
    if constexpr (Kernel::spline_gradient)
      add_force_by_slopes(at.w, Kernel::slopes_of_point(t_x, t_y), c, lane);
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
  /// c_fx w′(ξ) w(η) + c_fy w(ξ) w′(η).
  REPOSE_INLINE void add_force_by_slopes(const RowPair& w, const RowPair& slope,
                                         const double (*c)[Pack::size], std::size_t lane) {
    const auto of = [&](std::size_t k) { return Pack(c[k][lane]); };
    const Pack w_x = w.x_repeated();
    const Pack slope_x = slope.x_repeated();
    const Pack fx_x = of(C_FXX) * slope_x;
    const Pack fx_y = of(C_FXY) * w_x;
    const Pack fy_x = of(C_FXY) * slope_x;
    const Pack fy_y = of(C_FYY) * w_x;
    unrolled<packs_per_stencil>([&](auto k) REPOSE_INLINE {
      constexpr int row = static_cast<int>(k * rows_per_pack);
      const Pack w_y = w.template y_spread<row>();
      const Pack slope_y = slope.template y_spread<row>();
      Pack& fx = sum_[T_FX * packs_per_stencil + k];
      Pack& fy = sum_[T_FY * packs_per_stencil + k];
      fx = xsimd::fma(w_y, fx_x, xsimd::fma(slope_y, fx_y, fx));
      fy = xsimd::fma(w_y, fy_x, xsimd::fma(slope_y, fy_y, fy));
    });
  }

  static constexpr std::size_t channels = averages ? tile_channels : T_EXTRA;
  Pack sum_[channels * packs_per_stencil];
};

}  // namespace

template <class Kernel, bool affine, bool averages>
void points_to_tile(const PointSet& points, const Range& range, double h, std::array<int, 2> origin,
                    const double* elastic, Tile& tile) {
  const double inv_h = 1.0 / h;
  // −V D⁻¹ h and the affine velocity times h: distances are in units of h
  const Pack minus_D_h(-Kernel::gradient_scale * inv_h);
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
      stencil.template add<affine>(tx[lane], ty[lane], c, lane);
    }
  }
  if (current != nowhere) stencil.add_to(tile, current);
}

template <class Kernel, Keeps keeps, bool averages>
void tile_to_points(const VelocityTile& tile, std::array<int, 2> origin, double h,
                    const Range& range, const Retention& keep, PointSet& points, Motion motion) {
  const Pack inv_h(1.0 / h);
  const Pack inv_D_h(Kernel::gradient_scale / h);
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
    stencil.for_each_row([&](std::size_t row, const Pack& w, const Pack& w_d) {
      const std::size_t n = row * tile_stride;
      stencil.add(tile.vx.data() + n, w, w_d, vx);
      stencil.add(tile.vy.data() + n, w, w_d, vy);
      if constexpr (averages) stencil.add(tile.elastic.data() + n, w, elastic);
      if constexpr (keeps == Keeps::velocity || keeps == Keeps::extension) {
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
    } else if constexpr (keeps == Keeps::extension) {
      put(VX, vx.value + ux.value);
      put(VY, vy.value + uy.value);
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

#define REPOSE_FROM_TILE(KERNEL, KEEPS, AVERAGES)                                                 \
  template void tile_to_points<KERNEL, Keeps::KEEPS, AVERAGES>(                                   \
      const VelocityTile&, std::array<int, 2>, double, const Range&, const Retention&, PointSet&, \
      Motion);
#define REPOSE_TO_TILE(KERNEL, AFFINE, AVERAGES)          \
  template void points_to_tile<KERNEL, AFFINE, AVERAGES>( \
      const PointSet&, const Range&, double, std::array<int, 2>, const double*, Tile&);
#define REPOSE_TRANSFERS(KERNEL, AVERAGES)                  \
  REPOSE_TO_TILE(KERNEL, true, AVERAGES)                    \
  REPOSE_TO_TILE(KERNEL, false, AVERAGES)                   \
  REPOSE_FROM_TILE(KERNEL, nothing, AVERAGES)               \
  REPOSE_FROM_TILE(KERNEL, velocity, AVERAGES)              \
  REPOSE_FROM_TILE(KERNEL, velocity_and_gradient, AVERAGES) \
  REPOSE_FROM_TILE(KERNEL, extension, AVERAGES)             \
  REPOSE_TO_TILE(SplineGradient<KERNEL>, true, AVERAGES)    \
  REPOSE_FROM_TILE(SplineGradient<KERNEL>, nothing, AVERAGES)
REPOSE_TRANSFERS(CubicKernel, true)
REPOSE_TRANSFERS(CubicKernel, false)
REPOSE_TRANSFERS(QuadraticKernel, true)
REPOSE_TRANSFERS(QuadraticKernel, false)
#undef REPOSE_TRANSFERS
#undef REPOSE_TO_TILE
#undef REPOSE_FROM_TILE

}  // namespace repose::mpm

#include "mpm/transfer.hpp"

namespace repose::mpm {
namespace {

using Lanes = std::array<double, 4>;

Lanes lanes(const Row& r) {
  alignas(Row::arch_type::alignment()) Lanes x;
  r.store_aligned(x.data());
  return x;
}

/// Sums of a stencil kept in registers while consecutive points share the same stencil.
template <int rows>
struct Accumulator {
  Row sum[tile_channels][rows];

  void clear() {
    for (auto& channel : sum)
      for (Row& r : channel) r = Row(0.0);
  }
  void add_to(Tile& tile, std::size_t node) const {
    for (std::size_t c = 0; c < tile_channels; ++c)
      for (std::size_t j = 0; j < rows; ++j) {
        double* at = tile[c].data() + node + j * tile_stride;
        (Row::load_unaligned(at) + sum[c][j]).store_unaligned(at);
      }
  }
};

std::size_t tile_place(int base_x, int base_y, const std::array<int, 2>& origin) {
  return static_cast<std::size_t>((base_y - origin[1]) * tile_stride + base_x - origin[0]);
}

}  // namespace

template <class Kernel, bool affine>
void points_to_tile(const PointSet& points, const Range& range, double h, std::array<int, 2> origin,
                    Tile& tile) {
  constexpr int rows = Kernel::rows;
  const double inv_h = 1.0 / h;
  const double inv_D = Kernel::inverse_moment * inv_h * inv_h;
  const double *x = points[X], *y = points[Y], *vx = points[VX], *vy = points[VY];
  const std::size_t a = points.affine;
  const double *Axx = points[a], *Axy = points[a + 1], *Ayx = points[a + 2], *Ayy = points[a + 3];
  const std::array<std::size_t, 3>& stress = points.force_stress;
  const double *sxx = points[stress[0]], *syy = points[stress[1]], *sxy = points[stress[2]];
  const double *rho = points[RHO], *mass = points[MASS];

  Accumulator<rows> stencil;
  stencil.clear();
  constexpr std::size_t nowhere = static_cast<std::size_t>(-1);
  std::size_t current = nowhere;
  for (std::size_t k = range.begin; k < range.begin + range.count; ++k) {
    const Weights wx = Kernel::at(x[k] * inv_h);
    const Weights wy = Kernel::at(y[k] * inv_h);
    const std::size_t place = tile_place(wx.base, wy.base, origin);
    if (place != current) {
      if (current != nowhere) stencil.add_to(tile, current);
      stencil.clear();
      current = place;
    }
    const double m = mass[k];
    const double V_invD = -m / rho[k] * inv_D;
    const Row dx = wx.d * Row(h);
    // per column, and what a row's distance dy multiplies:
    const Row w_m = wx.w * Row(m);
    const Row w_px = w_m * (affine ? xsimd::fma(Row(Axx[k]), dx, Row(vx[k])) : Row(vx[k]));
    const Row w_py = w_m * (affine ? xsimd::fma(Row(Ayx[k]), dx, Row(vy[k])) : Row(vy[k]));
    const Row w_px_dy = affine ? w_m * Row(Axy[k]) : Row(0.0);
    const Row w_py_dy = affine ? w_m * Row(Ayy[k]) : Row(0.0);
    const Row w_V = wx.w * Row(V_invD);
    const Row w_fx = w_V * (Row(sxx[k]) * dx);
    const Row w_fx_dy = w_V * Row(sxy[k]);  // also f_y's share of dx
    const Row w_fy = w_fx_dy * dx;
    const Row w_fy_dy = w_V * Row(syy[k]);
    const Lanes w_row = lanes(wy.w);
    const Lanes w_dy = lanes(wy.w * wy.d * Row(h));
#pragma GCC unroll 4
    for (std::size_t j = 0; j < rows; ++j) {
      const Row w(w_row[j]);
      const Row wd(w_dy[j]);
      stencil.sum[T_MASS][j] = xsimd::fma(w, w_m, stencil.sum[T_MASS][j]);
      stencil.sum[T_PX][j] = xsimd::fma(wd, w_px_dy, xsimd::fma(w, w_px, stencil.sum[T_PX][j]));
      stencil.sum[T_PY][j] = xsimd::fma(wd, w_py_dy, xsimd::fma(w, w_py, stencil.sum[T_PY][j]));
      stencil.sum[T_FX][j] = xsimd::fma(wd, w_fx_dy, xsimd::fma(w, w_fx, stencil.sum[T_FX][j]));
      stencil.sum[T_FY][j] = xsimd::fma(wd, w_fy_dy, xsimd::fma(w, w_fy, stencil.sum[T_FY][j]));
    }
  }
  if (current != nowhere) stencil.add_to(tile, current);
}

namespace {

/// Velocity and gradient of one field at a point: the sums over its stencil.
struct Interpolated {
  double vx, vy, Lxx, Lxy, Lyx, Lyy;
};

template <class Kernel>
Interpolated interpolate(const double* field_x, const double* field_y, const Weights& wx,
                         const Row& dx, const Lanes& w_row, const Lanes& w_dy, double inv_D) {
  // columns first: Σ_j w_j v, Σ_j w_j dy_j v
  Row sx(0.0), sy(0.0), sx_dy(0.0), sy_dy(0.0);
#pragma GCC unroll 4
  for (std::size_t j = 0; j < Kernel::rows; ++j) {
    const Row row_x = Row::load_unaligned(field_x + j * tile_stride);
    const Row row_y = Row::load_unaligned(field_y + j * tile_stride);
    const Row w(w_row[j]);
    const Row wd(w_dy[j]);
    sx = xsimd::fma(w, row_x, sx);
    sy = xsimd::fma(w, row_y, sy);
    sx_dy = xsimd::fma(wd, row_x, sx_dy);
    sy_dy = xsimd::fma(wd, row_y, sy_dy);
  }
  sx = sx * wx.w;
  sy = sy * wx.w;
  const Row first[4] = {sx, sy, sx * dx, sy * dx};
  const Row second[4] = {sx_dy * wx.w, sy_dy * wx.w, Row(0.0), Row(0.0)};
  const Lanes a = lanes(xsimd::haddp(first));
  const Lanes b = lanes(xsimd::haddp(second));
  return {a[0], a[1], a[2] * inv_D, b[0] * inv_D, a[3] * inv_D, b[1] * inv_D};
}

}  // namespace

template <class Kernel, bool keeps>
void tile_to_points(const VelocityTile& tile, std::array<int, 2> origin, double h,
                    const Range& range, const Retention& keep, PointSet& points, Motion motion) {
  const double inv_h = 1.0 / h;
  const double inv_D = Kernel::inverse_moment * inv_h * inv_h;
  const double *x = points[X], *y = points[Y];
  double *vx = points[VX], *vy = points[VY];
  double *Lxx = points[LXX], *Lxy = points[LXY], *Lyx = points[LYX], *Lyy = points[LYY];
  const std::size_t a = points.affine;
  double *Axx = points[a], *Axy = points[a + 1], *Ayx = points[a + 2], *Ayy = points[a + 3];
  for (std::size_t k = range.begin; k < range.begin + range.count; ++k) {
    const Weights wx = Kernel::at(x[k] * inv_h);
    const Weights wy = Kernel::at(y[k] * inv_h);
    const std::size_t place = tile_place(wx.base, wy.base, origin);
    const Row dx = wx.d * Row(h);
    const Lanes w_row = lanes(wy.w);
    const Lanes w_dy = lanes(wy.w * wy.d * Row(h));
    const Interpolated v = interpolate<Kernel>(tile.vx.data() + place, tile.vy.data() + place, wx,
                                               dx, w_row, w_dy, inv_D);
    motion.vx[k - range.begin] = v.vx;
    motion.vy[k - range.begin] = v.vy;
    if constexpr (keeps) {
      const Interpolated u = interpolate<Kernel>(tile.ux.data() + place, tile.uy.data() + place, wx,
                                                 dx, w_row, w_dy, inv_D);
      vx[k] = v.vx + keep.velocity * (vx[k] - u.vx);
      vy[k] = v.vy + keep.velocity * (vy[k] - u.vy);
      if (a != LXX) {
        Axx[k] = v.Lxx + keep.gradient * (Axx[k] - u.Lxx);
        Axy[k] = v.Lxy + keep.gradient * (Axy[k] - u.Lxy);
        Ayx[k] = v.Lyx + keep.gradient * (Ayx[k] - u.Lyx);
        Ayy[k] = v.Lyy + keep.gradient * (Ayy[k] - u.Lyy);
      }
    } else {
      vx[k] = v.vx;
      vy[k] = v.vy;
    }
    Lxx[k] = v.Lxx;
    Lyx[k] = v.Lyx;
    Lxy[k] = v.Lxy;
    Lyy[k] = v.Lyy;
  }
}

#define REPOSE_TRANSFERS(KERNEL)                                                                 \
  template void points_to_tile<KERNEL, true>(const PointSet&, const Range&, double,              \
                                             std::array<int, 2>, Tile&);                         \
  template void points_to_tile<KERNEL, false>(const PointSet&, const Range&, double,             \
                                              std::array<int, 2>, Tile&);                        \
  template void tile_to_points<KERNEL, true>(const VelocityTile&, std::array<int, 2>, double,    \
                                             const Range&, const Retention&, PointSet&, Motion); \
  template void tile_to_points<KERNEL, false>(const VelocityTile&, std::array<int, 2>, double,   \
                                              const Range&, const Retention&, PointSet&, Motion);
REPOSE_TRANSFERS(CubicKernel)
REPOSE_TRANSFERS(QuadraticKernel)
#undef REPOSE_TRANSFERS

}  // namespace repose::mpm

#pragma once
/// \file
/// The points of a range on a tile where two rows of a stencil fit into a register (AVX-512): the
/// sums of a whole stencil, in space of one plane after the other, stay in registers from one point
/// to the next that has the same stencil.

#include "mpm/grid/grid.hpp"
#include "mpm/grid/kernel.hpp"
#include "mpm/grid/unrolled.hpp"

namespace repose::mpm {

constexpr std::size_t packs_per_stencil = stencil_width / rows_per_pack;

/// What a point adds to a node at the distance d = (dx, dy) h is w times a polynomial in d:
///   mass c_m,   momentum c_p + c_px dx + c_py dy,   force c_fx dx + c_fy dy,
/// but for the force by the spline's gradient, c_fx ∂w/∂ξ + c_fy ∂w/∂η. In space the same holds in
/// each plane of nodes, at the distance dz h, with the coefficients
///   w(ζ) c_m,   w(ζ)(c_p + c_pz dz),  w(ζ) c_px,  w(ζ) c_fx, …   and a force w(ζ) c_fz dz (or c_fz
///   ∂w/∂ζ)
/// that is constant in the plane.
/// The coefficients of a pack of points.
template <int dim>
struct Coefficient {
  static constexpr std::size_t axes = dim;
  static constexpr std::size_t M = 0;
  static constexpr std::size_t E = 1;
  static constexpr std::size_t P = 2;         ///< + component
  static constexpr std::size_t A = P + axes;  ///< + 2 component + (dx or dy)
  static constexpr std::size_t F = A + 2 * axes;
  static constexpr std::size_t F_constant = F + 2 * axes - 1;  ///< + component
  static constexpr std::size_t count = dim == 2 ? F_constant : F_constant + axes;
  /// c_fx (a = 0) or c_fy (a = 1) of component i: xx, xy; xy, yy; zx, yz
  static constexpr std::size_t force(std::size_t i, std::size_t a) { return F + i + a + (i == 2); }
};

/// Sums of a stencil, or of a plane of it, kept in registers while consecutive points share the
/// same stencil: all of its rows, side by side. (Every index is known to the compiler, or they
/// would live in memory.)
template <class Kernel, bool averages, int dim>
class Accumulator {
  using C = Coefficient<dim>;
  using T = Channels<dim>;

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
    Pack p[dim], f[dim];
    unrolled<dim>([&](auto i) REPOSE_INLINE {
      p[i] = affine ? xsimd::fma(of(C::A + 2 * i), dx, of(C::P + i)) : of(C::P + i);
      if constexpr (dim == 2)
        f[i] = of(C::force(i, 0)) * dx;
      else
        f[i] = xsimd::fma(of(C::force(i, 0)), dx, of(C::F_constant + i));
    });
    unrolled<packs_per_stencil>([&](auto k) REPOSE_INLINE {
      constexpr int row = static_cast<int>(k * rows_per_pack);
      const Pack w = w_row * at.w.template y_spread<row>();
      const Pack dy = at.d.template y_spread<row>();
      const auto add = [&](auto channel, const Pack& value) REPOSE_INLINE {
        Pack& sum = sum_[channel * packs_per_stencil + k];
        sum = xsimd::fma(w, value, sum);
      };
      add(std::integral_constant<std::size_t, T::mass>{}, of(C::M));
      unrolled<dim>([&](auto i) REPOSE_INLINE {
        add(std::integral_constant<std::size_t, T::momentum + i>{},
            affine ? xsimd::fma(of(C::A + 2 * i + 1), dy, p[i]) : p[i]);
      });
      if constexpr (!Kernel::spline_gradient)
        unrolled<dim>([&](auto i) REPOSE_INLINE {
          add(std::integral_constant<std::size_t, T::force + i>{},
              xsimd::fma(of(C::force(i, 1)), dy, f[i]));
        });
      if constexpr (averages) add(std::integral_constant<std::size_t, T::extra>{}, of(C::E));
    });
    if constexpr (Kernel::spline_gradient)
      add_force_by_slopes(at.w, Kernel::slopes_of_point(t_x, t_y), c, lane);
  }

  REPOSE_INLINE void add_to(TileOf<dim>& tile, std::size_t node) const {
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
  /// c_fx w′(ξ) w(η) + c_fy w(ξ) w′(η), in space + c_f w(ξ) w(η).
  REPOSE_INLINE void add_force_by_slopes(const RowPair& w, const RowPair& slope,
                                         const double (*c)[Pack::size], std::size_t lane) {
    const auto of = [&](std::size_t k) { return Pack(c[k][lane]); };
    const Pack w_x = w.x_repeated();
    const Pack slope_x = slope.x_repeated();
    Pack f_x[dim], f_y[dim];
    unrolled<dim>([&](auto i) REPOSE_INLINE {
      f_x[i] = of(C::force(i, 0)) * slope_x;
      if constexpr (dim == 3) f_x[i] = xsimd::fma(of(C::F_constant + i), w_x, f_x[i]);
      f_y[i] = of(C::force(i, 1)) * w_x;
    });
    unrolled<packs_per_stencil>([&](auto k) REPOSE_INLINE {
      constexpr int row = static_cast<int>(k * rows_per_pack);
      const Pack w_y = w.template y_spread<row>();
      const Pack slope_y = slope.template y_spread<row>();
      unrolled<dim>([&](auto i) REPOSE_INLINE {
        Pack& sum = sum_[(T::force + i) * packs_per_stencil + k];
        sum = xsimd::fma(w_y, f_x[i], xsimd::fma(slope_y, f_y[i], sum));
      });
    });
  }

  static constexpr std::size_t channels = averages ? T::count : T::extra;
  Pack sum_[channels * packs_per_stencil];
};

/// points_to_tile() (transfer.hpp).
template <class Kernel, bool affine, bool averages, int dim>
void add_plane_sums(const PointsOf<dim>& points, const SlotRange& range, double h,
                    const std::array<int, Shape<dim>::axes>& origin, const double* elastic,
                    TileOf<dim>& tile) {
  using F = Layout<dim>;
  using C = Coefficient<dim>;
  const double inv_h = 1.0 / h;
  // −V D⁻¹ h and the affine velocity times h: distances are in units of h
  const Pack minus_D_h(-Kernel::gradient_scale * inv_h);
  const Pack cell(h);
  // the anchor of a point whose stencil begins with the tile's first node
  const Pack x_1(origin[0] + 1.0);
  const Pack y_1(origin[1] + 1.0);
  const std::size_t a = points.affine;

  constexpr std::size_t planes = dim == 2 ? 1 : Kernel::rows;
  constexpr std::size_t nowhere = static_cast<std::size_t>(-1);
  for (std::size_t plane = 0; plane < planes; ++plane) {
    Accumulator<Kernel, averages, dim> stencil;
    std::size_t current = nowhere;
    for (std::size_t first = 0; first < range.count; first += Pack::size) {
      const auto at = [&](std::size_t f) {
        return Pack::load_aligned(points.data(f) + range.begin + first);
      };
      alignas(64) double c[C::count][Pack::size];
      alignas(64) double tx[Pack::size], ty[Pack::size], place[Pack::size];
      Pack m = at(F::mass);
      Pack V = m / at(F::rho) * minus_D_h;
      const Pack x = at(F::x) * Pack(inv_h);
      const Pack y = at(F::x + 1) * Pack(inv_h);
      const Pack anchor_x = Kernel::anchor(x);
      const Pack anchor_y = Kernel::anchor(y);
      (x - anchor_x).store_aligned(tx);
      (y - anchor_y).store_aligned(ty);
      Pack node = (anchor_y - y_1) * Pack(tile_stride) + (anchor_x - x_1);
      if constexpr (dim == 3) {
        constexpr double plane_nodes = Shape<3>::tile[0] * Shape<3>::tile[1];
        const Pack z = at(F::x + 2) * Pack(inv_h);
        const Pack anchor_z = Kernel::anchor(z);
        const Pack t = z - anchor_z;
        const Pack dz = Pack(static_cast<double>(plane) - 1.0) - t;
        const Pack w = Kernel::weights(t)[plane];
        node = node +
               (anchor_z - Pack(origin[2] + 1.0 - static_cast<double>(plane))) * Pack(plane_nodes);
        Pack V_dz = V * w * dz;
        if constexpr (Kernel::spline_gradient) V_dz = V * Kernel::slopes(t)[plane];
        m = m * w;
        V = V * w;
        (V_dz * at(points.force_stress[5])).store_aligned(c[C::F_constant]);
        (V_dz * at(points.force_stress[4])).store_aligned(c[C::F_constant + 1]);
        (V_dz * at(points.force_stress[2])).store_aligned(c[C::F_constant + 2]);
        (V * at(points.force_stress[5])).store_aligned(c[C::force(2, 0)]);
        (V * at(points.force_stress[4])).store_aligned(c[C::force(2, 1)]);
        for (std::size_t i = 0; i < dim; ++i) {
          Pack v = at(F::v + i);
          if constexpr (affine) v = xsimd::fma(cell * dz, at(a + dim * i + 2), v);
          (m * v).store_aligned(c[C::P + i]);
        }
      } else {
        for (std::size_t i = 0; i < dim; ++i) (m * at(F::v + i)).store_aligned(c[C::P + i]);
      }
      as_bits(node).store_aligned(place);
      m.store_aligned(c[C::M]);
      if constexpr (averages) (m * Pack::load_aligned(elastic + first)).store_aligned(c[C::E]);
      if constexpr (affine) {
        const Pack mh = m * cell;
        for (std::size_t i = 0; i < dim; ++i)
          for (std::size_t j = 0; j < 2; ++j)
            (mh * at(a + dim * i + j)).store_aligned(c[C::A + 2 * i + j]);
      }
      (V * at(points.force_stress[0])).store_aligned(c[C::force(0, 0)]);
      (V * at(points.force_stress[1])).store_aligned(c[C::force(1, 1)]);
      (V * at(points.force_stress[dim == 2 ? 2 : 3])).store_aligned(c[C::force(0, 1)]);

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
}

}  // namespace repose::mpm

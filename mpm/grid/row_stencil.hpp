#pragma once
/// \file
/// The way from a tile to the points of a pack where looking nodes up in registers
/// (table_stencil.hpp) would be a gather from memory: the lanes are the nodes of a stencil row
/// while a field is summed across rows and planes, and become points, four at a time (two where a
/// register has no more), for the sum along the row.
///
/// Distances to a point are whole numbers k − 1 = −1 … 2 from its anchor less its own t: sums with
/// whole numbers are made of the products that are there already, and t times the value is taken
/// off once, at the end:
///   Σ w f (k − 1 − t) = ((w f)_2 − (w f)_0 + 2 (w f)_3) − t Σ w f.

#include "mpm/grid/grid.hpp"
#include "mpm/grid/kernel.hpp"
#include "mpm/grid/moments.hpp"
#include "mpm/grid/unrolled.hpp"

namespace repose::mpm {

/// The stencils of a pack of points in a tile.
template <class Kernel, int dim>
class RowStencil {
 public:
  using Moments = MomentsOf<dim>;

  /// Positions in units of h from the tile's first node.
  explicit RowStencil(const std::array<Pack, dim>& xi) {
    Pack node(0.0);
    for (std::size_t a = dim; a-- > 0;) {
      const Pack anchor = Kernel::anchor(xi[a]);
      const Pack t = xi[a] - anchor;
      const std::array<Pack, 4> w = Kernel::weights(t);
      std::array<Pack, 4> slope{};
      if constexpr (Kernel::spline_gradient) slope = Kernel::slopes(t);
      for (std::size_t k = 0; k < rows; ++k) {
        w[k].store_aligned(w_[a][k].data());
        if constexpr (Kernel::spline_gradient) slope[k].store_aligned(slope_[a][k].data());
      }
      t.store_aligned(t_[a].data());
      node = node * Pack(static_cast<double>(Shape<dim>::tile[a])) + (anchor - Pack(1.0));
    }
    as_bits(node).store_aligned(first_node_.data());
  }

  /// Moments of n fields of the tile and the values of `count` others.
  template <std::size_t n, std::size_t count>
  void read(const std::array<const double*, n>& fields, std::array<Moments, n>& moments,
            const std::array<const double*, count>& value_fields,
            std::array<Pack, count>& values) const {
    std::array<std::array<Lanes, 1 + dim>, n> sums;
    std::array<Lanes, count> value_sums;
    for (std::size_t first = 0; first < Pack::size; first += at_a_time) {
      // by field, then by point
      std::array<std::array<Row, at_a_time>, n> s, s_y, s_z;
      std::array<std::array<Row, at_a_time>, count> v;
      for (std::size_t k = 0; k < at_a_time; ++k) {
        const std::size_t lane = first + k;
        const std::size_t node = whole_number(first_node_[lane]);
        const Across y(*this, 1, lane);
        if constexpr (dim == 2) {
          unrolled<n>([&](auto f) REPOSE_INLINE {
            y.sum(fields[f] + node, tile_stride, s[f][k], s_y[f][k]);
          });
          unrolled<count>([&](auto f) REPOSE_INLINE {
            v[f][k] = y.value(value_fields[f] + node, tile_stride);
          });
        } else {
          const Across z(*this, 2, lane);
          unrolled<n>([&](auto f) REPOSE_INLINE {
            std::array<Row, rows> plane, plane_y;
            unrolled<rows>([&](auto at) REPOSE_INLINE {
              y.sum(fields[f] + node + at * plane_nodes, tile_stride, plane[at], plane_y[at]);
            });
            z.sum(plane, s[f][k], s_z[f][k]);
            s_y[f][k] = z.value(plane_y);
          });
          unrolled<count>([&](auto f) REPOSE_INLINE {
            std::array<Row, rows> plane;
            unrolled<rows>([&](auto at) REPOSE_INLINE {
              plane[at] = y.value(value_fields[f] + node + at * plane_nodes, tile_stride);
            });
            v[f][k] = z.value(plane);
          });
        }
      }
      unrolled<n>([&](auto f) REPOSE_INLINE {
        const auto put = [&](std::size_t which, const RowPoints& x)
                             REPOSE_INLINE { x.store_aligned(sums[f][which].data() + first); };
        const Columns columns = columns_of(s[f]);
        const Columns columns_y = columns_of(s_y[f]);
        const RowPoints value = along(w_[0], columns, first);
        put(0, value);
        put(1, from_anchor(0, slope_along(columns, first), value, first));
        put(2, from_anchor(1, along(w_[0], columns_y, first), value, first));
        if constexpr (dim == 3)
          put(3, from_anchor(2, along(w_[0], columns_of(s_z[f]), first), value, first));
      });
      unrolled<count>([&](auto f) REPOSE_INLINE {
        along(w_[0], columns_of(v[f]), first).store_aligned(value_sums[f].data() + first);
      });
    }
    unrolled<n>([&](auto f) REPOSE_INLINE {
      moments[f].value = load(sums[f][0]);
      moments[f].dx = load(sums[f][1]);
      moments[f].dy = load(sums[f][2]);
      if constexpr (dim == 3) moments[f].dz = load(sums[f][3]);
    });
    unrolled<count>([&](auto f) REPOSE_INLINE { values[f] = load(value_sums[f]); });
  }

 private:
  static constexpr std::size_t rows = Kernel::rows;
  static constexpr std::size_t at_a_time = RowPoints::size;
  using Columns = std::array<RowPoints, 4>;  ///< a node of the row each
  static constexpr std::size_t plane_nodes =
      static_cast<std::size_t>(tile_stride) * (dim == 2 ? 1 : Shape<dim>::tile[1]);
  /// One number per point of the pack.
  struct alignas(Pack) Lanes : std::array<double, Pack::size> {};
  REPOSE_INLINE static Pack load(const Lanes& lanes) { return Pack::load_aligned(lanes.data()); }

  /// Sums of one point across rows (axis 1) or planes (axis 2), the nodes of a row in the lanes.
  class Across {
   public:
    REPOSE_INLINE Across(const RowStencil& stencil, std::size_t axis, std::size_t lane) {
      for (std::size_t k = 0; k < rows; ++k) {
        w_[k] = Row(stencil.w_[axis][k][lane]);
        if constexpr (Kernel::spline_gradient) slope_[k] = Row(stencil.slope_[axis][k][lane]);
      }
    }
    REPOSE_INLINE Row value(const std::array<Row, rows>& f) const {
      Row s = w_[0] * f[0];
      for (std::size_t k = 1; k < rows; ++k) s = fma(w_[k], f[k], s);
      return s;
    }
    /// Σ w f, and with it Σ w f (k − 1) or Σ f ∂w/∂ξ.
    REPOSE_INLINE void sum(const std::array<Row, rows>& f, Row& s, Row& s_d) const {
      if constexpr (Kernel::spline_gradient) {
        s = value(f);
        s_d = slope_[0] * f[0];
        for (std::size_t k = 1; k < rows; ++k) s_d = fma(slope_[k], f[k], s_d);
      } else {
        const Row first = w_[0] * f[0];
        const Row third = w_[2] * f[2];
        s = fma(w_[1], f[1], first) + third;
        s_d = third - first;
        if constexpr (rows == 4) {
          const Row fourth = w_[3] * f[3];
          s = s + fourth;
          s_d = s_d + (fourth + fourth);
        }
      }
    }
    REPOSE_INLINE Row value(const double* at, std::size_t stride) const {
      return value(rows_of(at, stride));
    }
    REPOSE_INLINE void sum(const double* at, std::size_t stride, Row& s, Row& s_d) const {
      sum(rows_of(at, stride), s, s_d);
    }

   private:
    REPOSE_INLINE static std::array<Row, rows> rows_of(const double* at, std::size_t stride) {
      std::array<Row, rows> f;
      for (std::size_t k = 0; k < rows; ++k) f[k] = Row::load_unaligned(at + k * stride);
      return f;
    }
    std::array<Row, rows> w_, slope_;
  };

  /// Σ w f along x with the points in the lanes.
  REPOSE_INLINE static RowPoints along(const std::array<Lanes, 4>& w, const Columns& f,
                                       std::size_t first) {
    RowPoints s = RowPoints::load_aligned(w[0].data() + first) * f[0];
    for (std::size_t k = 1; k < rows; ++k)
      s = fma(RowPoints::load_aligned(w[k].data() + first), f[k], s);
    return s;
  }
  REPOSE_INLINE RowPoints slope_along(const Columns& f, std::size_t first) const {
    if constexpr (Kernel::spline_gradient) return along(slope_[0], f, first);
    const auto w = [&](std::size_t k) { return RowPoints::load_aligned(w_[0][k].data() + first); };
    RowPoints s = fms(w(2), f[2], w(0) * f[0]);
    if constexpr (rows == 4) s = fma(w(3), f[3] + f[3], s);
    return s;
  }
  /// From whole numbers to distances.
  REPOSE_INLINE RowPoints from_anchor(std::size_t axis, const RowPoints& s_d,
                                      const RowPoints& value, std::size_t first) const {
    if constexpr (Kernel::spline_gradient) return s_d;
    return xsimd::fnma(RowPoints::load_aligned(t_[axis].data() + first), value, s_d);
  }

  std::array<std::array<Lanes, 4>, dim> w_, slope_;
  std::array<Lanes, dim> t_;
  Lanes first_node_;
};

}  // namespace repose::mpm

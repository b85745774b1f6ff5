#pragma once
/// \file
/// The points of a range on a tile where a row of a stencil is one register of sixteen (AVX2) or
/// two of thirty-two (NEON): channel by channel and plane by plane, the four rows of a stencil are
/// loaded, take what up to four consecutive points with the same stencil add to them, and are
/// stored again.

#include "mpm/grid/grid.hpp"
#include "mpm/grid/kernel.hpp"
#include "mpm/grid/unrolled.hpp"

namespace repose::mpm {

/// Four points on their way to a tile. With the distance d = (dx, dy, dz) h of a node, w its weight
/// and w_x, w_y, w_z those along the axes, a point adds
///   w m,   w m(v + A d),   and as force  w V D⁻¹ σ d  or, by the spline's own gradient,  V σ ∇w
/// to the mass, momentum and force of the node.
template <class Kernel, bool affine, bool averages, int dim>
class RowSums {
 public:
  static constexpr std::size_t size = Row::size;
  static constexpr std::size_t rows = Kernel::rows;
  static constexpr std::size_t planes = dim == 2 ? 1 : rows;

  /// Numbers of four points.
  struct alignas(Row) Numbers : std::array<double, size> {
    void operator=(const Row& x) { x.store_aligned(this->data()); }
  };
  Numbers mass, extra;
  std::array<Numbers, dim> momentum;                          ///< m v
  std::array<std::array<Numbers, dim>, dim> affine_momentum;  ///< m A h, unless affine
  std::array<std::array<Numbers, dim>, dim> stress;           ///< −V σ D⁻¹ h, or −V σ/h
  Numbers first_node;                                         ///< as_bits()

  /// `t`: from the anchor, in units of h.
  void place(const std::array<Row, dim>& t) {
    x_weights_ = Kernel::weights(t[0]);
    for (std::size_t k = 0; k < size; ++k) x_distance_[k] = whole(k) - t[0];
    transpose(x_weights_);
    transpose(x_distance_);
    if constexpr (Kernel::spline_gradient) {
      x_slopes_ = Kernel::slopes(t[0]);
      transpose(x_slopes_);
    }
    for (std::size_t a = 1; a < dim; ++a) {
      const std::array<Row, 4> w = Kernel::weights(t[a]);
      std::array<Row, 4> slope;
      if constexpr (Kernel::spline_gradient) slope = Kernel::slopes(t[a]);
      for (std::size_t k = 0; k < rows; ++k) {
        w_[a - 1][k] = w[k];
        w_d_[a - 1][k] = w[k] * (whole(k) - t[a]);
        if constexpr (Kernel::spline_gradient) slope_[a - 1][k] = slope[k];
      }
    }
  }

  void add_to(TileOf<dim>& tile, std::size_t points) const {
    for (std::size_t k = 0; k < points;) {
      const std::uint32_t node = whole_number(first_node[k]);
      std::size_t run = 1;
      while (k + run < points && whole_number(first_node[k + run]) == node) ++run;
      switch (run) {
        case 1:
          add_run<1>(tile, node, k);
          break;
        case 2:
          add_run<2>(tile, node, k);
          break;
        case 3:
          add_run<3>(tile, node, k);
          break;
        default:
          add_run<4>(tile, node, k);
      }
      k += run;
    }
  }

 private:
  /// What the rows of a stencil are weighted with, of each point of a run.
  template <std::size_t run>
  using Weights = std::array<std::array<Row, rows>, run>;

  static Row whole(std::size_t k) { return Row(static_cast<double>(k) - 1.0); }

  /// Adds Σ over the run and the terms (weights w, factor k) of w k to the rows of a plane.
  template <std::size_t run, class... Terms>
  REPOSE_INLINE static void add_rows(double* at, const Terms&... terms) {
    unrolled<rows>([&](auto row) REPOSE_INLINE {
      double* const to = at + row * tile_stride;
      Row sum = Row::load_unaligned(to);
      unrolled<run>([&](auto j) REPOSE_INLINE {
        ((sum = fma((*terms.weights)[j][row], terms.factor[j], sum)), ...);
      });
      sum.store_unaligned(to);
    });
  }
  template <std::size_t run>
  struct Term {
    const Weights<run>* weights;
    std::array<Row, run> factor;
  };

  template <std::size_t run>
  REPOSE_INLINE void add_run(TileOf<dim>& tile, std::size_t node, std::size_t first) const {
    using T = Channels<dim>;
    Weights<run> w, w_dy;                            // w_x w_y, w_x w_y dy
    [[maybe_unused]] Weights<run> slope_x, slope_y;  // ∂w_x/∂ξ w_y, w_x ∂w_y/∂η
    for (std::size_t j = 0; j < run; ++j)
      for (std::size_t k = 0; k < rows; ++k) {
        w[j][k] = x_weights_[first + j] * Row(w_[0][k][first + j]);
        w_dy[j][k] = x_weights_[first + j] * Row(w_d_[0][k][first + j]);
        if constexpr (Kernel::spline_gradient) {
          slope_x[j][k] = x_slopes_[first + j] * Row(w_[0][k][first + j]);
          slope_y[j][k] = x_weights_[first + j] * Row(slope_[0][k][first + j]);
        }
      }
    /// Of a number of each point of the run.
    const auto of = [&](const Numbers& x) REPOSE_INLINE {
      std::array<Row, run> all;
      for (std::size_t j = 0; j < run; ++j) all[j] = Row(x[first + j]);
      return all;
    };
    const auto times = [&](std::array<Row, run> a, const std::array<Row, run>& b) REPOSE_INLINE {
      for (std::size_t j = 0; j < run; ++j) a[j] = a[j] * b[j];
      return a;
    };
    const auto plus = [&](std::array<Row, run> a, const std::array<Row, run>& b,
                          const std::array<Row, run>& c) REPOSE_INLINE {
      for (std::size_t j = 0; j < run; ++j) a[j] = fma(b[j], c[j], a[j]);
      return a;
    };
    std::array<Row, run> dx;
    for (std::size_t j = 0; j < run; ++j) dx[j] = x_distance_[first + j];
    /// Calls f(plane's rows, x times the plane's weight w_z) for every plane of a channel.
    const auto each_plane = [&](std::size_t channel, auto&& f) REPOSE_INLINE {
      double* const at = tile[channel].data() + node;
      if constexpr (dim == 2) {
        f(at, std::size_t{0}, [](const std::array<Row, run>& x) REPOSE_INLINE { return x; });
      } else {
        for (std::size_t plane = 0; plane < planes;
             ++plane) {  // written out, it is longer than the cache
          const std::array<Row, run> w_z = of(w_[1][plane]);
          f(at + plane * plane_nodes, plane,
            [&](const std::array<Row, run>& x) REPOSE_INLINE { return times(x, w_z); });
        }
      }
    };
    /// Of what does not change with the distance.
    const auto add_scalar = [&](std::size_t channel, const Numbers& x) REPOSE_INLINE {
      const std::array<Row, run> all = of(x);
      each_plane(channel, [&](double* at, std::size_t, auto&& weighted) REPOSE_INLINE {
        add_rows<run>(at, Term<run>{&w, weighted(all)});
      });
    };

    add_scalar(T::mass, mass);
    unrolled<dim>([&](auto i) REPOSE_INLINE {
      if constexpr (affine) {
        const std::array<Numbers, dim>& A = affine_momentum[i];
        const std::array<Row, run> x = plus(of(momentum[i]), of(A[0]), dx), y = of(A[1]);
        each_plane(T::momentum + i,
                   [&](double* at, std::size_t plane, auto&& weighted) REPOSE_INLINE {
                     std::array<Row, run> part = weighted(x);
                     if constexpr (dim == 3) part = plus(part, of(A[2]), of(w_d_[1][plane]));
                     add_rows<run>(at, Term<run>{&w, part}, Term<run>{&w_dy, weighted(y)});
                   });
      } else {
        add_scalar(T::momentum + i, momentum[i]);
      }
    });
    unrolled<dim>([&](auto i) REPOSE_INLINE {
      const std::array<Numbers, dim>& s = stress[i];
      const std::array<Row, run> y = of(s[1]);
      std::array<Row, run> x = of(s[0]);
      if constexpr (!Kernel::spline_gradient) x = times(x, dx);
      each_plane(T::force + i, [&](double* at, std::size_t plane, auto&& weighted) REPOSE_INLINE {
        if constexpr (!Kernel::spline_gradient) {
          std::array<Row, run> part = weighted(x);
          if constexpr (dim == 3) part = plus(part, of(s[2]), of(w_d_[1][plane]));
          add_rows<run>(at, Term<run>{&w, part}, Term<run>{&w_dy, weighted(y)});
        } else if constexpr (dim == 2) {
          add_rows<run>(at, Term<run>{&slope_x, x}, Term<run>{&slope_y, y});
        } else {
          add_rows<run>(at, Term<run>{&slope_x, weighted(x)}, Term<run>{&slope_y, weighted(y)},
                        Term<run>{&w, times(of(s[2]), of(slope_[1][plane]))});
        }
      });
    });
    if constexpr (averages) add_scalar(T::extra, extra);
  }

  static constexpr std::size_t plane_nodes =
      static_cast<std::size_t>(tile_stride) * (dim == 2 ? 1 : Shape<dim>::tile[1]);
  std::array<Row, size> x_weights_, x_distance_, x_slopes_;  ///< by point, its nodes in the lanes
  /// Along y (and z): weights, times the distance, and their slopes.
  std::array<std::array<Numbers, rows>, dim - 1> w_, w_d_, slope_;
};

/// points_to_tile() (transfer.hpp).
template <class Kernel, bool affine, bool averages, int dim>
void add_row_sums(const PointsOf<dim>& points, const SlotRange& range, double h,
                  const std::array<int, Shape<dim>::axes>& origin, const double* elastic,
                  TileOf<dim>& tile) {
  using F = Layout<dim>;
  const Row inv_h(1.0 / h);
  const Row minus_D_h(-Kernel::gradient_scale / h);
  const Row cell(h);
  for (std::size_t first = 0; first < range.count; first += Row::size) {
    const auto at = [&](std::size_t f) {
      return Row::load_aligned(points.data(f) + range.begin + first);
    };
    RowSums<Kernel, affine, averages, dim> four;
    const Row m = at(F::mass);
    const Row V = m / at(F::rho) * minus_D_h;
    four.mass = m;
    if constexpr (averages) four.extra = m * Row::load_aligned(elastic + first);
    std::array<Row, dim> t;
    Row node(0.0);
    for (std::size_t a = dim; a-- > 0;) {
      const Row xi = at(F::x + a) * inv_h;
      const Row anchor = Kernel::anchor(xi);
      t[a] = xi - anchor;
      node = node * Row(static_cast<double>(Shape<dim>::tile[a])) + (anchor - Row(origin[a] + 1.0));
    }
    four.first_node = as_bits(node);
    four.place(t);
    for (std::size_t i = 0; i < dim; ++i) {
      four.momentum[i] = m * at(F::v + i);
      for (std::size_t j = 0; j < dim; ++j) {
        if constexpr (affine)
          four.affine_momentum[i][j] = m * cell * at(points.affine + dim * i + j);
        // xx, yy, xy; in space xx, yy, zz, xy, yz, zx
        const std::size_t component = i == j       ? i
                                      : dim == 2   ? 2
                                      : i + j == 1 ? 3
                                      : i + j == 3 ? 4
                                                   : 5;
        four.stress[i][j] = V * at(points.force_stress[component]);
      }
    }
    four.add_to(tile, std::min(Row::size, range.count - first));
  }
}

}  // namespace repose::mpm

#pragma once
/// \file
/// The way from a tile to the points of a pack: the lanes are points, each of which looks its nodes
/// up in registers that hold a row of the tile.

#include "mpm/grid.hpp"
#include "mpm/kernel.hpp"

namespace repose::mpm {

/// A field at the points of a pack: Σ w f, and Σ w f d with the distance d in units of h or, for
/// the spline's gradient, Σ f ∂w/∂ξ.
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
    const Pack tx = x - anchor_x;
    const Pack ty = y - anchor_y;
    wx_ = Kernel::weights(tx);
    wy_ = Kernel::weights(ty);
    if constexpr (Kernel::spline_gradient) {
      wx_dx_ = Kernel::slopes(tx);
      slope_y_ = Kernel::slopes(ty);
    }
    base_y_ = anchor_y - Pack(1.0);
    for (std::size_t k = 0; k < columns; ++k) {
      const Pack column = anchor_x + Pack(static_cast<double>(k) - 1.0);
      column_[k] = RowTable::index(column);
      if constexpr (!Kernel::spline_gradient) wx_dx_[k] = wx_[k] * (column - x);
    }
    first_row_ = static_cast<std::size_t>(least(base_y_));
    last_row_ = static_cast<std::size_t>(greatest(base_y_)) + Kernel::rows - 1;
  }

  /// Calls f(row of the tile, its weight w, w × distance or its slope): rows in which no lane has a
  /// node are left out, lanes that have none in this row get zeros.
  template <class F>
  void for_each_row(F&& f) const {
    for (std::size_t row = first_row_; row <= last_row_; ++row) {
      const Pack r(static_cast<double>(row));
      const Pack k = r - base_y_;
      Pack w(0.0), slope(0.0);
      for (std::size_t j = 0; j < Kernel::rows; ++j) {
        const auto here = k == Pack(static_cast<double>(j));
        w = select(here, wy_[j], w);
        if constexpr (Kernel::spline_gradient) slope = select(here, slope_y_[j], slope);
      }
      if constexpr (Kernel::spline_gradient)
        f(row, w, slope);
      else
        f(row, w, Pack(w * (r - y_)));
    }
  }

  /// Adds a row of a field to its moments; w_d = weight × distance or slope.
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
  std::array<Pack, 4> wx_, wy_, wx_dx_, slope_y_;
  RowTable::Index column_[columns];
  Pack base_y_;
  std::size_t first_row_, last_row_;
};

}  // namespace repose::mpm

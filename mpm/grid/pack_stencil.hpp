#pragma once
/// \file
/// The way from a tile to the points of a pack: the lanes are points, each of which looks its nodes
/// up in registers that hold a row of the tile.

#include "mpm/grid/grid.hpp"
#include "mpm/grid/kernel.hpp"

namespace repose::mpm {

/// A field at the points of a pack: Σ w f, and Σ w f d with the distance d in units of h or, for
/// the spline's gradient, Σ f ∂w/∂ξ.
struct Moments {
  Pack value = Pack(0.0), dx = Pack(0.0), dy = Pack(0.0);
};

/// The same in space.
struct SpaceMoments : Moments {
  Pack dz = Pack(0.0);
};

/// Where the points of a pack have their nodes across the rows of a tile, or across its planes.
template <class Kernel>
class PackRows {
 public:
  explicit PackRows(const Pack& y) : y_(y) {
    const Pack anchor = Kernel::anchor(y);
    const Pack t = y - anchor;
    w_ = Kernel::weights(t);
    if constexpr (Kernel::spline_gradient) slope_ = Kernel::slopes(t);
    base_ = anchor - Pack(1.0);
    first_ = static_cast<std::size_t>(least(base_));
    last_ = static_cast<std::size_t>(greatest(base_)) + Kernel::rows - 1;
  }

  /// Calls f(row of the tile, its weight w, w × distance or its slope): rows in which no lane has a
  /// node are left out, lanes that have none in this row get zeros.
  template <class F>
  void for_each(F&& f) const {
    for (std::size_t row = first_; row <= last_; ++row) {
      const Pack r(static_cast<double>(row));
      const Pack k = r - base_;
      Pack w(0.0), slope(0.0);
      for (std::size_t j = 0; j < Kernel::rows; ++j) {
        const auto here = k == Pack(static_cast<double>(j));
        w = select(here, w_[j], w);
        if constexpr (Kernel::spline_gradient) slope = select(here, slope_[j], slope);
      }
      if constexpr (Kernel::spline_gradient)
        f(row, w, slope);
      else
        f(row, w, Pack(w * (r - y_)));
    }
  }

 private:
  Pack y_;
  std::array<Pack, 4> w_, slope_;
  Pack base_;
  std::size_t first_, last_;
};

/// The stencils of a pack of points in a tile.
template <class Kernel>
class PackStencil {
 public:
  /// Positions in units of h from the tile's first node.
  PackStencil(const Pack& x, const Pack& y) : rows_(y) {
    const Pack anchor_x = Kernel::anchor(x);
    const Pack tx = x - anchor_x;
    wx_ = Kernel::weights(tx);
    if constexpr (Kernel::spline_gradient) wx_dx_ = Kernel::slopes(tx);
    for (std::size_t k = 0; k < columns; ++k) {
      const Pack column = anchor_x + Pack(static_cast<double>(k) - 1.0);
      column_[k] = RowTable::index(column);
      if constexpr (!Kernel::spline_gradient) wx_dx_[k] = wx_[k] * (column - x);
    }
  }

  /// PackRows::for_each.
  template <class F>
  void for_each_row(F&& f) const {
    rows_.for_each(f);
  }

  /// Adds a row of a field to its moments; w_d = weight × distance or slope.
  void add(const double* row, const Pack& w, const Pack& w_d, Moments& sum) const {
    const auto [s, s_dx] = along(row);
    sum.value = xsimd::fma(w, s, sum.value);
    sum.dx = xsimd::fma(w, s_dx, sum.dx);
    sum.dy = xsimd::fma(w_d, s, sum.dy);
  }

  /// In space, with weights that are those of the row times those of its plane: w, w_dy with the
  /// row's distance or slope, w_dz with the plane's.
  void add(const double* row, const Pack& w, const Pack& w_dy, const Pack& w_dz,
           SpaceMoments& sum) const {
    const auto [s, s_dx] = along(row);
    sum.value = xsimd::fma(w, s, sum.value);
    sum.dx = xsimd::fma(w, s_dx, sum.dx);
    sum.dy = xsimd::fma(w_dy, s, sum.dy);
    sum.dz = xsimd::fma(w_dz, s, sum.dz);
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

  /// The sums along a row alone.
  struct RowSums {
    Pack value, dx;
  };
  RowSums along(const double* row) const {
    const RowTable table(row);
    Pack s = table.at(column_[0]);
    Pack s_dx = s * wx_dx_[0];
    s = s * wx_[0];
    for (std::size_t k = 1; k < columns; ++k) {
      const Pack f = table.at(column_[k]);
      s = xsimd::fma(wx_[k], f, s);
      s_dx = xsimd::fma(wx_dx_[k], f, s_dx);
    }
    return {s, s_dx};
  }

  PackRows<Kernel> rows_;
  std::array<Pack, 4> wx_, wx_dx_;
  RowTable::Index column_[columns];
};

/// The stencils of a pack of points in space: those of the plane, once per plane of the tile.
template <class Kernel>
class SpaceStencil {
 public:
  SpaceStencil(const Pack& x, const Pack& y, const Pack& z) : plane_(x, y), planes_(z) {}

  /// Calls f(row of the tile, its planes one after the other; w, w_dy, w_dz as add() takes them).
  template <class F>
  void for_each_row(F&& f) const {
    planes_.for_each([&](std::size_t plane, const Pack& w_z, const Pack& w_z_d) {
      plane_.for_each_row([&](std::size_t row, const Pack& w_y, const Pack& w_y_d) {
        f(plane * Shape<3>::tile[1] + row, Pack(w_y * w_z), Pack(w_y_d * w_z), Pack(w_y * w_z_d));
      });
    });
  }
  void add(const double* row, const Pack& w, const Pack& w_dy, const Pack& w_dz,
           SpaceMoments& sum) const {
    plane_.add(row, w, w_dy, w_dz, sum);
  }
  void add(const double* row, const Pack& w, Pack& sum) const { plane_.add(row, w, sum); }

 private:
  PackStencil<Kernel> plane_;
  PackRows<Kernel> planes_;
};

}  // namespace repose::mpm

#pragma once
/// \file
/// The way from a tile to the points of a pack where a row of the tile fits into two registers: the
/// lanes are points, each of which looks its nodes up in them.

#include "mpm/grid/grid.hpp"
#include "mpm/grid/kernel.hpp"
#include "mpm/grid/moments.hpp"
#include "mpm/grid/unrolled.hpp"

namespace repose::mpm {

/// Where the points of a pack have their nodes across the rows of a tile.
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

/// The stencils of a pack of points in a tile of the plane.
template <class Kernel>
class TableStencil {
 public:
  /// Positions in units of h from the tile's first node.
  explicit TableStencil(const std::array<Pack, 2>& xi) : rows_(xi[1]) {
    const Pack anchor = Kernel::anchor(xi[0]);
    const Pack t = xi[0] - anchor;
    wx_ = Kernel::weights(t);
    if constexpr (Kernel::spline_gradient) wx_dx_ = Kernel::slopes(t);
    for (std::size_t k = 0; k < columns; ++k) {
      const Pack column = anchor + Pack(static_cast<double>(k) - 1.0);
      column_[k] = RowTable::index(column);
      if constexpr (!Kernel::spline_gradient) wx_dx_[k] = wx_[k] * (column - xi[0]);
    }
  }

  /// Moments of n fields of the tile and the values of `count` others.
  template <std::size_t n, std::size_t count>
  void read(const std::array<const double*, n>& fields, std::array<Moments, n>& moments,
            const std::array<const double*, count>& value_fields,
            std::array<Pack, count>& values) const {
    moments.fill(Moments{});
    values.fill(Pack(0.0));
    rows_.for_each([&](std::size_t row, const Pack& w, const Pack& w_d) {
      const std::size_t first = row * tile_stride;
      unrolled<n>([&](auto f) { add(fields[f] + first, w, w_d, moments[f]); });
      unrolled<count>([&](auto f) { add(value_fields[f] + first, w, values[f]); });
    });
  }

 private:
  static constexpr std::size_t columns = Kernel::rows;

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

  PackRows<Kernel> rows_;
  std::array<Pack, 4> wx_, wx_dx_;
  RowTable::Index column_[columns];
};

}  // namespace repose::mpm

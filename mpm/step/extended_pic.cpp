#include "mpm/step/extended_pic.hpp"

#include "mpm/grid/point_stencil.hpp"
#include "mpm/grid/tile_exchange.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {

template <class Kernel>
void through_points(const PointSet& points, const SlotRange& range, double h,
                    std::array<int, 2> origin, const VelocityTile& there, Tile& back) {
  const Pack inv_h(1.0 / h);
  const Pack x_0(static_cast<double>(origin[0]));
  const Pack y_0(static_cast<double>(origin[1]));
  const Pack one(1.0);
  for (std::size_t first = 0; first < range.count; first += Pack::size) {
    const auto at = [&](std::size_t f) {
      return Pack::load_aligned(points.data(f) + range.begin + first);
    };
    const Pack x = at(X) * inv_h - x_0;
    const Pack y = at(Y) * inv_h - y_0;
    std::array<Moments, 0> none;
    std::array<Pack, 2> v;
    PointStencil<Kernel, 2>({x, y}).read({}, none, {there.v[0].data(), there.v[1].data()}, v);
    alignas(64) double px[Pack::size], py[Pack::size];
    alignas(64) double tx[Pack::size], ty[Pack::size], place[Pack::size];
    (at(MASS) * v[0]).store_aligned(px);
    (at(MASS) * v[1]).store_aligned(py);
    const Pack anchor_x = Kernel::anchor(x);
    const Pack anchor_y = Kernel::anchor(y);
    (x - anchor_x).store_aligned(tx);
    (y - anchor_y).store_aligned(ty);
    as_bits((anchor_y - one) * Pack(tile_stride) + (anchor_x - one)).store_aligned(place);
    const std::size_t lanes = std::min(Pack::size, range.count - first);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const RowPair w = Kernel::of_point(tx[lane], ty[lane]).w;
      alignas(Row) double w_y[Row::size];
      w.y().store_aligned(w_y);
      const Row x_part = w.x() * Row(px[lane]);
      const Row y_part = w.x() * Row(py[lane]);
      std::size_t node = whole_number(place[lane]);
      for (std::size_t row = 0; row < Kernel::rows; ++row, node += tile_stride) {
        const auto add = [&](TileChannel c, const Row& part) {
          double* to = back[c].data() + node;
          fma(Row(w_y[row]), part, Row::load_unaligned(to)).store_unaligned(to);
        };
        add(T_PX, x_part);
        add(T_PY, y_part);
      }
    }
  }
}

template void through_points<CubicKernel>(const PointSet&, const SlotRange&, double,
                                          std::array<int, 2>, const VelocityTile&, Tile&);
template void through_points<QuadraticKernel>(const PointSet&, const SlotRange&, double,
                                              std::array<int, 2>, const VelocityTile&, Tile&);

template <>
void Simulation::Impl<2>::extend_velocity() {
  const bool after_forces = scene.transfer == Transfer::fmpm;
  const std::size_t n = grid.node_blocks.size();
  remainder_.resize(n);
  through_points_.resize(n);
  extension_.assign(n, NodeField{});
  for_each_block(arena, n, [&](std::size_t k) {
    const NodeBlock& nb = grid.node_blocks[k];
    remainder_[k].x = after_forces ? nb.v[0] : nb.u[0];
    remainder_[k].y = after_forces ? nb.v[1] : nb.u[1];
  });
  for (int pass = 1; pass < scene.order; ++pass) {
    // the tiles have given the nodes what they held (update_grid) and are free until the next P2G
    for_each_block(arena, grid.point_blocks.size(), [&](std::size_t k) {
      const PointBlock& pb = grid.point_blocks[k];
      VelocityTile there;
      fill_tile(pb, there.v[0], [&](std::size_t b) { return remainder_[b].x.data(); });
      fill_tile(pb, there.v[1], [&](std::size_t b) { return remainder_[b].y.data(); });
      Tile& back = grid.tiles[k];
      clear_touched(pb, back[T_PX]);
      clear_touched(pb, back[T_PY]);
      for (std::size_t b = 0; b < bodies.size(); ++b)
        bodies[b].read(pb.range[b], [&](const PointSet& points, const SlotRange& range) {
          if (scene.kernel == mpm::Kernel::cubic)
            mpm::through_points<CubicKernel>(points, range, grid.h(), tile_origin(pb), there, back);
          else
            mpm::through_points<QuadraticKernel>(points, range, grid.h(), tile_origin(pb), there,
                                                 back);
        });
    });
    for_each_block(arena, n, [&](std::size_t k) {
      const NodeBlock& nb = grid.node_blocks[k];
      alignas(64) NodeTotals<2> momentum{};
      add_tiles<2>(grid, nb, {T_PX, T_PY}, momentum);
      for (std::size_t i = 0; i < block_nodes; ++i) {
        const double inv_m = nb.mass[i] > 0.0 ? 1.0 / nb.mass[i] : 0.0;
        through_points_[k].x[i] = momentum[0][i] * inv_m;
        through_points_[k].y[i] = momentum[1][i] * inv_m;
      }
    });
    mirror(mirrored_, through_points_);
    for_each_block(arena, n, [&](std::size_t k) {
      const auto add = [&](auto NodeField::*c) {
        for (std::size_t i = 0; i < block_nodes; ++i) {
          (remainder_[k].*c)[i] -= (through_points_[k].*c)[i];
          (extension_[k].*c)[i] += (remainder_[k].*c)[i];
        }
      };
      add(&NodeField::x);
      add(&NodeField::y);
    });
  }
  for_each_block(arena, n, [&](std::size_t k) {
    NodeBlock& nb = grid.node_blocks[k];
    const NodeField& e = extension_[k];
    if (!after_forces) {
      nb.u[0] = e.x;
      nb.u[1] = e.y;
      return;
    }
    double work = 0.0;
    for (std::size_t i = 0; i < block_nodes; ++i) {
      work += 0.5 * nb.mass[i] *
              ((nb.v[0][i] - nb.u[0][i]) * e.x[i] + (nb.v[1][i] - nb.u[1][i]) * e.y[i]);
      nb.v[0][i] += e.x[i];
      nb.v[1][i] += e.y[i];
    }
    node_sums_[k].extension_work = work;
  });
}

}  // namespace repose::mpm

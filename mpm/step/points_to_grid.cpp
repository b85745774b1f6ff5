/// P2G: mass, momentum and internal force of every block's points on its tile.

#include "mpm/grid/tile_exchange.hpp"
#include "mpm/step/body_force.hpp"
#include "mpm/step/choose_kernel.hpp"
#include "mpm/step/simulation_impl.hpp"
#include "mpm/step/transfer.hpp"

namespace repose::mpm {

template <int dim>
template <class Kernel, bool affine, Extra extra>
void Simulation::Impl<dim>::transfer_to_tile(std::size_t block) {
  const PointBlockOf<dim>& pb = grid.point_blocks[block];
  TileOf<dim>& tile = grid.tiles[block];
  constexpr bool has_extra = extra != Extra::nothing;
  for (std::size_t c = 0; c < Channels<dim>::extra + has_extra; ++c) clear_touched(pb, tile[c]);
  static thread_local AlignedVector<double> values;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (pb.range[b].count == 0) continue;
    bodies[b].read(pb.range[b], [&](PointsOf<dim>& points, const SlotRange& range) {
      if constexpr (has_extra) values.resize(std::max(values.size(), padded(range.count)));
      if constexpr (extra == Extra::elastic)
        points.material->elastic_volume_strain(points.batch(range), values.data());
      if constexpr (extra == Extra::signal) square_signals(points, range, values.data());
      points_to_tile<Kernel, affine, has_extra>(points, range, grid.h(), tile_origin(pb),
                                                values.data(), tile);
      if (scene.water_table) buoyancy_to_tile<Kernel>(points, b, range, tile_origin(pb), tile);
      if constexpr (dim == 2) {
        if (prescribed.acceleration)
          prescribed_force_to_tile<Kernel>(points, range, tile_origin(pb), tile);
      }
    });
  }
}

template <int dim>
void Simulation::Impl<dim>::square_signals(PointsOf<dim>& points, const SlotRange& range,
                                           double* signal2) {
  using F = Layout<dim>;
  points.material->modulus(points.batch(range), signal2);
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const auto at = [&](std::size_t f) {
      return Pack::load_aligned(points.data(f) + range.begin + k);
    };
    const Pack c = Pack(points.damped_signal) * sqrt(Pack::load_aligned(signal2 + k) / at(F::rho));
    std::array<Pack, dim> v;
    for (std::size_t i = 0; i < dim; ++i) v[i] = at(F::v + i);
    const Pack signal = c + sqrt(dot(v, v));
    (signal * signal).store_aligned(signal2 + k);
  }
}

template <>
template <class Kernel>
void Simulation::Impl<2>::prescribed_force_to_tile(const PointSet& points, const SlotRange& range,
                                                   std::array<int, 2> origin, Tile& tile) const {
  const std::size_t n = range.count;
  static thread_local std::vector<double> scratch;
  scratch.assign(4 * n, 0.0);
  const std::span<double> start[2] = {{scratch.data(), n}, {scratch.data() + n, n}};
  const std::span<double> a[2] = {{scratch.data() + 2 * n, n}, {scratch.data() + 3 * n, n}};
  for (std::size_t k = 0; k < n; ++k) {
    const auto name = static_cast<std::size_t>(points.id[range.begin + k]);
    start[0][k] = start_x[name];
    start[1][k] = start_y[name];
  }
  prescribed.acceleration(tiles_time, start[0], start[1], a[0], a[1]);
  body_force_to_tile<Kernel>(points, range, a[0], a[1], grid.h(), origin, tile);
}

template <int dim>
template <class Kernel>
void Simulation::Impl<dim>::buoyancy_to_tile(const PointsOf<dim>& points, std::size_t body,
                                             const SlotRange& range,
                                             const std::array<int, Shape<dim>::axes>& origin,
                                             TileOf<dim>& tile) const {
  using F = Layout<dim>;
  TileField<dim>& force = tile[Channels<dim>::force + 1];
  const double inv_h = 1.0 / grid.h();
  for (std::size_t s = range.begin; s < range.begin + range.count; ++s) {
    const double share = buoyant(body, points[F::x + 1][s]);
    if (share == 0.0) continue;
    std::array<std::array<double, 4>, dim> w;
    std::size_t place = 0;
    for (std::size_t axis = dim; axis-- > 0;) {
      const double xi = points[F::x + axis][s] * inv_h;
      const double anchor = Kernel::anchor(xi);
      w[axis] = Kernel::weights(xi - anchor);
      place = place * static_cast<std::size_t>(Shape<dim>::tile[axis]) +
              static_cast<std::size_t>(anchor - 1.0 - origin[axis]);
    }
    const double borne = -share * gravity[1] * points[F::mass][s];
    constexpr std::size_t planes = dim == 2 ? 1 : Kernel::rows;
    constexpr std::size_t plane_nodes = Shape<dim>::tile[0] * Shape<dim>::tile[1];
    for (std::size_t k = 0; k < planes; ++k)
      for (std::size_t j = 0; j < Kernel::rows; ++j)
        for (std::size_t i = 0; i < Kernel::rows; ++i)
          force[place + k * plane_nodes + j * tile_stride + i] +=
              borne * w[0][i] * w[1][j] * (dim == 3 ? w[dim - 1][k] : 1.0);
  }
}

template <int dim>
void Simulation::Impl<dim>::points_to_grid() {
  tiles_time = time;
  for_each_block(arena, grid.point_blocks.size(),
                 [&](std::size_t k) { transfer_to_tile(k, extra(0)); });
}

template <int dim>
void Simulation::Impl<dim>::transfer_to_tile(std::size_t block, Extra extra) {
  choose<dim>(scene, retention(0.0).affine, averages(),
              [&]<class K>(K, auto affine, auto averages) {
                if constexpr (averages.value)
                  transfer_to_tile<K, affine.value, Extra::elastic>(block);
                else if (extra == Extra::signal)
                  transfer_to_tile<K, affine.value, Extra::signal>(block);
                else
                  transfer_to_tile<K, affine.value, Extra::nothing>(block);
              });
}

#define REPOSE_POINTS_TO_GRID(DIM)                       \
  template void Simulation::Impl<DIM>::points_to_grid(); \
  template void Simulation::Impl<DIM>::transfer_to_tile(std::size_t, Extra);
REPOSE_POINTS_TO_GRID(2)
REPOSE_POINTS_TO_GRID(3)
#undef REPOSE_POINTS_TO_GRID

}  // namespace repose::mpm

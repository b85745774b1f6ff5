#include "mpm/step/transfer.hpp"

#include "mpm/grid/point_stencil.hpp"
#include "mpm/grid/unrolled.hpp"
#if defined(__AVX512F__)
#include "mpm/step/plane_sums.hpp"
#else
#include "mpm/step/row_sums.hpp"
#endif

namespace repose::mpm {

template <class Kernel, bool affine, bool averages, int dim>
void points_to_tile(const PointsOf<dim>& points, const SlotRange& range, double h,
                    const std::array<int, Shape<dim>::axes>& origin, const double* elastic,
                    TileOf<dim>& tile) {
#if defined(__AVX512F__)
  add_plane_sums<Kernel, affine, averages>(points, range, h, origin, elastic, tile);
#else
  add_row_sums<Kernel, affine, averages>(points, range, h, origin, elastic, tile);
#endif
}

template <class Kernel, Keeps keeps, bool averages, int dim>
void tile_to_points(const VelocityTileOf<dim>& tile,
                    const std::array<int, Shape<dim>::axes>& origin, double h,
                    const SlotRange& range, const Retention& keep, PointsOf<dim>& points,
                    const MotionOf<dim>& motion) {
  using F = Layout<dim>;
  const Pack inv_h(1.0 / h);
  const Pack inv_D_h(Kernel::gradient_scale / h);
  const Pack keep_v(keep.velocity);
  const Pack keep_A(keep.gradient);
  const std::size_t a = points.affine;
  for (std::size_t k = 0; k < range.count; k += Pack::size) {
    const std::size_t s = range.begin + k;
    const auto at = [&](std::size_t f) { return Pack::load_aligned(points.data(f) + s); };
    const auto put = [&](std::size_t f, const Pack& x) { x.store_aligned(points.data(f) + s); };
    /// Coordinate in units of h from the tile's first node.
    const auto from_tile = [&](std::size_t axis) {
      return Pack(at(F::x + axis) * inv_h - Pack(static_cast<double>(origin[axis])));
    };
    std::array<Pack, dim> xi;
    for (std::size_t axis = 0; axis < dim; ++axis) xi[axis] = from_tile(axis);
    const PointStencil<Kernel, dim> stencil(xi);
    // v; of u what is kept; ē
    constexpr bool keeps_gradient = keeps == Keeps::velocity_and_gradient;
    constexpr bool keeps_velocity = keeps == Keeps::velocity || keeps == Keeps::extension;
    std::array<const double*, keeps_gradient ? 2 * dim : dim> fields;
    std::array<const double*, (keeps_velocity ? dim : 0) + averages> value_fields;
    for (std::size_t i = 0; i < dim; ++i) {
      fields[i] = tile.v[i].data();
      if constexpr (keeps_gradient) fields[dim + i] = tile.u[i].data();
      if constexpr (keeps_velocity) value_fields[i] = tile.u[i].data();
    }
    if constexpr (averages) value_fields.back() = tile.elastic.data();
    std::array<MomentsOf<dim>, fields.size()> moments;
    std::array<Pack, value_fields.size()> values;
    stencil.read(fields, moments, value_fields, values);
    if constexpr (averages) values.back().store_aligned(motion.elastic + k);
    unrolled<dim>([&](auto i) {
      const MomentsOf<dim>& v = moments[i];
      v.value.store_aligned(motion.v[i] + k);
      if constexpr (keeps == Keeps::nothing)
        put(F::v + i, v.value);
      else if constexpr (keeps == Keeps::extension)
        put(F::v + i, v.value + values[i]);
      else if constexpr (keeps == Keeps::velocity)
        put(F::v + i, v.value + keep_v * (at(F::v + i) - values[i]));
      else
        put(F::v + i, v.value + keep_v * (at(F::v + i) - moments[dim + i].value));
      unrolled<dim>([&](auto j) {
        const std::size_t ij = dim * i + j;
        const Pack L = derivative<j>(v) * inv_D_h;
        if constexpr (keeps_gradient)
          put(a + ij, L + keep_A * (at(a + ij) - derivative<j>(moments[dim + i]) * inv_D_h));
        put(F::L + ij, L);
      });
    });
  }
}

#define REPOSE_FROM_TILE(KERNEL, KEEPS, AVERAGES, DIM)                                   \
  template void tile_to_points<KERNEL, Keeps::KEEPS, AVERAGES, DIM>(                     \
      const VelocityTileOf<DIM>&, const std::array<int, DIM>&, double, const SlotRange&, \
      const Retention&, PointsOf<DIM>&, const MotionOf<DIM>&);
#define REPOSE_TO_TILE(KERNEL, AFFINE, AVERAGES, DIM)                                             \
  template void points_to_tile<KERNEL, AFFINE, AVERAGES, DIM>(                                    \
      const PointsOf<DIM>&, const SlotRange&, double, const std::array<int, DIM>&, const double*, \
      TileOf<DIM>&);
#define REPOSE_TRANSFERS(KERNEL, AVERAGES, DIM)                  \
  REPOSE_TO_TILE(KERNEL, true, AVERAGES, DIM)                    \
  REPOSE_TO_TILE(KERNEL, false, AVERAGES, DIM)                   \
  REPOSE_FROM_TILE(KERNEL, nothing, AVERAGES, DIM)               \
  REPOSE_FROM_TILE(KERNEL, velocity, AVERAGES, DIM)              \
  REPOSE_FROM_TILE(KERNEL, velocity_and_gradient, AVERAGES, DIM) \
  REPOSE_TO_TILE(SplineGradient<KERNEL>, true, AVERAGES, DIM)    \
  REPOSE_FROM_TILE(SplineGradient<KERNEL>, nothing, AVERAGES, DIM)
#define REPOSE_TO_SPACE_WITH_EXTRA(KERNEL) \
  REPOSE_TO_TILE(KERNEL, true, true, 3)    \
  REPOSE_TO_TILE(KERNEL, false, true, 3)   \
  REPOSE_TO_TILE(SplineGradient<KERNEL>, true, true, 3)
#define REPOSE_PLANE_TRANSFERS(KERNEL, AVERAGES) \
  REPOSE_TRANSFERS(KERNEL, AVERAGES, 2)          \
  REPOSE_FROM_TILE(KERNEL, extension, AVERAGES, 2)
REPOSE_PLANE_TRANSFERS(CubicKernel, true)
REPOSE_PLANE_TRANSFERS(CubicKernel, false)
REPOSE_PLANE_TRANSFERS(QuadraticKernel, true)
REPOSE_PLANE_TRANSFERS(QuadraticKernel, false)
REPOSE_TRANSFERS(CubicKernel, false, 3)
REPOSE_TRANSFERS(QuadraticKernel, false, 3)
REPOSE_TO_SPACE_WITH_EXTRA(CubicKernel)
REPOSE_TO_SPACE_WITH_EXTRA(QuadraticKernel)
#undef REPOSE_TO_SPACE_WITH_EXTRA
#undef REPOSE_PLANE_TRANSFERS
#undef REPOSE_TRANSFERS
#undef REPOSE_TO_TILE
#undef REPOSE_FROM_TILE

}  // namespace repose::mpm

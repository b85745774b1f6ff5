#include "mpm/step/body_force.hpp"

#include "mpm/grid/kernel.hpp"

namespace repose::mpm {

template <class Kernel>
void body_force_to_tile(const PointSet& points, const SlotRange& range, std::span<const double> ax,
                        std::span<const double> ay, double h, std::array<int, 2> origin,
                        Tile& tile) {
  for (std::size_t k = 0; k < range.count; ++k) {
    const std::size_t s = range.begin + k;
    const double x = points[X][s] / h;
    const double y = points[Y][s] / h;
    const double anchor_x = Kernel::anchor(x);
    const double anchor_y = Kernel::anchor(y);
    const Weights weights = Kernel::of_point(x - anchor_x, y - anchor_y);
    const auto place = static_cast<std::size_t>((anchor_y - 1.0 - origin[1]) * tile_stride +
                                                anchor_x - 1.0 - origin[0]);
    const Row w_m = weights.w.x() * Row(points[MASS][s]);
    alignas(Row) std::array<double, 4> w_row{};
    weights.w.y().store_aligned(w_row.data());
    for (std::size_t j = 0; j < Kernel::rows; ++j) {
      const auto add = [&](TileChannel channel, double a) {
        double* const at = tile[channel].data() + place + j * tile_stride;
        fma(w_m, Row(w_row[j] * a), Row::load_unaligned(at)).store_unaligned(at);
      };
      add(T_FX, ax[k]);
      add(T_FY, ay[k]);
    }
  }
}

#define REPOSE_BODY_FORCE(KERNEL)                                                            \
  template void body_force_to_tile<KERNEL>(const PointSet&, const SlotRange&,                \
                                           std::span<const double>, std::span<const double>, \
                                           double, std::array<int, 2>, Tile&);
REPOSE_BODY_FORCE(CubicKernel)
REPOSE_BODY_FORCE(QuadraticKernel)
REPOSE_BODY_FORCE(SplineGradient<CubicKernel>)
REPOSE_BODY_FORCE(SplineGradient<QuadraticKernel>)
#undef REPOSE_BODY_FORCE

}  // namespace repose::mpm

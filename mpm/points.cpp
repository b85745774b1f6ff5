#include "mpm/points.hpp"

namespace repose::mpm {

template <int dim>
typename PointsOf<dim>::Batch PointsOf<dim>::batch(const Range& range) {
  Batch b;
  b.count = range.count;
  b.density = field[At::rho].data() + range.begin;
  for (std::size_t k = 0; k < At::components; ++k)
    b.stress[k] = field[At::stress + k].data() + range.begin;
  for (std::size_t k = 0; k < state_fields(); ++k)
    b.state[k] = field[At::state + k].data() + range.begin;
  return b;
}

template <int dim>
void rearrange(PointsOf<dim>& points, const std::vector<std::uint32_t>& order,
               const std::vector<bool>& is_padding) {
  AlignedVector<double> moved(order.size());
  for (std::size_t f = 0; f < points.fields; ++f) {
    const double* from = points[f];
    for (std::size_t k = 0; k < order.size(); ++k) moved[k] = from[order[k]];
    points.field[f].swap(moved);
    moved.resize(order.size());
  }
  std::vector<std::int64_t> names(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    names[k] = is_padding[k] ? -1 : points.id[order[k]];
  points.id.swap(names);
}

template struct PointsOf<2>;
template struct PointsOf<3>;
template void rearrange(PointsOf<2>&, const std::vector<std::uint32_t>&, const std::vector<bool>&);
template void rearrange(PointsOf<3>&, const std::vector<std::uint32_t>&, const std::vector<bool>&);

}  // namespace repose::mpm

#include "mpm/points.hpp"

namespace repose::mpm {

Batch PointSet::batch(const Range& range) {
  Batch b;
  b.count = range.count;
  b.density = field[RHO].data() + range.begin;
  for (std::size_t k = 0; k < 4; ++k) b.stress[k] = field[SXX + k].data() + range.begin;
  for (std::size_t k = 0; k < state_fields(); ++k)
    b.state[k] = field[STATE + k].data() + range.begin;
  return b;
}

void rearrange(PointSet& points, const std::vector<std::uint32_t>& order,
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

}  // namespace repose::mpm

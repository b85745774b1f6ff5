#include "mpm/deposit.hpp"

#include <algorithm>
#include <cmath>

namespace repose::mpm {

Deposit::Deposit(const std::vector<PointSet>& bodies, double column_spacing, int columns)
    : h(column_spacing),
      depth(static_cast<std::size_t>(columns) + 1, 0.0) {
  for (const PointSet& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double xi = std::clamp(points[X][s] / h, 0.0, static_cast<double>(columns));
      const auto i = std::min(static_cast<std::size_t>(xi), depth.size() - 2);
      const double share = xi - static_cast<double>(i);
      const double solid = points[MASS][s] / (points.rho_0 * h);
      depth[i] += (1.0 - share) * solid;
      depth[i + 1] += share * solid;
    }
  depth.front() *= 2.0;
  depth.back() *= 2.0;
}

double Deposit::front(double threshold) const {
  for (std::size_t i = depth.size(); i-- > 0;) {
    if (depth[i] < threshold) continue;
    if (i + 1 == depth.size()) return static_cast<double>(i) * h;
    const double beyond = (depth[i] - threshold) / (depth[i] - depth[i + 1]);
    return (static_cast<double>(i) + beyond) * h;
  }
  return 0.0;
}

}  // namespace repose::mpm

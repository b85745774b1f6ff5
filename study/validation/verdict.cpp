#include "study/validation/verdict.hpp"

#include <algorithm>
#include <vector>

#include "study/accuracy/own_runs.hpp"

namespace repose::study {

Verdict judge(const Estimated& estimated, const std::array<double, 2>& band, double least) {
  if (!std::isfinite(estimated.value)) return Verdict::failed;
  const double bar = std::isfinite(estimated.error) ? estimated.error : 0.0;
  const double low = std::max(least, estimated.value - bar), high = estimated.value + bar;
  if (low >= band[0] && high <= band[1]) return Verdict::inside;
  if (high < band[0] || low > band[1]) return Verdict::outside;
  return Verdict::undecided;
}

Estimated estimate_of_sizes(std::span<const double> h, std::span<const double> values) {
  if (values.size() < 2) return {values.back(), std::nan("")};
  // own_estimate() divides by the size of the value, and a figure may well be 0: on top of this, it
  // is not
  double lift = 0.0;
  for (const double value : values) lift = std::max(lift, std::abs(value));
  lift = lift > 0.0 ? 3.0 * lift : 1.0;
  std::vector<Resolution> levels;
  for (std::size_t i = 0; i < values.size(); ++i)
    levels.push_back({h[i], {Eigen::VectorXd::Constant(1, values[i] + lift)}});
  auto own = own_estimate(levels, 0.0);
  if (own->sizes < 3)
    if (auto close = close_estimate(levels)) own = close;
  return {own->value[0] - lift, own->error * std::abs(own->value[0])};
}

}  // namespace repose::study

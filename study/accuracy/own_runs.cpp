#include "study/accuracy/own_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace repose::study {
namespace {

using Eigen::VectorXd;

/// The three sizes of own_estimate() whose finest is levels[finest]; coarse to fine.
std::optional<std::array<std::size_t, 3>> three_of(std::span<const Resolution> levels,
                                                   std::size_t finest) {
  constexpr double coarser_by = 1.9;
  std::array<std::size_t, 3> three{finest, finest, finest};
  for (std::size_t slot = 2; slot-- > 0;) {
    std::size_t k = three[slot + 1];
    while (k-- > 0 && levels[k].h < coarser_by * levels[three[slot + 1]].h) {
    }
    if (k >= levels.size()) return {};
    three[slot] = k;
  }
  return three;
}

struct Extrapolated {
  VectorXd value;
  double order, observed, weight, change;  ///< change: |u_f − u_m|/|value|
};

Extrapolated extrapolated(std::span<const Resolution> levels,
                          const std::array<std::size_t, 3>& three) {
  const Resolution &coarse = levels[three[0]], &middle = levels[three[1]], &fine = levels[three[2]];
  Extrapolated e;
  e.observed = observed_order(coarse, middle, fine);
  e.order = std::isfinite(e.observed)
                ? std::clamp(e.observed, least_own_order, largest_own_order)
                : least_own_order;
  e.weight = richardson_weight(middle.h, fine.h, e.order);
  const VectorXd u = fine.mean(), change = u - middle.mean();
  e.value = u + e.weight * change;
  e.change = change.lpNorm<1>() / e.value.lpNorm<1>();
  return e;
}

}  // namespace

std::optional<OwnEstimate> own_estimate(std::span<const Resolution> levels, double scatter) {
  if (levels.size() < 2) return {};
  const auto three = three_of(levels, levels.size() - 1);
  if (!three) {
    const Resolution &coarse = levels.front(), &fine = levels.back();
    constexpr double safety = 3.0;  // Roache's factor where there are two sizes
    return OwnEstimate{fine.mean(), 2,
                       safety * richardson_weight(coarse.h, fine.h, 1.0) *
                           relative_distance(coarse.mean(), fine.mean()),
                       0.0, 1.0, std::nan("")};
  }
  const Resolution &middle = levels[(*three)[1]], &fine = levels[(*three)[2]];
  const Extrapolated e = extrapolated(levels, *three);
  const bool shrinks = std::isfinite(e.observed);

  const double to_come = (shrinks ? 0.5 : 1.0) * e.weight * e.change;
  const auto with = [&](double order) { return richardson_weight(middle.h, fine.h, order); };
  const double observed = shrinks ? std::clamp(e.observed, 0.5, 2.0) : 1.0;
  const double of_order =
      e.change * std::max(std::abs(with(observed) - e.weight), std::abs(with(1.0) - e.weight));

  double apart = 0.0;
  int before = 0;
  for (std::size_t k = levels.size() - 1; k-- > 0 && before < 2;) {
    const auto coarser = three_of(levels, k);
    if (!coarser) break;
    apart = std::max(apart, relative_distance(extrapolated(levels, *coarser).value, e.value));
    ++before;
  }
  if (before == 0)  // the finest of the two coarser sizes, extrapolated with order 1
    apart = relative_distance(
        middle.mean() + richardson_weight(levels[(*three)[0]].h, middle.h, 1.0) *
                            (middle.mean() - levels[(*three)[0]].mean()),
        e.value);
  const double steady = (before == 2 ? 0.5 : 1.0) * apart;

  const auto of_mean = [&](const Resolution& level) {
    const double seen = level.scatter();
    return std::max(scatter, std::isfinite(seen) ? seen : 0.0) /
           std::sqrt(static_cast<double>(level.runs.size()));
  };
  const double scattered =
      2.0 * std::hypot((1.0 + e.weight) * of_mean(fine), e.weight * of_mean(middle));
  return OwnEstimate{e.value, 3, std::hypot(std::hypot(to_come, of_order, steady), scattered),
                     scattered, e.order, e.observed};
}

}  // namespace repose::study

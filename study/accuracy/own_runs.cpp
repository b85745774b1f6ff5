#include "study/accuracy/own_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace repose::study {
namespace {

using Eigen::VectorXd;

/// Indices of a coarse, a middle and a fine size.
using Three = std::array<std::size_t, 3>;

/// Those of own_estimate() whose finest is levels[finest], each the finest that is so many times as
/// coarse as the next.
std::optional<Three> three_of(std::span<const Resolution> levels, std::size_t finest,
                              double coarser_by = 1.9) {
  Three three{finest, finest, finest};
  for (std::size_t slot = 2; slot-- > 0;) {
    const double wanted = coarser_by * levels[three[slot + 1]].h;
    std::size_t k = three[slot + 1];
    while (k > 0 && levels[k].h < wanted) --k;
    if (levels[k].h < wanted) return {};
    three[slot] = k;
  }
  return three;
}

/// The three sizes that end in the next coarser one.
std::optional<Three> three_before(std::span<const Resolution> levels, const Three& three) {
  if (three[2] == 0) return {};
  return three_of(levels, three[2] - 1);
}

struct Extrapolated {
  VectorXd value;
  double order, observed, weight;
  bool shrinks() const { return std::isfinite(observed); }
};

Extrapolated extrapolated(std::span<const Resolution> levels, const Three& three) {
  const Resolution &coarse = levels[three[0]], &middle = levels[three[1]], &fine = levels[three[2]];
  Extrapolated e;
  e.observed = observed_order(coarse, middle, fine);
  e.order =
      e.shrinks() ? std::clamp(e.observed, least_own_order, largest_own_order) : least_own_order;
  e.weight = richardson_weight(middle.h, fine.h, e.order);
  const VectorXd u = fine.mean();
  e.value = u + e.weight * (u - middle.mean());
  return e;
}

/// How far an estimate is from those of the two sizes next coarser, weighed.
double unsteadiness(std::span<const Resolution> levels, const Three& three, const VectorXd& value) {
  double apart = 0.0;
  int before = 0;
  for (auto coarser = three_before(levels, three); coarser && before < 2;
       coarser = three_before(levels, *coarser)) {
    apart = std::max(apart, relative_distance(extrapolated(levels, *coarser).value, value));
    ++before;
  }
  if (before < 2) {  // there is one more estimate, of two sizes
    const Resolution &coarse = levels[three[0]], &middle = levels[three[1]];
    const VectorXd u = middle.mean();
    const VectorXd earlier = u + richardson_weight(coarse.h, middle.h, 1.0) * (u - coarse.mean());
    apart = std::max(apart, relative_distance(earlier, value));
    ++before;
  }
  return (before == 2 ? 0.5 : 1.0) * apart;
}

/// The first two parts of own_estimate()'s bar: what is extrapolated, and by which order.
double bar_of_extrapolation(std::span<const Resolution> levels, const Three& three,
                            const Extrapolated& e) {
  const Resolution &coarse = levels[three[0]], &middle = levels[three[1]], &fine = levels[three[2]];
  const double size = e.value.lpNorm<1>();
  // sizes that agree by chance tell no more than the largest order does of the change before
  const double before = (middle.mean() - coarse.mean()).lpNorm<1>() / size;
  const double change = std::max((fine.mean() - middle.mean()).lpNorm<1>() / size,
                                 before * std::pow(middle.h / coarse.h, largest_own_order));
  const double to_come = (e.shrinks() ? 0.5 : 1.0) * e.weight * change;

  const auto weight = [&](double order) { return richardson_weight(middle.h, fine.h, order); };
  const double seen = e.shrinks() ? std::clamp(e.observed, 0.5, 2.0) : 1.0;
  const double of_order =
      change * std::max(std::abs(weight(seen) - e.weight), std::abs(weight(1.0) - e.weight));
  return std::hypot(to_come, of_order);
}

/// own_estimate() of these three sizes, without regard to the bar of those before.
OwnEstimate estimate_of(std::span<const Resolution> levels, const Three& three, double scatter) {
  const Resolution &middle = levels[three[1]], &fine = levels[three[2]];
  const Extrapolated e = extrapolated(levels, three);
  const auto of_mean = [&](const Resolution& level) {
    const double shown = level.scatter();
    return std::max(scatter, std::isfinite(shown) ? shown : 0.0) /
           std::sqrt(static_cast<double>(level.runs.size()));
  };
  const double scattered =
      2.0 * std::hypot((1.0 + e.weight) * of_mean(fine), e.weight * of_mean(middle));
  const double error = std::hypot(bar_of_extrapolation(levels, three, e),
                                  unsteadiness(levels, three, e.value), scattered);
  return {e.value, 3, error, scattered, e.order, e.observed};
}

}  // namespace

std::optional<OwnEstimate> own_estimate(std::span<const Resolution> levels, double scatter) {
  if (levels.size() < 2) return {};
  const auto three = three_of(levels, levels.size() - 1);
  if (!three) {
    const Resolution &coarse = levels.front(), &fine = levels.back();
    constexpr double safety = 3.0;  // Roache's factor where there are two sizes
    const double change = relative_distance(coarse.mean(), fine.mean());
    return OwnEstimate{fine.mean(), 2,   safety * richardson_weight(coarse.h, fine.h, 1.0) * change,
                       0.0,         1.0, std::nan("")};
  }
  OwnEstimate estimate = estimate_of(levels, *three, scatter);
  const auto before = three_before(levels, *three);
  const double bar_before =
      before ? estimate_of(levels, *before, scatter).error : 4.0 * estimate.error;
  estimate.error = std::max(estimate.error, 0.5 * bar_before);
  return estimate;
}

std::optional<OwnEstimate> close_estimate(std::span<const Resolution> levels) {
  if (levels.empty()) return {};
  constexpr double coarser_by = 1.3;
  const auto three = three_of(levels, levels.size() - 1, coarser_by);
  if (!three) return {};
  const Extrapolated e = extrapolated(levels, *three);
  return OwnEstimate{e.value, 3, bar_of_extrapolation(levels, *three, e), 0.0, e.order, e.observed};
}

}  // namespace repose::study

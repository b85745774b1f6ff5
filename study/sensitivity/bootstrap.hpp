#pragma once
/// \file
/// How far chance moves a figure: 95 % intervals by drawing the sample again from itself (Efron
/// 1979).

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "calibration/convergence.hpp"

namespace repose::study {

/// A figure with its interval; NaN where there is none.
struct Bounded {
  double value = std::nan("");
  std::array<double, 2> interval_95{std::nan(""), std::nan("")};
};

inline constexpr int bootstrap_draws = 500;

/// Which of n are drawn, with replacement.
inline std::vector<Eigen::Index> drawn_again(Eigen::Index n, std::mt19937_64& random) {
  std::vector<Eigen::Index> list(static_cast<std::size_t>(n));
  for (Eigen::Index& i : list)  // 53 bits: the bias of the remainder is below 1e-11
    i = static_cast<Eigen::Index>((random() >> 11) % static_cast<std::uint64_t>(n));
  return list;
}

/// The basic interval, 2 θ − quantiles of the θ* of the draws: where θ is biased, θ* is so once
/// more, which the difference takes off (Davison & Hinkley 1997, 5.2). figures: of one draw, as
/// many as values.
inline std::vector<Bounded> with_intervals(
    const Eigen::VectorXd& values, std::uint64_t seed,
    const std::function<Eigen::VectorXd(std::mt19937_64&)>& figures) {
  Eigen::MatrixXd draws(bootstrap_draws, values.size());
  for (int b = 0; b < bootstrap_draws; ++b) {
    std::mt19937_64 random(seed + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(b + 1));
    draws.row(b) = figures(random).transpose();
  }
  std::vector<Bounded> list;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    Bounded one{values[i]};
    if (draws.col(i).allFinite())
      one.interval_95 = {2.0 * values[i] - calibration::sample_quantile(draws.col(i), 0.975),
                         2.0 * values[i] - calibration::sample_quantile(draws.col(i), 0.025)};
    list.push_back(one);
  }
  return list;
}

}  // namespace repose::study

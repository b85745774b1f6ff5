// Refits of data made anew from the fit and its own noise.

#include <algorithm>
#include <cmath>
#include <random>

#include <tbb/parallel_for.h>

#include "calibration/uncertainty.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Innovations of one channel's residuals, of mean 0 and of the variance that its errors have. With
/// a robust loss that is their own, outliers included: the channel's noise is of their scores.
VectorXd innovations(const ChannelNoise& c, const VectorXd& r, bool robust) {
  VectorXd white = whitened(r.segment(c.block.first, c.block.rows), c.rho);
  white.array() -= white.mean();
  const auto rows = static_cast<double>(white.size());
  const double size = std::sqrt(white.squaredNorm() / rows);
  if (robust)
    white *= std::sqrt(rows / c.freedom);
  else if (size > 0.0)
    white *= c.sd / size;
  return white;
}

}  // namespace

MatrixXd bootstrap(const Problem& problem, const Uncertainty& at, const VectorXd& z, int repeats,
                   std::uint64_t seed, const VectorXd& simulator_error) {
  std::vector<MatrixXd> fitted;
  for (std::size_t k = 0; k < problem.targets().size(); ++k)
    fitted.push_back(problem.predict(k, z).simulated);
  Evaluation e;
  problem.with_loss({}).evaluate(z, false, e);
  std::vector<VectorXd> white;
  for (const ChannelNoise& c : at.noise.channels)
    white.push_back(innovations(c, e.r, problem.loss().robust()));
  const bool erring = simulator_error.size() == e.r.size();
  MatrixXd values(repeats, problem.parameters());
  tbb::parallel_for(0, repeats, [&](int b) {
    std::mt19937_64 random(seed + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(b + 1));
    std::normal_distribution<double> normal;
    std::vector<MatrixXd> observed = fitted;
    const double erred = erring ? normal(random) : 0.0;
    std::vector<Index> rows;
    std::size_t of = problem.targets().size();
    for (std::size_t j = 0; j < white.size(); ++j) {
      const ChannelNoise& c = at.noise.channels[j];
      if (c.block.target != of) {  // the same rows for all channels of an experiment
        of = c.block.target;
        rows.clear();
        for (Index i = 0; i < c.block.rows; ++i)
          rows.push_back(static_cast<Index>(random() % static_cast<std::uint64_t>(c.block.rows)));
      }
      VectorXd drawn(c.block.rows);
      for (Index i = 0; i < drawn.size(); ++i)
        drawn[i] = white[j][rows[static_cast<std::size_t>(i)]];
      VectorXd error = coloured(drawn, c.rho);
      if (erring) error += erred * simulator_error.segment(c.block.first, c.block.rows);
      const Channel& channel = problem.targets()[of].channels[c.block.channel];
      for (Index i = 0; i < error.size(); ++i)
        observed[of](i, static_cast<Index>(c.block.channel)) -=
            error[i] / c.block.factor * scale_of(channel, i);
    }
    VectorXd means(problem.prior_weights().size());
    Index row = 0;
    for (const FreeParameter& p : problem.space().parameters()) {
      if (!p.prior) continue;
      const double off = p.prior->sd * normal(random);
      means[row++] = p.prior->relative ? p.prior->mean * std::exp(off) : p.prior->mean + off;
    }
    const Problem again =
        problem.with_observed(observed).with_space(problem.space().with_prior_means(means));
    values.row(b) = problem.space().values(levenberg_marquardt(again, z).z).transpose();
  });
  return values;
}

std::array<double, 2> bootstrap_interval(const VectorXd& draws, double value, double quantile) {
  std::vector<double> sorted(draws.begin(), draws.end());
  std::sort(sorted.begin(), sorted.end());
  const double wider = quantile / t_quantile(std::numeric_limits<double>::infinity());
  const auto end = [&](double share) {
    const double at = share * static_cast<double>(sorted.size() - 1);
    const auto k = static_cast<std::size_t>(at);
    const double next = sorted[std::min(k + 1, sorted.size() - 1)];
    const double drawn = sorted[k] + (at - static_cast<double>(k)) * (next - sorted[k]);
    return value + wider * (drawn - value);
  };
  return {end(0.025), end(0.975)};
}

}  // namespace repose::calibration

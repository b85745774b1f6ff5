#include "calibration/convergence.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "calibration/quantiles.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Each chain's halves as chains of their own; the middle draw of an odd number is left out.
MatrixXd split(const MatrixXd& draws) {
  const Index half = draws.rows() / 2;
  MatrixXd out(half, 2 * draws.cols());
  out << draws.topRows(half), draws.bottomRows(half);
  return out;
}

/// Normal scores of the ranks, ties sharing their mean rank (eq. 14).
MatrixXd rank_normalised(const MatrixXd& draws) {
  const Index n = draws.size();
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  const double* x = draws.data();
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return x[a] < x[b]; });
  MatrixXd scores(draws.rows(), draws.cols());
  for (Index first = 0; first < n;) {
    Index last = first;
    while (last + 1 < n && x[order[static_cast<std::size_t>(last + 1)]] ==
                               x[order[static_cast<std::size_t>(first)]])
      ++last;
    const double rank = 0.5 * static_cast<double>(first + last) + 1.0;
    const double score = normal_quantile((rank - 0.375) / (static_cast<double>(n) + 0.25));
    for (; first <= last; ++first) scores.data()[order[static_cast<std::size_t>(first)]] = score;
  }
  return scores;
}

/// Variances within chains and over all of them.
struct Variances {
  double within = 0.0, all = 0.0;
};

Variances variances(const MatrixXd& chains) {
  const auto n = static_cast<double>(chains.rows()), m = static_cast<double>(chains.cols());
  const Eigen::RowVectorXd mean = chains.colwise().mean();
  const double within = (chains.rowwise() - mean).colwise().squaredNorm().mean() / (n - 1.0);
  const double between = m > 1.0 ? (mean.array() - mean.mean()).square().sum() / (m - 1.0) : 0.0;
  return {within, (n - 1.0) / n * within + between};
}

double r_hat(const MatrixXd& chains) {
  const Variances v = variances(chains);
  return std::sqrt(v.all / v.within);
}

/// n m over the autocorrelation time, whose sum ends by Geyer's initial monotone sequence.
double effective_size(const MatrixXd& chains) {
  const Index n = chains.rows();
  const Variances v = variances(chains);
  if (!(v.within > 0.0)) return std::nan("");
  const MatrixXd centred = chains.rowwise() - chains.colwise().mean();
  const auto correlation = [&](Index lag) {
    double mean = 0.0;
    for (Index c = 0; c < chains.cols(); ++c)
      mean += centred.col(c).head(n - lag).dot(centred.col(c).tail(n - lag));
    mean /= static_cast<double>(n * chains.cols());
    const auto rows = static_cast<double>(n);
    return 1.0 - (v.within * (rows - 1.0) / rows - mean) / v.all;
  };
  double sum = 0.0, least = std::numeric_limits<double>::infinity();
  for (Index lag = 0; lag + 1 < n; lag += 2) {
    const double pair = (lag == 0 ? 1.0 : correlation(lag)) + correlation(lag + 1);
    if (!(pair > 0.0)) break;
    least = std::min(least, pair);
    sum += least;
  }
  const auto total = static_cast<double>(chains.size());
  // antithetic draws are worth more than their number, within reason
  const double time = std::max(2.0 * sum - 1.0, 1.0 / std::log10(total));
  return total / time;
}

}  // namespace

double sample_quantile(VectorXd sample, double share) {
  std::sort(sample.begin(), sample.end());
  const double at = share * static_cast<double>(sample.size() - 1);
  const auto k = static_cast<Index>(at);
  const Index next = std::min(k + 1, sample.size() - 1);
  return sample[k] + (at - static_cast<double>(k)) * (sample[next] - sample[k]);
}

Convergence convergence(const MatrixXd& draws) {
  Convergence result{std::nan(""), std::nan(""), std::nan("")};
  if (draws.rows() < 4 || !(draws.maxCoeff() > draws.minCoeff())) return result;
  const MatrixXd halves = split(draws);
  const VectorXd pooled = halves.reshaped();
  const MatrixXd spread = (halves.array() - sample_quantile(pooled, 0.5)).abs();
  const MatrixXd scores = rank_normalised(halves);
  result.r_hat = std::max(r_hat(scores), r_hat(rank_normalised(spread)));
  result.bulk_ess = effective_size(scores);
  const auto tail = [&](double share) {
    const double at = sample_quantile(pooled, share);
    return effective_size((halves.array() <= at).cast<double>());
  };
  result.tail_ess = std::min(tail(0.05), tail(0.95));
  return result;
}

}  // namespace repose::calibration

#include "study/sensitivity/sobol.hpp"

#include <numeric>

#include "study/sensitivity/low_discrepancy.hpp"

namespace repose::study {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// All S, then all ST, of the blocks that were drawn. blocks: columns a, b, and a with b's j-th.
VectorXd shares_of_blocks(const MatrixXd& blocks, const std::vector<Index>& drawn) {
  const Index inputs = blocks.cols() - 2;
  const auto n = static_cast<double>(drawn.size());
  double mean = 0.0, variance = 0.0;
  for (const Index i : drawn) mean += blocks(i, 0) + blocks(i, 1);
  mean /= 2.0 * n;
  VectorXd first = VectorXd::Zero(inputs), total = VectorXd::Zero(inputs);
  for (const Index i : drawn) {
    const double a = blocks(i, 0) - mean, b = blocks(i, 1) - mean;
    variance += (a * a + b * b) / (2.0 * n);
    for (Index j = 0; j < inputs; ++j) {
      const double moved = blocks(i, j + 2) - mean;
      first[j] += b * (moved - a) / n;
      total[j] += (a - moved) * (a - moved) / (2.0 * n);
    }
  }
  VectorXd shares(2 * inputs);
  shares << first / variance, total / variance;
  return shares;
}

}  // namespace

MatrixXd variance_points(int inputs, int blocks, std::uint64_t seed) {
  const LowDiscrepancy sequence(2 * static_cast<std::size_t>(inputs), seed);
  MatrixXd points(Index{blocks} * (inputs + 2), inputs);
  for (int i = 0; i < blocks; ++i) {
    const VectorXd both = sequence.point(static_cast<std::uint32_t>(i));
    const Index first = Index{i} * (inputs + 2);
    points.middleRows(first, inputs + 2).rowwise() = both.head(inputs).transpose();
    points.row(first + 1) = both.tail(inputs).transpose();
    for (Index j = 0; j < inputs; ++j) points(first + 2 + j, j) = both[inputs + j];
  }
  return points;
}

std::vector<VarianceShares> variance_shares(int inputs, const VectorXd& y, std::uint64_t seed) {
  const Index width = inputs + 2;
  MatrixXd blocks(y.size() / width, width);
  Index n = 0;
  for (Index i = 0; i < y.size() / width; ++i)
    if (const auto block = y.segment(i * width, width); block.allFinite())
      blocks.row(n++) = block.transpose();
  blocks.conservativeResize(n, width);
  std::vector<VarianceShares> list(static_cast<std::size_t>(inputs));
  if (n < 2) return list;
  std::vector<Index> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), Index{0});
  const std::vector<Bounded> shares = with_intervals(
      shares_of_blocks(blocks, all), seed,
      [&](std::mt19937_64& random) { return shares_of_blocks(blocks, drawn_again(n, random)); });
  for (std::size_t j = 0; j < list.size(); ++j) list[j] = {shares[j], shares[list.size() + j]};
  return list;
}

}  // namespace repose::study

#include "study/sensitivity/morris.hpp"

#include <numeric>
#include <utility>

namespace repose::study {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// μ*, then σ, of every column, from the rows that were drawn; values that are not finite do not
/// count.
VectorXd sizes_and_spreads(const MatrixXd& effects, const std::vector<Index>& rows) {
  VectorXd figures(2 * effects.cols());
  for (Index j = 0; j < effects.cols(); ++j) {
    double n = 0.0, sum = 0.0, size = 0.0, square = 0.0;
    for (const Index t : rows) {
      const double e = effects(t, j);
      if (!std::isfinite(e)) continue;
      n += 1.0;
      sum += e;
      size += std::abs(e);
    }
    for (const Index t : rows)
      if (const double e = effects(t, j) - sum / n; std::isfinite(e)) square += e * e;
    figures[j] = n < 2.0 ? std::nan("") : size / n;
    figures[effects.cols() + j] = n < 2.0 ? std::nan("") : std::sqrt(square / (n - 1.0));
  }
  return figures;
}

}  // namespace

MatrixXd morris_points(int inputs, int trajectories, int levels, std::uint64_t seed) {
  const double step = 1.0 / (levels - 1);
  const double jump = 0.5 * levels * step;
  MatrixXd points(Index{trajectories} * (inputs + 1), inputs);
  for (int t = 0; t < trajectories; ++t) {
    std::mt19937_64 random(seed + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(t + 1));
    const auto below = [&](int n) {
      return static_cast<int>((random() >> 11) % static_cast<std::uint64_t>(n));
    };
    std::vector<int> order(static_cast<std::size_t>(inputs));
    std::iota(order.begin(), order.end(), 0);
    for (int j = inputs - 1; j > 0; --j)  // Fisher & Yates
      std::swap(order[static_cast<std::size_t>(j)], order[static_cast<std::size_t>(below(j + 1))]);
    Eigen::RowVectorXd at(inputs), to(inputs);
    for (int j = 0; j < inputs; ++j) {
      at[j] = step * below(levels / 2);
      to[j] = at[j] + jump;
      if (below(2) == 1) std::swap(at[j], to[j]);
    }
    const Index first = Index{t} * (inputs + 1);
    points.row(first) = at;
    for (int k = 0; k < inputs; ++k) {
      const int j = order[static_cast<std::size_t>(k)];
      at[j] = to[j];
      points.row(first + k + 1) = at;
    }
  }
  return points;
}

std::vector<ElementaryEffects> elementary_effects(const MatrixXd& points, const VectorXd& y,
                                                  std::uint64_t seed) {
  const Index inputs = points.cols(), trajectories = points.rows() / (inputs + 1);
  MatrixXd effects(trajectories, inputs);
  for (Index t = 0; t < trajectories; ++t)
    for (Index k = 0; k < inputs; ++k) {
      const Index before = t * (inputs + 1) + k;
      const Eigen::RowVectorXd move = points.row(before + 1) - points.row(before);
      Index j = 0;
      move.cwiseAbs().maxCoeff(&j);
      effects(t, j) = (y[before + 1] - y[before]) / move[j];
    }
  std::vector<Index> all(static_cast<std::size_t>(trajectories));
  std::iota(all.begin(), all.end(), Index{0});
  const std::vector<Bounded> figures =
      with_intervals(sizes_and_spreads(effects, all), seed, [&](std::mt19937_64& random) {
        return sizes_and_spreads(effects, drawn_again(trajectories, random));
      });
  std::vector<ElementaryEffects> list;
  for (Index j = 0; j < inputs; ++j) {
    ElementaryEffects one{figures[static_cast<std::size_t>(j)], 0.0,
                          figures[static_cast<std::size_t>(inputs + j)]};
    double sum = 0.0;
    for (const double e : effects.col(j)) {
      if (!std::isfinite(e)) continue;
      sum += e;
      ++one.count;
    }
    one.mean = sum / static_cast<double>(one.count);
    list.push_back(one);
  }
  return list;
}

}  // namespace repose::study

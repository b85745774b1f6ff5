#include "calibration/uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calibration/dense.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double at_bound_distance = 1e-6;

double lag_correlation(const VectorXd& r) {
  const Index n = r.size();
  const double all = r.squaredNorm();
  if (n < 4 || !(all > 0.0)) return 0.0;
  return r.head(n - 1).dot(r.tail(n - 1)) / all;
}

bool correlated(double rho, Index n) {
  return n >= 4 && rho > 2.0 / std::sqrt(static_cast<double>(n));
}

std::string percent(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2g %%", 100.0 * x);
  return text.data();
}

/// "raising M by 1 % with lowering kappa by 0.4 % …"
std::string in_words(const ParameterSpace& space, const VectorXd& direction, double sd) {
  std::vector<Index> order;
  for (Index i = 0; i < direction.size(); ++i)
    if (std::abs(direction[i]) > 0.2 * direction.cwiseAbs().maxCoeff()) order.push_back(i);
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return std::abs(direction[a]) > std::abs(direction[b]); });
  const double lead = direction[order.front()];
  const auto name = [&](Index i) { return space[static_cast<std::size_t>(i)].name; };
  const bool unknown = !(sd < 1e6);
  if (order.size() == 1)
    return unknown ? "the data do not depend on " + name(order[0])
                   : name(order[0]) + " is known to " + percent(sd * std::abs(lead));
  std::string text = name(order[0]) + " up by 1 %";
  for (std::size_t k = 1; k < order.size(); ++k) {
    const double share = direction[order[k]] / lead;
    text += (k + 1 == order.size() ? " and " : ", ") + name(order[k]) +
            (share > 0.0 ? " up by " : " down by ") + percent(std::abs(share) * 0.01);
  }
  return text + (unknown ? ": the data do not change"
                         : " together: known to " + percent(sd * std::abs(lead)) + " (of " +
                               name(order[0]) + ")");
}

}  // namespace

std::vector<ChannelScore> score(const Problem& problem, const VectorXd& z) {
  std::vector<ChannelScore> scores;
  const double freedom =
      static_cast<double>(std::max<Index>(1, problem.data_rows() - problem.parameters()));
  const double widen = static_cast<double>(problem.data_rows()) / freedom;
  for (std::size_t k = 0; k < problem.targets().size(); ++k) {
    const Target& t = problem.targets()[k];
    const Misfit m = problem.predict(k, z);
    for (std::size_t c = 0; c < t.channels.size(); ++c) {
      const Channel& channel = t.channels[c];
      const Index n = t.rows();
      const VectorXd r = m.r.segment(static_cast<Index>(c) * n, n);
      const double scale = scale_of(channel);
      ChannelScore s;
      s.target = k;
      s.channel = c;
      s.rows = n;
      const double mean_square = r.squaredNorm() / static_cast<double>(n);
      // in the channel's unit whatever the noise of each row; a distance is between curves
      VectorXd off = r * scale;
      if (channel.row_noise.size() > 0) off = r.cwiseProduct(channel.row_noise);
      s.rms = std::sqrt(off.squaredNorm() / static_cast<double>(n));
      const double range = channel.observed.maxCoeff() - channel.observed.minCoeff();
      s.relative_rms = range > 0.0 ? s.rms / range : std::nan("");
      s.bias = off.mean();
      s.chi2_per_row = channel.noise ? mean_square : std::nan("");
      s.lag_correlation = lag_correlation(r);
      r.cwiseAbs().maxCoeff(&s.worst_row);
      const double scatter = mean_square * (t.held_out ? 1.0 : widen);
      // χ² of n rows exceeds n + 2.33 √(2n) in 1 % of cases
      const bool beyond =
          channel.noise && scatter > 1.0 + 2.33 * std::sqrt(2.0 / static_cast<double>(n));
      s.variance = channel.noise && !beyond ? 1.0 : scatter;
      // what the integrator leaves (1e-8 and less) is smooth as well, and no discrepancy
      const double size = range > 0.0
                              ? s.relative_rms
                              : s.rms / std::max(channel.observed.cwiseAbs().maxCoeff(), 1e-300);
      s.large = size > 0.1 && !(channel.noise && !beyond);
      s.systematic = beyond || s.large ||
                     (n >= 8 && s.lag_correlation > 0.5 && correlated(s.lag_correlation, n) &&
                      s.relative_rms > 1e-6);
      for (const Block& b : problem.blocks())
        if (b.target == k && b.channel == c) s.objective = problem.cost(b, b.factor * r);
      scores.push_back(s);
    }
  }
  return scores;
}

namespace {

/// The linear problem at an optimum, of some coordinates.
struct Linear {
  std::vector<Index> columns;
  MatrixXd pseudo;        ///< J⁺ (coordinates × rows), without what the data do not determine
  MatrixXd U;             ///< rows × determined directions, orthonormal
  MatrixXd inverse;       ///< (JᵀJ)⁺ of all n coordinates
  MatrixXd V;             ///< coordinates × determined directions, orthonormal
  VectorXd undetermined;  ///< per coordinate: 1 where the data say nothing
  VectorXd bounded;       ///< variance that the bounds leave along directions not determined
};

/// scatter: of the residuals in r.
Linear linearised(const MatrixXd& J, const std::vector<Index>& columns, double scatter) {
  const Index n = J.cols(), m = static_cast<Index>(columns.size());
  Linear l;
  l.columns = columns;
  l.pseudo = MatrixXd::Zero(n, J.rows());
  l.inverse = MatrixXd::Zero(n, n);
  l.undetermined = l.bounded = VectorXd::Zero(n);
  l.U.resize(J.rows(), 0);
  l.V.resize(n, 0);
  if (m == 0) return l;
  MatrixXd A(J.rows(), m);
  for (Index j = 0; j < m; ++j) A.col(j) = J.col(columns[static_cast<std::size_t>(j)]);
  // z runs over the bounds: a singular value is what a walk across all of them does to r. What
  // lies below 1e-8 of the largest are the last digits of the path.
  const SingularValues svd = singular_values(A);
  const VectorXd& s = svd.s;
  const double limit = std::max({0.1 * scatter, 1e-8 * s[0], 1e-280});
  Index rank = 0;
  while (rank < s.size() && s[rank] > limit) ++rank;
  l.U = svd.U.leftCols(rank);
  const MatrixXd& V = svd.V;
  const MatrixXd part = V.leftCols(rank) * s.head(rank).cwiseInverse().asDiagonal();
  const MatrixXd pseudo = part * l.U.transpose(), inverse = part * part.transpose();
  l.V = MatrixXd::Zero(n, rank);
  for (Index i = 0; i < m; ++i) {
    const Index a = columns[static_cast<std::size_t>(i)];
    l.pseudo.row(a) = pseudo.row(i);
    l.V.row(a) = V.row(i).head(rank);
    for (Index j = 0; j < m; ++j)
      l.inverse(a, columns[static_cast<std::size_t>(j)]) = inverse(i, j);
    const double lost = 1.0 - std::min(1.0, V.row(i).head(rank).squaredNorm());
    // a tenth of the way along a direction that is free to go anywhere
    if (lost > 0.01) l.undetermined[a] = 1.0;
    if (lost > 1e-14) l.bounded[a] = lost / 12.0;  // even over the bounds
  }
  return l;
}

/// Scatter of the data's residuals before anything is known of their correlation.
double rough_scatter(const Problem& problem, const VectorXd& r) {
  double total = 0.0;
  for (const Block& b : problem.blocks()) {
    const double seen = r.segment(b.first, b.rows).squaredNorm() / static_cast<double>(b.rows);
    const bool declared = problem.targets()[b.target].channels[b.channel].noise.has_value();
    total += static_cast<double>(b.rows) * std::max(seen, declared ? b.factor * b.factor : 0.0);
  }
  return std::sqrt(total / static_cast<double>(problem.data_rows()));
}

/// The optimum, its active bounds and its noise.
struct Optimal {
  Evaluation e;
  VectorXd gain;  ///< of each row (Problem::linearise)
  std::vector<int> at_bound;
  std::vector<Index> inside;
  double scatter = 1.0;
  Linear linear;
  Noise noise;
};

Optimal optimal(const Problem& problem, const VectorXd& z) {
  Optimal o;
  problem.linearise(z, o.e, o.gain);
  // a bound that stops a parameter is not a measurement of it
  const VectorXd gradient = o.e.J.transpose() * o.e.r;
  for (Index i = 0; i < problem.parameters(); ++i) {
    const bool low = z[i] < at_bound_distance && gradient[i] >= 0.0;
    const bool high = z[i] > 1.0 - at_bound_distance && gradient[i] <= 0.0;
    o.at_bound.push_back(low ? -1 : (high ? 1 : 0));
    if (!low && !high) o.inside.push_back(i);
  }
  o.scatter = rough_scatter(problem, o.e.r);
  o.linear = linearised(o.e.J, o.inside, o.scatter);
  o.noise = estimate_noise(problem, o.e.r, o.linear.U);
  return o;
}

/// Where the excess ((x + outside)² − outside²)/error² of a value x away from the best one reaches
/// what a 95 % interval holds. room: to the bound on this side; behind: from the best value to the
/// bound on the other side.
double reach_of(double error, double outside, double freedom, double room, double behind,
                bool bounded) {
  const auto open = [&](double x) {
    const double excess = x * (x + 2.0 * outside) / (error * error);
    return excess < (bounded ? critical_excess(freedom, (room - x) / error, (behind + x) / error)
                             : critical_excess(freedom, infinity, infinity));
  };
  if (open(room)) return room;
  double low = 0.0, high = room;
  const double far = t_quantile(freedom) * error;
  if (far < high) high = far * (1.0 + 1e-12);  // never further than a two-sided interval
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (open(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

VectorXd weighed_priors(const Problem& problem, const VectorXd& z) {
  const ParameterSpace& space = problem.space();
  const Optimal o = optimal(problem, z);
  const MatrixXd slopes = space.slopes(z);
  const MatrixXd data = o.e.J.topRows(problem.size() - problem.prior_weights().size());
  VectorXd weights(problem.prior_weights().size());
  Index row = 0;
  for (std::size_t i = 0; i < space.size(); ++i) {
    if (!space[i].prior) continue;
    const VectorXd d = o.linear.inverse * slopes.row(static_cast<Index>(i)).transpose();
    MatrixXd a = MatrixXd::Zero(o.e.J.rows(), 1);
    a.topRows(data.rows()) = data * d;
    const double information = a.squaredNorm();
    // nothing from the data, or at a bound: any weight will do
    const bool none = !(information > 1e-12 * d.squaredNorm() * o.scatter * o.scatter);
    weights[row] = none ? o.noise.mean_variance() : o.noise.variance(a)(0, 0) / information;
    weights[row] = std::max(weights[row], 1e-280);
    ++row;
  }
  return weights;
}

Uncertainty uncertainty(const Problem& problem, const VectorXd& z, const VectorXd& own_error) {
  const ParameterSpace& space = problem.space();
  const Index n = problem.parameters();
  Uncertainty u;
  u.values = space.values(z);
  u.channels = score(problem, z);
  Optimal o = optimal(problem, z);
  const Evaluation& e = o.e;
  const std::vector<Index>& inside = o.inside;
  const auto m = static_cast<Index>(inside.size());
  u.at_bound = o.at_bound;
  u.noise = std::move(o.noise);
  u.freedom = std::max<Index>(1, problem.data_rows() - o.linear.U.cols());
  bool all_declared = true;
  for (const ChannelNoise& c : u.noise.channels) {
    all_declared = all_declared && c.declared;
    for (ChannelScore& s : u.channels)
      if (s.target == c.block.target && s.channel == c.block.channel)
        s.variance = c.sd * c.sd / (c.block.factor * c.block.factor);
  }
  u.quantile = all_declared ? t_quantile(infinity) : t_quantile(static_cast<double>(u.freedom));

  const MatrixXd slopes = space.slopes(z);
  const bool erring = own_error.size() == e.J.rows();
  const VectorXd simulator_error = erring ? VectorXd(own_error.cwiseProduct(o.gain)) : own_error;
  const VectorXd shift_z =
      erring ? VectorXd(-o.linear.pseudo * simulator_error) : VectorXd(VectorXd::Zero(n));
  u.shift = slopes * shift_z;
  MatrixXd cov = u.noise.variance(o.linear.pseudo.transpose());
  const MatrixXd& V = o.linear.V;
  u.information = MatrixXd::Zero(n, n);
  for (const Index i : inside) u.information(i, i) = 12.0;
  if (V.cols() > 0)
    u.information +=
        V * (inverse(V.transpose() * cov * V) - 12.0 * MatrixXd::Identity(V.cols(), V.cols())) *
        V.transpose();
  cov.diagonal() += o.linear.bounded;
  MatrixXd cov_white = u.noise.white_variance(o.linear.pseudo.transpose());
  const MatrixXd value_cov = slopes * cov * slopes.transpose() + u.shift * u.shift.transpose();
  const MatrixXd value_white = slopes * cov_white * slopes.transpose();
  u.standard_error = value_cov.diagonal().cwiseSqrt();
  u.white_error = value_white.diagonal().cwiseSqrt();
  u.released_error = u.freedoms = u.quantiles = u.beyond_bound = u.naive = VectorXd::Zero(n);
  u.correlation = MatrixXd::Identity(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const double d = u.standard_error[i] * u.standard_error[j];
      if (i != j) u.correlation(i, j) = d > 0.0 && std::isfinite(d) ? value_cov(i, j) / d : 0.0;
    }
  }
  for (Index i = 0; i < n; ++i) {
    const FreeParameter& p = space[static_cast<std::size_t>(i)];
    Linear own = o.linear;
    const bool stopped = u.at_bound[static_cast<std::size_t>(i)] != 0;
    if (stopped) {  // what it would be known to without its bound
      std::vector<Index> columns = inside;
      columns.insert(std::upper_bound(columns.begin(), columns.end(), i), i);
      own = linearised(e.J, columns, o.scatter);
      const VectorXd step = -own.pseudo * e.r;
      u.beyond_bound[i] = std::abs(slopes.row(i).dot(step));
      u.standard_error[i] = u.white_error[i] = std::nan("");
    }
    const VectorXd a = own.pseudo.transpose() * slopes.row(i).transpose();
    const VectorXd free = slopes.row(i).transpose().cwiseAbs2().cwiseProduct(own.bounded);
    double more = free.sum();
    if (erring) more += std::pow(a.dot(simulator_error), 2);
    u.naive[i] = slopes.row(i) * own.inverse * slopes.row(i).transpose();
    u.freedoms[i] = u.noise.freedom(a, more);
    u.quantiles[i] = t_quantile(u.freedoms[i]);
    u.released_error[i] = std::sqrt(u.noise.variance(a)(0, 0) + more);
    const bool unknown = slopes.row(i).cwiseAbs().dot(own.undetermined) > 0.0 ||
                         slopes.row(i).cwiseAbs().maxCoeff() == 0.0;
    if (unknown) {
      u.released_error[i] = infinity;
      if (!stopped) u.standard_error[i] = u.white_error[i] = infinity;
    }
    const auto [lower, upper] = space.reach(static_cast<std::size_t>(i));
    const double v = u.values[i], error = u.released_error[i], t = u.freedoms[i];
    if (!std::isfinite(error) || !(error > 0.0)) {
      u.interval.push_back(std::isfinite(error) ? std::array<double, 2>{v, v}
                                                : std::array<double, 2>{lower, upper});
      continue;
    }
    const bool log = p.scale == Scale::log && lower > 0.0;  // symmetric in the logarithm
    const double se = log ? error / v : error, outside = u.beyond_bound[i] / (log ? v : 1.0);
    const double below = std::max(0.0, log ? std::log(v / lower) : v - lower);
    const double above = std::max(0.0, log ? std::log(upper / v) : upper - v);
    const double down = reach_of(se, outside, t, below, above, p.of < 0);
    const double up = reach_of(se, outside, t, above, below, p.of < 0);
    const double low = down < below ? (log ? v * std::exp(-down) : v - down) : lower;
    const double high = up < above ? (log ? v * std::exp(up) : v + up) : upper;
    u.interval.push_back({low, high});
  }

  // directions in relative changes: ∂r/∂ln value over the residuals' own scatter
  if (m > 0) {
    MatrixXd relative(e.J.rows(), m);
    // value_i moves with its own coordinate and with those it is a ratio to: invert the map
    const MatrixXd by_value = e.J * inverse(slopes);
    for (Index j = 0; j < m; ++j) {
      const Index i = inside[static_cast<std::size_t>(j)];
      relative.col(j) = by_value.col(i) * std::abs(u.values[i]);
    }
    relative /= std::max(std::sqrt(u.noise.mean_variance()), 1e-300);
    const SingularValues svd = singular_values(relative);
    for (Index k = svd.s.size() - 1; k >= 0; --k) {
      Combination c;
      c.singular_value = svd.s[k];
      const bool none = c.singular_value <= 1e-9 * svd.s[0];
      c.relative_sd = none ? infinity : 1.0 / c.singular_value;
      c.direction = VectorXd::Zero(n);
      for (Index j = 0; j < m; ++j) c.direction[inside[static_cast<std::size_t>(j)]] = svd.V(j, k);
      c.words = in_words(space, c.direction, c.relative_sd);
      u.combinations.push_back(std::move(c));
    }
  }
  return u;
}

}  // namespace repose::calibration

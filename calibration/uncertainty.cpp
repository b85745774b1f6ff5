#include "calibration/uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <tbb/parallel_for.h>

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

/// Var(mean of a correlated series) over that of a white one, at most that of n equal values.
double correlation_factor(double rho, Index n) {
  if (!correlated(rho, n)) return 1.0;
  return std::min((1.0 + rho) / (1.0 - rho), static_cast<double>(n));
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

double t_quantile(double n) {
  if (!(n >= 1.0)) return infinity;
  if (n < 3.0) return n < 2.0 ? 12.706 : 4.303;
  // Abramowitz & Stegun 26.7.5
  const double x = 1.959963985, x2 = x * x;
  return x * (1.0 + (x2 + 1.0) / (4.0 * n) + ((5.0 * x2 + 16.0) * x2 + 3.0) / (96.0 * n * n) +
              (((3.0 * x2 + 19.0) * x2 + 17.0) * x2 - 15.0) / (384.0 * n * n * n));
}

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
      s.systematic = beyond || (n >= 8 && s.lag_correlation > 0.5 &&
                                correlated(s.lag_correlation, n) && s.relative_rms > 1e-6);
      for (const Block& b : problem.blocks())
        if (b.target == k && b.channel == c)
          s.objective = 0.5 * b.factor * b.factor * r.squaredNorm();
      scores.push_back(s);
    }
  }
  return scores;
}

Uncertainty uncertainty(const Problem& problem, const VectorXd& z,
                        const VectorXd& simulator_error) {
  const ParameterSpace& space = problem.space();
  const Index n = problem.parameters();
  Uncertainty u;
  u.values = space.values(z);
  u.channels = score(problem, z);
  u.freedom = std::max<Index>(1, problem.data_rows() - n);
  Evaluation e;
  problem.evaluate(z, true, e);
  // a bound that stops a parameter is not a measurement of it
  std::vector<Index> inside;
  const VectorXd gradient = e.J.transpose() * e.r;
  for (Index i = 0; i < n; ++i) {
    const bool low = z[i] < at_bound_distance && gradient[i] >= 0.0;
    const bool high = z[i] > 1.0 - at_bound_distance && gradient[i] <= 0.0;
    u.at_bound.push_back(low ? -1 : (high ? 1 : 0));
    if (!low && !high) inside.push_back(i);
  }
  const auto m = static_cast<Index>(inside.size());
  MatrixXd J(e.J.rows(), m);
  for (Index j = 0; j < m; ++j) J.col(j) = e.J.col(inside[static_cast<std::size_t>(j)]);
  // meat: variance of each residual in r's units; priors and penalties have variance 1
  VectorXd white = VectorXd::Ones(J.rows()), full = white;
  bool all_declared = true;
  double total = 0.0, rows = 0.0;
  for (const Block& b : problem.blocks()) {
    const Channel& channel = problem.targets()[b.target].channels[b.channel];
    all_declared = all_declared && channel.noise.has_value();
    for (const ChannelScore& s : u.channels) {
      if (s.target != b.target || s.channel != b.channel) continue;
      const double v = b.factor * b.factor * s.variance;
      white.segment(b.first, b.rows).setConstant(v);
      full.segment(b.first, b.rows).setConstant(v * correlation_factor(s.lag_correlation, b.rows));
      total += v * static_cast<double>(b.rows);
      rows += static_cast<double>(b.rows);
    }
  }
  u.quantile = all_declared ? 1.959963985 : t_quantile(static_cast<double>(u.freedom));

  MatrixXd cov = MatrixXd::Zero(n, n), cov_white = cov;
  VectorXd unknown = VectorXd::Zero(n);
  u.shift = unknown;
  if (m > 0) {
    const VectorXd size = J.colwise().norm().transpose().cwiseMax(1e-300);
    const Eigen::JacobiSVD<MatrixXd> svd(J * size.cwiseInverse().asDiagonal(),
                                         Eigen::ComputeThinU | Eigen::ComputeThinV);
    const VectorXd& sigma = svd.singularValues();
    VectorXd inverse = VectorXd::Zero(sigma.size());
    MatrixXd lost = MatrixXd::Zero(m, 1);
    const double limit = 1e-9 * std::max(sigma[0], 1e-300);
    for (Index k = 0; k < sigma.size(); ++k) {
      if (sigma[k] > limit && sigma[0] > 1e-290)
        inverse[k] = 1.0 / sigma[k];
      else
        lost += svd.matrixV().col(k).cwiseAbs2();
    }
    const MatrixXd pseudo = size.cwiseInverse().asDiagonal() * svd.matrixV() *
                            inverse.asDiagonal() * svd.matrixU().transpose();
    MatrixXd c_full = pseudo * full.asDiagonal() * pseudo.transpose();
    if (simulator_error.size() == J.rows()) {
      const VectorXd shift = -pseudo * simulator_error;
      c_full += shift * shift.transpose();
      for (Index i = 0; i < m; ++i) u.shift[inside[static_cast<std::size_t>(i)]] = shift[i];
    }
    const MatrixXd c_white = pseudo * white.asDiagonal() * pseudo.transpose();
    for (Index i = 0; i < m; ++i) {
      const Index a = inside[static_cast<std::size_t>(i)];
      if (lost(i, 0) > 1e-6 || e.J.col(a).norm() == 0.0) unknown[a] = 1.0;
      for (Index j = 0; j < m; ++j) {
        const Index b = inside[static_cast<std::size_t>(j)];
        cov(a, b) = c_full(i, j);
        cov_white(a, b) = c_white(i, j);
      }
    }
  }
  const MatrixXd slopes = space.slopes(z);
  const MatrixXd value_cov = slopes * cov * slopes.transpose();
  u.shift = slopes * u.shift;
  const MatrixXd value_white = slopes * cov_white * slopes.transpose();
  u.standard_error = value_cov.diagonal().cwiseSqrt();
  u.white_error = value_white.diagonal().cwiseSqrt();
  u.correlation = MatrixXd::Identity(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const double d = u.standard_error[i] * u.standard_error[j];
      if (i != j) u.correlation(i, j) = d > 0.0 && std::isfinite(d) ? value_cov(i, j) / d : 0.0;
      if (slopes(i, j) != 0.0 && unknown[j] > 0.0)
        u.standard_error[i] = u.white_error[i] = infinity;
    }
    const FreeParameter& p = space[static_cast<std::size_t>(i)];
    const double of = p.of < 0 ? 1.0 : u.values[p.of];
    const double lower = p.lower * of, upper = p.upper * of;
    const double se = u.standard_error[i];
    double low = u.values[i] - u.quantile * se, high = u.values[i] + u.quantile * se;
    if (p.scale == Scale::log && u.values[i] > 0.0) {  // symmetric in the logarithm
      low = u.values[i] * std::exp(-u.quantile * se / u.values[i]);
      high = u.values[i] * std::exp(u.quantile * se / u.values[i]);
    }
    u.interval.push_back({std::max(low, lower), std::min(high, upper)});
  }

  // directions in relative changes: ∂r/∂ln value over the residuals' own scatter
  if (m > 0) {
    MatrixXd relative(J.rows(), m);
    // value_i moves with its own coordinate and with those it is a ratio to: invert the map
    const MatrixXd inverse = slopes.fullPivLu().inverse();
    const MatrixXd by_value = e.J * inverse;
    for (Index j = 0; j < m; ++j) {
      const Index i = inside[static_cast<std::size_t>(j)];
      relative.col(j) = by_value.col(i) * std::abs(u.values[i]);
    }
    const double scatter = rows > 0.0 ? std::sqrt(total / rows) : 1.0;
    relative /= std::max(scatter, 1e-300);
    const Eigen::JacobiSVD<MatrixXd> svd(relative, Eigen::ComputeThinU | Eigen::ComputeThinV);
    for (Index k = svd.singularValues().size() - 1; k >= 0; --k) {
      Combination c;
      c.singular_value = svd.singularValues()[k];
      const bool none = c.singular_value <= 1e-9 * svd.singularValues()[0];
      c.relative_sd = none ? infinity : 1.0 / c.singular_value;
      c.direction = VectorXd::Zero(n);
      for (Index j = 0; j < m; ++j)
        c.direction[inside[static_cast<std::size_t>(j)]] = svd.matrixV()(j, k);
      c.words = in_words(space, c.direction, c.relative_sd);
      u.combinations.push_back(std::move(c));
    }
  }
  return u;
}

Profile profile(const Problem& problem, const Uncertainty& at, const VectorXd& z, int parameter,
                int points_per_side) {
  Profile p;
  p.parameter = parameter;
  const Index i = parameter;
  const ParameterSpace& space = problem.space();
  Evaluation e;
  problem.evaluate(z, true, e);
  const double best = e.r.squaredNorm();
  // the misfit's own scale, so that the profile's curvature at the optimum is the covariance's
  const Eigen::JacobiSVD<MatrixXd> svd(e.J, Eigen::ComputeThinV);
  double naive = 0.0;
  for (Index k = 0; k < svd.singularValues().size(); ++k)
    naive += std::pow(svd.matrixV()(i, k) / std::max(svd.singularValues()[k], 1e-12), 2.0);
  const MatrixXd slopes = space.slopes(z);
  const double se_z = at.standard_error[i] / slopes(i, i);
  const bool own = space[static_cast<std::size_t>(i)].of < 0;
  double factor = own && std::isfinite(se_z) && naive > 0.0 ? se_z * se_z / naive : 1.0;
  if (!own || !(factor > 0.0)) {
    double total = 0.0;
    for (const ChannelScore& s : at.channels)
      if (!problem.targets()[s.target].held_out) total += s.variance * static_cast<double>(s.rows);
    factor = std::max(total / static_cast<double>(problem.data_rows()), 1e-300);
  }
  const double limit = at.quantile * at.quantile;
  double sd = std::sqrt(naive * factor);
  if (!(sd > 1e-8)) sd = 1e-8;
  const auto side = [&](double sign, double& end, bool& open) {
    std::vector<std::pair<double, double>> points;
    VectorXd from = z;
    double at_z = z[i], root_before = 0.0, z_before = z[i];
    const double step = std::min(sd * at.quantile * 1.25 / points_per_side, 0.5 / points_per_side);
    OptimiseOptions options;
    options.fixed.assign(static_cast<std::size_t>(problem.parameters()), false);
    options.fixed[static_cast<std::size_t>(i)] = true;
    options.max_evaluations = 60;
    double stride = step;
    open = true;
    for (int k = 0; k < 4 * points_per_side && !problem.interrupted(); ++k) {
      at_z = std::min(1.0, std::max(0.0, z_before + sign * stride));
      if (at_z == z_before) break;
      from[i] = at_z;
      const Optimum o = levenberg_marquardt(problem, from, options);
      from = o.z;
      const double excess = std::max(0.0, (2.0 * o.objective - best) / factor);
      const double value = space.values(o.z)[i];
      points.emplace_back(value, excess);
      const double root = std::sqrt(excess);
      if (excess >= limit) {
        // √excess is nearly straight: interpolate for the crossing
        const double share = (at.quantile - root_before) / (root - root_before);
        VectorXd crossing = o.z;
        crossing[i] = z_before + share * (at_z - z_before);
        end = space.values(crossing)[i];
        open = false;
        break;
      }
      if (root - root_before < 0.3 * at.quantile / points_per_side) stride *= 2.0;
      root_before = root;
      z_before = at_z;
      end = value;
    }
    return points;
  };
  p.lower = p.upper = at.values[i];
  auto below = side(-1.0, p.lower, p.lower_open);
  const auto above = side(1.0, p.upper, p.upper_open);
  std::reverse(below.begin(), below.end());
  for (const auto& [value, excess] : below) {
    p.value.push_back(value);
    p.excess.push_back(excess);
  }
  p.value.push_back(at.values[i]);
  p.excess.push_back(0.0);
  for (const auto& [value, excess] : above) {
    p.value.push_back(value);
    p.excess.push_back(excess);
  }
  return p;
}

MatrixXd bootstrap(const Problem& problem, const VectorXd& z, int repeats, std::uint64_t seed) {
  std::vector<MatrixXd> fitted;
  for (std::size_t k = 0; k < problem.targets().size(); ++k)
    fitted.push_back(problem.predict(k, z).simulated);
  MatrixXd values(repeats, problem.parameters());
  const double widen = std::sqrt(
      static_cast<double>(problem.data_rows()) /
      static_cast<double>(std::max<Index>(1, problem.data_rows() - problem.parameters())));
  tbb::parallel_for(0, repeats, [&](int b) {
    std::mt19937_64 random(seed + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(b + 1));
    std::vector<MatrixXd> observed = fitted;
    for (std::size_t k = 0; k < problem.targets().size(); ++k) {
      const Target& t = problem.targets()[k];
      if (t.held_out) continue;
      for (std::size_t c = 0; c < t.channels.size(); ++c) {
        const auto col = static_cast<Index>(c);
        const VectorXd r = t.channels[c].observed - fitted[k].col(col);
        VectorXd sd(r.size());  // rows of different noise exchange their residuals in units of it
        for (Index i = 0; i < r.size(); ++i) sd[i] = scale_of(t.channels[c], i);
        const VectorXd units = r.cwiseQuotient(sd);
        const VectorXd centred = (units.array() - units.mean()).matrix() * widen;
        const auto n = static_cast<std::uint64_t>(r.size());
        const auto block =
            static_cast<Index>(std::ceil(correlation_factor(lag_correlation(r), r.size())));
        for (Index i = 0; i < r.size();) {
          const auto from = static_cast<Index>(random() % n);
          for (Index j = 0; j < block && i < r.size(); ++j, ++i)
            observed[k](i, col) += sd[i] * centred[(from + j) % r.size()];
        }
      }
    }
    const Problem again = problem.with_observed(observed);
    values.row(b) = problem.space().values(levenberg_marquardt(again, z).z).transpose();
  });
  return values;
}

}  // namespace repose::calibration

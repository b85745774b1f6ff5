#include "calibration/noise.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "calibration/quantiles.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// σ Lᵀ A of one channel's rows.
MatrixXd transposed_filter(const ChannelNoise& c, const MatrixXd& A) {
  MatrixXd w = A.middleRows(c.block.first, c.block.rows);
  for (Index i = w.rows() - 2; i >= 0; --i) w.row(i) += c.rho * w.row(i + 1);
  const double innovation = std::sqrt(1.0 - c.rho * c.rho);
  if (w.rows() > 1) w.bottomRows(w.rows() - 1) *= innovation;
  return c.sd * w;
}

/// σ L B of one channel.
MatrixXd filter(const ChannelNoise& c, MatrixXd b) {
  const double innovation = std::sqrt(1.0 - c.rho * c.rho);
  for (Index i = 1; i < b.rows(); ++i) b.row(i) = c.rho * b.row(i - 1) + innovation * b.row(i);
  return c.sd * b;
}

/// Sums over the rows of two channels: lag 0, and lag 1 if they are the same.
struct Sums {
  double same = 0.0, next = 0.0;
};

/// Sums of products as they are expected of (1 − UUᵀ) Ω (1 − UUᵀ).
class Expected {
 public:
  Expected(const Noise& noise, const MatrixXd& U) : noise_(noise), U_(U) {
    const std::size_t n = noise.channels.size();
    std::vector<MatrixXd> b;
    for (const ChannelNoise& c : noise.channels) b.push_back(transposed_filter(c, U));
    W_ = MatrixXd::Zero(U.rows(), U.cols());
    for (std::size_t i = 0; i < n; ++i) {
      const ChannelNoise& c = noise.channels[i];
      MatrixXd mixed = MatrixXd::Zero(c.block.rows, U.cols());
      for (std::size_t j = 0; j < n; ++j) {
        const double h = noise.between(static_cast<Index>(i), static_cast<Index>(j));
        if (h != 0.0) mixed += h * b[j];
      }
      W_.middleRows(c.block.first, c.block.rows) = filter(c, std::move(mixed));
    }
    for (Index k = 0; k < noise.priors.size(); ++k)
      W_.row(noise.first_prior + k) = noise.priors[k] * U.row(noise.first_prior + k);
    UK_ = U * (U.transpose() * W_);
  }

  Sums of(std::size_t i, std::size_t j) const {
    const ChannelNoise &a = noise_.channels[i], &b = noise_.channels[j];
    const double h = noise_.between(static_cast<Index>(i), static_cast<Index>(j));
    const double s = a.sd * b.sd * h;
    Sums sums;
    const Index n = a.block.rows;
    // covariance of the two at the same row: both start stationary, then it settles
    double same = s;
    const double ra = a.rho, rb = b.rho;
    const double innovation = std::sqrt((1.0 - ra * ra) * (1.0 - rb * rb));
    for (Index k = 0; k < n; ++k) {
      const Index p = a.block.first + k, q = b.block.first + k;
      sums.same += same + corner(p, q);
      if (i == j && k + 1 < n) sums.next += a.rho * same + corner(p, q + 1);
      same = ra * rb * same + innovation * s;
    }
    return sums;
  }

 private:
  double corner(Index p, Index q) const {
    return -U_.row(p).dot(W_.row(q)) - W_.row(p).dot(U_.row(q)) + UK_.row(p).dot(U_.row(q));
  }
  const Noise& noise_;
  const MatrixXd& U_;
  MatrixXd W_, UK_;
};

Sums seen(const VectorXd& r, const ChannelNoise& a, const ChannelNoise& b) {
  const auto x = r.segment(a.block.first, a.block.rows), y = r.segment(b.block.first, b.block.rows);
  const Index n = a.block.rows;
  return {x.dot(y), x.head(n - 1).dot(y.tail(n - 1))};
}

/// The strongest correlation that n rows can show: that of n equal values.
double strongest(Index n) {
  const auto rows = static_cast<double>(n);
  return (rows - 1.0) / (rows + 1.0);
}

bool together(const ChannelNoise& a, const ChannelNoise& b) {
  return a.block.target == b.block.target;
}

/// h made positive definite where pairs estimated one by one contradict each other.
void mend(MatrixXd& h) {
  for (int k = 0; k < 60; ++k) {
    const Eigen::LDLT<MatrixXd> root(h - 1e-6 * MatrixXd::Identity(h.rows(), h.cols()));
    if (root.info() == Eigen::Success && root.vectorD().minCoeff() > 0.0) return;
    const VectorXd diagonal = h.diagonal();
    h *= 0.95;
    h.diagonal() = diagonal;
  }
}

}  // namespace

VectorXd whitened(const VectorXd& errors, double rho) {
  VectorXd white = errors;
  const double innovation = std::sqrt(1.0 - rho * rho);
  for (Index i = 1; i < errors.size(); ++i)
    white[i] = (errors[i] - rho * errors[i - 1]) / innovation;
  return white;
}

VectorXd coloured(const VectorXd& white, double rho) {
  ChannelNoise c;
  c.sd = 1.0;
  c.rho = rho;
  return filter(c, white);
}

MatrixXd Noise::filtered(const MatrixXd& A) const {
  MatrixXd b = MatrixXd::Zero(A.rows(), A.cols());
  for (const ChannelNoise& c : channels)
    b.middleRows(c.block.first, c.block.rows) = transposed_filter(c, A);
  for (Index k = 0; k < priors.size(); ++k)
    b.row(first_prior + k) = std::sqrt(priors[k]) * A.row(first_prior + k);
  return b;
}

MatrixXd Noise::variance(const MatrixXd& A) const {
  const MatrixXd b = filtered(A);
  MatrixXd v = b.transpose() * b;
  for (std::size_t i = 0; i < channels.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double h = between(static_cast<Index>(i), static_cast<Index>(j));
      if (h == 0.0) continue;
      const Block &p = channels[i].block, &q = channels[j].block;
      const MatrixXd cross =
          h * b.middleRows(p.first, p.rows).transpose() * b.middleRows(q.first, q.rows);
      v += cross + cross.transpose();
    }
  return v;
}

MatrixXd Noise::white_variance(const MatrixXd& A) const {
  Noise white = *this;
  for (ChannelNoise& c : white.channels) {
    c.rho = 0.0;
    c.sd = c.white_sd;
  }
  white.between.setIdentity();
  return white.variance(A);
}

double Noise::freedom(const VectorXd& a, double more) const {
  const double total = variance(a)(0, 0) + more;
  if (!(total > 0.0)) return infinity;
  const MatrixXd b = filtered(a);
  double squares = 0.0, correlations = 0.0;  // variance of ln(total) by their estimates
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const ChannelNoise& c = channels[i];
    const auto mine = b.col(0).segment(c.block.first, c.block.rows);
    if (!c.declared) {  // ln σ² has the variance 2/freedom at given ρ
      double share = mine.squaredNorm();
      for (std::size_t j = 0; j < channels.size(); ++j) {
        const double h = between(static_cast<Index>(i), static_cast<Index>(j));
        if (j == i || h == 0.0) continue;
        const Block& q = channels[j].block;
        share += h * mine.dot(b.col(0).segment(q.first, q.rows));
      }
      squares += std::pow(share / total, 2) * 2.0 / c.freedom;
    }
    if (c.rho > 0.0) {  // ρ has (1 − ρ²)/freedom, independent of the innovations' variance
      const double step = 1e-4 * (1.0 - c.rho);
      std::array<double, 2> side{};
      for (const int k : {0, 1}) {
        Noise other = *this;
        ChannelNoise& d = other.channels[i];
        d.rho += k == 0 ? -step : step;
        if (!c.declared) d.sd *= std::sqrt((1.0 - c.rho * c.rho) / (1.0 - d.rho * d.rho));
        side[static_cast<std::size_t>(k)] = other.variance(a)(0, 0);
      }
      const double slope = (side[1] - side[0]) / (2.0 * step * total);
      correlations += slope * slope * (1.0 - c.rho * c.rho) / c.freedom;
    }
    for (std::size_t j = 0; j < i; ++j) {
      const double h = between(static_cast<Index>(i), static_cast<Index>(j));
      if (h == 0.0) continue;
      const Block& q = channels[j].block;
      const double slope = 2.0 * mine.dot(b.col(0).segment(q.first, q.rows)) / total;
      correlations +=
          slope * slope * std::pow(1.0 - h * h, 2) / std::min(c.freedom, channels[j].freedom);
    }
  }
  return mixed_freedom(squares > 0.0 ? 2.0 / squares : infinity, correlations);
}

double Noise::mean_variance() const {
  double total = 0.0, rows = 0.0;
  for (const ChannelNoise& c : channels) {
    total += c.sd * c.sd * static_cast<double>(c.block.rows);
    rows += static_cast<double>(c.block.rows);
  }
  return rows > 0.0 ? total / rows : 1.0;
}

Noise estimate_noise(const Problem& problem, const VectorXd& r, const MatrixXd& U) {
  Noise noise;
  noise.priors = problem.prior_weights();
  noise.first_prior = problem.size() - noise.priors.size();
  const auto n = static_cast<Index>(problem.blocks().size());
  noise.between = MatrixXd::Identity(n, n);
  std::vector<Sums> own;
  for (const Block& b : problem.blocks()) {
    ChannelNoise c;
    c.block = b;
    const auto rows = static_cast<double>(b.rows);
    const double used = U.middleRows(b.first, b.rows).squaredNorm();
    c.freedom = std::max(rows - used, 0.5);
    own.push_back(seen(r, c, c));
    c.sd = std::sqrt(own.back().same / c.freedom);
    if (problem.targets()[b.target].channels[b.channel].noise && !problem.loss().robust()) {
      // χ² of n rows exceeds n + 2.33 √(2n) in 1 % of cases
      const double chi2 = c.sd * c.sd / (b.factor * b.factor);
      c.beyond = chi2 > 1.0 + 2.33 * std::sqrt(2.0 / c.freedom);
      c.declared = !c.beyond;
      if (c.declared) c.sd = b.factor;
    }
    c.white_sd = c.sd;
    noise.channels.push_back(c);
  }
  // Correlations first all together, then without those that are no more than chance: one standard
  // deviation of what white noise shows
  std::vector<bool> follows(noise.channels.size());
  for (std::size_t i = 0; i < follows.size(); ++i)
    follows[i] = noise.channels[i].block.rows >= 4 && own[i].same > 0.0;
  MatrixXd pairs = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < i; ++j)
      pairs(i, j) = together(noise.channels[static_cast<std::size_t>(i)],
                             noise.channels[static_cast<std::size_t>(j)]) &&
                            follows[static_cast<std::size_t>(i)] &&
                            follows[static_cast<std::size_t>(j)]
                        ? 1.0
                        : 0.0;
  for (const bool last : {false, true}) {
    // Each correction as if the expected sums followed their own quantity alone. They do not: where
    // correlations are strong, h moves a ratio of sums by more than itself, and whole corrections
    // swing about the solution without end. So after every twenty they are halved.
    double gain = 1.0;
    for (int sweep = 0; sweep < 160; ++sweep) {
      if (sweep > 0 && sweep % 20 == 0) gain *= 0.5;
      const Expected expected(noise, U);
      const Noise before = noise;
      double change = 0.0;
      std::vector<double> size;
      for (std::size_t i = 0; i < follows.size(); ++i) {
        ChannelNoise& c = noise.channels[i];
        const Sums e = expected.of(i, i);
        size.push_back(e.same);
        if (!(own[i].same > 0.0 && e.same > 0.0)) continue;
        if (!c.declared) c.sd *= std::pow(own[i].same / e.same, 0.5 * gain);
        if (follows[i]) {
          // a ratio of two sums is 2ρ/n too small in the mean (Marriott & Pope 1954)
          const double wanted = own[i].next / own[i].same + 2.0 * c.rho / c.freedom;
          const double most = strongest(c.block.rows);
          c.rho = std::clamp(c.rho + gain * (wanted - e.next / e.same), last ? 0.0 : -most, most);
        }
        change = std::max({change, std::abs(c.rho - before.channels[i].rho),
                           std::abs(c.sd / before.channels[i].sd - 1.0)});
      }
      for (std::size_t i = 0; i < follows.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
          const auto p = static_cast<Index>(i), q = static_cast<Index>(j);
          if (pairs(p, q) == 0.0 || !(size[i] > 0.0 && size[j] > 0.0)) continue;
          const Sums s = seen(r, noise.channels[i], noise.channels[j]);
          const double wanted = s.same / std::sqrt(own[i].same * own[j].same) -
                                expected.of(i, j).same / std::sqrt(size[i] * size[j]);
          noise.between(p, q) = noise.between(q, p) =
              std::clamp(before.between(p, q) + gain * wanted, -0.98, 0.98);
          change = std::max(change, std::abs(noise.between(p, q) - before.between(p, q)));
        }
      mend(noise.between);
      if (change < 1e-6) break;
    }
    if (last) break;
    for (std::size_t i = 0; i < follows.size(); ++i) {
      ChannelNoise& c = noise.channels[i];
      follows[i] = follows[i] && c.rho > 1.0 / std::sqrt(c.freedom);
      if (!follows[i]) c.rho = 0.0;
      for (std::size_t j = 0; j < i; ++j) {
        const auto p = static_cast<Index>(i), q = static_cast<Index>(j);
        const double chance = 1.0 / std::sqrt(std::min(c.freedom, noise.channels[j].freedom));
        if (pairs(p, q) != 0.0 && std::abs(noise.between(p, q)) > chance) continue;
        pairs(p, q) = noise.between(p, q) = noise.between(q, p) = 0.0;
      }
    }
  }
  return noise;
}

}  // namespace repose::calibration

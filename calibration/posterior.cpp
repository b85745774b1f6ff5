#include "calibration/posterior.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Prior of ln ℓ: a law's error hangs together over a fifth of the curve, give or take a factor 2.
constexpr double usual_length = 0.2, length_width = 0.7;

VectorXd cube(const VectorXd& u) { return (1.0 + (-u.array()).exp()).inverse(); }

}  // namespace

Posterior::Posterior(const Problem& problem, const PosteriorOptions& options)
    : problem_(problem),
      size_(problem.parameters()) {
  for (const Block& b : problem_.blocks()) {
    const Channel& channel = problem_.targets()[b.target].channels[b.channel];
    ChannelErrors c;
    c.scale = scale_of(channel);
    c.w = VectorXd::Ones(b.rows);
    for (Index i = 0; i < b.rows; ++i) c.w[i] = scale_of(channel, i) / c.scale;
    const double range = (channel.observed.maxCoeff() - channel.observed.minCoeff()) / c.scale;
    if (options.keep_declared_noise && !channel.noise)
      throw InputError("noise", problem_.targets()[b.target].name + ": " + channel.name +
                                    " has no declared noise to keep to");
    if (!options.keep_declared_noise) c.noise = size_++;
    // what is declared is right within a factor 2; what is not lies about a hundredth of the range,
    // give or take a factor 20: next to even in ln σ
    c.noise_centre = channel.noise ? 1.0 : 0.01;
    c.noise_width = channel.noise ? std::log(2.0) : 3.0;
    if (options.discrepancy > 0.0) {
      c.discrepancy = size_;
      size_ += 2;
      c.discrepancy_size = options.discrepancy * (range > 0.0 ? range : 1.0);
    }
    channels_.push_back(std::move(c));
  }
}

CurveError Posterior::error_of(const VectorXd& u, const ChannelErrors& c) const {
  CurveError error;
  error.noise = c.noise < 0 ? c.noise_centre : std::exp(u[c.noise]);
  if (c.discrepancy >= 0) {
    error.discrepancy = std::exp(u[c.discrepancy]);
    error.length = std::exp(u[c.discrepancy + 1]);
  }
  return error;
}

/// ln p of the errors' own priors, as a density in their logarithms, and its slopes.
double Posterior::error_priors(const ChannelErrors& c, const CurveError& error,
                               std::array<double, 3>& slope) const {
  double sum = 0.0;
  if (c.noise >= 0) {
    const double off = std::log(error.noise / c.noise_centre) / c.noise_width;
    sum -= 0.5 * off * off;
    slope[0] -= off / c.noise_width;
  }
  if (c.discrepancy >= 0) {
    const double share = error.discrepancy / c.discrepancy_size;
    sum += std::log(share) - 0.5 * share * share;
    slope[1] += 1.0 - share * share;
    const double off = std::log(error.length / usual_length) / length_width;
    sum -= 0.5 * off * off;
    slope[2] -= off / length_width;
  }
  return sum;
}

/// −∂² ln p/∂(ln σ, ln τ, ln ℓ)² of one channel, by differences of the exact slopes, which cost no
/// simulation; made positive definite. Rows of what is not free are those of the identity.
Eigen::Matrix3d Posterior::error_curvature(const ChannelErrors& c, const CurveError& error,
                                           const VectorXd& off) const {
  constexpr double h = 1e-4;
  const std::array<bool, 3> free{c.noise >= 0, c.discrepancy >= 0, c.discrepancy >= 0};
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity();
  for (std::size_t i = 0; i < 3; ++i) {
    if (!free[i]) continue;
    std::array<std::array<double, 3>, 2> side{};
    for (const std::size_t s : {0U, 1U}) {
      CurveError moved = error;
      double& x = i == 0 ? moved.noise : i == 1 ? moved.discrepancy : moved.length;
      x *= std::exp(s == 0 ? -h : h);
      side[s] = likelihood(moved, off, c.w).by_logarithm;
      error_priors(c, moved, side[s]);
    }
    for (std::size_t j = 0; j < 3; ++j)
      if (free[j])
        H(static_cast<Index>(i), static_cast<Index>(j)) = -(side[1][j] - side[0][j]) / (2.0 * h);
  }
  // no direction is taken to be wider than a standard deviation of 2, a factor 7 either way
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(0.5 * (H + H.transpose()));
  return axes.eigenvectors() * axes.eigenvalues().cwiseAbs().cwiseMax(0.25).asDiagonal() *
         axes.eigenvectors().transpose();
}

void Posterior::evaluate(const VectorXd& u, bool with_curvature, Point& out) const {
  const Index n = problem_.parameters();
  const VectorXd z = cube(u.head(n));
  const VectorXd dz = z.cwiseProduct((1.0 - z.array()).matrix());
  out.gradient = VectorXd::Zero(size_);
  out.curvature = MatrixXd();
  out.log_density = -infinity;
  if (!(dz.minCoeff() > 0.0)) return;  // so near a bound that z is the bound
  Evaluation e;
  problem_.evaluate(z, true, e);
  if (e.failed) return;
  VectorXd by_z;
  double sum = problem_.space().log_prior(z, by_z) + dz.array().log().sum();
  if (with_curvature) {
    out.curvature = MatrixXd::Zero(size_, size_);
    out.curvature.topLeftCorner(n, n) = problem_.space().prior_curvature(z);
  }
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    const Block& b = problem_.blocks()[k];
    const ChannelErrors& c = channels_[k];
    const CurveError error = error_of(u, c);
    // r in units of the noise of each row; the errors are alike in units of their mean
    const VectorXd unit = c.w / b.factor;
    const VectorXd off = e.r.segment(b.first, b.rows).cwiseProduct(unit);
    const MatrixXd slope = unit.asDiagonal() * e.J.middleRows(b.first, b.rows);
    CurveLikelihood l = likelihood(error, off, c.w);
    sum += l.value + error_priors(c, error, l.by_logarithm);
    by_z += slope.transpose() * l.by_row;
    if (c.noise >= 0) out.gradient[c.noise] = l.by_logarithm[0];
    if (c.discrepancy >= 0) {
      out.gradient[c.discrepancy] = l.by_logarithm[1];
      out.gradient[c.discrepancy + 1] = l.by_logarithm[2];
    }
    if (!with_curvature) continue;
    const MatrixXd white = innovations(error, slope, c.w);
    out.curvature.topLeftCorner(n, n) += white.transpose() * white;
    const std::array<Index, 3> place{c.noise, c.discrepancy,
                                     c.discrepancy < 0 ? -1 : c.discrepancy + 1};
    const Eigen::Matrix3d own = error_curvature(c, error, off);
    for (Index i = 0; i < 3; ++i)
      for (Index j = 0; j < 3; ++j) {
        const Index row = place[static_cast<std::size_t>(i)],
                    column = place[static_cast<std::size_t>(j)];
        if (row >= 0 && column >= 0) out.curvature(row, column) = own(i, j);
      }
  }
  out.gradient.head(n) = by_z.cwiseProduct(dz) + (1.0 - 2.0 * z.array()).matrix();
  if (with_curvature) {
    out.curvature.topLeftCorner(n, n) =
        dz.asDiagonal() * out.curvature.topLeftCorner(n, n) * dz.asDiagonal();
    // −d² ln(dz/du)/du² = 2z(1 − z), and −(∂ln p/∂z) d²z/du² = (1 − 2z)² at the mode
    out.curvature.diagonal().head(n).array() += 1.0 - 2.0 * dz.array();
  }
  const bool good = std::isfinite(sum) && out.gradient.allFinite();
  if (good) out.log_density = sum;
}

VectorXd Posterior::start(const VectorXd& at) const {
  const Index n = problem_.parameters();
  VectorXd u = VectorXd::Zero(size_);
  const VectorXd z = at.cwiseMax(0.01).cwiseMin(0.99);
  u.head(n) = (z.array() / (1.0 - z.array())).log();
  Evaluation e;
  problem_.evaluate(z, false, e);
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    const Block& b = problem_.blocks()[k];
    const ChannelErrors& c = channels_[k];
    const VectorXd off = e.r.segment(b.first, b.rows).cwiseProduct(c.w) / b.factor;
    const double rms = std::sqrt(off.squaredNorm() / static_cast<double>(b.rows));
    if (c.noise >= 0) u[c.noise] = std::log(std::max(rms, 1e-3 * c.noise_centre));
    if (c.discrepancy < 0) continue;
    if (c.noise >= 0) u[c.noise] -= std::log(2.0);  // half of it is either's
    u[c.discrepancy] = std::log(std::max(0.5 * rms, 1e-2 * c.discrepancy_size));
    u[c.discrepancy + 1] = std::log(usual_length);
  }
  return u;
}

VectorXd Posterior::z(const VectorXd& u) const { return cube(u.head(problem_.parameters())); }

CurveError Posterior::error(const VectorXd& u, std::size_t block) const {
  const ChannelErrors& c = channels_[block];
  CurveError error = error_of(u, c);
  error.noise *= c.scale;
  error.discrepancy *= c.scale;
  return error;
}

std::vector<std::string> Posterior::quantity_names() const {
  std::vector<std::string> names;
  for (const FreeParameter& p : problem_.space().parameters()) names.push_back(p.name);
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    const Target& t = problem_.targets()[problem_.blocks()[k].target];
    const std::string of = " of " + t.name + " " + t.channels[problem_.blocks()[k].channel].name;
    if (channels_[k].noise >= 0) names.push_back("noise" + of);
    if (channels_[k].discrepancy < 0) continue;
    names.push_back("discrepancy" + of);
    names.push_back("length" + of);
  }
  return names;
}

VectorXd Posterior::quantities(const VectorXd& u) const {
  const VectorXd values = problem_.space().values(z(u));
  VectorXd all(size_);
  all.head(values.size()) = values;
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    const CurveError e = error(u, k);
    if (channels_[k].noise >= 0) all[channels_[k].noise] = e.noise;
    if (channels_[k].discrepancy < 0) continue;
    all[channels_[k].discrepancy] = e.discrepancy;
    all[channels_[k].discrepancy + 1] = e.length;
  }
  return all;
}

VectorXd mode(const Posterior& posterior, const VectorXd& start) {
  VectorXd u = start;
  Posterior::Point here, there;
  posterior.evaluate(u, true, here);
  double damping = 1e-3;
  for (int trial = 0; trial < 300 && damping < 1e10 && std::isfinite(here.log_density); ++trial) {
    MatrixXd A = here.curvature;
    A.diagonal() *= 1.0 + damping;
    VectorXd step = A.ldlt().solve(here.gradient);
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > 2.0) step *= 2.0 / longest;  // of a factor 7 of an error
    posterior.evaluate(u + step, true, there);
    if (there.log_density > here.log_density) {
      const double rise = there.log_density - here.log_density;
      u += step;
      std::swap(here, there);
      damping = std::max(1e-9, 0.2 * damping);
      if (rise < 1e-9) break;
    } else {
      if (step.cwiseAbs().maxCoeff() < 1e-8) break;
      damping *= 4.0;
    }
  }
  return u;
}

}  // namespace repose::calibration

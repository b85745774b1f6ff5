#include "calibration/unseen.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "calibration/uncertainty.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double log_two_pi = 1.8378770664093453;

/// C⁻¹ in z: what the fitted data and the priors tell, and the bounds.
MatrixXd information(const Problem& fitted, const VectorXd& z,
                     const std::vector<LikelyErrors>& errors) {
  std::vector<CurveError> of_blocks;
  for (const LikelyErrors& e : errors) of_blocks.push_back(e.error);
  Evaluation e;
  fitted.with_errors(std::move(of_blocks)).evaluate(z, true, e);
  MatrixXd H = e.J.transpose() * e.J;
  H.diagonal().array() += 12.0;
  return H;
}

/// The errors of a channel's rows in units of its r (factor 1), from fitted channels of its name.
CurveError error_of(const Problem& fitted, const std::vector<LikelyErrors>& errors,
                    const Channel& channel, const VectorXd& r, bool& own) {
  double variance = 0.0, rho = 0.0, count = 0.0;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const Block& b = fitted.blocks()[k];
    const Channel& seen = fitted.targets()[b.target].channels[b.channel];
    if (seen.name != channel.name) continue;
    const double size = std::max(errors[k].error.noise, errors[k].error.discrepancy);
    variance += std::pow(size / b.factor * scale_of(seen), 2);
    rho += errors[k].rho;
    count += 1.0;
  }
  CurveError error;
  const auto n = static_cast<double>(r.size());
  if (count > 0.0) {
    error.noise = std::sqrt(variance / count) / scale_of(channel);
    rho /= count;
    if (rho > 0.0 && n > 1.0) {
      error.discrepancy = error.noise;
      error.noise = 0.0;
      error.length = -1.0 / ((n - 1.0) * std::log(rho));
    }
  } else {
    own = !channel.noise;
    error.noise = own ? std::max(std::sqrt(r.squaredNorm() / n), 1e-4) : 1.0;
  }
  return error;
}

/// ln p of errors e with the covariance of `white` rows and, on top, A Aᵀ, both whitened:
/// ln det(1 + AᵀA) and the quadratic form by Woodbury's identity; without the whitening's own part.
double log_normal(const VectorXd& e, const MatrixXd& A) {
  MatrixXd inner = A.transpose() * A;
  inner.diagonal().array() += 1.0;
  const Eigen::LLT<MatrixXd> root(inner);
  const VectorXd b = A.transpose() * e;
  const MatrixXd lower = root.matrixL();
  return -0.5 * (e.squaredNorm() - b.dot(root.solve(b))) - lower.diagonal().array().log().sum() -
         0.5 * static_cast<double>(e.size()) * log_two_pi;
}

}  // namespace

UnseenTest score_unseen(const Problem& fitted, const VectorXd& z,
                        const std::vector<std::size_t>& targets) {
  UnseenTest test;
  const std::vector<LikelyErrors> errors = likely_errors(fitted, z, Errors::correlated);
  std::vector<bool> others(fitted.targets().size(), true);
  for (const std::size_t k : targets) others[k] = false;
  const Problem unseen = fitted.with_held_out(others).with_loss({});
  Evaluation e;
  unseen.evaluate(z, true, e);
  fitted.account(unseen);
  test.failed = e.failed;
  // C = L⁻ᵀL⁻¹ of C⁻¹ = LLᵀ
  const Eigen::LLT<MatrixXd> root(information(fitted, z, errors));
  MatrixXd all(0, z.size());
  VectorXd white(0);
  double jacobian = 0.0;  // ln of the whitening's determinant, in the channels' units
  for (const Block& b : unseen.blocks()) {
    const Target& target = unseen.targets()[b.target];
    const Channel& channel = target.channels[b.channel];
    UnseenChannel c;
    c.target = b.target;
    c.channel = b.channel;
    c.rows = b.rows;
    const VectorXd r = e.r.segment(b.first, b.rows) / b.factor;
    VectorXd off = r;
    for (Index i = 0; i < b.rows; ++i) off[i] *= scale_of(channel, i);
    c.rms = std::sqrt(off.squaredNorm() / static_cast<double>(b.rows));
    const double range = channel.observed.maxCoeff() - channel.observed.minCoeff();
    c.relative_rms = range > 0.0 ? c.rms / range : std::nan("");
    const CurveError error = error_of(fitted, errors, channel, r, c.own_error);
    const VectorXd alike = VectorXd::Ones(b.rows);
    const VectorXd mine = innovations(error, r, alike);
    const MatrixXd J = innovations(error, e.J.middleRows(b.first, b.rows), alike) / b.factor;
    const MatrixXd A = root.matrixL().solve(J.transpose()).transpose();
    // ln det of the whitening: what its density has beyond that of white rows
    double units = likelihood(error, r, alike).value + 0.5 * mine.squaredNorm();
    for (Index i = 0; i < b.rows; ++i) units -= std::log(scale_of(channel, i));
    c.log_score = log_normal(mine, A) + units;
    test.channels.push_back(c);
    jacobian += units;
    all.conservativeResize(all.rows() + b.rows, Eigen::NoChange);
    all.bottomRows(b.rows) = A;
    white.conservativeResize(white.size() + b.rows);
    white.tail(b.rows) = mine;
  }
  test.log_score = log_normal(white, all) + jacobian;
  return test;
}

LeftOut left_out(const Problem& problem, Optimum optimum, const std::vector<std::size_t>& targets) {
  std::vector<bool> held;
  for (const Target& t : problem.targets()) held.push_back(t.held_out);
  for (const std::size_t k : targets) held[k] = true;
  const Problem without = problem.with_held_out(held);
  LeftOut left;
  left.test = score_unseen(without, optimum.z, targets);
  const Uncertainty u = uncertainty(without, optimum.z);
  for (std::size_t i = 0; i < problem.space().size(); ++i)
    if (!std::isfinite(u.released_error[static_cast<Index>(i)])) left.unknown.push_back(i);
  problem.account(without);
  left.optimum = std::move(optimum);
  return left;
}

LeftOut leave_out(const Problem& problem, const VectorXd& z,
                  const std::vector<std::size_t>& targets, std::string_view algorithm,
                  const OptimiseOptions& options) {
  std::vector<bool> held;
  for (const Target& t : problem.targets()) held.push_back(t.held_out);
  for (const std::size_t k : targets) held[k] = true;
  const Problem without = problem.with_held_out(held);
  Optimum optimum = optimise(without, algorithm, z, options);
  problem.account(without);
  return left_out(problem, std::move(optimum), targets);
}

}  // namespace repose::calibration

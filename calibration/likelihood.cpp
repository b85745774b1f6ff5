#include "calibration/likelihood.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/noise.hpp"
#include "calibration/optimise.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double log_two_pi = 1.8378770664093453;

/// The ρ in [0, most] of the largest ln p: the best of a lattice, then by golden section.
template <class Density>
double best_correlation(double most, const Density& density) {
  constexpr int lattice = 32;
  int best = 0;
  for (int i = 1; i <= lattice; ++i)
    if (density(most * i / lattice) > density(most * best / lattice)) best = i;
  double a = most * std::max(0, best - 1) / lattice,
         b = most * std::min(lattice, best + 1) / lattice;
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  while (b - a > 1e-10) {
    const double low = b - golden * (b - a), high = a + golden * (b - a);
    (density(low) >= density(high) ? b : a) = density(low) >= density(high) ? high : low;
  }
  const double inside = 0.5 * (a + b);
  return density(inside) > density(0.0) ? inside : 0.0;
}

/// ln p(y) − ln p(r): r of a row is factor/scale times its y.
double log_units(const Problem& problem) {
  double sum = 0.0;
  for (const Block& b : problem.blocks()) {
    const Channel& channel = problem.targets()[b.target].channels[b.channel];
    for (Index i = 0; i < b.rows; ++i) sum += std::log(b.factor / scale_of(channel, i));
  }
  return sum;
}

}  // namespace

LikelyErrors likely_errors(const VectorXd& r, double least, Errors errors) {
  const auto n = static_cast<double>(r.size());
  LikelyErrors likely;
  const auto size = [&](double rho) {
    return std::max(std::sqrt(whitened(r, rho).squaredNorm() / n), least);
  };
  const auto density = [&](double rho) {
    const double tau = size(rho);
    return -n * std::log(tau) - 0.5 * whitened(r, rho).squaredNorm() / (tau * tau) -
           0.5 * (n - 1.0) * std::log(1.0 - rho * rho);
  };
  if (errors == Errors::correlated && r.size() >= 4)
    likely.rho = best_correlation((n - 1.0) / (n + 1.0), density);
  likely.log_density = density(likely.rho) - 0.5 * n * log_two_pi;
  likely.effective_rows = n * (1.0 - likely.rho) / (1.0 + likely.rho);
  likely.error.noise = size(likely.rho);
  if (likely.rho > 0.0) {
    likely.error.discrepancy = likely.error.noise;
    likely.error.noise = 0.0;
    likely.error.length = -1.0 / ((n - 1.0) * std::log(likely.rho));
  }
  return likely;
}

std::vector<LikelyErrors> likely_errors(const Problem& problem, const VectorXd& z, Errors errors) {
  Evaluation e;
  problem.with_loss({}).evaluate(z, false, e);
  std::vector<LikelyErrors> list;
  for (const Block& b : problem.blocks()) {
    const Channel& channel = problem.targets()[b.target].channels[b.channel];
    const double range = channel.observed.maxCoeff() - channel.observed.minCoeff();
    const double least =
        channel.noise ? 1.0 : 1e-4 * (range > 0.0 ? range : scale_of(channel)) / scale_of(channel);
    list.push_back(likely_errors(e.r.segment(b.first, b.rows), b.factor * least, errors));
  }
  return list;
}

double Likelihood::aic() const {
  return -2.0 * log_likelihood + 2.0 * static_cast<double>(parameters);
}

double Likelihood::aicc() const {
  const auto k = static_cast<double>(parameters), n = static_cast<double>(rows);
  return n > k + 1.0 ? aic() + 2.0 * k * (k + 1.0) / (n - k - 1.0) : std::nan("");
}

double Likelihood::bic() const {
  return -2.0 * log_likelihood +
         static_cast<double>(parameters) * std::log(static_cast<double>(rows));
}

Likelihood most_likely(const Problem& problem, const VectorXd& z, Errors errors) {
  constexpr int most_turns = 200;
  constexpr double small_rise = 1e-9;
  Likelihood l;
  l.z = z;
  l.rows = problem.data_rows();
  l.at_the_fit =
      std::any_of(problem.targets().begin(), problem.targets().end(),
                  [](const Target& t) { return !t.held_out && !t.simulator->has_derivatives(); });
  const double units = log_units(problem);
  double before = -std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < most_turns; ++turn) {
    const std::vector<LikelyErrors> likely = likely_errors(problem, l.z, errors);
    l.log_likelihood = units;
    l.effective_rows = 0.0;
    std::vector<CurveError> of_blocks;
    for (const LikelyErrors& c : likely) {
      l.log_likelihood += c.log_density;
      l.effective_rows += c.effective_rows;
      of_blocks.push_back(c.error);
    }
    const Problem whitened = problem.with_errors(std::move(of_blocks));
    VectorXd priors(static_cast<Index>(problem.space().prior_count()));
    problem.space().priors(l.z, priors, nullptr);
    const double now = l.log_likelihood - 0.5 * priors.squaredNorm();
    if (l.at_the_fit || problem.interrupted() || !(now - before > small_rise)) break;
    before = now;
    l.z = levenberg_marquardt(whitened, l.z).z;
    problem.account(whitened);
  }
  l.parameters = problem.parameters();
  for (const Block& b : problem.blocks())
    l.parameters += errors == Errors::correlated && b.rows >= 4 ? 2 : 1;
  return l;
}

std::vector<double> akaike_weights(const std::vector<double>& criteria) {
  double least = std::numeric_limits<double>::infinity(), sum = 0.0;
  for (const double c : criteria)
    if (c < least) least = c;
  std::vector<double> weights;
  for (const double c : criteria) {
    weights.push_back(std::isnan(c) ? 0.0 : std::exp(-0.5 * (c - least)));
    sum += weights.back();
  }
  for (double& w : weights) w /= sum;
  return weights;
}

}  // namespace repose::calibration

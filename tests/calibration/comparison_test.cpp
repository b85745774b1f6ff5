// Which law: criteria and predictions of unseen tests where they are known in closed form.

#include <random>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "calibration/likelihood.hpp"
#include "calibration/unseen.hpp"
#include "tests/calibration/toy.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double two_pi = 6.283185307179586;
constexpr double width = 20.0;  // of both parameters' bounds

/// y = 1 + slope x + noise, rows 0 … n − 1 at x = i/n, cut into tests of `each` rows.
std::vector<Target> line_targets(Index n, Index each, double slope, std::uint64_t seed,
                                 bool with_slope = true) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Target> targets;
  for (Index from = 0; from < n; from += each) {
    std::vector<double> x;
    for (Index i = from; i < from + each; ++i)
      x.push_back(static_cast<double>(i) / static_cast<double>(n));
    Target t;
    t.name = "line " + std::to_string(from);
    t.simulator = std::make_shared<Line>(x);
    t.inputs = {0.0, 0.0};
    t.bindings = {{0, 0}};
    if (with_slope) t.bindings.push_back({1, 1});
    t.x = Eigen::Map<const VectorXd>(x.data(), each);
    Channel c;
    c.name = "y";
    c.observed = (1.0 + slope * t.x.array()).matrix();
    for (double& y : c.observed) y += 0.1 * normal(random);
    t.channels.push_back(c);
    targets.push_back(t);
  }
  return targets;
}

ParameterSpace line_space(bool with_slope = true) {
  std::vector<FreeParameter> free{free_parameter("a", -0.5 * width, 0.5 * width)};
  if (with_slope) free.push_back(free_parameter("b", -0.5 * width, 0.5 * width));
  return ParameterSpace(free);
}

VectorXd best_of(const Problem& problem) {
  return levenberg_marquardt(problem, problem.space().start()).z;
}

/// Rows of y and of the regressors of all targets.
struct Regression {
  MatrixXd X;
  VectorXd y;
};
Regression regression(const std::vector<Target>& targets) {
  Regression all;
  for (const Target& t : targets) {
    const Index n = all.y.size();
    all.X.conservativeResize(n + t.rows(), 2);
    all.y.conservativeResize(n + t.rows());
    all.X.bottomRows(t.rows()).col(0).setOnes();
    all.X.bottomRows(t.rows()).col(1) = t.x;
    all.y.tail(t.rows()) = t.channels[0].observed;
  }
  return all;
}

TEST(Comparison, CriteriaOfALineAreTheTextbooks) {
  const std::vector<Target> targets = line_targets(20, 20, 2.0, 3);
  const Problem problem(line_space(), targets);
  const Likelihood l = most_likely(problem, best_of(problem), Errors::white);
  const Regression all = regression(targets);
  const VectorXd b = (all.X.transpose() * all.X).ldlt().solve(all.X.transpose() * all.y);
  const double rss = (all.y - all.X * b).squaredNorm(), n = 20.0, k = 3.0;
  const double log_likelihood = -0.5 * n * (std::log(two_pi * rss / n) + 1.0);
  // the optimum is met to 1e-9 of z, of which the likelihood is a quadratic
  EXPECT_NEAR(l.log_likelihood, log_likelihood, 1e-9);
  EXPECT_EQ(l.parameters, 3);
  EXPECT_NEAR(l.aic(), -2.0 * log_likelihood + 2.0 * k, 1e-9);
  EXPECT_NEAR(l.aicc(), l.aic() + 2.0 * k * (k + 1.0) / (n - k - 1.0), 1e-12);
  EXPECT_NEAR(l.bic(), -2.0 * log_likelihood + k * std::log(n), 1e-9);
  const std::vector<double> weights = akaike_weights({10.0, 12.0, std::nan("")});
  EXPECT_NEAR(weights[0], 1.0 / (1.0 + std::exp(-1.0)), 1e-15);
  EXPECT_EQ(weights[2], 0.0);
}

/// ln p by the dense covariance τ² ρ^|i − j|.
double dense_log_density(const VectorXd& r, double tau, double rho) {
  const Index n = r.size();
  MatrixXd C(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      C(i, j) = tau * tau * std::pow(rho, std::abs(static_cast<double>(i - j)));
  const Eigen::LLT<MatrixXd> root(C);
  const MatrixXd lower = root.matrixL();
  return -0.5 * r.dot(root.solve(r)) - lower.diagonal().array().log().sum() -
         0.5 * static_cast<double>(n) * std::log(two_pi);
}

TEST(Comparison, CorrelatedErrorsAreTheMostLikelyOnes) {
  std::mt19937_64 random(5);
  CurveError truth;
  truth.noise = 0.0;
  truth.discrepancy = 0.3;
  truth.length = -1.0 / (59.0 * std::log(0.7));
  const VectorXd r = drawn_error(truth, VectorXd::Ones(60), random);
  const LikelyErrors likely = likely_errors(r, 1e-9, Errors::correlated);
  const double tau = likely.error.discrepancy;
  EXPECT_NEAR(likely.log_density, dense_log_density(r, tau, likely.rho), 1e-9);
  // three standard deviations of ρ, √((1 − ρ²)/n)
  EXPECT_NEAR(likely.rho, 0.7, 0.28);
  for (const double more : {0.999, 1.001}) {
    EXPECT_LT(dense_log_density(r, more * tau, likely.rho), likely.log_density);
    EXPECT_LT(dense_log_density(r, tau, more * likely.rho), likely.log_density);
  }
  EXPECT_NEAR(likely.effective_rows, 60.0 * (1.0 - likely.rho) / (1.0 + likely.rho), 1e-12);
  const LikelyErrors white = likely_errors(r, 1e-9, Errors::white);
  EXPECT_NEAR(white.log_density, dense_log_density(r, white.error.noise, 0.0), 1e-9);
  EXPECT_LT(white.log_density, likely.log_density);
}

TEST(Comparison, ATestLeftOutIsPredictedAsTheHatMatrixSays) {
  const std::vector<Target> targets = line_targets(15, 3, 2.0, 7);
  const Regression all = regression(targets);
  const MatrixXd hat =
      all.X * (all.X.transpose() * all.X).ldlt().solve(MatrixXd(all.X.transpose()));
  const VectorXd residual = all.y - hat * all.y;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    // every channel counts in units of its range: make them alike
    std::vector<Target> alike = targets;
    for (Target& t : alike) t.channels[0].noise = 0.1;
    const Problem even(line_space(), alike, false);
    const LeftOut left = leave_out(even, best_of(even), {k}, levenberg_marquardt_name, {});
    const auto from = static_cast<Index>(3 * k);
    // PRESS by blocks: e_(k) = (1 − H_kk)⁻¹ e_k (Allen 1974)
    const MatrixXd own = MatrixXd::Identity(3, 3) - hat.block(from, from, 3, 3);
    const VectorXd expected = own.ldlt().solve(residual.segment(from, 3));
    EXPECT_NEAR(left.test.channels[0].rms, std::sqrt(expected.squaredNorm() / 3.0), 1e-8);
    // its density: σ² of the others (declared: 0.1 at least), widened by what they leave of a and b
    double variance = 0.0;
    MatrixXd rest(0, 2);
    VectorXd y(0);
    for (std::size_t j = 0; j < targets.size(); ++j) {
      if (j == k) continue;
      const auto at = static_cast<Index>(3 * j);
      rest.conservativeResize(rest.rows() + 3, 2);
      rest.bottomRows(3) = all.X.middleRows(at, 3);
      y.conservativeResize(y.size() + 3);
      y.tail(3) = all.y.segment(at, 3);
    }
    const VectorXd b = (rest.transpose() * rest).ldlt().solve(rest.transpose() * y);
    MatrixXd inverse = MatrixXd::Identity(2, 2) * 12.0 / (width * width);
    for (Index j = 0; j < rest.rows(); j += 3) {
      const double seen = (y.segment(j, 3) - rest.middleRows(j, 3) * b).squaredNorm() / 3.0;
      const double own_variance = std::max(seen, 0.01);
      variance += own_variance / 4.0;
      inverse += rest.middleRows(j, 3).transpose() * rest.middleRows(j, 3) / own_variance;
    }
    const MatrixXd X = all.X.middleRows(from, 3);
    const MatrixXd C = variance * MatrixXd::Identity(3, 3) + X * inverse.inverse() * X.transpose();
    const double score = -0.5 * expected.dot(C.ldlt().solve(expected)) -
                         0.5 * std::log(C.determinant()) - 1.5 * std::log(two_pi);
    EXPECT_NEAR(left.test.log_score, score, 1e-6);
    EXPECT_NEAR(left.test.channels[0].log_score, score, 1e-6);
    EXPECT_TRUE(left.unknown.empty());
  }
}

TEST(Comparison, WhatOnlyTheTestLeftOutTellsIsNamed) {
  // the first test stands at x = 0 alone, where b does nothing
  std::vector<Target> targets = line_targets(12, 6, 2.0, 9);
  std::vector<double> zero(6, 0.0);
  targets[0].simulator = std::make_shared<Line>(zero);
  targets[0].x.setZero();
  const Problem problem(line_space(), targets);
  const LeftOut left = leave_out(problem, best_of(problem), {1}, levenberg_marquardt_name, {});
  EXPECT_EQ(left.unknown, std::vector<std::size_t>{1});
}

/// How often the larger of two nested laws (constant, line) has the smaller criterion.
struct Votes {
  double aic = 0.0, bic = 0.0;
};
Votes votes(double slope, int sets) {
  Votes votes;
  for (int s = 0; s < sets; ++s) {
    const auto seed = static_cast<std::uint64_t>(100 + s);
    const Problem small(line_space(false), line_targets(100, 100, slope, seed, false));
    const Problem large(line_space(), line_targets(100, 100, slope, seed));
    const Likelihood a = most_likely(small, best_of(small), Errors::white),
                     b = most_likely(large, best_of(large), Errors::white);
    votes.aic += b.aic() < a.aic() ? 1.0 : 0.0;
    votes.bic += b.bic() < a.bic() ? 1.0 : 0.0;
  }
  return votes;
}

TEST(Comparison, NestedLawsAreToldApart) {
  // Without a slope 2 Δ ln L is χ² of one degree: above 2 in 15.7 %, above ln 100 in 3.2 % (Wilks
  // 1938; its own error at n = 100 is below 1 %). Three standard deviations of 300 draws and that
  // 1 %: 7.3 and 4.1 %.
  const int sets = 300;
  const Votes without = votes(0.0, sets);
  EXPECT_NEAR(without.aic / sets, 0.157, 0.073);
  EXPECT_NEAR(without.bic / sets, 0.032, 0.041);
  // a slope of 0.3 is 0.3 √(100/12)/0.1 = 8.7 standard errors: χ² below 4.6 is 6.5 of them away
  const Votes with = votes(0.3, 50);
  EXPECT_EQ(with.aic, 50.0);
  EXPECT_EQ(with.bic, 50.0);
}

}  // namespace
}  // namespace repose::calibration

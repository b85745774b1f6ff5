// Sensitivity indices of functions whose indices are known in closed form.
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "calibration/quantiles.hpp"
#include "study/sensitivity/chaos.hpp"
#include "study/sensitivity/low_discrepancy.hpp"
#include "study/sensitivity/morris.hpp"

namespace repose::study {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Function = std::function<double(const VectorXd&)>;  // of a point in the unit cube

VectorXd values_of(const Function& f, const MatrixXd& points) {
  VectorXd y(points.rows());
  for (Index i = 0; i < y.size(); ++i) y[i] = f(points.row(i).transpose());
  return y;
}

MatrixXd spread(int inputs, int points, std::uint64_t seed) {
  const LowDiscrepancy sequence(static_cast<std::size_t>(inputs), seed);
  MatrixXd u(points, inputs);
  for (int i = 0; i < points; ++i)
    u.row(i) = sequence.point(static_cast<std::uint32_t>(i)).transpose();
  return u;
}

/// The shares of variance that are known.
struct Known {
  VectorXd first, total;
};

/// sin x1 + a sin² x2 + b x3⁴ sin x1 over [−π, π]³ (Ishigami & Homma 1990), a = 7, b = 0.1.
constexpr double a = 7.0, b = 0.1;
double ishigami(const VectorXd& u) {
  const VectorXd x = std::numbers::pi * (2.0 * u.array() - 1.0);
  return std::sin(x[0]) + a * std::pow(std::sin(x[1]), 2) + b * std::pow(x[2], 4) * std::sin(x[0]);
}
Known of_ishigami() {
  const double pi4 = std::pow(std::numbers::pi, 4);
  const double v1 = 0.5 * std::pow(1.0 + b * pi4 / 5.0, 2), v2 = a * a / 8.0;
  const double v13 = 8.0 * b * b * pi4 * pi4 / 225.0, v = v1 + v2 + v13;
  return {VectorXd{{v1, v2, 0.0}} / v, VectorXd{{v1 + v13, v2, v13}} / v};
}

/// Π (|4 u_j − 2| + a_j)/(1 + a_j) (Sobol' 1993)
const VectorXd g_weights{{0.0, 1.0, 4.5, 9.0}};
double g_function(const VectorXd& u) {
  return ((4.0 * u.array() - 2.0).abs() + g_weights.array()).prod() /
         (1.0 + g_weights.array()).prod();
}
Known of_g_function() {
  const Eigen::ArrayXd v = (3.0 * (1.0 + g_weights.array()).square()).inverse();
  const double all = (1.0 + v).prod(), variance = all - 1.0;
  return {v / variance, v * all / (1.0 + v) / variance};
}

const VectorXd slopes{{1.0, -2.0, 0.5, 0.0}};
double linear(const VectorXd& u) { return 3.0 + slopes.dot(u); }
Known of_linear() {
  const VectorXd shares = slopes.array().square() / slopes.squaredNorm();
  return {shares, shares};
}

void expect_shares(const std::vector<VarianceShares>& found, const Known& known, double tolerance) {
  ASSERT_EQ(static_cast<Index>(found.size()), known.first.size());
  for (Index j = 0; j < known.first.size(); ++j) {
    const VarianceShares& one = found[static_cast<std::size_t>(j)];
    EXPECT_NEAR(one.first.value, known.first[j], tolerance) << "first order, input " << j;
    EXPECT_NEAR(one.total.value, known.total[j], tolerance) << "total, input " << j;
    for (const Bounded& share : {one.first, one.total})
      EXPECT_LE(share.interval_95[0], share.interval_95[1]);
  }
}

std::vector<VarianceShares> by_differences(const Function& f, int inputs, int blocks,
                                           std::uint64_t seed = 1) {
  return variance_shares(inputs, values_of(f, variance_points(inputs, blocks, seed)), seed);
}

TEST(LowDiscrepancy, EveryPowerOfTwoIsStratifiedAlongEveryAxis) {
  constexpr int dimensions = 40, points = 1 << 10;
  const MatrixXd u = spread(dimensions, points, 7);
  for (Index d = 0; d < dimensions; ++d)
    for (const int n : {16, 256, points}) {
      std::vector<int> held(static_cast<std::size_t>(n));
      for (Index i = 0; i < n; ++i) ++held[static_cast<std::size_t>(u(i, d) * n)];
      EXPECT_EQ(std::count(held.begin(), held.end(), 1), n) << "axis " << d;
    }
  EXPECT_GT(u.minCoeff(), 0.0);
  EXPECT_LT(u.maxCoeff(), 1.0);
}

TEST(LowDiscrepancy, PlanesAreEven) {
  // Two dimensions of a (t, s)-sequence cannot all have t = 0; with two polynomials of degree s the
  // sequence of the pair has t ≤ 2 (s − 1) (Sobol' 1967), 12 for degree 7. What the search finds:
  const LowDiscrepancy sequence(40, 0);
  int worst = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < 40; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const int t = 10 - sequence.strength(i, j, 10);
      worst = std::max(worst, t);
      sum += t;
    }
  EXPECT_EQ(10 - sequence.strength(0, 1, 10), 0);
  EXPECT_LE(worst, 7);
  EXPECT_LT(sum / 780.0, 4.0);
}

TEST(LowDiscrepancy, AnIntegralConvergesFasterThanByChance) {
  // ∫ Π (1 + (u − ½)) du = 1; n = 4096 points by chance: s.d. √((13/12)⁴ − 1)/64 = 0.0096
  const MatrixXd u = spread(4, 4096, 3);
  double sum = 0.0;
  for (Index i = 0; i < u.rows(); ++i) sum += (u.row(i).array() + 0.5).prod();
  EXPECT_NEAR(sum / 4096.0, 1.0, 1e-4);
}

// 4096 blocks: the s.d. by chance would be about 0.02; scrambled points are some five times better.
TEST(SobolIndices, Ishigami) {
  expect_shares(by_differences(ishigami, 3, 4096), of_ishigami(), 0.01);
}
TEST(SobolIndices, GFunction) {
  expect_shares(by_differences(g_function, 4, 4096), of_g_function(), 0.01);
}
TEST(SobolIndices, Linear) { expect_shares(by_differences(linear, 4, 4096), of_linear(), 0.01); }

TEST(SobolIndices, IntervalsHoldTheTruth) {
  // 20 seeds × 6 shares of 256 blocks; at least 95 % wanted, and so many draws scatter by 2 %
  const Known known = of_ishigami();
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto found = by_differences(ishigami, 3, 256, seed);
    for (Index j = 0; j < 3; ++j)
      for (const auto& [share, truth] :
           {std::pair{found[static_cast<std::size_t>(j)].first, known.first[j]},
            {found[static_cast<std::size_t>(j)].total, known.total[j]}})
        held += share.interval_95[0] <= truth && truth <= share.interval_95[1] ? 1 : 0;
  }
  EXPECT_GE(held, 108);  // 90 % of 120
}

TEST(SobolIndices, ABlockWithAFailedRunIsLeftOut) {
  MatrixXd points = variance_points(3, 64, 1);
  VectorXd y = values_of(ishigami, points);
  const VectorXd whole = y.tail(63 * 5);
  y[3] = std::nan("");
  const auto one = variance_shares(3, y, 1), other = variance_shares(3, whole, 1);
  for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(one[j].total.value, other[j].total.value);
  EXPECT_TRUE(std::isnan(variance_shares(3, VectorXd::Constant(320, 2.0), 1)[0].first.value))
      << "an output that does not vary has no shares";
}

constexpr std::array uniform{Orthonormal::legendre, Orthonormal::legendre, Orthonormal::legendre,
                             Orthonormal::legendre};

TEST(Chaos, Ishigami) {
  const MatrixXd u = spread(3, 512, 1);
  const PolynomialChaos chaos(u, std::span(uniform).first(3), values_of(ishigami, u));
  EXPECT_GT(chaos.q2(), 0.999);
  expect_shares(chaos.shares(1), of_ishigami(), 0.01);
}

TEST(Chaos, ItsOwnErrorIsThatOfNewPoints) {
  const MatrixXd u = spread(3, 128, 2), fresh = spread(3, 2048, 99);
  const PolynomialChaos chaos(u, std::span(uniform).first(3), values_of(ishigami, u));
  const VectorXd y = values_of(ishigami, fresh);
  double missed = 0.0;
  for (Index i = 0; i < y.size(); ++i)
    missed += std::pow(y[i] - chaos(fresh.row(i).transpose()), 2);
  const double variance = (y.array() - y.mean()).square().sum();
  // A mean over 128 squares is within a factor 2 of the truth; the correction for few points, n/(n
  // − P) (1 + tr), is 4 or more with half as many terms as points, and errs on the safe side.
  EXPECT_LT((1.0 - chaos.q2()) / (missed / variance), 8.0);
  EXPECT_GT((1.0 - chaos.q2()) / (missed / variance), 0.5);
}

TEST(Chaos, APolynomialIsFoundExactly) {
  // (2 u_0 − 1) ψ of degree 1 has variance 1/3; u_0² u_1 and a normal input's square
  const MatrixXd u = spread(4, 64, 1);
  const PolynomialChaos line(u, uniform, values_of(linear, u));
  EXPECT_EQ(line.degree(), 1);
  EXPECT_NEAR(line.q2(), 1.0, 1e-12);
  expect_shares(line.shares(1), of_linear(), 1e-12);

  // y = ξ_0 + ξ_1² − 1, ξ standard normal: variances 1 and 2
  constexpr std::array normal{Orthonormal::hermite, Orthonormal::hermite};
  const MatrixXd v = spread(2, 64, 1);
  const PolynomialChaos square(v, normal,
                               values_of(
                                   [](const VectorXd& p) {
                                     return calibration::normal_quantile(p[0]) +
                                            std::pow(calibration::normal_quantile(p[1]), 2) - 1.0;
                                   },
                                   v));
  EXPECT_NEAR(square.variance(), 3.0, 1e-8);
  EXPECT_NEAR(square.mean(), 0.0, 1e-8);
  const VectorXd shares{{1.0 / 3.0, 2.0 / 3.0}};
  expect_shares(square.shares(1), {shares, shares}, 1e-8);
}

TEST(Chaos, IntervalsHoldWhatTheNoiseHides) {
  // y = u_0 + noise of a quarter of its standard deviation, by a hash of the point
  const MatrixXd u = spread(2, 64, 5);
  VectorXd y(64);
  for (Index i = 0; i < 64; ++i)
    y[i] = u(i, 0) +
           0.07 * std::sqrt(12.0) *
               (static_cast<double>(mixed(static_cast<std::uint64_t>(i)) >> 11) * 0x1p-53 - 0.5);
  const PolynomialChaos chaos(u, std::span(uniform).first(2), y);
  const auto shares = chaos.shares(1);
  EXPECT_LE(shares[1].total.interval_95[0], 0.0) << "u_1 may do nothing";
  EXPECT_LT(shares[1].total.interval_95[1], 0.1);
  EXPECT_LT(chaos.q2(), 0.98);
}

TEST(Morris, OfALinearFunctionExactly) {
  const MatrixXd points = morris_points(4, 10, 4, 1);
  EXPECT_GE(points.minCoeff(), 0.0);
  EXPECT_LE(points.maxCoeff(), 1.0 + 1e-12);
  const auto effects = elementary_effects(points, values_of(linear, points), 1);
  for (Index j = 0; j < 4; ++j) {
    const ElementaryEffects& one = effects[static_cast<std::size_t>(j)];
    // differences of values of size 3 over Δ = 2/3: a few round-offs of 4e-16
    EXPECT_NEAR(one.mean, slopes[j], 1e-14);
    EXPECT_NEAR(one.mean_size.value, std::abs(slopes[j]), 1e-14);
    EXPECT_NEAR(one.spread.value, 0.0, 1e-14);
    EXPECT_EQ(one.count, 10);
  }
}

TEST(Morris, AMonotoneFunctionIsRankedRightAndItsCurvatureSeen) {
  // over the cube, e^{2u} rises by 6.4, u³ by 1, and the third by 0.1
  const MatrixXd points = morris_points(3, 20, 6, 4);
  const auto effects = elementary_effects(
      points,
      values_of(
          [](const VectorXd& u) { return std::exp(2.0 * u[0]) + std::pow(u[1], 3) + 0.1 * u[2]; },
          points),
      1);
  EXPECT_GT(effects[0].mean_size.value, effects[1].mean_size.value);
  EXPECT_GT(effects[1].mean_size.value, effects[2].mean_size.value);
  EXPECT_GT(effects[0].spread.value, 0.5);
  EXPECT_NEAR(effects[2].spread.value, 0.0, 1e-13);
  for (const ElementaryEffects& one : effects) {
    EXPECT_EQ(one.mean, one.mean_size.value) << "monotone: |effect| = effect";
    EXPECT_LE(one.mean_size.interval_95[0], one.mean_size.value + 1e-13);
    EXPECT_GE(one.mean_size.interval_95[1], one.mean_size.value - 1e-13);
  }
}

TEST(Morris, AFailedRunTakesItsEffectsAlone) {
  const MatrixXd points = morris_points(4, 10, 4, 1);
  VectorXd y = values_of(linear, points);
  y[2] = std::nan("");  // between two moves
  const auto effects = elementary_effects(points, y, 1);
  Index count = 0;
  for (Index j = 0; j < 4; ++j) {
    count += effects[static_cast<std::size_t>(j)].count;
    EXPECT_NEAR(effects[static_cast<std::size_t>(j)].mean, slopes[j], 1e-14);
  }
  EXPECT_EQ(count, 38);
}

TEST(Morris, MoreTrajectoriesKeepThoseThereAre) {
  const MatrixXd few = morris_points(3, 5, 4, 2), more = morris_points(3, 9, 4, 2);
  EXPECT_EQ(few, more.topRows(few.rows()));
  EXPECT_EQ(variance_points(3, 5, 2), variance_points(3, 9, 2).topRows(25));
}

}  // namespace
}  // namespace repose::study

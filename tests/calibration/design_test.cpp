// Which test next: what candidates would teach, where it is known in closed form and where the test
// is then made.

#include "calibration/design.hpp"

#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "study/fit/twin.hpp"
#include "tests/calibration/toy.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double width = 10.0;  // of both parameters' bounds

/// Rows of y = 1 + 2x at these x, with a declared noise.
Target line_target(const std::vector<double>& x, double noise, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  Target t;
  t.name = "line";
  t.simulator = std::make_shared<Line>(x);
  t.inputs = {0.0, 0.0};
  t.bindings = {{0, 0}, {1, 1}};
  t.x = Eigen::Map<const VectorXd>(x.data(), static_cast<Index>(x.size()));
  Channel c;
  c.name = "y";
  c.noise = noise;
  c.observed = (1.0 + 2.0 * t.x.array()).matrix();
  if (seed > 0)
    for (double& y : c.observed) y += normal(random);
  t.channels.push_back(c);
  return t;
}

MatrixXd information_of(const Target& t) {
  MatrixXd X(t.rows(), 2);
  X.col(0).setOnes();
  X.col(1) = t.x;
  return X.transpose() * X / std::pow(*t.channels[0].noise, 2);
}

/// Two curves of three rows: too few to be taken for correlated.
std::vector<Target> measured() {
  return {line_target({0.0, 0.4, 0.8}, 0.1, 3), line_target({0.2, 0.6, 1.0}, 0.1, 4)};
}

ParameterSpace line_space() {
  return ParameterSpace(
      {free_parameter("a", -0.5 * width, 0.5 * width), free_parameter("b", 0.0, width)});
}

TEST(Design, OfALineIsTheTextbooks) {
  const Problem problem(line_space(), measured(), false);
  const VectorXd z = levenberg_marquardt(problem, problem.space().start()).z;
  const Uncertainty at = uncertainty(problem, z);
  const std::vector<Target> candidates{line_target({0.0, 0.0}, 0.1, 0),
                                       line_target({2.0, 3.0}, 0.1, 0), line_target({3.0}, 1.0, 0)};
  const MatrixXd before = information_of(measured()[0]) + information_of(measured()[1]);
  const Design found = design(problem, at, z, candidates);
  ASSERT_EQ(found.candidates.size(), 3u);
  double last = std::numeric_limits<double>::infinity();
  for (const Taught& t : found.candidates) {
    const MatrixXd after = before + information_of(candidates[t.candidate]);
    EXPECT_NEAR(t.gain, 0.5 * std::log(after.determinant() / before.determinant()), 1e-9);
    const MatrixXd from = before.inverse(), to = after.inverse();
    for (Index i = 0; i < 2; ++i)
      EXPECT_NEAR(t.narrower[i], std::sqrt(to(i, i) / from(i, i)), 1e-9);
    EXPECT_LE(t.gain, last);
    last = t.gain;
  }
  // far out tells the slope, at 0 the intercept
  EXPECT_EQ(found.candidates.front().candidate, 1u);
  EXPECT_EQ(found.candidates.front().most, 1u);
  // one after another: each is the best beside those before it
  ASSERT_EQ(found.sequence.size(), 3u);
  MatrixXd known = before;
  for (const Taught& t : found.sequence) {
    const double gain = [&] {
      double best = 0.0;
      for (const Target& c : candidates)
        best = std::max(
            best, 0.5 * std::log((known + information_of(c)).determinant() / known.determinant()));
      return best;
    }();
    EXPECT_NEAR(t.gain, gain, 1e-9);
    known += information_of(candidates[t.candidate]);
  }
}

TEST(Design, TheWidthItForetellsIsTheOneThatTheFitThenFinds) {
  std::vector<Target> targets = measured();
  const Problem problem(line_space(), targets, false);
  const VectorXd z = levenberg_marquardt(problem, problem.space().start()).z;
  const Uncertainty at = uncertainty(problem, z);
  Target next = line_target({2.0, 3.0, 4.0}, 0.1, 0);
  const Design found = design(problem, at, z, {next});
  // the test is made, and shows the curve of the fit itself
  const VectorXd values = problem.space().values(z);
  next.channels[0].observed = (values[0] + values[1] * next.x.array()).matrix();
  targets.push_back(next);
  const Problem both(line_space(), targets, false);
  const Uncertainty then = uncertainty(both, levenberg_marquardt(both, z).z);
  for (Index i = 0; i < 2; ++i)
    EXPECT_NEAR(found.candidates[0].narrower[i] * at.standard_error[i], then.standard_error[i],
                1e-9 * then.standard_error[i]);
}

/// A noise of half a per cent of the range is declared, and half of it is there, in patterns that
/// correlate neither along the rows (by more than 0) nor with each other: + − + − …, and the same
/// with the other sign in the second half.
Target clay_target(const study::Twin& twin, const study::TwinTest& test) {
  Target t = study::measure(twin, test);
  for (std::size_t c = 0; c < t.channels.size(); ++c) {
    Channel& channel = t.channels[c];
    channel.noise = 0.005 * (channel.observed.maxCoeff() - channel.observed.minCoeff());
    for (Index i = 0; i < t.rows(); ++i)
      channel.observed[i] += 0.5 * *channel.noise * (i % 2 == 0 ? 1.0 : -1.0) *
                             (c == 1 && i >= t.rows() / 2 ? -1.0 : 1.0);
  }
  return t;
}

TEST(Design, CompressionAloneLearnsTheStrengthFromShear) {
  const study::Twin twin = study::cam_clay_twin();
  const std::vector<study::TwinTest> tests = study::cam_clay_tests();
  const Target compression = clay_target(twin, tests[0]), shear = clay_target(twin, tests[1]);
  const ParameterSpace space(twin.free);
  const Problem problem(space, {compression}, false);
  const VectorXd z = space.coordinates(twin.truth_vector());
  const Uncertainty at = uncertainty(problem, z);
  EXPECT_FALSE(std::isfinite(at.standard_error[0]));  // M
  const Design found = design(problem, at, z, {compression, shear});
  const Taught& best = found.candidates.front();
  EXPECT_EQ(best.candidate, 1u);
  EXPECT_EQ(best.most, 0u);
  EXPECT_GT(best.gain, 3.0 * found.candidates.back().gain);
  EXPECT_EQ(found.sequence.front().candidate, 1u);
  // compression again tells nothing of M
  EXPECT_NEAR(found.candidates.back().narrower[0], 1.0, 1e-6);

  const Problem both(space, {compression, shear}, false);
  const Uncertainty then = uncertainty(both, z);
  const MatrixXd S = space.slopes(z);
  const MatrixXd before = S * at.information.inverse() * S.transpose();
  for (Index i = 0; i < z.size(); ++i) {
    // what the bounds told before stays in the prediction and not in the fit: 12 of the information
    // of a coordinate, of which no value has more than 1e-3 of its bounds for a standard error
    const double foretold = best.narrower[i] * std::sqrt(before(i, i));
    EXPECT_NEAR(foretold / then.standard_error[i], 1.0, 1e-2) << i;
  }
}

}  // namespace
}  // namespace repose::calibration

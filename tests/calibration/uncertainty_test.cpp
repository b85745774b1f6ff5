// Covariance, intervals, identifiability, profiles and bootstrap where the answers are known.

#include "calibration/uncertainty.hpp"

#include <gtest/gtest.h>

#include "study/fit/twin.hpp"
#include "tests/calibration/toy.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<double> line_x(int n) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(i / (n - 1.0));
  return x;
}

/// y = 1 + 2x + noise of 0.1
Problem line_problem(int n, bool declare, std::uint64_t seed, double noise = 0.1) {
  Target t;
  t.name = "line";
  const auto x = line_x(n);
  t.simulator = std::make_shared<Line>(x);
  t.inputs = {0.0, 0.0};
  t.bindings = {{0, 0}, {1, 1}};
  t.x_name = "x";
  t.x = Eigen::Map<const VectorXd>(x.data(), n);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  Channel c;
  c.name = "y";
  c.observed = t.x;
  for (double& y : c.observed) y = 1.0 + 2.0 * y + normal(random);
  if (declare) c.noise = noise;
  t.channels.push_back(c);
  return Problem(ParameterSpace({free_parameter("a", -5.0, 5.0), free_parameter("b", 0.1, 10.0)}),
                 {t});
}

Uncertainty fitted(const Problem& problem, VectorXd* z = nullptr) {
  const Optimum o = levenberg_marquardt(problem, VectorXd::Constant(problem.parameters(), 0.5));
  if (z != nullptr) *z = o.z;
  return uncertainty(problem, o.z);
}

TEST(Uncertainty, OfALineIsTheTextbooks) {
  const int n = 40;
  const Problem problem = line_problem(n, true, 1);
  const Uncertainty u = fitted(problem);
  double sx = 0.0, sxx = 0.0;
  for (const double x : line_x(n)) {
    sx += x;
    sxx += x * x;
  }
  const double det = n * sxx - sx * sx;
  // ordinary least squares with σ = 0.1: Var a = σ² Σx²/det, Var b = σ² n/det, Cov = −σ² Σx/det
  EXPECT_NEAR(u.standard_error[0], 0.1 * std::sqrt(sxx / det), 1e-12);
  EXPECT_NEAR(u.standard_error[1], 0.1 * std::sqrt(n / det), 1e-12);
  EXPECT_NEAR(u.correlation(0, 1), -sx / std::sqrt(n * sxx), 1e-12);
  EXPECT_NEAR(u.interval[0][1] - u.interval[0][0], 2.0 * 1.959963985 * u.standard_error[0], 1e-9);
  EXPECT_FALSE(u.channels[0].systematic);
}

TEST(Uncertainty, StudentsQuantile) {
  // tables: t(0.975; 5) = 2.571, (10) 2.228, (30) 2.042; the expansion is good to 1 % at 5, 0.1 %
  // at 10
  EXPECT_NEAR(t_quantile(5), 2.571, 0.026);
  EXPECT_NEAR(t_quantile(10), 2.228, 0.003);
  EXPECT_NEAR(t_quantile(30), 2.042, 0.001);
}

TEST(Uncertainty, ProfileOfALineIsTheCovariancesInterval) {
  const Problem problem = line_problem(40, true, 2);
  VectorXd z;
  const Uncertainty u = fitted(problem, &z);
  for (int i = 0; i < 2; ++i) {
    const Profile p = profile(problem, u, z, i);
    // the objective is a parabola, so √excess is straight and the crossing exact
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(p.lower, u.interval[k][0], 1e-6);
    EXPECT_NEAR(p.upper, u.interval[k][1], 1e-6);
    EXPECT_FALSE(p.lower_open || p.upper_open);
    for (std::size_t j = 0; j < p.value.size(); ++j) {
      const double d =
          1.959963985 * (p.value[j] - u.values[i]) / u.standard_error[i] / u.quantiles[i];
      EXPECT_NEAR(p.excess[j], d * d, 1e-6 * (1.0 + d * d));
    }
  }
}

TEST(Uncertainty, BootstrapAgreesWithTheCovariance) {
  const Problem problem = line_problem(60, true, 3);
  VectorXd z;
  const Uncertainty u = fitted(problem, &z);
  const MatrixXd draws = bootstrap(problem, u, z, 400, 5);
  for (Index i = 0; i < 2; ++i) {
    const VectorXd d = draws.col(i).array() - draws.col(i).mean();
    const double sd = std::sqrt(d.squaredNorm() / 399.0);
    // the noise of these 60 residuals itself scatters by 1/√120 = 9 %, and 400 draws by 3.5 %
    EXPECT_NEAR(sd / u.standard_error[i], 1.0, 0.25);
  }
  EXPECT_EQ(draws, bootstrap(problem, u, z, 400, 5));
}

TEST(Uncertainty, AMisfitBeyondTheNoiseWidensTheIntervalAndIsToldOf) {
  const Problem honest = line_problem(40, true, 4);
  Problem doubtful = honest;
  std::vector<Eigen::MatrixXd> bent{honest.targets()[0].channels[0].observed};
  const VectorXd x = honest.targets()[0].x;
  bent[0].col(0) += (4.0 * x.array().square()).matrix();  // no line follows this
  const Problem wrong = honest.with_observed(bent);
  const Uncertainty a = fitted(honest), b = fitted(wrong);
  EXPECT_FALSE(a.channels[0].systematic);
  EXPECT_TRUE(b.channels[0].systematic);
  EXPECT_GT(b.channels[0].lag_correlation, 0.5);
  EXPECT_GT(b.standard_error[0], 3.0 * a.standard_error[0]);
}

TEST(Uncertainty, TellsWhatTheDataDoNotDetermine) {
  // one undrained curve: neither Γ (the state starts from p and OCR) nor λ and κ apart from Λ
  study::Twin twin = study::cam_clay_twin("ln_v-ln_p");
  const Problem problem = study::twin_problem(twin, {study::cam_clay_tests()[1]});
  const VectorXd z = problem.space().coordinates(twin.truth_vector());
  const Uncertainty u = uncertainty(problem, z);
  EXPECT_TRUE(std::isinf(u.standard_error[4]));
  ASSERT_FALSE(u.combinations.empty());
  EXPECT_EQ(u.combinations.front().words, "the data do not depend on Gamma");
  EXPECT_TRUE(std::isinf(u.combinations.front().relative_sd));
  std::printf("[ measured ] next worst: %s\n", u.combinations[1].words.c_str());
}

TEST(Uncertainty, AParameterAtItsBoundIsNotAMeasurement) {
  Problem problem = line_problem(30, true, 6);
  Target t = problem.targets()[0];
  const Problem bounded(
      ParameterSpace({free_parameter("a", -5.0, 5.0), free_parameter("b", 3.0, 10.0)}), {t});
  const Uncertainty u = fitted(bounded);
  EXPECT_EQ(u.at_bound[1], -1);
  EXPECT_EQ(u.values[1], 3.0);
  EXPECT_EQ(u.at_bound[0], 0);
  EXPECT_TRUE(std::isnan(u.standard_error[1]));
}

TEST(Uncertainty, APriorHoldsWhatTheDataDoNot) {
  study::Twin twin = study::cam_clay_twin();
  twin.free[3].prior = Prior{0.25, 0.02};
  const Problem problem =
      study::twin_problem(twin, {study::cam_clay_tests()[0]});  // isotropic: nothing about M, ν
  const Optimum o = levenberg_marquardt(problem, VectorXd::Constant(5, 0.4));
  const Uncertainty u = uncertainty(problem, o.z);
  EXPECT_NEAR(u.values[3], 0.25, 1e-6);
  EXPECT_NEAR(u.standard_error[3], 0.02, 1e-6);
  // M is not zero information to round-off only: the path's last digits depend on it
  EXPECT_GT(u.standard_error[0], 10.0);
}

}  // namespace
}  // namespace repose::calibration

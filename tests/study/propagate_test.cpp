/// Draws of a posterior through a scene: the regression of fine runs on coarse ones, and which runs
/// are made.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "calibration/convergence.hpp"
#include "input/shipped_input.hpp"
#include "study/propagate/propagation.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::study {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

VectorXd normal(Index n, std::mt19937_64& random) {
  std::normal_distribution<double> one;
  VectorXd x(n);
  for (double& value : x) value = one(random);
  return x;
}

TEST(Propagated, OfALineIsTheLineOfTheCoarseDistribution) {
  std::mt19937_64 random(1);
  const VectorXd c = normal(50, random);
  const std::vector<Index> places{3, 10, 20, 30, 44};
  VectorXd f(5);
  for (Index i = 0; i < 5; ++i) f[i] = 2.0 - 3.0 * c[places[static_cast<std::size_t>(i)]];
  const Propagated p = propagated(c, places, f);
  EXPECT_NEAR(p.correlation, -1.0, 1e-14);
  EXPECT_NEAR(p.mean, 2.0 - 3.0 * c.mean(), 1e-13);
  const double s_c = std::sqrt((c.array() - c.mean()).square().sum() / 49.0);
  EXPECT_NEAR(p.deviation, 3.0 * s_c, 1e-13);
  EXPECT_NEAR(p.standard_error, 3.0 * s_c / std::sqrt(50.0), 1e-13);
  EXPECT_NEAR(p.worth, 50.0, 1e-11);  // as all draws with fine cells
  EXPECT_NEAR(p.change, p.mean - c.mean(), 1e-15);
  // the same line for all five residuals of nothing: 5 of each of the 50 values, of which the
  // median is that of the 50 to a fifth of the step between its neighbours
  const double median = calibration::sample_quantile(c, 0.5),
               above = calibration::sample_quantile(c, 0.55),
               below = calibration::sample_quantile(c, 0.45);
  EXPECT_GT(p.median, 2.0 - 3.0 * above);
  EXPECT_LT(p.median, 2.0 - 3.0 * below);
  EXPECT_NEAR(p.median, 2.0 - 3.0 * median, 3.0 * (above - below));
}

TEST(Propagated, WhereCoarseRunsTellNothingIsThatOfTheFineOnes) {
  const VectorXd c = VectorXd::Constant(30, 0.7);
  const VectorXd f = (VectorXd(5) << 1.0, 2.0, 3.0, 4.0, 5.0).finished();
  const Propagated p = propagated(c, {0, 7, 14, 21, 28}, f);
  EXPECT_EQ(p.correlation, 0.0);
  EXPECT_DOUBLE_EQ(p.mean, 3.0);
  const double s2 = 10.0 / 3.0;  // Σ (f − 3)²/(n − 2)
  EXPECT_DOUBLE_EQ(p.deviation, std::sqrt(s2));
  EXPECT_DOUBLE_EQ(p.standard_error, std::sqrt(s2 / 5.0));
  EXPECT_DOUBLE_EQ(p.worth, 5.0);
}

TEST(Propagated, HoldsTheTruthAsOftenAsItSays) {
  // f = 1 + 2c + e/2, c and e standard normal: mean 1, deviation √4.25
  constexpr int repeats = 2000;
  constexpr Index draws = 200, pairs = 12;
  const double deviation = std::sqrt(4.25);
  std::vector<Index> places;
  for (Index i = 0; i < pairs; ++i) places.push_back(i * draws / pairs);
  std::mt19937_64 random(20);
  int held = 0;
  double low = 0.0, high = 0.0;
  for (int r = 0; r < repeats; ++r) {
    const VectorXd c = normal(draws, random), e = normal(pairs, random);
    VectorXd f(pairs);
    for (Index i = 0; i < pairs; ++i)
      f[i] = 1.0 + 2.0 * c[places[static_cast<std::size_t>(i)]] + 0.5 * e[i];
    const Propagated p = propagated(c, places, f);
    constexpr double t = 2.228;  // of 10 degrees of freedom, 95 %
    held += std::abs(p.mean - 1.0) < t * p.standard_error ? 1 : 0;
    low += p.interval_90[0] / repeats;
    high += p.interval_90[1] / repeats;
  }
  // Student's t for all of the error would hold 95.0 %, a normal error within 2.228 deviations
  // 97.4 %, and it is a sum of both; give or take three deviations of 2000 trials, 1.5 %
  const double share = static_cast<double>(held) / repeats;
  EXPECT_GT(share, 0.935);
  EXPECT_LT(share, 0.989);
  // A 5 % quantile of 200 has a deviation of √(0.05 · 0.95/200)/0.103 = 0.15; of the mean of 2000
  // 0.0034. Its bias is of the order of 1/200 over that density times the share beyond: 0.05·0.05.
  EXPECT_NEAR((low - 1.0) / deviation, -1.645, 0.03);
  EXPECT_NEAR((high - 1.0) / deviation, 1.645, 0.03);
}

TEST(Propagated, LeavesOutWhatIsNoNumber) {
  std::mt19937_64 random(3);
  VectorXd c = normal(40, random);
  const std::vector<Index> places{1, 9, 17, 25, 33, 39};
  VectorXd f = normal(6, random);
  VectorXd without(38);
  without << c.head(9), c.segment(10, 9), c.tail(20);
  const Propagated expected =
      propagated(without, {1, 16, 23, 31}, (VectorXd(4) << f[0], f[2], f[3], f[4]).finished());
  c[9] = c[19] = nan;
  f[5] = HUGE_VAL;
  const Propagated p = propagated(c, places, f);
  EXPECT_EQ(p.draws, 38);
  EXPECT_EQ(p.pairs, 4);
  EXPECT_EQ(p.mean, expected.mean);  // the same numbers, so the same bits
  EXPECT_EQ(p.interval_90, expected.interval_90);
  f[0] = nan;
  EXPECT_TRUE(std::isnan(propagated(c, places, f).mean)) << "three pairs";
}

FittedPosterior grains(Index draws) {
  FittedPosterior p;
  p.name = "beads";
  p.law = {"mu_i", {{"form", "elastoviscoplastic"}}, {{"mu_0", 0.38}, {"mu_d", 0.6}, {"d", 0.02}}};
  p.parameters = {"mu_0", "mu_d"};
  p.others = {"p"};
  p.draws.resize(draws, 2);
  for (Index i = 0; i < draws; ++i) p.draws.row(i) << 0.3 + 0.001 * static_cast<double>(i), 0.6;
  return p;
}

input::SceneFile shipped(const std::string& name) {
  input::InputFile file = input::open_scene(name, {});
  return input::read_scene(file);
}

TEST(PropagationPlan, SpreadsRunsOverTheDraws) {
  PropagationOptions options;
  options.runs = 20;
  options.fine = 5;
  options.coarsen = 4;
  const PropagationPlan plan = plan_propagation(grains(200), shipped("flat_mu_i"), options);
  ASSERT_EQ(plan.draws.size(), 20u);
  EXPECT_EQ(plan.draws.front(), 5);  // the middle of the first twentieth of 200
  EXPECT_EQ(plan.draws.back(), 195);
  EXPECT_EQ(plan.fine, (std::vector<Index>{2, 6, 10, 14, 18}));
  EXPECT_EQ(
      plan.coarse_sets.sets(0),
      (std::vector<std::string>{"body[0].law.mu_0=0.305", "body[0].law.mu_d=0.6", "grid.h=0.025"}));
  EXPECT_EQ(plan.fine_sets.sets(1),
            (std::vector<std::string>{"body[0].law.mu_0=0.365", "body[0].law.mu_d=0.6"}));
  EXPECT_EQ(plan.asked.outputs, (std::vector<std::string>{"front_99_m", "height_m"}));
  // the scene's grains are smaller than the fit's, and p is no parameter of the law
  ASSERT_EQ(plan.warnings.size(), 2u);
  EXPECT_NE(plan.warnings[0].find("p: of the tests of the fit"), std::string::npos);
  EXPECT_NE(plan.warnings[1].find("d = 0.0053 in the scene, 0.02 in the fit"), std::string::npos);
}

TEST(PropagationPlan, RefusesWhatCannotBe) {
  const auto told = [](const FittedPosterior& posterior, const std::string& scene,
                       const PropagationOptions& options) {
    try {
      plan_propagation(posterior, shipped(scene), options);
    } catch (const input::BadInput& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(told(grains(200), "flat_newtonian", {}),
            "no body of flat_newtonian follows mu_i, the law of the fit beads; it has newtonian");
  EXPECT_EQ(told(grains(50), "flat_mu_i", {}), "--runs 100: the posterior has 50 draws");
  PropagationOptions few;
  few.fine = 3;
  few.coarsen = 1.0;
  EXPECT_EQ(told(grains(200), "flat_mu_i", few),
            "--fine 3: at least 4 runs with fine cells are needed\n"
            "--coarsen 1: must be more than 1");
}

}  // namespace
}  // namespace repose::study

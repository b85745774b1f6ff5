// Richardson's extrapolation and the error model on made-up quantities whose limit is known.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "calibration/error_model.hpp"

namespace repose::calibration {
namespace {

using Eigen::VectorXd;

/// u* (1 + c h^p) on a curve of three places.
VectorXd value_at(double h, double c, double p) {
  return VectorXd{{1.0, 2.0, 0.5}} * (1.0 + c * std::pow(h, p));
}
const VectorXd limit = value_at(0.0, 0.0, 1.0);

TEST(Richardson, TheOrderIsFoundForAnySizes) {
  for (const double p : {0.5, 1.0, 1.7, 3.0}) {
    const auto at = [&](double h) { return Resolution{h, {value_at(h, 0.3, p)}}; };
    // bisection to 10/2^60, on changes that round-off of 1e-16 disturbs by 1e-13 at most
    EXPECT_NEAR(observed_order(at(0.4), at(0.2), at(0.1)), p, 1e-9);
    EXPECT_NEAR(observed_order(at(0.5), at(0.3), at(0.2)), p, 1e-9) << "no common ratio";
  }
  const auto flat = [](double h, double x) { return Resolution{h, {VectorXd::Constant(1, x)}}; };
  EXPECT_TRUE(std::isnan(observed_order(flat(0.4, 1.0), flat(0.2, 1.1), flat(0.1, 1.3))))
      << "changes that grow have no order";
}

TEST(Richardson, TheReferenceIsTheLimit) {
  std::vector<Resolution> levels;
  for (const double h : {0.4, 0.2, 0.1}) levels.push_back({h, {value_at(h, 0.3, 1.0)}});
  const Reference reference = extrapolated_reference(levels);
  EXPECT_NEAR(reference.order, 1.0, 1e-9);
  EXPECT_LT(relative_distance(reference.value, limit), 1e-9);
  // a quarter of what was extrapolated: 0.3 × 0.1 relative; the order is 1, and nothing scatters
  EXPECT_NEAR(reference.error, 0.25 * 0.3 * 0.1, 1e-9);
  EXPECT_THROW(extrapolated_reference(std::span(levels).first(2)), std::invalid_argument);
}

TEST(Richardson, SizesInBetweenDoNotCount) {
  std::vector<Resolution> levels;
  for (const double h : {0.4, 0.2, 0.15, 0.1}) levels.push_back({h, {value_at(h, 0.3, 1.0)}});
  EXPECT_EQ(extrapolated_reference(levels).sizes, (std::array{0.4, 0.2, 0.1}));
}

// With scatter, the limit lies within three error bars, each a standard deviation.
TEST(Richardson, TheErrorBarOfAReferenceBoundsScatter) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> scatter(0.0, 0.003);
  int outside = 0;
  constexpr int trials = 200;
  for (int k = 0; k < trials; ++k) {
    std::vector<Resolution> levels;
    for (const double h : {0.4, 0.2, 0.1}) {
      levels.push_back({h, {}});
      for (int run = 0; run < 3; ++run)
        levels.back().runs.push_back(VectorXd::Constant(1, 1.0 + 0.3 * h + scatter(random)));
    }
    const Reference reference = extrapolated_reference(levels);
    if (std::abs(reference.value[0] - 1.0) > 3.0 * reference.error) ++outside;
  }
  // 0.3 % of normal deviates lie beyond 3σ; a bound of 2 % is 4 of 200 (Poisson with mean 0.6:
  // more than 4 in 0.04 % of the seeds)
  EXPECT_LE(outside, 4);
}

const ErrorModel typical{1.0, 1.0, 0.3, 0.002, 0.0};

TEST(ErrorModel, FinerCellsAndMoreRunsAreNeverWorse) {
  const Convergence nothing(typical, 1.0);
  double last = HUGE_VAL;
  for (double h = 0.1; h > 0.001; h *= 0.5) {
    const double error = nothing.predicted_error({{2.0 * h, 1}, {h, 1}});
    EXPECT_LT(error, last);
    last = error;
    double fewer = error;
    for (const int runs : {2, 4, 8}) {
      const double more = nothing.predicted_error({{2.0 * h, runs}, {h, runs}});
      EXPECT_LT(more, fewer);
      fewer = more;
    }
  }
  // what is left where the cells no longer matter: 1.28 × 0.2 % of the finest runs, not
  // extrapolated
  EXPECT_NEAR(nothing.predicted_error({{2e-7, 1}, {1e-7, 1}}), 1.2816 * 0.002, 1e-5);
  EXPECT_TRUE(std::isinf(nothing.predicted_error({{0.1, 1}, {0.07, 1}}))) << "too close a pair";
}

TEST(ErrorModel, RunsWithoutScatterAreExtrapolatedInFull) {
  Convergence so_far({1.0, 1.0, 0.3, 1e-9, 0.0}, 1.0);
  for (const double h : {0.2, 0.1, 0.05}) so_far.add(h, value_at(h, 1.3, 1.0));
  const Estimate estimate = so_far.estimate();
  EXPECT_NEAR(estimate.weight, 1.0, 1e-6) << "1/(2 - 1)";
  EXPECT_LT(relative_distance(estimate.value, limit), 1e-6);
  // The bias in shares of |u_f| is 1.3 h/(1 + 1.3 h); of the model, with a weight of a half, it is
  // h. The two changes seen give 1.3 × 0.05/1.065 and half of 1.3 × 0.1/1.13.
  const double B = std::sqrt((0.5 * std::pow(0.05, 2) + std::pow(1.3 * 0.05 / 1.065, 2) +
                              std::pow(0.5 * 1.3 * 0.1 / 1.13, 2)) /
                             2.5);
  EXPECT_NEAR(so_far.bias_at(0.05), B, 1e-9);
  EXPECT_NEAR(estimate.error, 0.3 * B, 1e-6);
}

// Scatter of 5 % and hardly a bias: extrapolating would treble the error.
TEST(ErrorModel, WhatScattersIsNotExtrapolated) {
  Convergence so_far({0.1, 1.0, 0.3, 0.05, 0.0}, 1.0);
  so_far.add(0.1, VectorXd::Constant(1, 1.05));
  so_far.add(0.05, VectorXd::Constant(1, 0.97));
  EXPECT_EQ(so_far.estimate().weight, 0.0);
  EXPECT_EQ(so_far.estimate().value[0], 0.97);
}

TEST(ErrorModel, PlansBuyTheCheaperOfCellsAndRuns) {
  const std::vector<double> sizes{0.1, 0.05, 0.025, 2.0 * 0.025 / 3.0, 0.0125};
  std::vector<double> seconds;
  for (const double h : sizes) seconds.push_back(std::pow(0.1 / h, 3));
  const Convergence steady({1.0, 1.0, 0.3, 1e-6, 0.0}, 1.0);
  // 0.3 × 0.0125 is asked for: cells of 12.5 mm, once; those in between are passed by
  const Plan fine = cheapest_plan(steady, sizes, seconds, 0.00376, HUGE_VAL);
  ASSERT_EQ(fine.levels.size(), 4u);
  EXPECT_EQ(fine.levels.back().h, 0.0125);
  EXPECT_EQ(fine.levels.back().runs, 1);
  EXPECT_DOUBLE_EQ(fine.cost, 1.0 + 8.0 + 64.0 + 512.0);
  // a little less is asked for: two thirds of 25 mm do
  EXPECT_EQ(cheapest_plan(steady, sizes, seconds, 0.0051, HUGE_VAL).levels.back().h, sizes[3]);
  // scatter of 2 %, no bias: many runs with coarse cells
  const Convergence noisy({1e-3, 1.0, 0.3, 0.02, 0.0}, 1.0);
  const Plan many = cheapest_plan(noisy, sizes, seconds, 0.0129, HUGE_VAL);
  EXPECT_EQ(many.levels.back().h, 0.05);
  EXPECT_EQ(many.levels.back().runs, 4) << "1.28 × 2 %/√4";
  // out of reach of the budget: the best that it buys
  const Plan poor = cheapest_plan(steady, sizes, seconds, 0.001, 100.0);
  EXPECT_EQ(poor.levels.back().h, 0.025);
  EXPECT_GT(poor.error, 0.001);
}

TEST(ErrorModel, ConstantsAreThoseOfTheRuns) {
  std::vector<Resolution> levels;
  for (const double h : {0.2, 0.1, 0.05, 0.025})
    levels.push_back({h, {value_at(h, 0.7, 1.0), value_at(h, 0.7, 1.0)}});
  const ShownErrors shown = shown_errors(levels, limit, 1.0);
  EXPECT_NEAR(shown.bias, 0.7, 1e-12);
  EXPECT_EQ(shown.scatter, 1e-4) << "the least that is assumed";
  ASSERT_EQ(shown.remainders.size(), 2u) << "of cells of 0.1 and 0.05";
  for (const double r : shown.remainders) EXPECT_LT(r, 1e-4) << "an exact order leaves nothing";
  const std::vector<ShownErrors> scenes{{3.0, 0.01, {1.0}}, {4.0, 0.01, {0.0}}};
  const ErrorModel model = pooled_model(scenes);
  EXPECT_DOUBLE_EQ(model.bias, std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(model.scatter, 0.01);
  EXPECT_DOUBLE_EQ(model.remainder, 1.2816 * std::sqrt(0.5));
}

}  // namespace
}  // namespace repose::calibration

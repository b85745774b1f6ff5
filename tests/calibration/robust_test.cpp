// Rows that are wrong: losses that grow slower than squares, their scales, and what is left of the
// parameters.

#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "calibration/multistart.hpp"
#include "calibration/uncertainty.hpp"
#include "study/fit/twin.hpp"
#include "tests/calibration/toy.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

Loss loss_of(Residuals residuals) { return {residuals, usual_tuning(residuals)}; }
constexpr std::array robust{Residuals::huber, Residuals::student};

TEST(Loss, SlopesAreThoseOfTheCostAndTheParabolaLiesAbove) {
  for (const Residuals residuals : robust) {
    const Loss loss = loss_of(residuals);
    const double h = 1e-6;
    for (const double u : {-7.0, -1.2, -0.3, 0.4, 1.3, 2.0, 9.0}) {
      // differences of second order: h² and round-off over h
      EXPECT_NEAR(loss.score(u), (loss.cost(u + h) - loss.cost(u - h)) / (2.0 * h), 1e-8);
      EXPECT_NEAR(loss.slope(u), (loss.score(u + h) - loss.score(u - h)) / (2.0 * h), 1e-8);
      for (double v = -10.0; v <= 10.0; v += 0.37)
        EXPECT_LE(loss.cost(v), loss.cost(u) + 0.5 * loss.weight(u) * (v * v - u * u) + 1e-12);
    }
    EXPECT_NEAR(loss.cost(loss.tuning + 1e-12), loss.cost(loss.tuning - 1e-12), 1e-11);
  }
}

/// The place of the least of a function with one minimum.
double least(double low, double high, const std::function<double(double)>& f) {
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  for (int k = 0; k < 120; ++k) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    (f(a) < f(b) ? high : low) = f(a) < f(b) ? b : a;
  }
  return 0.5 * (low + high);
}

/// n draws of a normal distribution, every `each`-th of them ten times as large.
VectorXd spoiled(Index n, Index each, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  VectorXd r(n);
  for (Index i = 0; i < n; ++i) r[i] = normal(random) * (each > 0 && i % each == 0 ? 10.0 : 1.0);
  return r;
}

/// E ψ² of Huber's ψ and a standard normal variable, by the midpoint rule.
double mean_square_score(double k) {
  double sum = 0.0;
  const double h = 1e-3;
  for (double u = -8.0 + 0.5 * h; u < 8.0; u += h)
    sum += h * std::min(u * u, k * k) * std::exp(-0.5 * u * u) / std::sqrt(2.0 * M_PI);
  return sum;
}

TEST(Loss, ItsScaleIsTheLeastOfItsOwnObjective) {
  const VectorXd r = spoiled(60, 12, 3);
  const auto sum = [&](const Loss& loss, double s) {
    double all = 0.0;
    for (const double x : r) all += loss.cost(x / s);
    return all;
  };
  const Loss huber = loss_of(Residuals::huber), student = loss_of(Residuals::student);
  const double wanted = 58.0 * mean_square_score(1.345);
  // a minimum is found to the root of round-off
  EXPECT_NEAR(settled_scale(huber, r, 2.0, median_scale(r), 1e-9),
              least(0.1, 10.0, [&](double s) { return s * (sum(huber, s) + 0.5 * wanted); }), 1e-5);
  EXPECT_NEAR(settled_scale(student, r, 2.0, median_scale(r), 1e-9),
              least(0.1, 10.0, [&](double s) { return 60.0 * std::log(s) + sum(student, s); }),
              1e-6);
  // of normal errors the standard deviation: its own error 1/√(2·2000·0.9) = 1.7 %, three of them
  const VectorXd clean = spoiled(2000, 0, 4);
  EXPECT_NEAR(settled_scale(huber, clean, 0.0, 1.0, 1e-9), 1.0, 0.05);
  EXPECT_NEAR(median_scale(clean), 1.0, 0.08);
}

/// y = 1 + 2x and errors, x = 0 … 1.
Target line_target(const VectorXd& errors, bool declare, double noise) {
  const Index n = errors.size();
  std::vector<double> x;
  for (Index i = 0; i < n; ++i) x.push_back(static_cast<double>(i) / static_cast<double>(n - 1));
  Target t;
  t.name = "line";
  t.simulator = std::make_shared<Line>(x);
  t.inputs = {0.0, 0.0};
  t.bindings = {{0, 0}, {1, 1}};
  t.x = Eigen::Map<const VectorXd>(x.data(), n);
  t.channels.push_back({"y", (1.0 + 2.0 * t.x.array()).matrix() + noise * errors, {}, 1.0});
  if (declare) t.channels[0].noise = noise;
  return t;
}
ParameterSpace line_space() {
  return ParameterSpace({free_parameter("a", -5.0, 5.0), free_parameter("b", -5.0, 5.0)});
}

struct Line2 {
  double a = 0.0, b = 0.0, s = 0.0;
};
/// The textbook's iteration: a weighted line, weights from its residuals, and the scale if it is
/// not given.
Line2 reweighted(const Target& t, const Loss& loss, double scale) {
  Line2 line{0.0, 0.0, scale > 0.0 ? scale : 1.0};
  const VectorXd& y = t.channels[0].observed;
  const auto n = static_cast<double>(y.size());
  for (int turn = 0; turn < 3000; ++turn) {
    double w = 0.0, wx = 0.0, wxx = 0.0, wy = 0.0, wxy = 0.0, squares = 0.0;
    for (Index i = 0; i < y.size(); ++i) {
      const double u = (y[i] - line.a - line.b * t.x[i]) / line.s, weight = loss.weight(u);
      w += weight;
      wx += weight * t.x[i];
      wxx += weight * t.x[i] * t.x[i];
      wy += weight * y[i];
      wxy += weight * t.x[i] * y[i];
      squares +=
          loss.residuals == Residuals::huber ? std::pow(loss.score(u), 2) : loss.score(u) * u;
    }
    const double det = w * wxx - wx * wx;
    line.a = (wxx * wy - wx * wxy) / det;
    line.b = (w * wxy - wx * wy) / det;
    if (scale > 0.0) continue;
    const double wanted =
        loss.residuals == Residuals::huber ? (n - 2.0) * mean_square_score(loss.tuning) : n;
    line.s *= std::sqrt(squares / wanted);
  }
  return line;
}

TEST(Robust, ALineWithGrossOutliersIsTheTextbooks) {
  VectorXd errors = spoiled(30, 0, 5);
  errors[4] = 60.0;
  errors[25] = -200.0;
  for (const Residuals residuals : robust)
    for (const bool declare : {true, false}) {
      const Target t = line_target(errors, declare, 0.1);
      Problem problem(line_space(), {t}, true, loss_of(residuals));
      FitOptions options;
      options.starts = 3;
      std::vector<StartResult> starts = run_starts(problem, options);
      settle(problem, options, starts);
      const VectorXd values = problem.space().values(best_of(starts).optimum.z);
      const Line2 expected = reweighted(t, problem.loss(), declare ? 0.1 : 0.0);
      // scales are settled to 1e-6, and move the line by no more than that of its error, 0.04
      EXPECT_NEAR(values[0], expected.a, 1e-7);
      EXPECT_NEAR(values[1], expected.b, 1e-7);
      // three standard errors of an intercept and a slope over 30 rows, 0.1 (4/30) and 0.1 (12/30)
      EXPECT_NEAR(values[0], 1.0, 0.12);
      EXPECT_NEAR(values[1], 2.0, 0.20);
      if (declare) continue;
      const double range = t.channels[0].observed.maxCoeff() - t.channels[0].observed.minCoeff();
      EXPECT_NEAR(problem.scales()[0] * range, expected.s, 1e-6 * expected.s + 1e-7);
      // which rows are wrong
      const Eigen::MatrixXd weights = problem.row_weights(0, best_of(starts).optimum.z);
      EXPECT_LT(weights(4, 0), 0.1);
      EXPECT_LT(weights(25, 0), 0.1);
      EXPECT_EQ((weights.array() < 0.25).count(), 2);
    }
}

TEST(Robust, EveryAlgorithmLowersTheSameObjective) {
  VectorXd errors = spoiled(30, 0, 6);
  errors[3] = 40.0;
  const Target t = line_target(errors, true, 0.1);
  for (const Residuals residuals : robust) {
    const Problem problem(line_space(), {t}, true, loss_of(residuals));
    const VectorXd start = VectorXd::Constant(2, 0.5);
    const Optimum best = levenberg_marquardt(problem, start);
    EXPECT_EQ(best.why, "converged");
    // each trial that is kept lies below the one before
    for (std::size_t k = 1; k < best.trace.size(); ++k)
      EXPECT_LE(best.trace[k].objective, best.trace[k - 1].objective * (1.0 + 1e-12));
    for (const char* algorithm : {"LD_SLSQP", "LN_BOBYQA"})
      EXPECT_NEAR(optimise(problem, algorithm, start).objective, best.objective,
                  1e-8 * best.objective)
          << algorithm;
    Evaluation here, there;
    const VectorXd z = VectorXd::Constant(2, 0.6);
    problem.evaluate(z, true, here);
    const VectorXd gradient = here.J.transpose() * here.r;
    for (Index j = 0; j < 2; ++j) {
      VectorXd up = z, down = z;
      const double h = 1e-6;
      up[j] += h;
      down[j] -= h;
      problem.evaluate(up, false, there);
      const double above = there.objective();
      problem.evaluate(down, false, there);
      // round-off 1e-16 of the objective over h, and h²
      EXPECT_NEAR(gradient[j], (above - there.objective()) / (2.0 * h),
                  1e-6 * std::abs(gradient[j]) + 1e-9 * here.objective());
    }
  }
}

/// Slope of a line fitted to normal errors, every `each`-th ten times as large, and its own error.
struct Fitted {
  double slope = 0.0, error = 0.0;
};
Fitted slope_of(const VectorXd& errors, Residuals residuals) {
  Problem problem(line_space(), {line_target(errors, false, 0.1)}, true, loss_of(residuals));
  FitOptions options;
  options.starts = 1;
  std::vector<StartResult> starts = run_starts(problem, options);
  settle(problem, options, starts);
  const Uncertainty u = uncertainty(problem, best_of(starts).optimum.z);
  return {u.values[1], u.standard_error[1]};
}

TEST(Robust, CostsLittleWithoutOutliersAndItsErrorIsWhatItSays) {
  const int sets = 200;
  for (const Index each : {Index{0}, Index{20}}) {
    std::array<double, 3> variance{}, said{};
    for (int s = 0; s < sets; ++s) {
      const VectorXd errors = spoiled(60, each, static_cast<std::uint64_t>(1000 + s));
      for (const std::size_t k : {0U, 1U, 2U}) {
        const Fitted f = slope_of(errors, static_cast<Residuals>(k));
        variance[k] += std::pow(f.slope - 2.0, 2) / sets;
        said[k] += f.error * f.error / sets;
      }
    }
    for (const std::size_t k : {1U, 2U}) {
      // A variance of 200 draws is known to √(2/200) = 10 %; three of them
      EXPECT_NEAR(said[k] / variance[k], 1.0, 0.3) << k << " " << each;
      // Without outliers Huber's estimate has 1/0.95 of the variance of least squares, Student's
      // about 1/0.93; ratios of estimates that correlate by √0.95 are known to 2 √(0.05/200) = 3.2
      // %
      if (each == 0) {
        EXPECT_NEAR(variance[k] / variance[0], 1.06, 0.096) << k;
      } else {
        // 5 % of ten times the size: least squares has 0.95 + 0.05·100 = 5.95 times the variance
        EXPECT_LT(variance[k] / variance[0], 0.4) << k;
      }
    }
  }
}

TEST(Robust, ClayWithSpoiledRowsKeepsItsParameters) {
  const study::Twin twin = study::cam_clay_twin();
  std::vector<study::TwinTest> tests = study::cam_clay_tests();
  tests[1].abscissae = study::evenly(0.0, 0.1, 24);
  tests[2].abscissae = study::evenly(0.0, 0.15, 24);
  std::vector<Target> targets;
  for (std::size_t k = 0; k < tests.size(); ++k) {
    targets.push_back(study::measure(twin, tests[k], 0.01, 70 + k));
    for (Channel& c : targets.back().channels) c.noise.reset();
  }
  // 5 % of 106 rows, by half of the range and all to one side: a load cell that sticks
  for (const auto& [target, channel, row] :
       {std::array<std::size_t, 3>{1, 0, 23}, {1, 0, 17}, {2, 0, 23}, {2, 0, 20}, {2, 0, 17}}) {
    VectorXd& y = targets[target].channels[channel].observed;
    y[static_cast<Index>(row)] += 0.5 * (y.maxCoeff() - y.minCoeff());
  }
  for (const std::size_t kind : {0U, 1U, 2U}) {
    Problem problem(ParameterSpace(twin.free), targets, true,
                    loss_of(static_cast<Residuals>(kind)));
    FitOptions options;
    options.starts = 4;
    std::vector<StartResult> starts = run_starts(problem, options);
    settle(problem, options, starts);
    const Uncertainty u = uncertainty(problem, best_of(starts).optimum.z);
    const std::vector<Recommendation> quoted = recommend(problem, u, {});
    int held = 0;
    for (std::size_t i = 0; i < twin.truth.size(); ++i)
      held += twin.truth[i] >= quoted[i].interval[0] && twin.truth[i] <= quoted[i].interval[1];
    const double worst = study::worst_error(twin, u.values);
    if (kind == 0) {
      EXPECT_LT(held, 5);
      EXPECT_GT(worst, 0.03);
    } else {
      EXPECT_EQ(held, 5) << kind;
      // the widest interval of clean data with 1 % of noise, λ's, is 1.2 % to each side
      EXPECT_LT(worst, 0.012) << kind;
    }
  }
}

}  // namespace
}  // namespace repose::calibration

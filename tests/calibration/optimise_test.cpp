// The optimisers and their known traps, on problems whose answers are known.

#include <gtest/gtest.h>

#include "calibration/multistart.hpp"
#include "tests/calibration/toy.hpp"

namespace repose::calibration {
namespace {

using Eigen::VectorXd;

std::shared_ptr<Decay> decay(Trap trap = Trap::none) {
  return std::make_shared<Decay>(decay_x(), trap);
}

VectorXd z2(double a, double b) {
  VectorXd z(2);
  z << a, b;
  return z;
}

TEST(Optimise, LevenbergMarquardtFindsTheTruth) {
  const auto simulator = decay();
  const Problem problem = decay_problem(simulator);
  const Optimum o = levenberg_marquardt(problem, z2(0.2, 0.9));
  // zero residual: quadratic convergence down to round-off
  EXPECT_NEAR(problem.space().values(o.z)[0], 2.0, 1e-10);
  EXPECT_NEAR(problem.space().values(o.z)[1], 1.3, 1e-10);
  EXPECT_EQ(o.why, "converged");
}

TEST(Optimise, EveryLocalAlgorithmFindsTheTruthWithinItsEvaluations) {
  for (const Algorithm& a : algorithms()) {
    if (a.global) continue;
    const Problem problem = decay_problem(decay());
    OptimiseOptions options;
    options.max_evaluations = 5000;
    const Optimum o = optimise(problem, a.name, z2(0.3, 0.6), options);
    // Derivative-free ones stop at x_tolerance or where ½r² is round-off, r ~ 1e-8.
    const double tolerance = 2e-5;
    EXPECT_NEAR(problem.space().values(o.z)[0], 2.0, tolerance) << a.name << " " << o.why;
    EXPECT_NEAR(problem.space().values(o.z)[1], 1.3, tolerance) << a.name << " " << o.why;
  }
}

TEST(Optimise, EveryGlobalAlgorithmComesNear) {
  for (const Algorithm& a : algorithms()) {
    if (!a.global) continue;
    const Problem problem = decay_problem(decay());
    OptimiseOptions options;
    options.max_evaluations = 4000;
    const Optimum o = optimise(problem, a.name, z2(0.3, 0.9), options);
    // 4000 points in two dimensions without any model of the valley: 1/√4000 = 1.6 % of the bounds
    EXPECT_LT((o.z - problem.space().coordinates((VectorXd(2) << 2.0, 1.3).finished()))
                  .cwiseAbs()
                  .maxCoeff(),
              0.05)
        << a.name << " " << o.why;
  }
}

TEST(Optimise, NoAlgorithmMindsTrialsThatFail) {
  for (const Trap trap : {Trap::not_a_number, Trap::exception, Trap::breaks_off})
    for (const Algorithm& a : algorithms()) {
      const Problem problem = decay_problem(decay(trap));
      OptimiseOptions options;
      options.max_evaluations = 1500;
      // the start itself fails: b = 4.8 > 3
      const Optimum o = optimise(problem, a.name, z2(0.5, 0.8), options);
      Evaluation at_start;
      problem.evaluate(z2(0.5, 0.8), false, at_start);
      EXPECT_TRUE(std::isfinite(o.objective)) << a.name;
      EXPECT_TRUE(o.z.allFinite()) << a.name;
      EXPECT_LE(o.objective, at_start.objective()) << a.name;
      const char* reason = trap == Trap::not_a_number ? "not_finite"
                           : trap == Trap::exception  ? "exception"
                                                      : "broke_off";
      const Spent spent = problem.spent();
      ASSERT_EQ(spent.failures.size(), 1u) << a.name;
      EXPECT_EQ(spent.failures.begin()->first, reason);
      EXPECT_GE(spent.failures.begin()->second, 2);
    }
}

TEST(Optimise, ThePenaltyLeadsBackToPathsThatFinish) {
  // gradient algorithms see the penalty's slope and come back from a failing start
  for (const char* name : {"levenberg_marquardt", "LD_SLSQP", "LD_LBFGS", "LD_MMA", "LN_BOBYQA",
                           "LN_COBYLA", "LN_NELDERMEAD"}) {
    const Problem problem = decay_problem(decay(Trap::breaks_off));
    const Optimum o = optimise(problem, name, z2(0.5, 0.8));
    EXPECT_FALSE(o.failed) << name;
    EXPECT_NEAR(problem.space().values(o.z)[1], 1.3, 1e-3) << name << " " << o.why;
  }
}

TEST(Optimise, ThePenaltyIsContinuousAndGrowsWithWhatIsUnfinished) {
  const Problem problem = decay_problem(decay(Trap::breaks_off));
  Evaluation e;
  const double edge = (3.0 - 0.05) / (6.0 - 0.05);
  problem.evaluate(z2(0.5, edge), false, e);
  const double at_edge = e.objective();
  EXPECT_FALSE(e.failed);
  problem.evaluate(z2(0.5, edge + 1e-9), false, e);
  EXPECT_TRUE(e.failed);
  // 1e-9 beyond: share changes by 6e-9, the penalty's square root by √(10·20)·6e-9
  EXPECT_NEAR(e.objective(), at_edge, 1e-6 * at_edge);
  double before = e.objective();
  for (double z = edge + 0.01; z <= 1.0; z += 0.01) {
    problem.evaluate(z2(0.5, z), false, e);
    EXPECT_TRUE(e.failed);
    EXPECT_GT(e.objective(), before) << z;
    before = e.objective();
  }
}

TEST(Optimise, AStartOutsideBeginsOnTheBounds) {
  for (const Algorithm& a : algorithms()) {
    const auto simulator = decay();
    const Problem problem = decay_problem(simulator);
    simulator->worst_input = 0.0;
    OptimiseOptions options;
    options.max_evaluations = 300;
    const Optimum o = optimise(problem, a.name, z2(-3.0, 1.0 + 1e-6), options);
    EXPECT_TRUE(std::isfinite(o.objective)) << a.name << " " << o.why;
    // no trial ever leaves the bounds, not by a hair: a <= 10, b <= 6
    EXPECT_LE(simulator->worst_input, 10.0 * (1.0 + 1e-14)) << a.name;
    EXPECT_GE(o.z.minCoeff(), 0.0) << a.name;
    EXPECT_LE(o.z.maxCoeff(), 1.0) << a.name;
  }
}

TEST(Optimise, TheSameSeedGivesTheSameTrace) {
  for (const Algorithm& a : algorithms()) {
    OptimiseOptions options;
    options.max_evaluations = 400;
    options.seed = 7;
    const Optimum first = optimise(decay_problem(decay()), a.name, z2(0.2, 0.7), options);
    const Optimum second = optimise(decay_problem(decay()), a.name, z2(0.2, 0.7), options);
    EXPECT_EQ(first.z, second.z) << a.name;
    ASSERT_EQ(first.trace.size(), second.trace.size()) << a.name;
    for (std::size_t i = 0; i < first.trace.size(); ++i)
      EXPECT_EQ(first.trace[i].objective, second.trace[i].objective) << a.name;
  }
}

TEST(Optimise, EvaluationsAreBounded) {
  for (const Algorithm& a : algorithms()) {
    const Problem problem = decay_problem(decay());
    OptimiseOptions options;
    options.max_evaluations = 25;
    const Optimum o = optimise(problem, a.name, z2(0.2, 0.9), options);
    // Levenberg-Marquardt may finish the pair (trial, derivatives) that it has begun
    EXPECT_LE(o.evaluations + o.gradients, 26) << a.name;
    EXPECT_TRUE(std::isfinite(o.objective)) << a.name;
  }
}

TEST(Optimise, AnInterruptKeepsTheBestPoint) {
  for (const Algorithm& a : algorithms()) {
    const auto simulator = decay();
    Problem problem = decay_problem(simulator);
    const long before = simulator->calls;
    problem.interrupt_by([&] { return simulator->calls - before >= 12; });
    const Optimum o = optimise(problem, a.name, z2(0.2, 0.9));
    EXPECT_EQ(o.why, "interrupted") << a.name;
    EXPECT_LE(simulator->calls - before, 16) << a.name;
    double least = std::numeric_limits<double>::infinity();
    for (const TracePoint& t : o.trace) least = std::min(least, t.objective);
    EXPECT_EQ(o.objective, least) << a.name;
    Evaluation again;
    problem.evaluate(o.z, false, again);
    EXPECT_EQ(again.objective(), o.objective) << a.name;
  }
}

TEST(Optimise, RoundOffKeepsABestPointThatIsReevaluated) {
  // tolerances that cannot be met: the algorithm ends by round-off, evaluations or its own means
  OptimiseOptions options;
  options.x_tolerance = 0.0;
  options.f_tolerance = 0.0;
  options.max_evaluations = 3000;
  for (const char* name : {"LN_BOBYQA", "LD_SLSQP", "LD_LBFGS", "LD_MMA", "levenberg_marquardt"}) {
    const Problem problem = decay_problem(decay());
    const Optimum o = optimise(problem, name, z2(0.4, 0.5), options);
    Evaluation e;
    problem.evaluate(o.z, false, e);
    EXPECT_EQ(e.objective(), o.objective) << name;
    EXPECT_NEAR(problem.space().values(o.z)[0], 2.0, 1e-5) << name << " " << o.why;
  }
}

TEST(Multistart, TheResultDoesNotDependOnHowTheStartsAreShared) {
  FitOptions options;
  options.starts = 8;
  options.global = "GN_CRS2_LM";
  options.global_evaluations = 300;
  options.local = "LD_SLSQP";
  const auto whole = run_starts(decay_problem(decay()), options);
  ASSERT_EQ(whole.size(), 8u);
  options.starts_from = 3;
  const auto tail = run_starts(decay_problem(decay()), options);
  options.starts_from = 0;
  options.starts_to = 3;
  const auto both = run_starts(decay_problem(decay()), options, tail);
  ASSERT_EQ(tail.size(), 5u);
  ASSERT_EQ(both.size(), 3u + 5u);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(both[i].index, static_cast<int>(i));
    EXPECT_EQ(both[i].optimum.z, whole[i].optimum.z);
    EXPECT_EQ(both[i].optimum.objective, whole[i].optimum.objective);
  }
  EXPECT_EQ(clusters(decay_problem(decay()), whole).size(), 1u);
}

}  // namespace
}  // namespace repose::calibration

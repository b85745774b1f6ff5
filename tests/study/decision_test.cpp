// What may be promised and what not: the domain that was charted, answers from own runs, costs, and
// the marks of an exam. Values are made up, limits are known.
#include "study/accuracy/decision.hpp"

#include <cmath>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "input/read_scene.hpp"
#include "study/accuracy/exam.hpp"
#include "study/accuracy/own_runs.hpp"
#include "study/accuracy/run_cost.hpp"
#include "study/accuracy/trained_domain.hpp"

namespace repose::study {
namespace {

using Eigen::VectorXd;

VectorXd number(double x) { return VectorXd::Constant(1, x); }
std::vector<Resolution> levels_of(const std::vector<double>& sizes, const auto& value) {
  std::vector<Resolution> levels;
  for (const double h : sizes) levels.push_back({h, {number(value(h))}});
  return levels;
}

TEST(OwnRuns, RegularErrorsOfOrderOneAreExtrapolated) {
  const auto levels = levels_of({0.8, 0.4, 0.2, 0.1}, [](double h) { return 1.0 + 0.2 * h; });
  const auto own = own_estimate(levels, 0.0);
  ASSERT_TRUE(own);
  EXPECT_EQ(own->sizes, 3);
  // bisection to 10/2^60 on changes of 0.02 that round-off of 1e-16 disturbs by 1e-14 of them
  EXPECT_NEAR(own->value[0], 1.0, 1e-9);
  EXPECT_NEAR(own->observed, 1.0, 1e-9);
  // the estimates before are the same, so half of what is extrapolated, 0.2 × 0.1, is left; the
  // bar one size coarser is twice that, and half of it no more
  EXPECT_NEAR(own->error, 0.5 * 0.02, 1e-9);
}

TEST(OwnRuns, TheFirstThreeSizesCountTwice) {
  const auto levels = levels_of({0.4, 0.2, 0.1}, [](double h) { return 1.0 + 0.2 * h; });
  EXPECT_NEAR(own_estimate(levels, 0.0)->error, 2.0 * 0.5 * 0.02, 1e-9);
}

TEST(OwnRuns, ScatterOfTheMeansIsCarriedThrough) {
  auto levels = levels_of({0.8, 0.4, 0.2, 0.1}, [](double h) { return 1.0 + 0.2 * h; });
  // order 1: the value is 2 u_f − u_m, of which σ is √(2² + 1²) σ, and two of them are the bar
  const auto own = own_estimate(levels, 0.01);
  EXPECT_NEAR(own->scattered, 2.0 * std::sqrt(5.0) * 0.01, 1e-9);
  EXPECT_NEAR(own->error, std::hypot(own->scattered, 0.01), 1e-9);
  // four runs of the finest that agree: its σ is half
  for (int k = 0; k < 3; ++k) levels.back().runs.push_back(levels.back().runs.front());
  EXPECT_NEAR(own_estimate(levels, 0.01)->scattered, 2.0 * std::hypot(1.0, 1.0) * 0.01, 1e-9);
}

// 1.3, 1.2, 1.2: the last change is none. By order 2 it would be a quarter of the one before.
TEST(OwnRuns, SizesThatAgreeByChanceDoNotNarrowTheBar) {
  const std::vector<Resolution> levels{
      {0.4, {number(1.3)}}, {0.2, {number(1.2)}}, {0.1, {number(1.2)}}};
  const auto own = own_estimate(levels, 0.0);
  EXPECT_NEAR(own->value[0], 1.2, 1e-9);
  const double change = 0.25 * 0.1 / 1.2;
  // no order is seen (the ratio of changes is infinite): w = 1, all of it counts; the two coarser
  // sizes tend to 1.1, 0.1/1.2 away; it is the first bar, so twice
  EXPECT_NEAR(own->error, 2.0 * std::hypot(change, 0.1 / 1.2), 1e-9);
}

TEST(OwnRuns, ChangesThatGrowGiveAWideBar) {
  const std::vector<Resolution> levels{
      {0.4, {number(1.0)}}, {0.2, {number(1.1)}}, {0.1, {number(1.3)}}};
  const auto own = own_estimate(levels, 0.0);
  EXPECT_TRUE(std::isnan(own->observed));
  EXPECT_NEAR(own->value[0], 1.5, 1e-12) << "of order 1";
  // what is extrapolated, 0.2, in full; 0.3 from the 1.2 that the coarser two tend to; twice
  EXPECT_NEAR(own->error, 2.0 * std::hypot(0.2, 0.3) / 1.5, 1e-12);
}

TEST(OwnRuns, TwoSizesHaveThreeTimesTheirChangeAndOneHasNone) {
  const auto two = levels_of({0.2, 0.1}, [](double h) { return 1.0 + h; });
  const auto own = own_estimate(two, 0.0);
  ASSERT_TRUE(own);
  EXPECT_EQ(own->sizes, 2);
  EXPECT_NEAR(own->value[0], 1.1, 1e-12);
  EXPECT_NEAR(own->error, 3.0 * 0.1 / 1.1, 1e-12);
  EXPECT_FALSE(own_estimate(std::span(two).first(1), 0.0));
}

TEST(RunCost, HalvedCellsTakeEightTimesAndSixteenWhereViscosityBoundsTheStep) {
  const EstimatedCost wave{0.1, 3.0, 1e-3, HUGE_VAL, 2};
  EXPECT_DOUBLE_EQ(seconds_with(wave, 0.1, 1.0), 3.0);
  EXPECT_DOUBLE_EQ(seconds_with(wave, 0.05, 1.0), 24.0);
  EXPECT_DOUBLE_EQ(seconds_with(wave, 0.1, 0.5), 6.0);
  const EstimatedCost viscous{0.1, 3.0, 1e-3, 1e-4, 2};
  EXPECT_DOUBLE_EQ(seconds_with(viscous, 0.05, 1.0), 48.0);
  EXPECT_DOUBLE_EQ(seconds_with(viscous, 0.1, 0.5), 3.0) << "the Courant number does not matter";
  // from 1 ms by the wave and 1.5 ms by viscosity: with half the cells 0.5 and 0.375 ms
  const EstimatedCost both{0.1, 3.0, 1e-3, 1.5e-3, 2};
  EXPECT_DOUBLE_EQ(seconds_with(both, 0.05, 1.0), 3.0 * 4.0 * 1e-3 / 0.375e-3);
  const EstimatedCost space{0.1, 3.0, 1e-3, HUGE_VAL, 3};
  EXPECT_DOUBLE_EQ(seconds_with(space, 0.05, 1.0), 48.0);
}

mpm::Scene scene_of(const std::string& name, const std::vector<std::string>& sets = {}) {
  input::InputFile file =
      input::InputFile::read(fmt::format("{}/data/scenes/{}.toml", REPOSE_SOURCE_DIR, name), sets);
  return input::read_scene(file).scene;
}

TEST(TrainedDomain, HasWhatWasCharted) {
  EXPECT_TRUE(beyond_training(scene_of("flat_mu_i", {"scene.end_time=0.6"})).empty());
  EXPECT_TRUE(beyond_training(scene_of("flat_newtonian", {"scene.end_time=0.3"})).empty());
  EXPECT_TRUE(beyond_training(scene_of("flat_mcc", {"scene.end_time=0.4"})).empty());
  EXPECT_TRUE(
      beyond_training(scene_of("tilted_mu_i", {"scene.end_time=0.4", "body[0].law.I_0=0.2"}))
          .empty());
}

TEST(TrainedDomain, SaysWhatIsOutside) {
  const auto only_reason = [](const std::string& name, std::vector<std::string> sets) {
    sets.insert(sets.begin(),
                name == "flat_newtonian" ? "scene.end_time=0.3" : "scene.end_time=0.4");
    const std::vector<std::string> reasons = beyond_training(scene_of(name, sets));
    return reasons.size() == 1 ? reasons.front() : fmt::format("{} reasons", reasons.size());
  };
  // 1.2 s over √(0.4/9.8) s
  EXPECT_EQ(only_reason("flat_mu_i", {"scene.end_time=1.2"}),
            "an end time over sqrt(H/g) of 5.94 (shown: 0 to 3)");
  EXPECT_EQ(only_reason("flat_mu_i", {"body[0].law.form=\"barker_gray\""}),
            "mu_i of the form barker_gray");
  EXPECT_EQ(only_reason("flat_mu_i_regularised", {}), "mu_i of the form regularised");
  EXPECT_EQ(only_reason("flat_mcc", {"body[0].law.compression=\"v-ln_p\""}).substr(0, 29),
            "modified_cam_clay of the form");
  EXPECT_EQ(only_reason("flat_mu_i", {"scene.tilt_deg=40"}),
            "a tilt of 40 degrees (shown: 0 to 35)");
  EXPECT_EQ(only_reason("flat_mu_i", {"body[0].law.mu_0=0.7", "body[0].law.mu_d=0.75"}),
            "mu_0 of 0.7 (shown: 0.2 to 0.6)");
  EXPECT_EQ(only_reason("flat_newtonian", {"body[0].law.eta=50"}).substr(0, 25),
            "eta over rho sqrt(g H) H ");
  EXPECT_EQ(only_reason("flat_mu_i", {"grid.points_per_cell=9"}), "9 points per cell");
  EXPECT_EQ(only_reason("flat_mu_i", {"domain.walls=\"no_slip\""}), "walls other than slip");
}

/// 1 + b h at every size.
Convergence runs_of_slope(const ErrorModel& model, double b, const std::vector<double>& sizes) {
  Convergence so_far(model, 1.0);
  for (const double h : sizes) so_far.add(h, number(1.0 + b * h));
  return so_far;
}
const ErrorModel typical{.bias = 1.0, .irregularity = 0.3, .scatter = 1e-4};

TEST(Decision, TheModelSpeaksWhereRunsBearItOut) {
  const Answer answer = answer_of(runs_of_slope(typical, 1.0, {0.04, 0.02}), {0.05});
  EXPECT_EQ(answer.basis, Basis::measured);
  EXPECT_TRUE(answer.met) << "two sizes are enough for it";
  EXPECT_TRUE(answer.reasons.empty());
}

TEST(Decision, OwnRunsDecideWhereTheSceneIsOfAnotherKind) {
  const Convergence two = runs_of_slope(typical, 1.0, {0.04, 0.02});
  const Answer early = answer_of(two, {0.5, HUGE_VAL, {"another law"}});
  EXPECT_EQ(early.basis, Basis::own_runs);
  EXPECT_EQ(early.reasons, std::vector<std::string>{"another law"});
  EXPECT_LT(early.estimate.error, 0.5);
  EXPECT_FALSE(early.met) << "two sizes never are enough";
  const Answer later =
      answer_of(runs_of_slope(typical, 1.0, {0.04, 0.02, 0.01}), {0.5, HUGE_VAL, {"another law"}});
  EXPECT_TRUE(later.met);
}

// Runs that differ by three times what the model expects of such scenes contradict it.
TEST(Decision, OwnRunsDecideWhereTheyContradictTheModel) {
  // x = 2 and irregularity 0.3: pairs show b h √(1/(1 + 0.09 × 5)), 0.83 b h
  const Answer borne_out = answer_of(runs_of_slope(typical, 2.3, {0.04, 0.02}), {0.5});
  EXPECT_EQ(borne_out.basis, Basis::measured) << 0.83 * 2.3 << " times";
  const Answer contradicted = answer_of(runs_of_slope(typical, 3.0, {0.04, 0.02}), {0.5});
  EXPECT_EQ(contradicted.basis, Basis::own_runs);
  EXPECT_EQ(contradicted.reasons.size(), 1u);
}

TEST(Decision, OwnRunsGoFinerByHalvesAndThirds) {
  const std::vector<double> sizes{0.12, 0.096, 0.08, 0.06, 0.048, 0.04, 0.03};
  const std::vector<double> seconds{1.0, 2.0, 3.4, 8.0, 16.0, 27.0, 64.0};
  Question question{1e-6, HUGE_VAL, {"another law"}};
  Convergence so_far(typical, 1.0);
  std::vector<double> run;
  while (const auto next = next_run(so_far, question, sizes, seconds)) {
    run.push_back(next->h);
    so_far.add(next->h, number(1.0 + next->h));
  }
  EXPECT_EQ(run, (std::vector<double>{0.12, 0.08, 0.06, 0.04, 0.03}));
}

// 1, 3.4, 8 and 27 s were 39.4 s; the next takes 64 s.
TEST(Decision, OwnRunsStayWithinTheBudget) {
  const std::vector<double> sizes{0.12, 0.08, 0.06, 0.04, 0.03};
  const std::vector<double> seconds{1.0, 3.4, 8.0, 27.0, 64.0};
  for (const auto& [budget, finest] : {std::pair{103.0, 0.04}, {104.0, 0.03}}) {
    Convergence so_far(typical, 1.0);
    const Outcome outcome =
        run_to_target(so_far, {1e-6, budget, {"another law"}}, sizes, seconds,
                      [](const Level& next) { return std::optional(number(1.0 + next.h)); });
    EXPECT_EQ(outcome, Outcome::out_of_reach);
    EXPECT_EQ(so_far.levels().back().h, finest) << budget;
  }
}

TEST(Decision, ScatterIsAveragedBeforeCellsAreMadeFiner) {
  const std::vector<double> sizes{0.08, 0.04, 0.02, 0.01, 0.005};
  const std::vector<double> seconds(5, 1.0);
  ErrorModel noisy = typical;
  noisy.scatter = 0.05;
  const Convergence so_far = runs_of_slope(noisy, 0.1, {0.08, 0.04, 0.02, 0.01});
  const auto next = next_run(so_far, {0.05, HUGE_VAL, {"another law"}}, sizes, seconds);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->h, 0.01);
  EXPECT_EQ(next->runs, 1);
}

Graded graded(bool promised, double target, double bar, double error, double reference_bar) {
  Graded g;
  g.scene = "a";
  g.quantity = "height";
  g.basis = "own runs";
  g.promised = promised;
  g.target = target;
  g.bar = bar;
  g.error = error;
  g.reference_bar = reference_bar;
  return g;
}

TEST(Exam, VerdictsFollowTheRule) {
  EXPECT_EQ(verdict_of(graded(true, 0.02, 0.02, 0.030, 0.01)), Verdict::within);
  EXPECT_EQ(verdict_of(graded(true, 0.02, 0.02, 0.031, 0.01)), Verdict::beyond);
  EXPECT_EQ(verdict_of(graded(true, 0.02, 0.02, 0.031, 0.011)), Verdict::undecidable);
  EXPECT_EQ(verdict_of(graded(false, 0.02, 0.10, 0.10, 0.05)), Verdict::bar_holds);
  EXPECT_EQ(verdict_of(graded(false, 0.02, 0.10, 0.11, 0.05)), Verdict::bar_broken);
  EXPECT_EQ(verdict_of(graded(false, 0.02, 0.10, 0.11, 0.06)), Verdict::undecidable);
  EXPECT_EQ(verdict_of(graded(false, 0.02, HUGE_VAL, 0.9, 0.1)), Verdict::bar_holds)
      << "no bar says nothing";
}

TEST(Exam, SharesAreOfWhatCanBeDecided) {
  Marks marks;
  for (int k = 0; k < 19; ++k) marks.add(graded(true, 0.02, 0.02, 0.01, 0.001));
  marks.add(graded(true, 0.02, 0.02, 0.05, 0.001));
  marks.add(graded(true, 0.02, 0.02, 0.05, 0.02));
  marks.add(graded(false, 0.02, 0.06, 0.05, 0.02));
  marks.add(graded(false, 0.02, 0.06, 0.05, 0.04));
  EXPECT_EQ(marks.questions(), 23);
  EXPECT_DOUBLE_EQ(marks.share_within(), 0.95);
  EXPECT_DOUBLE_EQ(marks.share_not_promised(), 2.0 / 23.0) << "whether it can be decided or not";
  EXPECT_TRUE(std::isnan(Marks{}.share_within()));
}

// Limits of 1 and 1.1, ± 1 and 3 %: 1.05; (2 %)² + (0.05/1.05)².
TEST(Exam, KernelsThatDisagreeWidenTheReference) {
  Reference a, b;
  a.value = number(1.0);
  a.error = 0.01;
  b.value = number(1.1);
  b.error = 0.03;
  const Reference both = reference_of_both(a, b);
  EXPECT_DOUBLE_EQ(both.value[0], 1.05);
  EXPECT_NEAR(both.error, std::hypot(0.02, 0.05 / 1.05), 1e-15);
}

TEST(Exam, TheTableHasEveryWrongAnswer) {
  std::vector<Graded> answers{graded(true, 0.05, 0.04, 0.01, 0.001),
                              graded(true, 0.05, 0.04, 0.08, 0.001),
                              graded(false, 0.02, 0.06, 0.05, 0.02)};
  answers[1].scene = "b";
  answers[1].shipped = true;
  const std::string text = exam_tables(answers);
  EXPECT_NE(text.find("| all, 2 scenes | 3 | 1 | 1 | 50 % | 1 | 0 | 0 |"), std::string::npos)
      << text;
  EXPECT_NE(text.find("| shipped scenes at 5 % | 1 | 0 | 1 | 0 % | 0 | 0 | 0 |"), std::string::npos)
      << text;
  EXPECT_NE(text.find("Not promised: 33.3 % of all questions, 0 % of the shipped"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("| b: beyond | height | 5 % | met, own runs | 4 % | 8 % | 0.1 % |"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("| a: beyond"), std::string::npos);
}

TEST(Exam, AnswersAreReadAsTheyWereWritten) {
  Graded one = graded(false, 0.03, HUGE_VAL, 0.123456789012345, 0.01);
  one.shipped = true;
  const Graded again = graded_of(line_of(one));
  EXPECT_EQ(line_of(again), line_of(one));
  EXPECT_EQ(again.bar, HUGE_VAL);
  EXPECT_EQ(again.error, one.error);
  EXPECT_THROW(graded_of("{\"scene\": 3}"), std::invalid_argument);
}

}  // namespace
}  // namespace repose::study

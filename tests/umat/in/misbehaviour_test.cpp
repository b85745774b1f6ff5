/// Libraries that do what none should: what becomes of a path, and what is said of it.
#include <chrono>
#include <cmath>
#include <functional>

#include "calibration/point_simulator.hpp"
#include "tests/umat/in/umat_fixture.hpp"

namespace repose::umat {
namespace {

using point::Curve;
using point::Status;

/// The numbers of misbehaving.c.
enum Deed {
  nan_stress = 1,
  nan_tangent,
  endless_loop,
  call_abort,
  call_exit,
  call_underscore_exit,
  null_pointer,
  behind_statev,
  before_stress,
  far_behind_props,
  smaller_for_ever,
  kill_itself,
  deep_recursion,
  talk_and_exit,
  half_increments,
  divide_by_zero,
  fork_and_return,
  fork_and_exit
};

struct Fate {
  Deed deed;
  const char* word;                ///< by which a fit counts it
  std::vector<std::string> words;  ///< of the message
};

TestLaw misbehaving(Deed deed, int from) {
  Description d = describe(MISBEHAVING, 2, 2);
  d.library.time_limit_s = 0.3;
  return make_law(d, {static_cast<double>(deed), static_cast<double>(from)});
}

class UmatMisbehaviour : public testing::TestWithParam<Fate> {};

TEST_P(UmatMisbehaviour, EndsThePathWithItsReasonAndKeepsWhatWasDone) {
  const Fate& fate = GetParam();
  const TestLaw law = misbehaving(fate.deed, 26);
  const point::PointTest test = triaxial(1e5, 0.01, 10);
  Curve curve;
  const point::Outcome outcome = point::simulate(*law.info, law.theta, test, curve);
  EXPECT_EQ(outcome.status, Status::law_failed);
  EXPECT_EQ(outcome.fault, fate.word);
  // 25 good increments of 10 to a row: the start, two rows, and the last good state
  ASSERT_EQ(curve.rows.size(), 4u);
  EXPECT_NEAR(-curve.rows[2].strain[1], 0.002, 1e-12);
  EXPECT_NEAR(-curve.rows[3].strain[1], 0.0025, 1e-12);
  for (const auto& row : curve.rows) EXPECT_TRUE(std::isfinite(row.stress[1]));
  const std::string text = point::explain(*law.info, law.theta, test, curve);
  for (const std::string& word : fate.words)
    EXPECT_NE(text.find(word), std::string::npos) << "\"" << word << "\" is missing in: " << text;
  EXPECT_NE(text.find("libmisbehaving.so"), std::string::npos) << text;
  EXPECT_NE(text.find("eps_a = 0.0025"), std::string::npos) << text;
  // and the next path is none the worse for it
  const TestLaw good = misbehaving(fate.deed, 1'000'000);
  EXPECT_EQ(point::simulate(*good.info, good.theta, test, curve).status, Status::completed);
}

INSTANTIATE_TEST_SUITE_P(
    All, UmatMisbehaviour,
    testing::Values(
        Fate{nan_stress, "umat_not_finite", {"it returned STRESS(2) = nan"}},
        Fate{nan_tangent, "umat_not_finite", {"it returned DDSDDE(1,2) = inf"}},
        Fate{endless_loop, "umat_too_long", {"a call took more than 0.3 s", "endless loop"}},
        Fate{call_abort, "umat_aborted", {"it called abort()"}},
        Fate{call_exit, "umat_exited", {"ended its process with exit code 0", "exit"}},
        Fate{call_underscore_exit, "umat_exited", {"ended its process with exit code 0", "_exit"}},
        Fate{null_pointer, "umat_crashed", {"SIGSEGV", "Segmentation fault"}},
        Fate{behind_statev, "umat_beyond_array", {"beyond STATEV, behind its end", "NSTATV = 2"}},
        Fate{before_stress, "umat_beyond_array", {"beyond STRESS, before its beginning"}},
        Fate{far_behind_props, "umat_beyond_array", {"beyond PROPS, behind its end", "NPROPS = 2"}},
        Fate{kill_itself, "umat_killed", {"SIGKILL"}},
        Fate{deep_recursion, "umat_crashed", {"SIGSEGV"}},
        Fate{talk_and_exit,
             "umat_exited",
             {"exit code 3", "it printed \"no such material: gravel\""}},
        Fate{divide_by_zero, "umat_crashed", {"SIGFPE"}}),
    [](const auto& fate) {
      return std::string(fate.param.word) + "_" + std::to_string(fate.param.deed);
    });

// PNEWDT < 1 halves the step; 30 times in vain is the library's failure.
TEST(UmatPnewdt, BelowOneCutsTheStep) {
  const point::PointTest test = triaxial(1e5, 0.01, 2);  // steps of 5e-4, and 1e-4 is allowed
  TestLaw law = misbehaving(half_increments, 0);
  Curve curve;
  const point::Outcome outcome = point::simulate(*law.info, law.theta, test, curve);
  EXPECT_EQ(outcome.status, Status::completed);
  EXPECT_GE(outcome.counts.steps, 100);
  EXPECT_GT(outcome.counts.rejected, 0);
  // elastic, ν = 0: E ε, whatever the steps; 160 steps met to 1e-10 of 2e5 Pa
  EXPECT_NEAR(-curve.rows.back().stress[1] - 1e5, 1e7 * 0.01, 160 * 1e-10 * 2e5);
  law = misbehaving(smaller_for_ever, 26);
  const point::PointTest vain = triaxial(1e5, 0.01, 10);
  EXPECT_EQ(point::simulate(*law.info, law.theta, vain, curve).status, Status::law_failed);
  EXPECT_EQ(curve.outcome.fault, "umat_not_converged");
  EXPECT_NE(point::explain(*law.info, law.theta, vain, curve).find("ever smaller increments"),
            std::string::npos);
}

// A child of the library's process ends without a word: the path is that of a library without one.
TEST(UmatFork, AChildNeitherServesNorAnswers) {
  const point::PointTest test = triaxial(1e5, 0.01, 10);
  const auto last = [&](Deed deed, int from) {
    const TestLaw law = misbehaving(deed, from);
    Curve curve;
    EXPECT_EQ(point::simulate(*law.info, law.theta, test, curve).status, Status::completed) << deed;
    return curve.rows.back().stress;
  };
  const auto alone = last(fork_and_return, 1'000'000);
  for (const Deed deed : {fork_and_return, fork_and_exit})
    EXPECT_EQ(last(deed, 26).c, alone.c) << deed;
}

TEST(UmatLoading, SaysWhatIsMissing) {
  const auto said = [](Library library) {
    try {
      check_library(library);
    } catch (const InputError& error) {
      return error.key() + ": " + error.what();
    }
    return std::string("nothing");
  };
  Library library = describe(OTHER_NAME, 1, 0).library;
  const std::string missing = said(library);
  EXPECT_EQ(missing.find("symbol: "), 0u) << missing;
  EXPECT_NE(missing.find("no function umat_ (symbol); it has UMAT, my_umat_helper"),
            std::string::npos)
      << missing;
  library.symbol = "UMAT";
  EXPECT_EQ(said(library), "nothing");
  library.file = REPOSE_SOURCE_DIR "/README.md";
  const std::string text = said(library);
  EXPECT_EQ(text.find("library: "), 0u) << text;
  EXPECT_NE(text.find("cannot be loaded"), std::string::npos) << text;
}

// A fit goes on: a trial that breaks off is one that failed, by its reason, and its rows count.
TEST(UmatInAFit, NamesTheReasonOfAFailedTrial) {
  Description d = describe(MISBEHAVING, 2, 1);
  d.names = {"deed", "from"};
  const TestLaw law = make_law(d, {static_cast<double>(null_pointer), 1e6});
  calibration::PointExperiment experiment;
  experiment.law = law.info;
  experiment.theta = law.theta;
  experiment.test = triaxial(1e5, 0.01, 1);
  experiment.x = point::Quantity::eps_a;
  experiment.y = {point::Quantity::q};
  experiment.abscissae = {0.002, 0.004, 0.01};
  experiment.lines = {1, 2, 3};
  const auto simulator = calibration::make_point_simulator(experiment);
  std::vector<double> inputs = law.theta;
  inputs.resize(simulator->inputs().size(), std::nan(""));
  calibration::Response response;
  simulator->simulate(inputs, {}, response);
  EXPECT_TRUE(response.complete());
  ASSERT_EQ(response.x.size(), 3);
  EXPECT_NEAR(response.y(2, 0), 1e5, 30 * 1e-10 * 2e5);  // E ε_a
  inputs[1] = 25.0;                                      // in the third leg of ten increments
  const std::vector<int> wanted{1};
  for (const std::span<const int> by : {std::span<const int>(), std::span<const int>(wanted)}) {
    simulator->simulate(inputs, by, response);
    EXPECT_EQ(response.reason, "umat_crashed");
    EXPECT_EQ(response.x.size(), 2);
    EXPECT_GT(response.finished, 0.5);
    EXPECT_LT(response.finished, 1.0);
  }
}

#ifdef STOPPING
TEST(UmatMisbehaviour, FortranStopIsSaid) {
  const TestLaw law = make_law(STOPPING, {26.0});
  const point::PointTest test = triaxial(1e5, 0.01, 10);
  Curve curve;
  const point::Outcome outcome = point::simulate(*law.info, law.theta, test, curve);
  EXPECT_EQ(outcome.fault, "umat_exited");
  EXPECT_EQ(curve.rows.size(), 4u);
  const std::string text = point::explain(*law.info, law.theta, test, curve);
  EXPECT_NE(text.find("STOP, exit"), std::string::npos) << text;
  EXPECT_NE(text.find("it printed \"STOP the material has had enough\""), std::string::npos)
      << text;
}
#else
TEST(UmatMisbehaviour, FortranStopNeedsACompiler) { GTEST_SKIP() << "no gfortran"; }
#endif

}  // namespace
}  // namespace repose::umat

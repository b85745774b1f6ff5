// `repose run --accuracy`: what it predicts, refuses, runs and leaves; and the errors of a chart.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "app/command_line.hpp"
#include "io/json.hpp"
#include "study/accuracy/accurate_run.hpp"
#include "study/accuracy/errors.hpp"
#include "study/accuracy/trained_domain.hpp"
#include "study/run/run_record.hpp"
#include "tests/app/csv_table.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::study {
namespace {

namespace fs = std::filesystem;

class Accuracy : public testing::Test {
 protected:
  int run(std::vector<std::string> words, const std::string& out) {
    words.insert(words.begin(), {"repose"});
    words.insert(words.end(), {"-o", (base_ / out).string()});
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const int code = app::run_command_line(static_cast<int>(argv.size()), argv.data());
    error_ = testing::internal::GetCapturedStderr();
    text_ = testing::internal::GetCapturedStdout();
    return code;
  }
  /// What `repose run` complains about; it must be bad input and leave nothing.
  std::string complaint(std::vector<std::string> words) {
    words.insert(words.begin(), {"run", scene_});
    EXPECT_EQ(run(words, "bad"), 2) << error_;
    EXPECT_FALSE(fs::exists(base_ / "bad"));
    return error_;
  }
  io::Json summary(const std::string& out) const {
    return io::Json::parse(content_of(base_ / out / "summary.json"));
  }

  /// Kinetic energy over time of a run or an estimate.
  Eigen::VectorXd kinetic(const fs::path& table) const {
    std::vector<double> values;
    for (const auto& row : app::table_of(base_ / table))
      values.push_back(std::stod(row.at("kinetic_J_per_m")));
    return Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  }

  const std::string scene_ = REPOSE_SOURCE_DIR "/data/scenes/flat_mu_i.toml";
  const ScratchFolder scratch_;
  const fs::path base_ = scratch_.path();
  std::string error_, text_;
};

// 0.2 s of the column with cells of 50 and 25 mm (128 and 512 points), a few hundred steps.
TEST_F(Accuracy, RunsCoarseAndFineAndGivesAnErrorBar) {
  const std::vector<std::string> words{"run",   scene_,    "--accuracy", "0.2",
                                       "--for", "kinetic", "--set",      "scene.end_time=0.2"};
  ASSERT_EQ(run(words, "a"), 0) << error_;
  const io::Json s = summary("a");
  EXPECT_EQ(s["kind"], "accuracy");
  EXPECT_EQ(s["status"], "done");
  EXPECT_EQ(s["met"], true);
  EXPECT_LE(s["error_bar"].get<double>(), 0.2);
  EXPECT_GT(s["error_bar"].get<double>(), 0.0);
  ASSERT_GE(s["runs"].size(), 2u);
  EXPECT_GT(s["runs"][0]["h_m"].get<double>(), 1.9 * s["runs"].back()["h_m"].get<double>());
  EXPECT_GT(s["predicted"]["cpu_s"].get<double>(), 0.0);
  EXPECT_NE(text_.find("predicted: cells of "), std::string::npos) << text_;
  EXPECT_EQ(s["basis"], "measured");
  EXPECT_TRUE(s["reasons"].empty());
  // the row of rehearsed_rows.inc that counts: the largest target not above 0.2
  const auto shown = rehearsed("mu_i", "elastoviscoplastic", Quantity::kinetic, 0.2);
  ASSERT_TRUE(shown && shown->shown());
  EXPECT_EQ(s["promise"]["answers"], shown->answers);
  EXPECT_EQ(s["promise"]["held"], shown->held);
  EXPECT_NE(text_.find(fmt::format("{} of {} such answers were within 1.5 of the target",
                                   shown->held, shown->answers)),
            std::string::npos)
      << text_;
  for (const char* file : {"input.toml", "accuracy.csv", "estimate.csv", "advised.toml"})
    EXPECT_TRUE(fs::exists(base_ / "a" / file)) << file;
  // the energy over time begins at rest
  EXPECT_EQ(content_of(base_ / "a/estimate.csv").substr(0, 28), "time_s,kinetic_J_per_m\n0,0\n0");
  input::InputFile advised = input::InputFile::read(base_ / "a/advised.toml");
  EXPECT_EQ(input::read_scene(advised).scene.h, s["finest_h_m"].get<double>());

  // once more, with the runs of before: nothing is simulated, the same comes out
  std::vector<std::string> again = words;
  again.insert(again.end(), {"--runs", (base_ / "a/runs").string()});
  ASSERT_EQ(run(again, "b"), 0) << error_;
  EXPECT_EQ(summary("b")["cpu_s"], s["cpu_s"]) << "the same seconds, so the same runs";
  EXPECT_EQ(content_of(base_ / "b/estimate.csv"), content_of(base_ / "a/estimate.csv"));
}

// That a target is met is what ends the runs. Whether it is met, only finer runs can tell; and what
// is written must be what the runs in the folder give.
TEST_F(Accuracy, TheErrorBarIsThatOfItsRunsAndTrue) {
  ASSERT_EQ(
      run({"run", scene_, "--accuracy", "0.1", "--for", "kinetic", "--set", "scene.end_time=0.2"},
          "a"),
      0)
      << error_;
  const io::Json s = summary("a");
  input::InputFile file = input::InputFile::read(scene_);
  const mpm::Scene scene = input::read_scene(file).scene;
  const auto candidates = candidates_for(scene, Quantity::kinetic);
  const auto used = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& c) {
    return mpm::name_of(c.kernel) == s["kernel"].get<std::string>() &&
           mpm::name_of(c.transfer) == s["transfer"].get<std::string>() &&
           c.courant == s["courant"];
  });
  ASSERT_NE(used, candidates.end());
  Convergence again(used->model, std::sqrt(0.2 * 0.4));
  for (const auto& level : s["runs"])
    again.add(level["h_m"].get<double>(),
              kinetic(fs::path("a/runs") / level["run"].get<std::string>() / "series.csv"));
  const Estimate expected = again.estimate();
  // sums of some 500 products that are scaled by another interval: 500 eps
  EXPECT_NEAR(s["error_bar"].get<double>(), expected.error, 1e-12);
  const Eigen::VectorXd estimate = kinetic("a/estimate.csv");
  ASSERT_EQ(estimate.size(), expected.value.size());
  EXPECT_LT(relative_distance(estimate, expected.value), 1e-9) << "ten digits are written";

  // Against cells of an eighth of the coarsest, of which the error is an eighth of it at first
  // order. Nine of ten answers are within 1.5 error bars; and a bar ten times too wide would say
  // nothing.
  ASSERT_EQ(run({"run", (base_ / "a/advised.toml").string(), "--set",
                 fmt::format("grid.h={}", s["runs"][0]["h_m"].get<double>() / 8.0), "--set",
                 fmt::format("output.series_interval={}",
                             0.2 / static_cast<double>(estimate.size() - 1))},
                "fine"),
            0)
      << error_;
  const double off = relative_distance(estimate, kinetic("fine/series.csv"));
  EXPECT_LT(off, 1.5 * s["error_bar"].get<double>());
  EXPECT_GT(off, 0.1 * s["error_bar"].get<double>());
}

TEST_F(Accuracy, RefusesBeforehandWhatTheBudgetDoesNotBuy) {
  const std::string text = complaint(
      {"--accuracy", "0.02", "--for", "kinetic", "--budget", "0.2", "--set", "scene.end_time=0.5"});
  EXPECT_EQ(text.find("kinetic to 2 % needs about "), 0u) << text;
  EXPECT_NE(text.find("more than the budget of 0.2 s; within it, about "), std::string::npos)
      << text;
  const std::size_t advice = text.find(": --accuracy ");
  ASSERT_NE(advice, std::string::npos) << text;
  EXPECT_GT(std::stod(text.substr(advice + 13)), 0.02) << text;
  EXPECT_NE(text.find("; or --budget "), std::string::npos) << text;
}

// The paper's column at its own 1.2 s, longer than any training scene: 2 % of its energy take cells
// of 3 mm and less, half a minute. With half a second it says what its coarse runs show, and that
// this is not what was asked for. The last run may be under way when the budget ends; it is stopped
// at its next step, of which the smallest here takes 2 ms at most.
TEST_F(Accuracy, ABudgetEndsRunsAndLeavesTheBestAnswer) {
  ASSERT_EQ(run({"run", scene_, "--accuracy", "0.02", "--for", "kinetic", "--budget", "0.5"}, "a"),
            3)
      << error_;
  const io::Json s = summary("a");
  EXPECT_EQ(s["status"], "done");
  EXPECT_EQ(s["met"], false);
  EXPECT_EQ(s["basis"], "own runs");
  EXPECT_EQ(s["reasons"][0].get<std::string>().find("an end time over sqrt(H/g) of 5.94"), 0u);
  EXPECT_TRUE(s["promise"]["kept_to"].is_null());
  EXPECT_GT(s["error_bar"].get<double>(), 0.02);
  EXPECT_LE(s["cpu_s"].get<double>(), 0.5 + 0.1);
  EXPECT_GE(s["runs"].size(), 2u);
  EXPECT_NE(text_.find("not shown for an end time over sqrt(H/g) of 5.94"), std::string::npos)
      << text_;
  EXPECT_NE(error_.find("cannot promise kinetic to 2 %, only to "), std::string::npos) << error_;
}

// A run that alone takes more than the budget is stopped on its way.
TEST_F(Accuracy, ARunIsStoppedWhereItsLimitIs) {
  input::InputFile file = input::InputFile::read(scene_);
  const input::SceneFile scene = input::read_scene(file);
  SweepRun long_run = run_of(scene, scene.scene);  // 10 s of CPU
  const double begun = usage().cpu_s;
  EXPECT_EQ(carry_out(long_run, base_ / "runs", 1, false, 0.2), io::ExitCode::interrupted);
  EXPECT_LT(usage().cpu_s - begun, 1.0) << "0.2 s, the start and the checkpoint";
  EXPECT_FALSE(long_run.done());
}

// Explicit, the regularised column would take 7e8 steps at h = 6 mm and less
// (implicit_viscosity.md).
TEST_F(Accuracy, ViscosityThatBoundsTheStepIsSolvedFor) {
  AccuracyGoal goal;
  input::InputFile file =
      input::InputFile::read(REPOSE_SOURCE_DIR "/data/scenes/flat_mu_i_regularised.toml");
  goal.file = input::read_scene(file);
  goal.quantity = Quantity::kinetic;
  goal.target = 0.05;
  const AccurateRun work(goal);
  EXPECT_TRUE(work.made_implicit());
  EXPECT_EQ(work.scene().viscosity, mpm::Viscosity::implicit_solve);
  EXPECT_EQ(work.choice().reasons.front(), "an implicit viscosity");
}

TEST_F(Accuracy, SaysWhatIsWrong) {
  EXPECT_EQ(complaint({"--accuracy", "0.02", "--for", "frnt"}),
            "--for frnt: one of front, front_99, height, profile, kinetic is needed; did you mean "
            "'front'?\n");
  EXPECT_EQ(complaint({"--accuracy", "0.02"}),
            "--accuracy needs --for, one of front, front_99, height, profile, kinetic\n");
  EXPECT_EQ(complaint({"--accuracy", "2", "--for", "front"}),
            "--accuracy 2: the relative error must be a number in (0, 0.5]\n");
  EXPECT_EQ(complaint({"--accuracy", "0.02", "--for", "front", "--budget", "-1"}),
            "--budget -1: CPU seconds must be a number in (0, 1000000000]\n");
  EXPECT_EQ(complaint({"--for", "front"}), "--for goes with --accuracy, which is missing\n");
  EXPECT_EQ(complaint({"--accuracy", "0.02", "--for", "front", "--set", "grid.h=0.01"}),
            "--set grid.h=0.01: --accuracy chooses grid.h itself\n");
}

TEST(AccuracyTable, EveryLawHasConstants) {
  for (const char* name : {"flat_mu_i", "flat_newtonian", "flat_mcc"}) {
    input::InputFile file =
        input::InputFile::read(fmt::format("{}/data/scenes/{}.toml", REPOSE_SOURCE_DIR, name));
    const mpm::Scene scene = input::read_scene(file).scene;
    for (std::size_t q = 0; q < advised_names.size(); ++q) {
      const auto candidates = candidates_for(scene, static_cast<Quantity>(q));
      EXPECT_TRUE(is_charted(scene.bodies.front().law)) << name;
      ASSERT_FALSE(candidates.empty()) << name << " " << quantity_names[q];
      for (const Candidate& c : candidates) {
        EXPECT_GT(c.model.bias, 0.0);
        EXPECT_GT(c.model.irregularity, 0.0);
        EXPECT_GT(c.model.caution, 0.0);
        EXPECT_GE(c.model.scatter, 1e-4);
        mpm::Scene tried = scene_with(scene, c, scene.h, 2);
        EXPECT_NO_THROW(mpm::validate(tried));
        EXPECT_NEAR(tried.courant, 0.92 * c.courant, 1e-4);
      }
    }
  }
}

TEST(AccuracyTable, SizesFitTheBoxAndTheBodies) {
  input::InputFile file = input::InputFile::read(REPOSE_SOURCE_DIR "/data/scenes/flat_mu_i.toml");
  const mpm::Scene scene = input::read_scene(file).scene;
  const std::vector<double> sizes = sizes_for(scene, 40000.0);
  // the column is 0.2 m wide: 4 cells of 50 mm; 4 × 0.08 m²/h² ≤ 40 000 is h ≥ 2.83 mm
  std::vector<double> expected;
  for (const double h : {0.05, 0.025, 0.0125, 0.00625})
    expected.insert(expected.end(), {h, 4.0 * h / 5.0, 2.0 * h / 3.0});
  expected.push_back(0.003125);
  EXPECT_EQ(sizes, expected);
}

/// A finished run with one figure.
SweepRun run_with(double h, double courant, double front, double cpu) {
  SweepRun run;
  mpm::Scene& scene = run.file.scene;
  scene.h = h;
  scene.courant = courant;
  scene.domain = {2.0, 1.0};
  scene.end_time = 1.0;
  scene.series_interval = 1.0;
  scene.bodies.resize(1);
  scene.bodies[0].size = {0.5, 0.5};
  run.summary.status = "done";
  run.summary.figures = {{"front_m", front}, {"height_m", 1.0}, {"cpu_s", cpu}};
  run.series["kinetic_J_per_m"] = {0.0, 1.0 + h};
  // a wedge whose volume does not depend on the cells
  run.x_m = {0.0, 1.0, 2.0};
  run.depth_m = {1.0, 0.5, 0.0};
  return run;
}

TEST(SweepErrors, AreMeasuredFromTheExtrapolatedReference) {
  std::vector<SweepRun> runs;
  for (const double h : {0.2, 0.1, 0.05})
    for (const double courant : {1.0, 0.8, 0.6})
      runs.push_back(run_with(h, courant, 1.0 - h, 1.0 / h / courant));
  const auto reference = reference_of(runs, runs[0].scene());
  ASSERT_TRUE(reference);
  EXPECT_EQ(reference->steps, 3u);
  const double bin = common_bin(runs);
  EXPECT_EQ(bin, 0.2);
  const auto& front = reference->values[static_cast<std::size_t>(Quantity::front)];
  ASSERT_TRUE(front);
  EXPECT_NEAR(front->value[0], 1.0, 1e-9);
  EXPECT_NEAR(front->observed, 1.0, 1e-9);
  EXPECT_NEAR(error_of(runs[0], Quantity::front, *reference, bin), 0.2, 1e-9);
  EXPECT_NEAR(error_of(runs[0], Quantity::profile, *reference, bin), 0.0, 1e-12);
  EXPECT_NEAR(error_of(runs[8], Quantity::kinetic, *reference, bin), 0.05, 1e-9);
  // the cheapest run of every size
  const std::vector<bool> pareto = pareto_front(runs, Quantity::front, *reference);
  EXPECT_EQ(std::count(pareto.begin(), pareto.end(), true), 3);
  for (const std::size_t k : {0u, 3u, 6u}) EXPECT_TRUE(pareto[k]) << k;
  runs.resize(6);
  EXPECT_FALSE(reference_of(runs, runs[0].scene())) << "two sizes are none";
}

TEST(SweepErrors, ProfilesOfDifferentCellsHaveTheSameVolumes) {
  SweepRun run = run_with(0.2, 1.0, 1.0, 1.0);
  const Eigen::VectorXd shares = shares_of(run, Quantity::profile, 0.5);
  ASSERT_EQ(shares.size(), 4);
  EXPECT_NEAR(shares.sum(), 1.0, 1e-15) << "the wedge of 2 m by 1 m";
  EXPECT_NEAR(shares[0], 0.5 * 0.875, 1e-15) << "between depths of 1 and 0.75 m";
  const QuantityCurve curve = curve_of(shares, Quantity::profile, run.scene(), 0.5);
  EXPECT_DOUBLE_EQ(curve.x[0], 0.25);
  EXPECT_NEAR(curve.y[0], 0.875, 1e-15);
}

TEST(Quantities, TheEnergyOfASceneInSpaceIsNotPerMetre) {
  EXPECT_EQ(column_of(Quantity::kinetic), "kinetic_J_per_m");
  EXPECT_EQ(column_of(Quantity::kinetic, 3), "kinetic_J");
  for (const Quantity q :
       {Quantity::front, Quantity::front_99, Quantity::height, Quantity::profile})
    EXPECT_EQ(column_of(q, 3), column_of(q));
}

}  // namespace
}  // namespace repose::study

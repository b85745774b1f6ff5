// `repose chart mpm`: what it varies, what it makes of the results, its files and its messages.
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "app/command_line.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "repose_version.hpp"
#include "study/accuracy/sweep.hpp"
#include "tests/app/csv_table.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;

study::SweepRun run_with(double courant, std::vector<double> depth, double front) {
  study::SweepRun run;
  mpm::Scene& scene = run.file.scene;
  scene.h = 0.5;
  scene.courant = courant;
  scene.bodies.resize(1);
  scene.bodies[0].size = {1.0, 2.0};
  run.summary.status = "done";
  run.summary.figures = {{"front_m", front},
                         {"front_99_m", 0.8 * front},
                         {"height_m", depth[0]},
                         {"time_s", 1.0},
                         {"steps", 1.0 / courant}};
  run.depth_m = std::move(depth);
  return run;
}

TEST(MpmSweep, ChangesAreMeasuredFromTheShortestStep) {
  const std::vector<study::SweepRun> runs{run_with(0.4, {2.2, 1.0, 0.0}, 1.1),
                                          run_with(0.2, {2.0, 1.2, 0.1}, 1.0),
                                          run_with(0.1, {2.0, 1.0, 0.0}, 1.0)};
  const std::vector<study::SweepSeries> series = study::series_of(runs);
  ASSERT_EQ(series.size(), 1u);
  ASSERT_EQ(series[0].finest(), &runs[2]);
  const auto change = study::change_between(runs[0], runs[2]);
  ASSERT_TRUE(change);
  EXPECT_DOUBLE_EQ(change->front, 1.1 / 1.0 - 1.0);
  EXPECT_DOUBLE_EQ(change->front_99, 0.8 * 1.1 / (0.8 * 1.0) - 1.0);
  EXPECT_DOUBLE_EQ(change->height, 2.2 / 2.0 - 1.0);
  EXPECT_DOUBLE_EQ(change->profile_max, (2.2 - 2.0) / 2.0);
  // |Δdepth| of 0.2 over half a column, over the front of 1 m and H_0 = 2 m
  EXPECT_DOUBLE_EQ(change->profile_mean, (2.2 - 2.0) * 0.25 / (1.0 * 2.0));
  // only 0.4 → 0.1 is a quarter
  const auto quartered = study::change_when_quartered(series[0]);
  ASSERT_TRUE(quartered);
  EXPECT_DOUBLE_EQ(quartered->front, change->front);
  EXPECT_DOUBLE_EQ(quartered->profile_max, change->profile_max);
}

TEST(MpmSweep, WhatIsNotThereIsNotCompared) {
  std::vector<study::SweepRun> runs{run_with(0.4, {2.2, 1.0, 0.0}, 1.1),
                                    run_with(0.1, {2.0, 1.0, 0.0}, 1.0)};
  runs[1].summary.status = "failed";
  EXPECT_EQ(study::series_of(runs)[0].finest(), &runs[0]) << "a failed run is no reference";
  EXPECT_FALSE(study::change_between(runs[0], runs[1]));
  EXPECT_FALSE(study::change_when_quartered(study::series_of(runs)[0]));
  runs[1].summary = {};
  EXPECT_EQ(study::series_of(runs)[0].finest(), nullptr) << "a run is still to come";
}

TEST(MpmSweep, VariesEverythingAndKeepsTheRestOfTheScene) {
  input::InputFile file = input::InputFile::read(REPOSE_SOURCE_DIR "/data/scenes/flat_mu_i.toml");
  const input::SceneFile scene = input::read_scene(file);
  std::vector<std::string> notes;
  const input::Sweep sweep = study::with_defaults({}, scene.scene, false, notes);
  const std::vector<study::SweepRun> runs = study::runs_of(scene, sweep);
  EXPECT_EQ(runs.size(), mpm::transfer_names.size() * 3 * 4);  // h of 50, 25, 12.5 mm, four steps
  std::set<std::string> names;
  for (const study::SweepRun& run : runs) {
    names.insert(run.scene().name);
    EXPECT_EQ(run.scene().end_time, 1.2);
    EXPECT_EQ(run.scene().frame_interval, 0.0);
    EXPECT_EQ(run.scene().bodies[0].law.values.at("K"), 254800.0);
  }
  EXPECT_EQ(names.size(), runs.size());
  EXPECT_EQ(runs[0].scene().name, "flat_mu_i_pic_cubic_h0.05_courant0.8");
  EXPECT_EQ(runs[11].scene().h, 0.0125);
  input::Sweep more = sweep;
  more.points_per_cell = {9, 4};
  more.reference = {0.00625};
  const std::vector<study::SweepRun> all = study::runs_of(scene, more);
  ASSERT_EQ(all.size(), 2 * runs.size() + 4);
  EXPECT_EQ(all[0].scene().name, "flat_mu_i_pic_cubic_9ppc_h0.05_courant0.8");
  EXPECT_EQ(all.back().scene().name, "flat_mu_i_relaxed_cubic_h0.00625_courant0.1");
  EXPECT_EQ(study::with_defaults({}, scene.scene, true, notes).cells, std::vector<double>{0.025});
  input::Sweep fixed;
  fixed.dts = {1e-4};
  EXPECT_TRUE(study::with_defaults(fixed, scene.scene, false, notes).courants.empty());
}

TEST(MpmSweep, LeavesOutTransfersThatTheSceneRefuses) {
  const std::vector<std::string> sets{"domain.walls=\"periodic\"", "domain.top=\"slip\""};
  input::InputFile file =
      input::InputFile::read(REPOSE_SOURCE_DIR "/data/scenes/flat_mu_i.toml", sets);
  const input::SceneFile scene = input::read_scene(file);
  std::vector<std::string> notes;
  const input::Sweep sweep = study::with_defaults({}, scene.scene, true, notes);
  EXPECT_EQ(sweep.transfers.size(), mpm::transfer_names.size() - 2);
  for (const mpm::Transfer transfer : sweep.transfers)
    EXPECT_TRUE(transfer != mpm::Transfer::xpic && transfer != mpm::Transfer::fmpm);
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_EQ(notes[0],
            "xpic is left out: a periodic edge or a wall that moves does not go with step.transfer "
            "= \"xpic\" yet; any other transfer does");
  EXPECT_EQ(study::runs_of(scene, sweep).size(), sweep.transfers.size() * 2);
  // asked for by name it is an error, and not one of the cells
  input::Sweep asked = sweep;
  asked.transfers = {mpm::Transfer::fmpm};
  try {
    study::runs_of(scene, asked);
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "chart.transfers");
  }
}

class ChartMpm : public testing::Test {
 protected:
  int run(std::vector<std::string> words, const std::string& out) {
    words.insert(words.begin(), {"repose"});
    words.insert(words.end(), {"-o", (base_ / out).string(), "--quiet"});
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    testing::internal::CaptureStderr();
    const int code = run_command_line(static_cast<int>(argv.size()), argv.data());
    error_ = testing::internal::GetCapturedStderr();
    return code;
  }
  /// What `repose chart …` complains about; it must be bad input and leave nothing.
  std::string complaint(std::vector<std::string> words) {
    words.insert(words.begin(), "chart");
    EXPECT_EQ(run(words, "bad"), 2) << error_;
    EXPECT_FALSE(fs::exists(base_ / "bad"));
    return error_;
  }
  io::Json summary(const std::string& out) const {
    return io::Json::parse(content_of(base_ / out / "summary.json"));
  }

  const ScratchFolder scratch_;
  const fs::path base_ = scratch_.path();
  std::string error_;
};

// In space energies are whole, not per metre: columns, units and pictures follow.
TEST_F(ChartMpm, InSpace) {
  ASSERT_EQ(run({"chart", "mpm", REPOSE_SOURCE_DIR "/data/scenes/axisymmetric_mu_i.toml", "--set",
                 "scene.end_time=0.02", "--transfers", "relaxed", "--kernels", "quadratic",
                 "--cells", "0.05", "--courants", "0.8,0.4", "--no-plot"},
                "space"),
            0)
      << error_;
  const Table chart = table_of(base_ / "space/chart.csv");
  ASSERT_EQ(chart.size(), 2u);
  EXPECT_EQ(chart[0].count("kinetic_J_per_m"), 0u);
  EXPECT_GT(std::stod(chart[0].at("kinetic_J")), 0.0);
  EXPECT_GE(std::stod(chart[0].at("peak_kinetic_J")), std::stod(chart[0].at("kinetic_J")));
  const Table history = table_of(base_ / "space/history.csv");
  EXPECT_EQ(history.size(), 2u * 61u);
  EXPECT_EQ(std::stod(history.back().at("kinetic_J")), std::stod(chart[1].at("kinetic_J")));
  const io::Json answer = summary("space")["answer"];
  EXPECT_TRUE(answer[0]["kinetic_J"].is_array()) << answer.dump();
}

// 512 points, 0.2 s: eight runs in about a second.
TEST_F(ChartMpm, AQuickChart) {
  const std::vector<std::string> quick{"chart",        "mpm",   "--quick",           "--transfers",
                                       "apic,relaxed", "--set", "scene.end_time=0.2"};
  ASSERT_EQ(run(quick, "a"), 0) << error_;
  const Table chart = table_of(base_ / "a/chart.csv");
  ASSERT_EQ(chart.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& row = chart[i];
    EXPECT_EQ(row.at("transfer"), i < 2 ? "apic" : "relaxed");
    EXPECT_EQ(row.at("kernel"), "cubic");
    EXPECT_EQ(row.at("h_m"), "0.025");
    EXPECT_EQ(row.at("courant"), i % 2 == 0 ? "0.8" : "0.4");
    EXPECT_EQ(row.at("dt_s"), "");
    EXPECT_EQ(row.at("status"), "done");
    EXPECT_EQ(row.at("points"), "512");
    EXPECT_EQ(row.at("threads"), "1");
    EXPECT_GT(std::stod(row.at("point_steps_per_cpu_s")), 0.0);
    EXPECT_GE(std::stod(row.at("peak_kinetic_J_per_m")), std::stod(row.at("kinetic_J_per_m")));
    if (i % 2 == 0)
      EXPECT_NE(std::stod(row.at("profile_change_max")), 0.0);
    else
      EXPECT_EQ(row.at("profile_change_max"), "0") << "the reference itself";
  }

  // the same run by hand
  ASSERT_EQ(
      run({"run", REPOSE_SOURCE_DIR "/data/scenes/flat_mu_i.toml", "--set", "grid.h=0.025", "--set",
           "step.courant=0.8", "--set", "step.transfer=apic", "--set", "scene.end_time=0.2",
           "--set", "output.series_interval=" + fmt::format("{}", 0.2 / 60), "--set",
           "output.frame_interval=0", "--threads", "1"},
          "hand"),
      0);
  const io::Json hand = summary("hand");
  EXPECT_EQ(chart[0].at("steps"), std::to_string(hand["steps"].get<int>()));
  for (const char* key :
       {"front_m", "front_99_m", "height_m", "kinetic_J_per_m", "angular_momentum"})
    EXPECT_EQ(chart[0].at(key), fmt::format("{:.10g}", hand[key].get<double>())) << key;
  EXPECT_EQ(chart[0].at("mean_dt_s"),
            fmt::format("{:.10g}", 0.2 / static_cast<double>(hand["steps"].get<int>())));

  const Table history = table_of(base_ / "a/history.csv");
  ASSERT_EQ(history.size(), 4u * 61);
  EXPECT_EQ(history[60].at("time_s"), "0.2");
  EXPECT_EQ(history[60].at("front_m"), chart[0].at("front_m"));

  const io::Json s = summary("a");
  EXPECT_EQ(s["status"], "done");
  EXPECT_EQ(s["runs"], 4);
  ASSERT_EQ(s["answer"].size(), 2u);
  EXPECT_EQ(s["answer"][0]["front_m"][0], hand["front_m"]);
  EXPECT_TRUE(s["answer"][0]["independent_of_step"].is_null()) << "no step is a quarter of another";

  // its input.toml makes the same chart; once more in the same folder, nothing is repeated
  const auto physics = [](Table table) {
    for (auto& row : table)
      for (const char* key : {"cpu_s", "point_steps_per_cpu_s"}) row.erase(key);
    return table;
  };
  ASSERT_EQ(run({"chart", (base_ / "a/input.toml").string()}, "b"), 0) << error_;
  EXPECT_EQ(physics(table_of(base_ / "b/chart.csv")), physics(chart));
  const std::string before = content_of(base_ / "a/chart.csv");
  std::vector<std::string> again = quick;
  ASSERT_EQ(run(again, "a"), 0) << error_;
  EXPECT_EQ(content_of(base_ / "a/chart.csv"), before) << "the same seconds, so the same runs";
  // another scene's runs are not taken for this one's
  again.insert(again.end(), {"--set", "scene.gravity=4.9"});
  ASSERT_EQ(run(again, "a"), 0) << error_;
  EXPECT_NE(table_of(base_ / "a/chart.csv")[0].at("front_m"), chart[0].at("front_m"));
}

// What lies there is kept if the same solver made it, and only then. A figure that no run gives
// tells which it was.
TEST_F(ChartMpm, RunsOfAnotherSolverAreRepeated) {
  input::InputFile file =
      input::InputFile::read(REPOSE_SOURCE_DIR "/data/scenes/flat_mu_i.toml",
                             std::vector<std::string>{"grid.h=0.05", "scene.end_time=0.01"});
  const input::SceneFile scene = input::read_scene(file);
  const auto front = [&] {
    study::SweepRun run = study::run_of(scene, scene.scene);
    EXPECT_EQ(study::carry_out(run, base_, 1, false), io::ExitCode::done);
    return run.figure("front_m");
  };
  const double first = front();
  const fs::path folder = base_ / study::run_of(scene, scene.scene).scene().name;
  io::Json marked = io::Json::parse(content_of(folder / "summary.json"));
  marked["front_m"] = 123.0;
  std::ofstream(folder / "summary.json") << marked;
  io::ResultFolder(folder).seal();
  EXPECT_EQ(front(), 123.0) << "it is not repeated";
  std::string input = content_of(folder / "input.toml");
  const std::size_t digest = input.find(solver_digest);
  ASSERT_NE(digest, std::string::npos) << input;
  input[digest] = input[digest] == '0' ? '1' : '0';
  std::ofstream(folder / "input.toml") << input;
  EXPECT_EQ(front(), first);
}

// A step of 5 ms is three times h/c for cells of 25 mm: that run fails and is kept as such.
TEST_F(ChartMpm, ARunThatFailsIsARowAndAWarning) {
  const std::vector<std::string> words{"chart", "mpm",  "--quick", "--transfers",       "apic",
                                       "--dts", "5e-3", "--set",   "scene.end_time=0.6"};
  EXPECT_EQ(run(words, "all"), 3) << "nothing came to its end";
  EXPECT_EQ(summary("all")["status"], "failed");
  std::vector<std::string> more = words;
  more.insert(more.end(), {"--courants", "0.4"});
  ASSERT_EQ(run(more, "some"), 0) << error_;
  EXPECT_NE(error_.find("failed"), std::string::npos);
  const Table chart = table_of(base_ / "some/chart.csv");
  ASSERT_EQ(chart.size(), 2u);
  EXPECT_EQ(chart[0].at("status"), "done");
  EXPECT_EQ(chart[1].at("status"), "failed");
  EXPECT_EQ(chart[1].at("dt_s"), "0.005");
  EXPECT_EQ(chart[1].at("front_change"), "");
  EXPECT_EQ(summary("some")["runs_done"], 1);
  ASSERT_FALSE(summary("some")["warnings"].empty());
}

TEST_F(ChartMpm, SaysWhatIsWrong) {
  const std::string scene = REPOSE_SOURCE_DIR "/data/scenes/flat_mu_i.toml";
  EXPECT_EQ(
      complaint({"mmp"}),
      "there is no chart 'mmp': point, fit, mpm, all, or a .toml file with a [chart] table; did "
      "you mean 'mpm'?\n");
  EXPECT_EQ(complaint({"mpm", scene, "--transfers", "apic,flop"}),
            "--set chart.transfers=[\"apic\", \"flop\"]: chart.transfers[1] must be one of \"" +
                fmt::format("{}", fmt::join(mpm::transfer_names, "\", \"")) +
                "\"; got the string \"flop\"; did you mean \"flip\"?\n");
  EXPECT_EQ(complaint({"mpm", "--courants", "0.4,1.5"}),
            "--set chart.courants=[0.4, 1.5]: chart.courants[1] = 1.5 is out of range: Courant "
            "numbers must be a number in (0, 1.4]\n");
  EXPECT_EQ(
      complaint({"mpm", "--cells", "0.03"}).find("--set chart.cells=[0.03]: cells of 0.03 m: "), 0u)
      << error_;
  EXPECT_EQ(complaint({"mpm", "--dts", "1e-4,,1e-5"}).find("--set chart.dts=[1e-4, "), 0u)
      << error_;
  EXPECT_EQ(complaint({"mpm", REPOSE_SOURCE_DIR "/data/experiments/weald_clay_undrained.toml"})
                .find("weald_clay_undrained.toml:"),
            std::string(REPOSE_SOURCE_DIR "/data/experiments/").size())
      << error_;
  EXPECT_NE(error_.find("this is a point test ([test]), and `repose chart mpm` takes a scene"),
            std::string::npos)
      << error_;
  EXPECT_EQ(complaint({"point", "--cells", "0.1"}), "--cells belongs to repose chart mpm\n");
  EXPECT_EQ(complaint({"point", "--evaluations", "5"}),
            "--evaluations belongs to repose chart fit\n");
  const std::string misspelt = complaint({"mpm", "flat_mui"});
  EXPECT_TRUE(misspelt.starts_with("there is no scene 'flat_mui': ")) << misspelt;
  EXPECT_TRUE(misspelt.ends_with(", or a .toml file; did you mean 'flat_mu_i'?\n")) << misspelt;
  EXPECT_EQ(complaint({scene}),
            scene + ":1:1: [chart] needs kind = \"point\" or \"fit\" or \"mpm\"\n");
  std::ofstream(base_ / "c.toml") << content_of(scene) << "[chart]\nkind = \"mpm\"\ncels = [0.1]\n";
  EXPECT_NE(complaint({(base_ / "c.toml").string()})
                .find("unknown key 'cels' in [chart]; did you mean 'cells'?"),
            std::string::npos)
      << error_;
  EXPECT_EQ(run({"chart", "mpm", "absent.toml"}, "bad"), 4);
}

}  // namespace
}  // namespace repose::app

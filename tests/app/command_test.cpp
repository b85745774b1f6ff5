// The built `repose` command, run as a user runs it: texts, exit codes, results, interruption.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/json.hpp"
#include "tests/scratch_folder.hpp"

using repose::content_of;
using repose::ScratchFolder;

namespace {

namespace fs = std::filesystem;
using Json = repose::io::Json;

const std::string scenes = REPOSE_SOURCE_DIR "/data/scenes/";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

struct Outcome {
  int exit = -1;  ///< −1: ended by a signal
  std::string out, err;
};

class CommandTest : public ::testing::Test {
 protected:
  void SetUp() override { std::ofstream(base_ / "tiny.toml") << tiny; }

  /// Starts the command in base_, its outputs going to files there. Before that the child runs
  /// `prepare`, which may redirect them elsewhere or limit what it can do.
  pid_t start(
      const std::vector<std::string>& arguments,
      const std::function<void()>& prepare = [] {}) const {
    std::vector<std::string> words{REPOSE_COMMAND};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string out = base_ / "out", err = base_ / "err";
    const pid_t child = ::fork();
    if (child != 0) return child;
    const auto redirect = [](const char* path, int to) {
      ::dup2(::open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600), to);
    };
    redirect(out.c_str(), STDOUT_FILENO);
    redirect(err.c_str(), STDERR_FILENO);
    if (::chdir(base_.c_str()) != 0) ::_exit(127);
    prepare();
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }

  Outcome finish(pid_t child) const {
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content_of(base_ / "out"),
            content_of(base_ / "err")};
  }

  Outcome run(const std::vector<std::string>& arguments) const { return finish(start(arguments)); }

  Json summary(const std::string& folder) const {
    return Json::parse(content_of(base_ / folder / "summary.json"));
  }

  // 5000 steps of 128 points
  static constexpr const char* tiny =
      "[scene]\nend_time = 0.1\n"
      "[domain]\nsize = [0.6, 0.3]\n"
      "[[body]]\nsize = [0.1, 0.2]\n"
      "law = { name = \"mu_i\", mu_0 = 0.38, mu_d = 0.57, I_0 = 0.28, d = 5e-3, rho_p = 2000, "
      "rho_0 "
      "= 1300, K = 1e5 }\n"
      "[grid]\nh = 0.025\n"
      "[step]\ndt = 2e-5\n"
      "[output]\nseries_interval = 0.001\nframe_interval = 0.05\n";
  const ScratchFolder scratch_;
  const fs::path base_ = scratch_.path();
};

TEST_F(CommandTest, HelpAndVersion) {
  const Outcome version = run({"--version"});
  EXPECT_EQ(version.exit, 0);
  EXPECT_EQ(version.out.substr(0, 7), "repose ");
  EXPECT_EQ(run({"--help"}).exit, 0);
  for (const char* const verb : {"run", "check", "models"}) {
    const Outcome help = run({verb, "--help"});
    EXPECT_EQ(help.exit, 0);
    EXPECT_NE(help.out.find(std::string("Usage: repose ") + verb), std::string::npos) << help.out;
    EXPECT_NE(help.out.find(std::string("\n  repose ") + verb), std::string::npos) << help.out;
  }
}

TEST_F(CommandTest, MisuseIsBadInput) {
  const Outcome nothing = run({});
  EXPECT_EQ(nothing.exit, 2);
  EXPECT_NE(nothing.err.find("Usage: repose"), std::string::npos);
  const Outcome verb = run({"rnu", "x.toml"});
  EXPECT_EQ(verb.exit, 2);
  EXPECT_EQ(lines_of(verb.err).at(0), "repose: there is no verb 'rnu'; did you mean 'run'?");
  const Outcome option = run({"run", "tiny.toml", "--quite"});
  EXPECT_EQ(option.exit, 2);
  EXPECT_EQ(lines_of(option.err).at(0),
            "repose: '--quite' was not expected; did you mean '--quiet'?");
  EXPECT_EQ(run({"run"}).exit, 2);
  EXPECT_EQ(run({"run", "tiny.toml", "--threads", "-1"}).exit, 2);
}

TEST_F(CommandTest, Models) {
  const Outcome list = run({"models"});
  EXPECT_EQ(list.exit, 0);
  for (const char* const name : {"modified_cam_clay", "mu_i", "newtonian", "neo_hookean"})
    EXPECT_NE(list.out.find(name), std::string::npos);
  const Outcome law = run({"models", "mu_i"});
  EXPECT_EQ(law.exit, 0);
  EXPECT_NE(
      law.out.find(
          "\n  ρ_0     rho_0  kg/m³  required  > 0                     bulk density at p = 0\n"),
      std::string::npos)
      << law.out;
  // what follows from the state is listed under a heading of its own
  const Outcome both = run({"models", "critical_state_mu_i"});
  EXPECT_NE(both.out.find("\n  OUTPUT  KEY  UNIT  MEANING\n  p_c     p_c  Pa "), std::string::npos)
      << both.out;
  EXPECT_EQ(
      Json::parse(run({"models", "critical_state_mu_i", "--json"}).out)[0]["output"][1]["key"],
      "I");
  const Outcome unknown = run({"models", "mu_j"});
  EXPECT_EQ(unknown.exit, 2);
  EXPECT_EQ(unknown.err,
            "repose models: unknown law \"mu_j\"; did you mean \"mu_i\"? (known: "
            "\"modified_cam_clay\", \"mu_i\", \"newtonian\", \"neo_hookean\", "
            "\"critical_state_mu_i\")\n");
  EXPECT_TRUE(Json::parse(run({"models", "mu_i", "--json"}).out).is_array());
}

TEST_F(CommandTest, Check) {
  const Outcome text = run({"check", scenes + "flat_mu_i.toml"});
  EXPECT_EQ(text.exit, 0) << text.err;
  EXPECT_NE(text.out.find("points      8 192\n"), std::string::npos) << text.out;
  const Json report = Json::parse(run({"check", scenes + "flat_mu_i.toml", "--json"}).out);
  EXPECT_EQ(report.at("points"), 8192);
  EXPECT_EQ(report.at("live_cells"), 2048);  // 32 × 64 cells of 4 points
  EXPECT_GT(report.at("steps").get<int>(), 1000);
  EXPECT_EQ(fs::exists(base_ / "results"), false);
}

TEST_F(CommandTest, CheckDrawsTheScene) {
  const auto files = [this] {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(base_))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  };
  const Outcome text = run({"check", "tiny.toml", "--picture", "a.svg", "--threads", "1"});
  EXPECT_EQ(text.exit, 0) << text.err;
  EXPECT_NE(text.out.find("\n  picture     a.svg\n"), std::string::npos) << text.out;
  const std::string svg = content_of(base_ / "a.svg");
  EXPECT_NE(svg.find("tiny before its first step"), std::string::npos);
  EXPECT_NE(svg.find("body0 (mu"), std::string::npos);
  EXPECT_EQ(files(), (std::vector<std::string>{"a.svg", "err", "out", "tiny.toml"}));
  // over an older file; the same picture with more threads
  std::ofstream(base_ / "b.svg") << "old";
  const Outcome json =
      run({"check", "tiny.toml", "--picture", "b.svg", "--json", "--threads", "2"});
  EXPECT_EQ(Json::parse(json.out).at("picture"), "b.svg");
  EXPECT_EQ(content_of(base_ / "b.svg"), svg);
  EXPECT_FALSE(Json::parse(run({"check", "tiny.toml", "--json"}).out).contains("picture"));
}

TEST_F(CommandTest, CheckDrawsNothingElse) {
  const std::string data = REPOSE_SOURCE_DIR "/data/";
  for (const auto& [file, what] :
       {std::pair{"experiments/fit_kaolin.toml", "this is a fit ([fit])"},
        {"experiments/weald_clay_undrained.toml", "this is a point test ([test])"}}) {
    const Outcome refused = run({"check", data + file, "--picture", "a.svg"});
    EXPECT_EQ(refused.exit, 2);
    EXPECT_NE(refused.err.find(std::string(what) +
                               ", and `repose check --picture` takes a scene ([scene])"),
              std::string::npos)
        << refused.err;
  }
  const Outcome charts = run({"check", data + "charts/all.toml", "--picture", "a.svg"});
  EXPECT_EQ(charts.exit, 2);
  EXPECT_NE(charts.err.find("[scene]"), std::string::npos) << charts.err;
  fs::create_directory(base_ / "folder.svg");
  const Outcome folder = run({"check", "tiny.toml", "--picture", "folder.svg"});
  EXPECT_EQ(folder.exit, 4);
  EXPECT_EQ(folder.err, "folder.svg: --picture takes the name of a file, and this is a folder\n");
  const Outcome itself =
      run({"check", "tiny.toml", "--picture", "../" + base_.filename().string() + "/tiny.toml"});
  EXPECT_EQ(itself.exit, 4);
  EXPECT_EQ(content_of(base_ / "tiny.toml"), tiny);
  const Outcome nowhere = run({"check", "tiny.toml", "--picture", "no/a.svg"});
  EXPECT_EQ(nowhere.exit, 4);
  EXPECT_EQ(nowhere.err.substr(0, 9), "no/a.svg:") << nowhere.err;
  EXPECT_FALSE(fs::exists(base_ / "a.svg"));
  // without gnuplot: what was asked for is not there, and the exit code says so
  const Outcome bare = finish(start({"check", "tiny.toml", "--picture", "a.svg"},
                                    [] { ::setenv("PATH", "/nonexistent", 1); }));
  EXPECT_EQ(bare.exit, 4);
  EXPECT_NE(bare.err.find("gnuplot is not installed"), std::string::npos) << bare.err;
}

// Every scene of data/scenes goes by its name, wherever the program is started.
TEST_F(CommandTest, ShippedScenesByName) {
  for (const auto& entry : fs::directory_iterator(scenes)) {
    if (entry.path().extension() != ".toml") continue;
    const std::string name = entry.path().stem();
    const Outcome by_name = run({"check", name, "--json"});
    EXPECT_EQ(by_name.exit, 0) << name << by_name.err;
    EXPECT_EQ(Json::parse(by_name.out).at("points"),
              Json::parse(run({"check", entry.path(), "--json"}).out).at("points"));
  }
  EXPECT_EQ(
      run({"run", "couette", "--quiet", "--set", "grid.h=0.0125", "--set", "scene.end_time=0.005"})
          .exit,
      0);
  EXPECT_TRUE(fs::exists(base_ / "results/couette/summary.json"));
  const Outcome misspelt = run({"run", "couete"});
  EXPECT_EQ(misspelt.exit, 2);
  EXPECT_TRUE(misspelt.err.ends_with("did you mean 'couette'?\n")) << misspelt.err;
}

TEST_F(CommandTest, BadInputIsToldWithItsPlaceAndLeavesNothing) {
  const Outcome bad = run({"run", "tiny.toml", "--set", "body[0].law.rho_0=-1"});
  EXPECT_EQ(bad.exit, 2);
  EXPECT_EQ(bad.err,
            "--set body[0].law.rho_0=-1: body[0].law.rho_0 = -1 kg/m³ is out of range: bulk "
            "density at p = 0 must be a number > 0 kg/m³\n");
  std::ofstream(base_ / "wrong.toml") << tiny << "colour = \"red\"\nfoo = 1\n";
  const Outcome wrong = run({"run", "wrong.toml", "--json"});
  EXPECT_EQ(wrong.exit, 2);
  EXPECT_EQ(
      wrong.err,
      "wrong.toml:15:1: output.colour must be one of \"mises\", \"density\", \"body\"; got the "
      "string \"red\"\n"
      "wrong.toml:16:1: unknown key 'foo' in [output]; [output] takes checkpoint_interval, colour, "
      "final_state, frame_interval, grid_frames, series_interval, shear_strain, stress\n");
  const Json event = Json::parse(wrong.out);
  EXPECT_EQ(event.at("event"), "error");
  EXPECT_EQ(event.at("exit"), 2);
  EXPECT_EQ(event.at("messages").size(), 2U);
  EXPECT_FALSE(fs::exists(base_ / "results"));
}

TEST_F(CommandTest, FilesThatCannotBeReadOrWritten) {
  const Outcome absent = run({"run", "tinny.toml"});
  EXPECT_EQ(absent.exit, 4);
  EXPECT_EQ(absent.err, "tinny.toml: there is no such file; did you mean tiny.toml?\n");
  std::ofstream(base_ / "file") << "mine";
  const Outcome folder = run({"run", "tiny.toml", "-o", "file"});
  EXPECT_EQ(folder.exit, 4);
  EXPECT_EQ(folder.err, "file: cannot be a result folder: it is a file\n");
  EXPECT_EQ(content_of(base_ / "file"), "mine");
  EXPECT_EQ(run({"run", "tiny.toml", "-o", "none", "--resume"}).exit, 4);
  EXPECT_FALSE(fs::exists(base_ / "none"));
}

TEST_F(CommandTest, ARunLeavesACompleteResult) {
  const Outcome run_1 = run({"run", "tiny.toml", "--seed", "7", "--threads", "2"});
  ASSERT_EQ(run_1.exit, 0) << run_1.err;
  EXPECT_EQ(run_1.err.find('\r'), std::string::npos)
      << "a progress line where there is no terminal";
  const fs::path folder = base_ / "results" / "tiny";
  const std::vector<std::string> series = lines_of(content_of(folder / "series.csv"));
  ASSERT_EQ(series.size(), 102U);  // header, 0 to 0.1 s every millisecond
  EXPECT_EQ(series[0],
            "time_s,step,dt_s,front_m,front_max_m,height_m,kinetic_J_per_m,potential_J_per_m,"
            "elastic_J_per_m,dissipated_J_per_m,mass_kg_per_m,momentum_x,momentum_y,density_min,"
            "density_max,points_separated,transfer_loss_J_per_m,wall_loss_J_per_m,"
            "energy_residual_J_per_m,outflow_kg_per_m,angular_momentum,front_99_m,"
            "plastic_J_per_m,viscous_J_per_m,hypoelastic_J_per_m,separation_J_per_m,"
            "averaging_loss_J_per_m,density_floor_J_per_m,work_residual_J_per_m,inflow_kg_per_m");
  EXPECT_EQ(series[1].substr(0, 4), "0,0,");
  EXPECT_EQ(series[101].substr(0, 9), "0.1,5000,");
  EXPECT_EQ(lines_of(content_of(folder / "profile.csv")).at(0), "x_m,depth_m");
  EXPECT_NE(content_of(folder / "final.svg").find("<svg"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "frames" / "tiny_00002.hdf"));  // 0, 0.05, 0.1 s
  EXPECT_FALSE(fs::exists(folder / "frames" / "tiny_00003.hdf"));
  EXPECT_FALSE(fs::exists(folder / "checkpoint.h5"));

  const Json s = summary("results/tiny");
  EXPECT_EQ(s.at("status"), "done");
  EXPECT_EQ(s.at("points"), 128);
  EXPECT_EQ(s.at("lost_points"), 0);
  EXPECT_EQ(s.at("steps"), 5000);
  EXPECT_EQ(s.at("seed"), 7);
  EXPECT_EQ(s.at("threads"), 2);
  EXPECT_EQ(s.at("input").at("body").at(0).at("law").at("form"), "elastoviscoplastic");
  // sums of 128 equal masses: 128 roundings of at most 2^-53 each
  EXPECT_LT(std::abs(s.at("mass_error").get<double>()), 128 * 0x1p-53);
  for (const char* const key :
       {"front_m", "front_99_m", "front_max_m", "height_m", "kinetic_J_per_m", "energy_error",
        "density_min", "density_max", "wall_s", "cpu_s", "point_steps_per_s", "peak_memory_MB"})
    EXPECT_TRUE(s.at(key).is_number()) << key;

  // the resolved input gives the same bits, on one thread as well
  const Outcome run_2 = run({"run", "results/tiny/input.toml", "--threads", "1", "-o", "again"});
  ASSERT_EQ(run_2.exit, 0) << run_2.err;
  EXPECT_EQ(content_of(base_ / "again" / "series.csv"), content_of(folder / "series.csv"));
  EXPECT_EQ(content_of(base_ / "again" / "profile.csv"), content_of(folder / "profile.csv"));
}

TEST_F(CommandTest, FramesOfTheGridStandBesideThoseOfThePoints) {
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"run", "tiny.toml", "--no-plot", "--set", "scene.end_time=0.01"});
    return run(more);
  };
  const Outcome done =
      with({"--set", "output.frame_interval=0.005", "--set", "output.grid_frames=true"});
  ASSERT_EQ(done.exit, 0) << done.err;
  EXPECT_NE(done.out.find("frames/tiny.hdf.series, frames/tiny_grid.hdf.series"), std::string::npos)
      << done.out;
  const fs::path folder = base_ / "results/tiny", frames = folder / "frames";
  const Json points = Json::parse(content_of(frames / "tiny.hdf.series"));
  const Json grid = Json::parse(content_of(frames / "tiny_grid.hdf.series"));
  ASSERT_EQ(grid.at("files").size(), 3U);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(grid.at("files").at(k).at("time"), points.at("files").at(k).at("time"));
  const Json manifest = Json::parse(content_of(folder / "manifest.json"));
  for (const char* const name : {"frames/tiny_grid_00002.hdf", "frames/tiny_grid.hdf.series"})
    EXPECT_NE(manifest.at("files").find(name), nullptr) << name;
  // the page shows the points
  const Outcome page = run({"report", "results/tiny"});
  EXPECT_EQ(page.exit, 0) << page.err;

  // a later run of the same name takes them away, and one without frames cannot have them
  ASSERT_EQ(with({"--set", "output.frame_interval=0.005"}).exit, 0);
  EXPECT_TRUE(fs::exists(frames / "tiny_00002.hdf"));
  EXPECT_FALSE(fs::exists(frames / "tiny_grid_00002.hdf"));
  EXPECT_FALSE(fs::exists(frames / "tiny_grid.hdf.series"));
  const Outcome none =
      with({"--set", "output.frame_interval=0", "--set", "output.grid_frames=true"});
  EXPECT_EQ(none.exit, 2);
  EXPECT_NE(none.err.find("only a run with frames (output.frame_interval)"), std::string::npos)
      << none.err;
}

TEST_F(CommandTest, QuietAndJson) {
  const Outcome quiet = run({"run", "tiny.toml", "--quiet", "--set", "scene.end_time=0.002"});
  EXPECT_EQ(quiet.exit, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
  const Outcome json = run({"run", "tiny.toml", "--json", "--set", "scene.end_time=0.002"});
  EXPECT_EQ(json.exit, 0);
  std::vector<std::string> events;
  for (const std::string& line : lines_of(json.out))
    events.push_back(Json::parse(line).at("event").get<std::string>());
  EXPECT_EQ(events, (std::vector<std::string>{"start", "progress", "progress", "end"}));
}

TEST_F(CommandTest, InterruptedAndResumedGivesTheSameBits) {
  ASSERT_EQ(run({"run", "tiny.toml", "-o", "whole"}).exit, 0);
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::string name = signal == SIGINT ? "int" : "term";
    const pid_t child = start({"run", "tiny.toml", "-o", name});
    // as soon as a few rows are there; far from the end, which takes 5000 steps
    for (int i = 0; i < 6000 && lines_of(content_of(base_ / name / "series.csv")).size() < 6; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ::kill(child, signal);
    const Outcome stopped = finish(child);
    ASSERT_EQ(stopped.exit, 130) << stopped.err;
    EXPECT_TRUE(fs::exists(base_ / name / "checkpoint.h5"));
    EXPECT_EQ(summary(name).at("status"), "interrupted");
    const std::size_t rows = lines_of(content_of(base_ / name / "series.csv")).size();
    EXPECT_LT(rows, 102U);

    const Outcome other =
        run({"run", "tiny.toml", "-o", name, "--resume", "--set", "scene.gravity=9.81"});
    EXPECT_EQ(other.exit, 2);
    EXPECT_EQ(lines_of(other.err).at(0), name + "/input.toml: scene.gravity: 9.8 there, 9.81 here");

    const Outcome resumed = run({"run", "tiny.toml", "-o", name, "--resume"});
    ASSERT_EQ(resumed.exit, 0) << resumed.err;
    for (const char* const file :
         {"series.csv", "profile.csv", "final.svg", "frames/tiny_00001.hdf",
          "frames/tiny_00002.hdf", "frames/tiny.hdf.series"})
      EXPECT_EQ(content_of(base_ / name / file), content_of(base_ / "whole" / file)) << file;
    EXPECT_EQ(summary(name).at("status"), "done");
    EXPECT_EQ(summary(name).at("sessions"), 2);
    EXPECT_EQ(summary(name).at("energy_error"), summary("whole").at("energy_error"));
    EXPECT_FALSE(fs::exists(base_ / name / "checkpoint.h5"));
    EXPECT_EQ(run({"run", "tiny.toml", "-o", name, "--resume"}).exit, 0) << "nothing left to do";
  }
}

// The run under way goes on from its checkpoint, those before it are not repeated.
TEST_F(CommandTest, AnInterruptedChartGoesOn) {
  const std::vector<std::string> chart{"chart", "mpm",  "tiny.toml", "--transfers", "apic,pic",
                                       "--dts", "2e-5", "--cells",   "0.025",       "--quiet"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), chart.begin(), chart.end());
    return more;
  };
  ASSERT_EQ(run(with({"-o", "whole"})).exit, 0);
  const pid_t child = start(with({"-o", "cut"}));
  const fs::path second = base_ / "cut" / "runs" / "tiny_pic_cubic_h0.025_dt2e-05" / "series.csv";
  for (int i = 0; i < 6000 && lines_of(content_of(second)).size() < 6; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  ::kill(child, SIGINT);
  const Outcome stopped = finish(child);
  ASSERT_EQ(stopped.exit, 130) << stopped.err;
  EXPECT_EQ(summary("cut").at("status"), "interrupted");
  EXPECT_EQ(lines_of(content_of(base_ / "cut" / "chart.csv")).size(), 2U) << "one run is there";
  ASSERT_EQ(run(with({"-o", "cut", "--resume"})).exit, 0);
  EXPECT_EQ(content_of(base_ / "cut" / "history.csv"), content_of(base_ / "whole" / "history.csv"));
  EXPECT_EQ(Json::parse(content_of(second.parent_path() / "summary.json")).at("sessions"), 2);
}

// The chart that is done is kept, the one under way goes on where it was.
TEST_F(CommandTest, AnInterruptedSetOfChartsGoesOn) {
  std::ofstream(base_ / "set.toml") << R"(
[[chart]]
name = "first"
kind = "mpm"
input = "tiny.toml"
transfers = ["apic"]
cells = [0.025]
dts = [2e-5]

[[chart]]
name = "second"
kind = "mpm"
input = "tiny.toml"
transfers = ["pic"]
cells = [0.025]
dts = [2e-5]
)";
  ASSERT_EQ(run({"chart", "set.toml", "--quiet", "-o", "whole"}).exit, 0);
  const pid_t child = start({"chart", "set.toml", "--quiet", "-o", "cut"});
  const fs::path rows = base_ / "cut/second/runs/tiny_pic_cubic_h0.025_dt2e-05/series.csv";
  for (int i = 0; i < 6000 && lines_of(content_of(rows)).size() < 6; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  ::kill(child, SIGINT);
  const Outcome stopped = finish(child);
  ASSERT_EQ(stopped.exit, 130) << stopped.err;
  EXPECT_EQ(summary("cut").at("status"), "interrupted");
  EXPECT_EQ(summary("cut/first").at("status"), "done");
  EXPECT_EQ(summary("cut/second").at("status"), "interrupted");
  ASSERT_EQ(run({"chart", "set.toml", "--quiet", "-o", "cut", "--resume"}).exit, 0);
  EXPECT_EQ(summary("cut").at("status"), "done");
  EXPECT_EQ(summary("cut").at("parts").at(0).at("kept"), true);
  EXPECT_EQ(Json::parse(content_of(rows.parent_path() / "summary.json")).at("sessions"), 2);
  EXPECT_EQ(content_of(base_ / "cut/second/history.csv"),
            content_of(base_ / "whole/second/history.csv"));
}

TEST_F(CommandTest, OneProgressLineOnATerminal) {
  int master = -1, slave = -1;
  if (::openpty(&master, &slave, nullptr, nullptr, nullptr) != 0)
    GTEST_SKIP() << "this system has no pseudo-terminals";
  const pid_t child = start({"run", "tiny.toml"}, [&] { ::dup2(slave, STDERR_FILENO); });
  ::close(slave);
  std::string shown;
  char buffer[4096];
  for (ssize_t n = 0; (n = ::read(master, buffer, sizeof buffer)) > 0;)
    shown.append(buffer, static_cast<std::size_t>(n));
  ::close(master);
  EXPECT_EQ(finish(child).exit, 0);
  EXPECT_NE(shown.find("\r\033[Ktiny  0 %  t = 0.000 of 0.1 s"), std::string::npos) << shown;
  EXPECT_NE(shown.find("Mpoint-steps/s"), std::string::npos) << shown;
  EXPECT_EQ(shown.find('\n'), std::string::npos) << shown;
  EXPECT_EQ(shown.substr(shown.size() - 4), "\r\033[K") << "the line is taken off at the end";
}

// A disk without room: no file may grow beyond 8 KiB, of which series.csv needs about 30.
TEST_F(CommandTest, AFullDiskIsToldAndLeavesNothingHalfWritten) {
  const pid_t child =
      start({"run", "tiny.toml", "-o", "full", "--set", "output.frame_interval=0"}, [] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{8192, 8192};
        ::setrlimit(RLIMIT_FSIZE, &limit);
      });
  const Outcome full = finish(child);
  EXPECT_EQ(full.exit, 4);
  EXPECT_EQ(full.err, "full/series.csv: cannot write: File too large\n");
  const std::string series = content_of(base_ / "full" / "series.csv");
  EXPECT_EQ(series.back(), '\n');
  for (const std::string& row : lines_of(series))
    EXPECT_EQ(std::count(row.begin(), row.end(), ','), 29) << row;
  EXPECT_FALSE(fs::exists(base_ / "full" / "summary.json")) << "nothing says that it is complete";
  for (const auto& entry : fs::directory_iterator(base_ / "full"))
    EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
}

TEST_F(CommandTest, MaterialMayLeaveThroughAnOpenEdge) {
  const Outcome open = run({"run", "tiny.toml", "--set", "domain.floor=open", "--set",
                            "scene.end_time=0.4", "--set", "step.dt=1e-4"});
  EXPECT_EQ(open.exit, 0) << open.err;
  EXPECT_EQ(open.err.substr(0, 48), "warning: all material had left the box by t = 0.");
  const Json s = summary("results/tiny");
  EXPECT_EQ(s.at("lost_points"), 0);
  EXPECT_EQ(s.at("points"), 128);
  // 0.1 m × 0.2 m × 1300 kg/m³; 128 roundings of the sum
  EXPECT_NEAR(s.at("outflow_kg_per_m").get<double>(), 26.0, 26.0 * 128 * 0x1p-53);
}

TEST_F(CommandTest, ADivergingRunSaysSoAndSavesTheState) {
  const Outcome failed = run({"run", "tiny.toml", "-o", "f", "--set", "step.dt=0.02", "--set",
                              "scene.end_time=5", "--set", "output={}"});
  EXPECT_EQ(failed.exit, 3);
  EXPECT_NE(failed.err.find("tiny: failed: step "), std::string::npos) << failed.err;
  const Json s = summary("f");
  EXPECT_EQ(s.at("status"), "failed");
  EXPECT_NE(s.at("reason").get<std::string>().find("step "), std::string::npos);
  EXPECT_TRUE(fs::exists(base_ / "f" / "checkpoint.h5"));
  EXPECT_TRUE(fs::exists(base_ / "f" / "frames" / "tiny_00000.hdf"));
}

TEST_F(CommandTest, ANewRunReplacesAnOlderResultButNothingElse) {
  const fs::path folder = base_ / "r";
  fs::create_directory(folder);
  std::ofstream(folder / "notes.txt") << "mine";
  std::ofstream(folder / "fit.json") << "old";
  EXPECT_EQ(run({"run", "tiny.toml", "-o", "r", "--set", "scene.end_time=0.002"}).exit, 0);
  EXPECT_EQ(content_of(folder / "notes.txt"), "mine");
  EXPECT_FALSE(fs::exists(folder / "fit.json"));
}

}  // namespace

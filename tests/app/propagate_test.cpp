// `repose propagate`: what it leaves, on any threads and after an interruption, and what it
// refuses.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/command_line.hpp"
#include "io/json.hpp"
#include "tests/app/csv_table.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;
using io::Json;

const std::string scene = R"([scene]
end_time = 0.1
gravity = 9.81
[domain]
size = [0.8, 0.4]
[[body]]
law = { name = "newtonian", eta = 1.0, K = 1e5, rho_0 = 1000.0 }
origin = [0.0, 0.0]
size = [0.2, 0.2]
[grid]
h = 0.025
)";

class PropagateCommand : public testing::Test {
 protected:
  /// What a fit of η with this many draws leaves, η of 1 to 20 Pa s.
  void fit(const std::string& name, int draws) const {
    fs::create_directories(folder_.path() / name);
    write(name + "/fit.json", R"({"name": "honey", "parameters": {"eta": {"value": 5.0}}})");
    write(name + "/posterior.json", R"({"status": "done"})");
    write(name + "/fitted.toml",
          "[law]\nname = \"newtonian\"\neta = 5.0\nK = 1e5\nrho_0 = 1000.0\n");
    std::string text = "chain,draw,log_density,divergent,\"eta\",\"noise of a tau\"\n";
    for (int i = 0; i < draws; ++i)
      text += fmt::format("0,{},-1.5,no,{},0.1\n", i + 1, 1.0 + 19.0 * i / (draws - 1.0));
    write(name + "/posterior.csv", text);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string read(const std::string& name) const { return content_of(folder_.path() / name); }
  int run(const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> words{"repose", "propagate", path("fit"), path("scene.toml"),
                                   "-o",     path(out),   "--quiet",   "--no-plot"};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    return run_command_line(static_cast<int>(argv.size()), argv.data());
  }
  void SetUp() override {
    fit("fit", 40);
    write("scene.toml", scene);
  }

  ScratchFolder folder_;
};

TEST_F(PropagateCommand, LeavesTheDistributionOfEveryOutput) {
  ASSERT_EQ(run("out", {"--runs", "16", "--fine", "5"}), 0);
  const Json outputs = Json::parse(read("out/propagation.json"));
  const auto number = [&](const char* output, const char* key) {
    return outputs.at(output).at(key).get<double>();
  };
  // the thicker, the shorter: the front of 16 draws runs from that of η = 20 Pa s to that of 1
  EXPECT_GT(number("front_99_m", "mean"), 0.2);
  EXPECT_LT(number("front_99_m", "mean"), 0.5);
  EXPECT_GT(number("front_99_m", "correlation"), 0.9);
  EXPECT_EQ(outputs.at("front_99_m").at("draws").get<int>(), 16);
  EXPECT_EQ(outputs.at("front_99_m").at("pairs").get<int>(), 5);
  EXPECT_TRUE(
      read("out/draws.csv")
          .starts_with(
              "run,draw,eta,front_99_m_coarse,front_99_m_fine,height_m_coarse,height_m_fine\n"));
  const Table draws = table_of(folder_.path() / "out/draws.csv");
  ASSERT_EQ(draws.size(), 16u);
  EXPECT_GT(std::stod(draws[0].at("front_99_m_coarse")),
            std::stod(draws[15].at("front_99_m_coarse")));
  EXPECT_EQ(std::count_if(draws.begin(), draws.end(),
                          [](const auto& row) { return !row.at("front_99_m_fine").empty(); }),
            5);
  const Table bands = table_of(folder_.path() / "out/depth_bands.csv");
  ASSERT_GT(bands.size(), 10u);
  for (const auto& row : bands) {
    EXPECT_LE(std::stod(row.at("depth_p5_m")), std::stod(row.at("depth_p50_m")));
    EXPECT_LE(std::stod(row.at("depth_p50_m")), std::stod(row.at("depth_p95_m")));
  }
  EXPECT_EQ(Json::parse(read("out/summary.json")).at("status").get<std::string>(), "done");
}

TEST_F(PropagateCommand, SameBitsOnAnyThreadsAndWhenItGoesOn) {
  const std::vector<std::string> few{"--runs", "8", "--fine", "4", "--threads", "1"};
  ASSERT_EQ(run("one", few), 0);
  std::vector<std::string> two = few;
  two.back() = "2";
  ASSERT_EQ(run("two", two), 0);
  EXPECT_EQ(read("one/propagation.json"), read("two/propagation.json"));
  EXPECT_EQ(read("one/depth_bands.csv"), read("two/depth_bands.csv"));
  // as after an interruption: some runs are there, the outcome is not
  for (const char* gone : {"manifest.json", "propagation.json", "summary.json"})
    fs::remove(folder_.path() / "two" / gone);
  fs::remove_all(folder_.path() / "two/coarse/runs/0003");
  two.emplace_back("--resume");
  ASSERT_EQ(run("two", two), 0);
  EXPECT_EQ(read("one/propagation.json"), read("two/propagation.json"));
}

TEST_F(PropagateCommand, RefusesBeforeAnythingIsRun) {
  const auto told = [&](const std::vector<std::string>& more, int wanted = 2) {
    testing::internal::CaptureStderr();
    const int code = run("out", more);
    std::string text = testing::internal::GetCapturedStderr();
    EXPECT_EQ(code, wanted) << text;
    EXPECT_FALSE(fs::exists(folder_.path() / "out")) << text;
    return text;
  };
  const std::vector<std::string> few{"--runs", "8", "--fine", "4"};
  auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), few.begin(), few.end());
    return more;
  };
  EXPECT_NE(told(with({"--for", "front_99"})).find("did you mean 'front_99_m'?"),
            std::string::npos);
  EXPECT_NE(told({"--runs", "41"}).find("--runs 41: the posterior has 40 draws"),
            std::string::npos);
  EXPECT_NE(told(with({"--coarsen", "1"})).find("--coarsen 1: must be more than 1"),
            std::string::npos);
  EXPECT_NE(told(with({"--coarsen", "3"})).find("grid.h"), std::string::npos)
      << "cells that do not fit the box";
  fs::rename(folder_.path() / "fit/posterior.csv", folder_.path() / "kept.csv");
  EXPECT_NE(told(few).find("the fit has no posterior"), std::string::npos);
  write("fit/posterior.csv", "chain,draw,\"eta\"\n0,1,nan\n");
  EXPECT_NE(told(few, 4).find("posterior.csv: row 2: \"nan\" is no number"), std::string::npos);
}

}  // namespace
}  // namespace repose::app

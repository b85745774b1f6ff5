/// \file
/// `repose stability`: its files, what it says of a mistake, and that its input makes it again.

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "app/command_line.hpp"
#include "input/read_stability.hpp"
#include "io/json.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int exit;
  std::string errors;
};

Outcome command(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "repose");
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  const int exit = run_command_line(static_cast<int>(arguments.size()), arguments.data());
  ::testing::internal::GetCapturedStdout();
  return {exit, ::testing::internal::GetCapturedStderr()};
}

class Stability : public ::testing::Test {
 protected:
  const ScratchFolder scratch;
  const fs::path folder = scratch.path();
};

TEST_F(Stability, QuickMapsOfMuI) {
  const std::string to = (folder / "out").string();
  const Outcome outcome =
      command({"stability", "--quick", "--parts", "mu_i", "-o", to.c_str(), "--quiet"});
  EXPECT_EQ(outcome.exit, 0) << outcome.errors;
  const auto summary = io::Json::parse(content_of(folder / "out" / "summary.json"));
  EXPECT_EQ(summary["status"], "done");
  // the boundary is the criterion's: outside the margin every sign agrees in at least 95 %
  const auto& boundary = summary["parts"]["mu_i"]["boundary"];
  EXPECT_GE(boundary["share_outside_margin"].get<double>(), 0.95);
  EXPECT_GE(boundary["outside_margin"].get<int>(), 50);
  // and so it is in a Material Point shear cell, whose waves grow with the square of 1/h; what
  // compressibility takes of the shorter one is a few per cent (shear_cell_test.cpp)
  const auto& cell = summary["parts"]["mu_i"]["shear_cell"];
  EXPECT_GE(cell["signs"]["outside_margin"].get<int>(), 6);
  EXPECT_EQ(cell["signs"]["agree_outside_margin"], cell["signs"]["outside_margin"]);
  const auto& growth = cell["refinement"]["fixed_cells"];
  EXPECT_NEAR(growth[1]["rate_over_shear_rate"].get<double>() /
                  growth[0]["rate_over_shear_rate"].get<double>(),
              4.0, 0.2);
  for (const auto& file : summary["files"])
    EXPECT_TRUE(fs::exists(folder / "out" / file.get<std::string>())) << file;
}

TEST_F(Stability, QuickMapsOfClayAgainFromTheirInput) {
  const std::string to = (folder / "a").string(), again = (folder / "b").string();
  ASSERT_EQ(command({"stability", "--quick", "--parts", "clay", "-o", to.c_str(), "--quiet"}).exit,
            0);
  const std::string input = to + "/input.toml";
  ASSERT_EQ(command({"stability", input.c_str(), "-o", again.c_str(), "--quiet"}).exit, 0);
  EXPECT_EQ(content_of(folder / "a" / "clay_steps.csv"),
            content_of(folder / "b" / "clay_steps.csv"));
  const auto summary = io::Json::parse(content_of(folder / "a" / "summary.json"));
  const auto& steps = summary["parts"]["clay"]["single_steps"];
  EXPECT_EQ(steps["exact"]["ocr_1"]["share_converged"], 1.0);
  EXPECT_LT(steps["linearised"]["ocr_20"]["share_converged"].get<double>(), 0.9);
}

TEST_F(Stability, Mistakes) {
  EXPECT_EQ(
      command({"stability", "--parts", "mui"}).errors,
      "--set stability.parts=[\"mui\"]: stability.parts[0] must be one of \"clay\", \"mu_i\", "
      "\"step\", \"mpm\", \"collapse\"; got the string \"mui\"; did you mean \"mu_i\"?\n");
  fs::create_directories(folder);
  const std::string file = (folder / "x.toml").string();
  std::ofstream(file) << "[stability]\npart = [\"step\"]\n";
  const Outcome outcome = command({"stability", file.c_str()});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.errors.find("x.toml:2:1: unknown key 'part'"), std::string::npos)
      << outcome.errors;
  EXPECT_NE(outcome.errors.find("'parts'"), std::string::npos) << outcome.errors;
  std::ofstream(file) << "[law]\nname = \"newtonian\"\neta = 1.0\nK = 1e5\nrho_0 = 1000.0\n";
  EXPECT_NE(command({"stability", file.c_str()})
                .errors.find("there are maps of modified_cam_clay and mu_i, not of newtonian"),
            std::string::npos);
  std::ofstream(file) << "[scene]\n";
  EXPECT_NE(command({"stability", file.c_str()}).errors.find("takes a file with a [law] table"),
            std::string::npos);
}

}  // namespace
}  // namespace repose::app

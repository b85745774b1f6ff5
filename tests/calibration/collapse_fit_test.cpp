// A collapse made with 25 mm cells, fitted with 50 and 33 mm: seconds, not accuracy. What must hold
// all the same: the intervals hold the truth, and a repetition simulates nothing and says the same.

#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/command_line.hpp"
#include "input/collapse_simulator.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* scene_text = R"([scene]
name = "column"
end_time = 0.5
[domain]
size = [1.0, 0.5]
floor = "no_slip"
walls = "slip"
[[body]]
shape = "box"
origin = [0.0, 0.0]
size = [0.2, 0.4]
[body.law]
name = "mu_i"
mu_0 = 0.3819
mu_d = 0.5718
I_0 = 0.279
d = 0.02
rho_p = 2000.0
rho_0 = 1300.0
K = 26000.0
[grid]
h = 0.025
)";

constexpr const char* fit_text = R"([law]
name = "mu_i"
form = "elastoviscoplastic"
mu_d = 0.5718
I_0 = 0.279
d = 0.02
rho_p = 2000.0
rho_0 = 1300.0
K = 26000.0
[fit]
mu_0 = { lower = 0.1, upper = 0.56 }
[[target]]
scene = "scene.toml"
set = ["grid.h=0.0333333333333333"]
coarse = ["grid.h=0.05"]
data = "front.csv"
x = "time_s"
y = ["front_m", "height_m"]
noise = { front_m = 0.005, height_m = 0.005 }
[solver]
local = "LN_BOBYQA"
starts = 2
local_evaluations = 15
fine_evaluations = 15
tolerance = 1e-3
[uncertainty]
profile = false
resolution = 2.0
)";

nlohmann::json fit(const fs::path& file, const fs::path& out) {
  const std::string a = file.string(), b = out.string();
  const std::vector<const char*> argv{"repose", "fit", a.c_str(), "-o", b.c_str(), "--quiet"};
  EXPECT_EQ(run_command_line(static_cast<int>(argv.size()), argv.data()), 0);
  std::ifstream in(out / "fit.json");
  return nlohmann::json::parse(in);
}

TEST(CollapseFit, IntervalHoldsTheTruthOfAnotherResolutionAndRunsAreKept) {
  const ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  std::ofstream(folder / "scene.toml") << scene_text;
  std::ofstream(folder / "fit.toml") << fit_text;
  input::CollapseExperiment e;
  input::InputFile input = input::InputFile::read(folder / "scene.toml");
  e.scene = input::read_scene(input);
  e.law = e.scene.scene.bodies[0].law;
  e.channels = {"front_m", "height_m"};
  e.times = {0.1, 0.2, 0.3, 0.4, 0.5};
  const auto simulator = input::make_collapse_simulator(e);
  std::vector<double> truth;
  for (const std::string& name : simulator->inputs()) {
    const auto found = e.law.values.find(name);
    truth.push_back(found == e.law.values.end() ? std::nan("") : found->second);
  }
  calibration::Response made;
  simulator->simulate(truth, {}, made);
  ASSERT_TRUE(made.complete());
  std::string csv = "time_s,front_m,height_m\n";
  for (Eigen::Index i = 0; i < made.x.size(); ++i)
    csv += fmt::format("{},{},{}\n", made.x[i], made.y(i, 0), made.y(i, 1));
  std::ofstream(folder / "front.csv") << csv;

  const auto first = fit(folder / "fit.toml", folder / "out");
  const auto& mu_0 = first["parameters"]["mu_0"];
  std::printf("[ measured ] mu_0 %g, 95 %%: %g to %g, resolution %g; truth 0.3819\n",
              mu_0["value"].get<double>(), mu_0["interval_95"][0].get<double>(),
              mu_0["interval_95"][1].get<double>(), mu_0["shift_by_resolution"].get<double>());
  EXPECT_EQ(mu_0["at_bound"], false);
  EXPECT_LE(mu_0["interval_95"][0].get<double>(), 0.3819);
  EXPECT_GE(mu_0["interval_95"][1].get<double>(), 0.3819);
  // the interval says something: it is not the bounds
  EXPECT_LT(mu_0["interval_95"][1].get<double>() - mu_0["interval_95"][0].get<double>(), 0.46);
  EXPECT_GT(first["counts"]["this_session"]["scenes"]["simulated"].get<long>(), 10);

  const auto again = fit(folder / "fit.toml", folder / "out");
  EXPECT_EQ(again["counts"]["this_session"]["scenes"]["simulated"], 0);
  EXPECT_EQ(again["parameters"], first["parameters"]);
  EXPECT_EQ(again["coarse"], first["coarse"]);
}

}  // namespace
}  // namespace repose::app

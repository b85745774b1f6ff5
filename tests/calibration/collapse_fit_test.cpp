// A collapse made with 25 mm cells, fitted with 50 and 33 mm: seconds, not accuracy. What must hold
// all the same: the intervals hold the truth, and a repetition simulates nothing and says the same.

#include <filesystem>
#include <fstream>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "app/command_line.hpp"
#include "input/collapse_simulator.hpp"
#include "io/json.hpp"
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

int fit_command(const fs::path& file, const fs::path& out, bool resume) {
  const std::string a = file.string(), b = out.string();
  std::vector<const char*> argv{"repose", "fit", a.c_str(), "-o", b.c_str(), "--quiet"};
  if (resume) argv.push_back("--resume");
  return run_command_line(static_cast<int>(argv.size()), argv.data());
}

io::Json fit(const fs::path& file, const fs::path& out) {
  EXPECT_EQ(fit_command(file, out, false), 0);
  std::ifstream in(out / "fit.json");
  return io::Json::parse(std::string(std::istreambuf_iterator<char>(in), {}));
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
  // The interval is made of what it should be. What the cells do to μ_0 is, with the fit's own
  // slopes (differences over 3 % of the bounds to each side), the step of Gauss and Newton that
  // takes back twice the change from 50 to 33 mm; the same runs give the same digits, but for the
  // order of sums.
  const auto figures = [&](const char* h, double mu) {
    input::CollapseExperiment with = e;
    input::InputFile cells = input::InputFile::read(
        folder / "scene.toml", std::vector<std::string>{std::string("grid.h=") + h});
    with.scene = input::read_scene(cells);
    const auto simulated = input::make_collapse_simulator(with);
    std::vector<double> theta = truth;
    for (std::size_t i = 0; i < theta.size(); ++i) {
      if (simulated->inputs()[i] == "mu_0") theta[i] = mu;
      if (simulated->inputs()[i] == "G") theta[i] = std::nan("");
    }
    calibration::Response r;
    simulated->simulate(theta, {}, r);
    return Eigen::VectorXd(r.y.reshaped());
  };
  const char *fine = "0.0333333333333333", *coarse = "0.05";
  const double value = mu_0["value"].get<double>(), range = 0.56 - 0.1, step = 0.03 * range;
  const Eigen::VectorXd slope =
      (figures(fine, value + step) - figures(fine, value - step)) / (2.0 * step);
  const Eigen::VectorXd change = 2.0 * (figures(fine, value) - figures(coarse, value));
  const double shift = -slope.dot(change) / slope.squaredNorm();
  EXPECT_NEAR(mu_0["shift_by_resolution"].get<double>(), shift, 1e-6 * std::abs(shift));
  // The standard error holds it beside the scatter of the readings, of which the declared noise is
  // the least; and the interval, 0.15 to 0.49, is of that size and not that of the bounds: beside
  // these a normal error is cut off, and 95 % of what is left lie within 1.96 of it to each side.
  const double error = mu_0["standard_error"].get<double>(), noise = 0.005 / slope.norm();
  const double low = mu_0["interval_95"][0].get<double>(),
               high = mu_0["interval_95"][1].get<double>();
  EXPECT_GE(error, std::hypot(shift, noise) * (1.0 - 1e-6));
  EXPECT_GT(low, 0.1);
  EXPECT_LT(high, 0.56);
  EXPECT_LE(low, value - std::abs(shift));
  EXPECT_GE(high, value + std::abs(shift));
  EXPECT_LE(high - low, 2.0 * 1.959963985 * error);
  EXPECT_GT(first["counts"]["this_session"]["scenes"]["simulated"].get<long>(), 10);

  const auto again = fit(folder / "fit.toml", folder / "out");
  EXPECT_EQ(again["counts"]["this_session"]["scenes"]["simulated"], 0);
  EXPECT_EQ(again["parameters"], first["parameters"]);
  EXPECT_EQ(again["coarse"], first["coarse"]);

  // the starts of another scene are refused, though the fit file is the same
  EXPECT_EQ(fit_command(folder / "fit.toml", folder / "out", true), 0);
  std::ofstream(folder / "scene.toml") << scene_text << "[step]\ncourant = 0.7\n";
  EXPECT_EQ(fit_command(folder / "fit.toml", folder / "out", true), 2);
}

// A finished run is kept by all that its answer depends on.
TEST(CollapseCache, TellsRunsApart) {
  const ScratchFolder scratch;
  std::ofstream(scratch.path() / "scene.toml") << scene_text;
  input::InputFile file = input::InputFile::read(scratch.path() / "scene.toml",
                                                 std::vector<std::string>{"grid.h=0.05"});
  input::CollapseExperiment usual;
  usual.scene = input::read_scene(file);
  usual.law = usual.scene.scene.bodies[0].law;
  usual.channels = {"front_m", "height_m"};
  usual.times = {0.02, 0.06};
  usual.cache = scratch.path() / "cache";
  const auto answer = [&](const input::CollapseExperiment& e, double mu_0 = 0.3819) {
    const auto simulator = input::make_collapse_simulator(e);
    std::vector<double> theta;
    for (const std::string& name : simulator->inputs()) {
      const auto found = e.law.values.find(name);
      theta.push_back(name == "mu_0" ? mu_0 : found == e.law.values.end() ? NAN : found->second);
    }
    calibration::Response response;
    simulator->simulate(theta, {}, response);
    EXPECT_TRUE(response.complete());
    return response;
  };
  const calibration::Response first = answer(usual);
  EXPECT_EQ(usual.count->simulated, 1);
  const calibration::Response kept = answer(usual);
  EXPECT_EQ(usual.count->simulated, 1) << "the same run";
  EXPECT_EQ(usual.count->recalled, 1);
  EXPECT_EQ(kept.x, first.x);
  EXPECT_EQ(kept.y, first.y);
  long runs = 1;
  const auto expect_new = [&](const input::CollapseExperiment& e, double mu_0, const char* what) {
    const calibration::Response response = answer(e, mu_0);
    EXPECT_EQ(e.count->simulated, ++runs) << what;
    EXPECT_EQ(response.y.cols(), static_cast<Eigen::Index>(e.channels.size())) << what;
    EXPECT_EQ(response.x.size(), static_cast<Eigen::Index>(e.times.size())) << what;
  };
  expect_new(usual, 0.4, "another parameter");
  input::CollapseExperiment other = usual;
  other.times = {0.04, 0.06};
  expect_new(other, 0.3819, "other times");
  other.times = {0.04};
  expect_new(other, 0.3819, "fewer times");
  other = usual;
  other.channels = {"height_m", "front_m"};
  expect_new(other, 0.3819, "other columns");
  other = usual;
  other.scene.scene.courant = 0.7;
  expect_new(other, 0.3819, "another step");
  other = usual;
  other.scene.scene.pressure_averaging = 10.0;
  expect_new(other, 0.3819, "another setting of the step");
}

}  // namespace
}  // namespace repose::app

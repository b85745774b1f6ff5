// `repose chart all` and sets of charts: what a set says, that a second run repeats nothing, and
// that a part that fails does not stop the others. Beside it the two axes that sets use: further
// keys of the scene, and flows with exact solutions.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "app/command_line.hpp"
#include "input/read_chart_set.hpp"
#include "input/read_scene.hpp"
#include "input/shipped_input.hpp"
#include "io/json.hpp"
#include "pointdriver/study/tangent_convergence.hpp"
#include "study/accuracy/errors.hpp"
#include "study/accuracy/exact_flow.hpp"
#include "study/accuracy/grain_layer.hpp"
#include "study/run/finished_result.hpp"
#include "tests/app/csv_table.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;

/// Numbers that a column has, each finite.
std::size_t finite_numbers(const Table& table, const std::string& column) {
  std::size_t count = 0;
  for (const auto& row : table) {
    const std::string& cell = row.at(column);
    if (cell.empty()) continue;
    EXPECT_TRUE(std::isfinite(std::stod(cell))) << column << ": " << cell;
    ++count;
  }
  return count;
}

class ChartSetTest : public testing::Test {
 protected:
  int run(std::vector<std::string> words, const std::string& out) {
    words.insert(words.begin(), {"repose", "chart"});
    words.insert(words.end(), {"-o", (base_ / out).string(), "--quiet"});
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    testing::internal::CaptureStderr();
    const int code = run_command_line(static_cast<int>(argv.size()), argv.data());
    error_ = testing::internal::GetCapturedStderr();
    return code;
  }
  io::Json summary(const std::string& out) const {
    return io::Json::parse(study::text_of(base_ / out / "summary.json"));
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(base_ / name) << text;
    return (base_ / name).string();
  }

  const ScratchFolder scratch_;
  const fs::path base_ = scratch_.path();
  std::string error_;
};

TEST(ReadChartSet, TheShippedSetIsSoundAndQuickReplacesKeys) {
  for (const bool quick : {false, true}) {
    input::InputFile file = input::InputFile::parse(input::shipped_chart_set(), "all.toml");
    ASSERT_TRUE(input::is_chart_set(file));
    const input::ChartSet set = input::read_chart_set(file, "", quick);
    ASSERT_GE(set.parts.size(), 12u);
    EXPECT_EQ(set.parts[0].command(), "repose chart point");
    EXPECT_EQ(set.parts[1].command(),
              fmt::format("repose chart fit --set 'chart.evaluations={}'", quick ? 40 : 2000));
    EXPECT_EQ(set.parts[2].name, "mu_i_transfers");
    EXPECT_EQ(set.parts[2].input, "flat_mu_i");
    // what it writes down makes the same set, with nothing left to replace
    input::InputFile again = input::InputFile::parse(set.text, "input.toml");
    const input::ChartSet same = input::read_chart_set(again, "", !quick);
    ASSERT_EQ(same.parts.size(), set.parts.size());
    for (std::size_t i = 0; i < set.parts.size(); ++i) {
      EXPECT_EQ(same.parts[i].sets, set.parts[i].sets);
      EXPECT_EQ(same.parts[i].command(), set.parts[i].command());
      for (const std::string& one : set.parts[i].sets) EXPECT_EQ(one.find(".quick="), one.npos);
    }
  }
}

TEST_F(ChartSetTest, TheShippedSetCanBeMade) {
  const std::string file = write("all.toml", std::string(input::shipped_chart_set()));
  const std::array words{"repose", "check", file.c_str()};
  testing::internal::CaptureStdout();
  EXPECT_EQ(run_command_line(3, words.data()), 0);
  EXPECT_NE(testing::internal::GetCapturedStdout().find("mu_i_transfers   mpm, "),
            std::string::npos);
}

// The whole gallery in small: every part, its table and picture, the page, and nothing twice.
TEST_F(ChartSetTest, EveryChartInSmallAndNothingTwice) {
  ASSERT_EQ(run({"all", "--quick"}, "all"), 0) << error_;
  const io::Json first = summary("all");
  EXPECT_EQ(first["status"], "done");
  input::InputFile file = input::InputFile::parse(input::shipped_chart_set(), "all.toml");
  const input::ChartSet set = input::read_chart_set(file, "", true);
  ASSERT_EQ(first["parts"].size(), set.parts.size());
  const std::string page = study::text_of(base_ / "all/report.html");
  std::map<std::string, std::string> before;
  for (const input::ChartPart& part : set.parts) {
    const fs::path folder = base_ / "all" / part.name;
    EXPECT_EQ(summary("all/" + part.name)["status"], "done") << part.name;
    EXPECT_NE(page.find("\"label\":\"" + part.name + "\""), page.npos) << part.name;
    before[part.name] = study::text_of(folder / "summary.json");
    if (part.kind == input::PartKind::stability) {
      for (const auto& made : summary("all/" + part.name)["files"])
        EXPECT_GT(fs::file_size(folder / made.get<std::string>()), 0u) << made;
      continue;
    }
    EXPECT_GT(fs::file_size(folder / "chart.svg"), 1000u) << part.name;
    const Table chart = table_of(folder / "chart.csv");
    ASSERT_FALSE(chart.empty()) << part.name;
    const char* column = part.kind == input::PartKind::point ? "wall_s"
                         : part.kind == input::PartKind::fit ? "objective"
                                                             : "kinetic_J_per_m";
    EXPECT_EQ(finite_numbers(chart, column), chart.size()) << part.name;
    if (part.kind != input::PartKind::mpm || part.name == "mu_i_steps") continue;
    const Table errors = table_of(folder / "errors.csv");
    EXPECT_EQ(finite_numbers(errors, "kinetic_error"), errors.size()) << part.name;
    EXPECT_EQ(finite_numbers(errors, "momentum_error"), errors.size()) << part.name;
    EXPECT_EQ(finite_numbers(errors, "energy_error"), errors.size()) << part.name;
    EXPECT_GT(errors.size(), 1u) << part.name;
  }
  const Table averaging = table_of(base_ / "all/mu_i_averaging/errors.csv");
  ASSERT_EQ(averaging.size(), 6u);
  EXPECT_EQ(averaging.front().at("step.pressure_averaging"), "0.0");
  EXPECT_EQ(averaging.back().at("step.pressure_averaging"), "50.0");

  ASSERT_EQ(run({"all", "--quick", "--resume"}, "all"), 0) << error_;
  const io::Json second = summary("all");
  for (const auto& part : second["parts"]) EXPECT_EQ(part["kept"], true) << part["name"];
  for (const auto& [name, text] : before)
    EXPECT_EQ(study::text_of(base_ / "all" / name / "summary.json"), text)
        << name << " was made again";
}

// A step of 5 ms is three times h/c for cells of 25 mm: that chart fails, the one after it is made.
TEST_F(ChartSetTest, AChartThatFailsIsToldAndTheOthersAreMade) {
  const std::string file = write(
      "set.toml",
      "[[chart]]\nname = \"fails\"\nkind = \"mpm\"\ninput = \"flat_mu_i\"\ntransfers = [\"apic\"]\n"
      "cells = [0.025]\ndts = [5e-3]\nset = [\"scene.end_time=0.6\"]\n"
      "[[chart]]\nname = \"works\"\nkind = \"mpm\"\ninput = \"flat_mu_i\"\ntransfers = [\"apic\"]\n"
      "cells = [0.05]\ncourants = [1.0]\nset = [\"scene.end_time=0.1\"]\n"
      "vary = { \"step.pressure_averaging\" = [0.0, 10.0], \"scene.gravity\" = [9.8, 4.9] }\n");
  EXPECT_EQ(run({file}, "set"), 3) << "the failure of a run";
  EXPECT_EQ(summary("set")["status"], "failed");
  EXPECT_EQ(summary("set")["parts"][0]["status"], "failed");
  EXPECT_EQ(summary("set")["parts"][1]["status"], "done");
  // two keys are varied, each value with each
  const Table chart = table_of(base_ / "set/works/chart.csv");
  ASSERT_EQ(chart.size(), 4u);
  EXPECT_EQ(chart[0].at("scene.gravity"), "9.8");
  EXPECT_EQ(chart[3].at("scene.gravity"), "4.9");
  EXPECT_EQ(chart[3].at("step.pressure_averaging"), "10.0");
  EXPECT_NE(chart[0].at("kinetic_J_per_m"), chart[3].at("kinetic_J_per_m"));
  // once more: the failed one again, the other kept
  EXPECT_EQ(run({file, "--resume"}, "set"), 3);
  EXPECT_EQ(summary("set")["parts"][0]["kept"], false);
  EXPECT_EQ(summary("set")["parts"][1]["kept"], true);
  // its input.toml is such a set too
  EXPECT_EQ(run({(base_ / "set/input.toml").string()}, "again"), 3);
  EXPECT_EQ(summary("again")["parts"][1]["status"], "done");
}

TEST_F(ChartSetTest, SaysWhatIsWrongBeforeAnythingIsRun) {
  const auto complaint = [&](const std::string& text) {
    const std::string file = write("bad.toml", text);
    EXPECT_EQ(run({file}, "bad"), 2) << error_;
    EXPECT_FALSE(fs::exists(base_ / "bad"));
    return error_;
  };
  EXPECT_NE(complaint("[[chart]]\nkind = \"mpmm\"\n").find("did you mean \"mpm\"?"),
            std::string::npos)
      << error_;
  EXPECT_NE(complaint("[[chart]]\nname = \"a\"\n").find("chart[0] needs kind"), std::string::npos)
      << error_;
  EXPECT_NE(complaint("[[chart]]\nkind = \"point\"\n[[chart]]\nkind = \"point\"\n")
                .find("bad.toml:3:1: there are two charts called 'point'"),
            std::string::npos)
      << error_;
  EXPECT_NE(complaint("[[chart]]\nkind = \"mpm\"\ncels = [0.1]\n")
                .find("bad.toml:1:1, chart \"mpm\": --set chart.cels=[0.1]: unknown key 'cels' in "
                      "[chart]; did you mean 'cells'?"),
            std::string::npos)
      << error_;
  EXPECT_NE(complaint("[[chart]]\nkind = \"mpm\"\ninput = \"flat_mui\"\n")
                .find("there is no scene 'flat_mui'"),
            std::string::npos)
      << error_;
  EXPECT_NE(complaint("[[chart]]\nkind = \"mpm\"\nvary = { \"grid.h\" = [0.1] }\n")
                .find("grid.h has a list of its own, cells"),
            std::string::npos)
      << error_;
  EXPECT_NE(complaint("[[chart]]\nkind = \"mpm\"\nexact = \"couette\"\n")
                .find("chart.exact = \"couette\" needs periodic edges left and right"),
            std::string::npos)
      << error_;
  EXPECT_NE(complaint("[[chart]]\nkind = \"stability\"\nparts = [\"mui\"]\n").find("did you mean"),
            std::string::npos)
      << error_;
}

/// The scene of a flow, with rows as charts have them.
mpm::Scene flow_scene(const char* name) {
  input::InputFile file = input::open_scene(name);
  mpm::Scene scene = input::read_scene(file).scene;
  scene.series_interval = scene.end_time / 60.0;
  return scene;
}

// The modes cancel the steady flow at t = 0. Late, the slowest mode is left: of Couette flow
// (4/π²) e^{−π²νt/H²} of the momentum ½, at νt/H² = 0.5 0.58 % of it; of the layer 96/π⁴ e^{−t/τ}.
TEST(ExactFlows, StartAtRestAndEndSteady) {
  const mpm::Scene couette = flow_scene("couette");
  const double dt = couette.series_interval, mass = 1000.0 * 0.125 * 0.1;
  const auto momentum =
      study::exact_shares(input::ExactFlow::couette, couette, study::Quantity::momentum);
  const auto kinetic =
      study::exact_shares(input::ExactFlow::couette, couette, study::Quantity::kinetic);
  ASSERT_TRUE(momentum && kinetic);
  ASSERT_EQ(momentum->size(), 61);
  const double steady = 0.5 * mass * 0.2;
  // 200 modes leave out Σ 4/(m²π²) over odd m > 200, about 2/(200 π²) = 1e-3
  EXPECT_NEAR((*momentum)[0] / dt / steady, 0.0, 3e-3);
  EXPECT_NEAR((*momentum)[60] / dt / steady,
              1.0 - 8.0 / (M_PI * M_PI) * std::exp(-0.5 * M_PI * M_PI), 1e-9);
  // ⟨u²⟩ = V²/3 in the end; the slowest mode takes (4/π²) e of V² from it
  const double e = std::exp(-0.5 * M_PI * M_PI);
  EXPECT_NEAR((*kinetic)[60] / dt / (0.5 * mass * 0.04),
              1.0 / 3.0 - (4.0 * e - 2.0 * e * e) / (M_PI * M_PI), 1e-8);
  EXPECT_FALSE(study::exact_shares(input::ExactFlow::couette, couette, study::Quantity::front));

  const mpm::Scene layer = flow_scene("inclined_layer");
  const auto down =
      study::exact_shares(input::ExactFlow::inclined_layer, layer, study::Quantity::momentum);
  ASSERT_TRUE(down);
  const double nu = 0.05, H = 0.1, U = 9.8 * std::sin(M_PI / 18.0) * H * H / nu;
  EXPECT_NEAR((*down)[0] / layer.series_interval / (mass * U), 0.0, 1e-6);
  const double slowest = std::exp(-M_PI * M_PI * nu * 0.25 / (4.0 * H * H));
  EXPECT_NEAR((*down)[60] / layer.series_interval / (mass * U),
              1.0 / 3.0 - 32.0 / std::pow(M_PI, 4) * slowest, 1e-6);
  EXPECT_THROW(study::exact_shares(input::ExactFlow::couette, layer, study::Quantity::kinetic),
               InputError);
}

// Bagnold's flow is what a layer of grains tends to. At 15 s the slowest mode, of half a second, is
// gone. Mean of f = 1 − (1 − s)^{3/2} is 3/5, of its square 9/20; finite volumes are of second
// order.
TEST(ExactFlows, GrainsTendToBagnoldsFlow) {
  const study::GrainLayer layer{.H = 0.05,
                                .g = 9.8,
                                .tilt = 23.0 * M_PI / 180.0,
                                .mu_0 = 0.3819,
                                .mu_d = 0.5718,
                                .I_0 = 0.279,
                                .d = 0.0053,
                                .rho_p = 2000.0,
                                .rho = 1300.0,
                                .G = 4.0 * 254800.0};
  const double U = study::bagnold_speed(layer);
  EXPECT_NEAR(U, 0.2746, 1e-4);
  std::array<double, 2> error{};
  for (const std::size_t k : {0U, 1U}) {
    const study::LayerMeans late = study::starting_flow(layer, 1.0, 16, 50 * (k + 1)).back();
    error[k] = late.velocity / (0.6 * U) - 1.0;
    EXPECT_NEAR(late.square / (0.45 * U * U), 1.0, 2.0 * std::abs(error[k]));
  }
  EXPECT_NEAR(error[0] / error[1], 4.0, 0.2);
  EXPECT_LT(std::abs(error[1]), 1e-4);
  // halved steps change the start and the middle by less than 1e-4 of the end
  const auto coarse = study::starting_flow(layer, 0.05, 41),
             fine = study::starting_flow(layer, 0.05, 41, 100, 80);
  for (std::size_t i = 0; i < fine.size(); ++i)
    EXPECT_NEAR(coarse[i].velocity, fine[i].velocity, 1e-4 * fine.back().velocity);
}

// Before anything yields, the floor's shear wave climbs with c = √(G/ρ) into grains that fall
// freely along the slope: the floor carries τ = ρ g sin(tilt) ct, and the mean velocity is g
// sin(tilt) t (1 − ct/2H) up to ct = μ_0H/tan(tilt) = 0.9 H, where the floor yields.
TEST(ExactFlows, GrainsStartElastic) {
  const double H = 0.05, tilt = 23.0 * M_PI / 180.0, G = 1e6, rho = 1300.0;
  const study::GrainLayer layer{.H = H,
                                .g = 9.8,
                                .tilt = tilt,
                                .mu_0 = 0.3819,
                                .mu_d = 0.5718,
                                .I_0 = 0.279,
                                .d = 0.0053,
                                .rho_p = 2000.0,
                                .rho = rho,
                                .G = G};
  const double t = 0.5 * H / std::sqrt(G / rho);
  // what BDF2 smears of the front of the wave does not change what the floor carries
  EXPECT_NEAR(study::starting_flow(layer, t, 2)[1].velocity, 9.8 * std::sin(tilt) * t * 0.75,
              1e-3 * 9.8 * std::sin(tilt) * t);
}

// The scene's own layer, and what it refuses.
TEST(ExactFlows, BagnoldScene) {
  mpm::Scene scene = flow_scene("bagnold");
  const auto momentum =
      study::exact_shares(input::ExactFlow::bagnold, scene, study::Quantity::momentum);
  const auto kinetic =
      study::exact_shares(input::ExactFlow::bagnold, scene, study::Quantity::kinetic);
  ASSERT_TRUE(momentum && kinetic);
  ASSERT_EQ(momentum->size(), 61);
  const double mass = 1300.0 * 0.0625 * 0.05, steady = 0.6 * 0.2746 * mass * scene.series_interval;
  EXPECT_EQ((*momentum)[0], 0.0);
  EXPECT_GT((*momentum)[60], 0.95 * steady);
  EXPECT_LT((*momentum)[60], steady);
  // ⟨u²⟩ ≥ ⟨u⟩²
  EXPECT_GT((*kinetic)[60] * scene.series_interval * mass * 2.0, std::pow((*momentum)[60], 2));
  scene.tilt_deg = 31.0;
  EXPECT_THROW(study::exact_shares(input::ExactFlow::bagnold, scene, study::Quantity::momentum),
               InputError);
  EXPECT_THROW(study::exact_shares(input::ExactFlow::bagnold, flow_scene("inclined_layer"),
                                   study::Quantity::momentum),
               InputError);
}

// A tangent that is the derivative of the update has a remainder of second order; one that is not
// would show first order. Steps of 0.1 still feel the third order, by at most a tenth of it.
TEST(TangentConvergence, IsOfSecondOrderForEveryLaw) {
  const std::vector<point::TangentTest> tests = point::tangent_convergence();
  EXPECT_EQ(tests.size(), all_laws().size());
  for (const point::TangentTest& test : tests) EXPECT_NEAR(test.order, 2.0, 0.1) << test.name;
}

}  // namespace
}  // namespace repose::app

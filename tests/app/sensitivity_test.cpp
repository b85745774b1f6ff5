// `repose sensitivity`: of tests and of scenes, after an interruption, and with mistakes.
#include "study/sensitivity/sensitivity.hpp"

#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/command_line.hpp"
#include "input/read_sensitivity.hpp"
#include "io/json.hpp"
#include "tests/app/csv_table.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;
using io::Json;

const std::string test = R"([law]
name = "modified_cam_clay"
compression = "ln_v-ln_p"
M = 0.888
lambda = 0.161
kappa = 0.062
nu = 0.3
Gamma = 2.759
[initial]
p = 100e3
[test]
kind = "triaxial"
drainage = "undrained"
axial_strain = 0.5
points = 20
)";

const std::string scene = R"([scene]
end_time = 0.02
gravity = 9.81
[domain]
size = [0.8, 0.4]
[[body]]
law = { name = "newtonian", eta = 1.0, K = 1e5, rho_0 = 1000.0 }
origin = [0.0, 0.0]
size = [0.2, 0.2]
[grid]
h = 0.05
)";

const std::string of_clay = R"([sensitivity]
samples = 40
output = ["S_u_Pa", "end_p_Pa"]
input = [{ key = "law.M", lower = 0.8, upper = 1.0 },
         { key = "law.kappa", lower = 0.03, upper = 0.09, scale = "log" },
         { key = "initial.p", mean = 100e3, sd = 5e3 }]
)";

const std::string of_water = R"([sensitivity]
method = "morris"
samples = 3
output = ["front_99_m", "momentum_x"]
input = [{ key = "body[0].law.eta", lower = 0.1, upper = 10.0, scale = "log" },
         { key = "scene.gravity", lower = 5.0, upper = 15.0 }]
)";

class SensitivityCommand : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string read(const std::string& name) const { return content_of(folder_ / name); }
  int run(const std::string& file, const std::string& out,
          std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"repose",  "sensitivity", file, "-o", (folder_ / out).string(),
                                   "--quiet", "--no-plot"};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    return run_command_line(static_cast<int>(argv.size()), argv.data());
  }
  /// Everything that is wrong with a [sensitivity] of these lines.
  std::string problems(const std::string& lines) const {
    try {
      input::InputFile file = input::InputFile::parse(test + "[sensitivity]\n" + lines, "t.toml");
      input::read_sensitivity(file);
      file.throw_if_bad();
    } catch (const input::BadInput& error) {
      return error.what();
    }
    return "";
  }
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

TEST_F(SensitivityCommand, StrengthOfClay) {
  const std::string file = write("t.toml", test + of_clay);
  ASSERT_EQ(run(file, "one", {"--threads", "1"}), 0);
  const Json all = Json::parse(read("one/sensitivity.json"));
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0]["output"].get<std::string>(), "S_u_Pa");
  EXPECT_GT(all[0]["surrogate"]["q2"].get<double>(), 0.999);
  // S_u = M p/2 · 2^(−Λ), Λ = 1 − κ/λ, at ocr 1 (Wood 1990, 7.2), of which ln M + ln p + κ ln 2/λ
  // is nearly even in its inputs: s.d. of ln M 0.2/(√12 · 0.9) = 0.064, of ln p 0.05, of κ ln 2/λ
  // 0.017 · 0.69/0.161 = 0.074: shares 0.34, 0.21 and 0.45, to about 0.03 for what is not even.
  std::map<std::string, double> total;
  for (const Json& one : all[0]["inputs"])
    total[one["input"].get<std::string>()] = one["total"].get<double>();
  EXPECT_NEAR(total["law.M"], 0.34, 0.03);
  EXPECT_NEAR(total["initial.p"], 0.21, 0.03);
  EXPECT_NEAR(total["law.kappa"], 0.45, 0.03);
  const Table rows = table_of(folder_ / "one/samples.csv");
  EXPECT_EQ(rows.size(), 40u);
  EXPECT_FALSE(fs::exists(folder_ / "one/curves.csv"));
  EXPECT_EQ(table_of(folder_ / "one/sensitivity.csv").size(), 6u);

  // any threads, and after a kill: the same bytes
  ASSERT_EQ(run(file, "four", {"--threads", "4"}), 0);
  for (const char* const name : {"samples.csv", "sensitivity.json", "sensitivity.csv"})
    EXPECT_EQ(read(std::string("one/") + name), read(std::string("four/") + name)) << name;
  const auto written = fs::last_write_time(folder_ / "four/samples.csv");
  ASSERT_EQ(run(file, "four", {"--resume"}), 0);
  EXPECT_EQ(fs::last_write_time(folder_ / "four/samples.csv"), written) << "it was finished";
  ASSERT_EQ(run(file, "five", {"--seed", "2"}), 0);
  EXPECT_NE(read("one/samples.csv"), read("five/samples.csv"));
  ASSERT_EQ(run(file, "four", {"--seed", "2", "--resume"}), 0);
  EXPECT_EQ(read("four/samples.csv"), read("five/samples.csv"))
      << "what was finished has another seed";
}

TEST_F(SensitivityCommand, DifferencesOfRunsAgreeWithThePolynomial) {
  const std::string file = write("t.toml", test + of_clay);
  ASSERT_EQ(run(file, "chaos"), 0);
  ASSERT_EQ(run(file, "runs",
                {"--set", "sensitivity.surrogate=none", "--set", "sensitivity.samples=512"}),
            0);
  const Table a = table_of(folder_ / "chaos/sensitivity.csv");
  const Table b = table_of(folder_ / "runs/sensitivity.csv");
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k)
    for (const auto& row : b) {
      if (row.at("input") != a[k].at("input") || row.at("output") != a[k].at("output")) continue;
      // 512 blocks by chance: s.d. about 0.05, and so even ones a fifth of that
      EXPECT_NEAR(std::stod(row.at("total")), std::stod(a[k].at("total")), 0.03);
      EXPECT_NEAR(std::stod(row.at("first")), std::stod(a[k].at("first")), 0.03);
    }
}

TEST_F(SensitivityCommand, RunsOfASceneAreTakenUpAgain) {
  const std::string file = write("s.toml", scene + of_water);
  ASSERT_EQ(run(file, "a", {"--threads", "2"}), 0);
  EXPECT_EQ(table_of(folder_ / "a/samples.csv").size(), 9u);
  const std::string whole = read("a/sensitivity.json");
  Json outputs = Json::parse(whole);
  EXPECT_EQ(outputs[1]["output"].get<std::string>(), "momentum_x") << "of series.csv alone";
  EXPECT_GT(outputs[1]["inputs"][0]["mu_star"].get<double>(), 0.0);
  EXPECT_EQ(outputs[1]["inputs"][0]["effects"].get<int>(), 3);
  ASSERT_EQ(run(file, "b", {"--threads", "1"}), 0);
  EXPECT_EQ(read("b/sensitivity.json"), whole);

  // states that are saved side by side: HDF5 takes files in memory of one name for one
  ASSERT_EQ(run(file, "states",
                {"--threads", "4", "--set", "sensitivity.samples=20", "--set",
                 "output.final_state=true"}),
            0);
  EXPECT_EQ(table_of(folder_ / "states/samples.csv").size(), 60u);

  // a kill after some of the runs
  for (const char* const name :
       {"samples.csv", "sensitivity.json", "summary.json", "manifest.json"})
    fs::remove(folder_ / "a" / name);
  fs::remove_all(folder_ / "a/runs/0009");
  fs::remove(folder_ / "a/runs/0004/summary.json");
  const auto kept = fs::last_write_time(folder_ / "a/runs/0002/summary.json");
  ASSERT_EQ(run(file, "a", {"--resume"}), 0);
  EXPECT_EQ(fs::last_write_time(folder_ / "a/runs/0002/summary.json"), kept);
  EXPECT_EQ(read("a/sensitivity.json"), whole);

  // further trajectories, and another output, keep the runs there are
  ASSERT_EQ(run(file, "a",
                {"--resume", "--set", "sensitivity.samples=4", "--set",
                 "sensitivity.output=[\"height_m\"]"}),
            0);
  EXPECT_EQ(fs::last_write_time(folder_ / "a/runs/0002/summary.json"), kept);
  EXPECT_EQ(table_of(folder_ / "a/samples.csv").size(), 12u);
}

TEST_F(SensitivityCommand, RunsThatCannotBeUsedAreCountedAndTold) {
  // kappa beyond lambda = 0.161 in 1/14 of the range
  std::string some = test + of_clay;
  some.replace(some.find("lower = 0.03, upper = 0.09, scale = \"log\""), 41,
               "lower = 0.03, upper = 0.171");
  testing::internal::CaptureStderr();
  ASSERT_EQ(run(write("t.toml", some), "a"), 0);
  testing::internal::GetCapturedStderr();  // --quiet
  Json all = Json::parse(read("a/sensitivity.json"));
  const int lost = all[0]["runs_lost"].get<int>();
  EXPECT_GE(lost, 2);
  EXPECT_LE(lost, 4);
  EXPECT_EQ(all[0]["runs"].get<int>(), 40 - lost);
  EXPECT_TRUE(all[0]["inputs"][0].contains("total"));
  std::string many = some;
  many.replace(many.find("0.171"), 5, "0.25");
  ASSERT_EQ(run(write("m.toml", many), "b"), 0);
  all = Json::parse(read("b/sensitivity.json"));
  EXPECT_NE(all[0]["not_shown"].get<std::string>().find("runs have no value"), std::string::npos);
  EXPECT_FALSE(all[0]["inputs"][0].contains("total"));
  std::string none = some;
  none.replace(none.find("lower = 0.03"), 12, "lower = 0.17");
  EXPECT_EQ(run(write("n.toml", none), "c"), 2);
}

TEST_F(SensitivityCommand, ItsMistakes) {
  const auto says = [&](const std::string& lines, const std::string& part) {
    const std::string text = problems(lines);
    EXPECT_NE(text.find(part), std::string::npos) << lines << ": " << text;
    EXPECT_NE(text.find("t.toml:"), std::string::npos) << text;
  };
  const std::string head = "samples = 40\noutput = \"S_u_Pa\"\n";
  const auto with = [&](const std::string& entry) {
    return head + "input = [{ key = \"law.M\", " + entry + " }]\n";
  };
  says("", "[sensitivity] needs samples");
  says(head, "at least one [[sensitivity.input]]");
  says(with("lower = 1.0, uper = 2.0"), "did you mean 'upper'?");
  says(with("lower = 1.0"), "needs lower and upper, or mean and sd");
  says(with("lower = 2.0, upper = 1.0"), "must be > lower = 2");
  says(with("lower = -1.0, upper = 1.0, scale = \"log\""), "must be > 0 on a logarithmic scale");
  says(with("sd = 1.0"), "the mean of the normal distribution");
  says(with("mean = 1.0, sd = 0.1, relative_sd = 0.1"), "needs either sd or relative_sd");
  says(with("mean = -1.0, relative_sd = 0.1"), "must be > 0 with a relative_sd");
  says("method = \"sobel\"\n" + with("lower = 1.0, upper = 2.0"), "did you mean \"sobol\"?");
  says("levels = 4\n" + with("lower = 1.0, upper = 2.0"), "only method = \"morris\" has levels");
  says("method = \"morris\"\nlevels = 5\n" + with("lower = 1.0, upper = 2.0"), "must be even");
  says(
      "samples = 3\noutput = \"S_u_Pa\"\ninput = [{ key = \"law.M\", lower = 0.9, upper = 1.0 }]\n",
      "needs 4 runs at least");
  says(
      "samples = 20000\nsurrogate = \"none\"\noutput = \"S_u_Pa\"\n"
      "input = [{ key = \"law.M\", lower = 0.9, upper = 1.0 }]\n",
      "asks for 60000 runs");
  says(head + "input = [{ key = [\"law.M\", \"law.M\"], lower = 0.9, upper = 1.0 }]\n",
       "is there twice");

  const auto tells = [&](const std::string& text, const std::string& part) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(run(write("t.toml", text), "a"), 2);
    const std::string told = testing::internal::GetCapturedStderr();
    EXPECT_NE(told.find(part), std::string::npos) << told;
  };
  tells(test, "has no [sensitivity]");
  std::string typo = test + of_clay;
  typo.replace(typo.find("\"S_u_Pa\""), 8, "\"S_u\"");
  tells(typo, "t.toml:18:1: no run has a figure 'S_u'; did you mean 'S_u_Pa'?");
  typo = scene + of_water;
  typo.replace(typo.find("front_99_m"), 10, "front_99");
  tells(typo, "no run has a figure 'front_99'; did you mean 'front_99_m'?");
  EXPECT_FALSE(fs::exists(folder_ / "a/runs")) << "it was known before";
}

TEST(UncertainInput, ItsValues) {
  input::UncertainInput even{{"law.M"}, 1.0, 100.0, Scale::log, {}};
  EXPECT_DOUBLE_EQ(study::value_at(even, 0.5), 10.0);
  EXPECT_DOUBLE_EQ(study::value_within(even, 1.0), 100.0);
  input::UncertainInput normal{{"law.M"}};
  normal.prior = calibration::Prior{2.0, 0.5, false};
  EXPECT_NEAR(study::value_at(normal, 0.975), 2.0 + 0.5 * 1.959963984540054, 1e-9);
  EXPECT_DOUBLE_EQ(study::value_within(normal, 0.0), 1.0) << "two standard deviations below";
  normal.lower = 2.0;  // the upper half: its median is the upper quartile of the whole
  EXPECT_NEAR(study::value_at(normal, 0.5), 2.0 + 0.5 * 0.6744897501960817, 1e-9);
  EXPECT_DOUBLE_EQ(study::value_within(normal, 0.0), 2.0);
  input::UncertainInput relative{{"law.M"}};
  relative.prior = calibration::Prior{2.0, 0.1, true};
  EXPECT_NEAR(study::value_at(relative, 0.025), 2.0 * std::exp(-0.1 * 1.959963984540054), 1e-9);
}

}  // namespace
}  // namespace repose::app

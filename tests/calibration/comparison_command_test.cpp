// `repose fit A.toml B.toml --compare`: which law of two, from files to comparison.json.

#include <filesystem>
#include <fstream>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/command_line.hpp"
#include "input/read_fit.hpp"
#include "io/json.hpp"
#include "study/fit/comparison.hpp"
#include "study/fit/twin.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;
using io::Json;

/// London clay compressed undrained from three pressures, and from a fourth held out.
class CompareCommand : public testing::Test {
 protected:
  void SetUp() override {
    for (int k = 0; k < 4; ++k) write(fmt::format("cu{}.csv", k), table(k));
    write("fixed.toml", fit("nu = 0.3\n", ""));
    write("free.toml", fit("", "nu = { lower = 0.05, upper = 0.45 }\n"));
    // the true M, 0.888, is out of reach
    write("stiff.toml", replaced(fit("nu = 0.3\n", ""), "upper = 1.8", "upper = 0.7"));
  }

  static double pressure(int k) { return 1e5 * (k + 1); }

  /// Made by the law itself, with noise of 1 % of the pressure.
  static std::string table(int k) {
    study::Twin twin = study::cam_clay_twin("ln_v-ln_p");
    study::TwinTest test = study::cam_clay_tests()[1];
    test.initial.p = pressure(k);
    const calibration::Target t = study::measure(twin, test);
    std::mt19937_64 random(static_cast<std::uint64_t>(k + 1));
    std::normal_distribution<double> noise(0.0, 0.01 * pressure(k));
    std::string text = "eps_a,q_Pa,u_Pa\n";
    for (Eigen::Index i = 0; i < t.x.size(); ++i)
      text += fmt::format("{},{},{}\n", t.x[i], t.channels[0].observed[i] + noise(random),
                          t.channels[1].observed[i] + noise(random));
    return text;
  }

  static std::string fit(const std::string& law, const std::string& free) {
    std::string text = R"([law]
name = "modified_cam_clay"
compression = "ln_v-ln_p"
lambda = 0.161
Gamma = 2.759
)" + law + R"([fit]
M = { lower = 0.4, upper = 1.8 }
kappa = { lower = 0.02, upper = 0.15, scale = "log" }
)" + free;
    for (int k = 0; k < 4; ++k)
      text += fmt::format(R"([[target]]
data = "cu{}.csv"
x = "eps_a"
y = ["q_Pa", "u_Pa"]
held_out = {}
test = {{ kind = "triaxial", drainage = "undrained", axial_strain = 0.1 }}
initial = {{ p = {}, ocr = 1.0 }}
)",
                          k, k == 3, pressure(k));
    return text + "[solver]\nstarts = 2\n[uncertainty]\nprofile = false\n";
  }
  static std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const auto at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  Json json(const std::string& name) const { return Json::parse(content_of(folder_ / name)); }

  int command(std::vector<std::string> words) const {
    words.insert(words.begin(), {"repose", "fit"});
    words.insert(words.end(), {"--quiet", "--no-plot"});
    std::vector<const char*> argv;
    for (const std::string& w : words) argv.push_back(w.c_str());
    return run_command_line(static_cast<int>(argv.size()), argv.data());
  }
  /// Why the fit of `text` is not to be compared with fixed.toml.
  std::string refusal(const std::string& text) const {
    write("other.toml", text);
    try {
      study::check_same_data(
          {input::read_fit(path("fixed.toml"), {}, 1), input::read_fit(path("other.toml"), {}, 1)});
    } catch (const input::BadInput& error) {
      return error.what();
    }
    return "accepted";
  }

  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

TEST_F(CompareCommand, EachIsFittedAsAloneAndTheSmallerTrueLawIsPreferred) {
  ASSERT_EQ(command({path("fixed.toml"), path("free.toml"), "--compare", "-o", path("both")}), 0);
  ASSERT_EQ(command({path("free.toml"), "-o", path("alone")}), 0);
  for (const char* file : {"fitted.toml", "predictions.csv"})
    EXPECT_EQ(content_of(folder_ / "both/free" / file), content_of(folder_ / "alone" / file));
  const Json whole = json("both/free/fit.json"), alone = json("alone/fit.json");
  EXPECT_EQ(whole["parameters"], alone["parameters"]);

  const Json comparison = json("both/comparison.json");
  const Json &fixed = comparison["fits"]["fixed"], &free = comparison["fits"]["free"];
  for (const char* errors : {"white_errors", "correlated_errors"}) {
    // nested: more is free, so more is likely, but for the 1e-9 to which both are found
    EXPECT_GE(free[errors]["log_likelihood"].get<double>(),
              fixed[errors]["log_likelihood"].get<double>() - 1e-6);
    EXPECT_EQ(free[errors]["k"].get<int>(), fixed[errors]["k"].get<int>() + 1);
    EXPECT_EQ(fixed[errors]["n"], 60);
  }
  EXPECT_EQ(fixed["white_errors"]["k"], 2 + 6);
  // ν is 0.3: 2 Δ ln L is χ² of one degree, below ln 60 = 4.1 in 95.7 %
  EXPECT_EQ(fixed["white_errors"]["delta_bic"], 0.0);
  EXPECT_EQ(fixed["tests"].size(), 4u);
  EXPECT_TRUE(fixed["tests"]["cu3"]["held_out"].get<bool>());
  // predicted to its noise, 1 % of the pressure; the r.m.s. of ten rows has √(1/20) = 22 %, of
  // which these are two
  const double rms = fixed["tests"]["cu3"]["channels"][0]["rms"].get<double>();
  EXPECT_NEAR(rms / (0.01 * pressure(3)), 1.0, 0.5);
  EXPECT_NE(comparison["verdict"].get<std::string>().find("BIC "), std::string::npos);
  for (const char* file : {"comparison.csv", "unseen.csv", "left_out.jsonl", "manifest.json"})
    EXPECT_TRUE(fs::exists(folder_ / "both" / file)) << file;
}

TEST_F(CompareCommand, ALawThatCannotReachTheDataIsToldApart) {
  ASSERT_EQ(command({path("stiff.toml"), path("fixed.toml"), "--compare", "-o", path("both")}), 0);
  const Json fits = json("both/comparison.json")["fits"];
  const Json &stiff = fits["stiff"], &fixed = fits["fixed"];
  EXPECT_GT(stiff["correlated_errors"]["delta_bic"].get<double>(), 10.0);
  EXPECT_GT(stiff["white_errors"]["delta_bic"].get<double>(),
            stiff["correlated_errors"]["delta_bic"].get<double>());
  EXPECT_GT(fixed["left_out"]["log_score"].get<double>(),
            stiff["left_out"]["log_score"].get<double>());
  EXPECT_LT(fixed["held_out"]["rms_over_range"].get<double>(),
            stiff["held_out"]["rms_over_range"].get<double>());
  const std::string verdict = json("both/comparison.json")["verdict"].get<std::string>();
  EXPECT_EQ(verdict.find("fixed predicts the tests that are left out in turn better than stiff"),
            0u)
      << verdict;
  EXPECT_NE(verdict.find("BIC agrees: it prefers fixed"), std::string::npos) << verdict;
}

TEST_F(CompareCommand, ResumesWithoutRepeatingWhatWasDone) {
  const std::vector<std::string> words{path("fixed.toml"), path("free.toml"), "--compare", "-o",
                                       path("both")};
  ASSERT_EQ(command(words), 0);
  const std::string whole = content_of(folder_ / "both/comparison.json");
  // as a kill would leave it: the last test left out is cut short, and so is a fit
  std::string journal = content_of(folder_ / "both/left_out.jsonl");
  write("both/left_out.jsonl", journal.substr(0, journal.size() - 40));
  std::string starts = content_of(folder_ / "both/free/starts.jsonl");
  write("both/free/starts.jsonl", starts.substr(0, starts.size() - 40));
  std::vector<std::string> again = words;
  again.emplace_back("--resume");
  ASSERT_EQ(command(again), 0);
  EXPECT_EQ(content_of(folder_ / "both/comparison.json"), whole);
}

TEST_F(CompareCommand, RefusesFitsOfOtherDataAndTellsWhatDiffers) {
  const std::string good = fit("", "nu = { lower = 0.05, upper = 0.45 }\n");
  EXPECT_EQ(refusal(good), "accepted");
  const std::string not_same = "fixed and other are not fits of the same data: ";
  EXPECT_EQ(refusal(replaced(good, "held_out = true", "held_out = false")),
            not_same + "of target 4, cu3, it is held out in fixed alone");
  EXPECT_EQ(refusal(replaced(good, "held_out = false", "from = 0.05")),
            not_same + "of target 1, cu0, it has rows: 10 in fixed and 6 in other");
  EXPECT_EQ(refusal(replaced(good, "[\"q_Pa\", \"u_Pa\"]", "\"q_Pa\"")),
            not_same + "of target 1, cu0, it has channels: 2 in fixed and 1 in other");
  EXPECT_EQ(refusal(replaced(good, "held_out = false", "noise = { q_Pa = 2e3 }")),
            not_same +
                "of target 1, cu0, the noise of q_Pa is not declared in fixed and 2000 in "
                "other");
  EXPECT_NE(refusal(replaced(good, "cu1.csv", "cu2.csv")).find("it is called cu1 in fixed"),
            std::string::npos);
  EXPECT_EQ(command({path("fixed.toml"), "--compare", "-o", path("out")}), 2);
  EXPECT_EQ(command({path("fixed.toml"), path("free.toml"), "-o", path("out")}), 2);
  EXPECT_EQ(command({path("fixed.toml"), path("fixed.toml"), "--compare", "-o", path("out")}), 2);
  EXPECT_EQ(command({path("fixed.toml"), path("free.toml"), "--compare", "--starts-from", "1", "-o",
                     path("out")}),
            2);
  EXPECT_FALSE(fs::exists(folder_ / "out/comparison.json"));
}

}  // namespace
}  // namespace repose::app

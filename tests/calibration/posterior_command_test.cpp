// `repose fit --posterior` from file to result: its files, shares, stops, messages.

#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "app/command_line.hpp"
#include "io/json.hpp"
#include "study/fit/posterior_record.hpp"
#include "study/fit/twin.hpp"
#include "tests/calibration/clay_fit.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;

class PosteriorCommand : public testing::Test {
 protected:
  void SetUp() override {
    // undrained compression of London clay with 1 % noise, and another test of it to be predicted
    study::Twin twin = study::cam_clay_twin("ln_v-ln_p");
    const std::vector<study::TwinTest> tests = study::cam_clay_tests();
    write("cu.csv", table(study::measure(twin, tests[1], 0.01, 4)));
    write("cd.csv", table(study::measure(twin, tests[2], 0.01, 5)));
    write("fit.toml", text("[posterior]\nchains = 2\nwarmup = 40\ndraws = 100\n"));
  }
  static std::string table(const calibration::Target& t) {
    std::string text = "eps_a";
    for (const calibration::Channel& c : t.channels) text += "," + c.name;
    text += "\n";
    for (Eigen::Index i = 0; i < t.x.size(); ++i) {
      text += fmt::format("{}", t.x[i]);
      for (const calibration::Channel& c : t.channels) text += fmt::format(",{}", c.observed[i]);
      text += "\n";
    }
    return text;
  }
  static std::string text(const std::string& posterior) {
    return clay_fit + std::string(R"([[target]]
data = "cd.csv"
held_out = true
x = "eps_a"
y = ["q_Pa", "eps_v"]
test = { kind = "triaxial", drainage = "drained", axial_strain = 0.15 }
initial = { p = 100e3, ocr = 3.0 }
[solver]
starts = 2
)") + posterior;
  }

  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name) << content;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string read(const std::string& name) const { return content_of(folder_ / name); }

  int command(std::vector<std::string> words) const {
    words.insert(words.begin(), {"repose", "fit", path("fit.toml")});
    words.insert(words.end(), {"--quiet", "--no-plot"});
    std::vector<const char*> argv;
    for (const std::string& w : words) argv.push_back(w.c_str());
    return run_command_line(static_cast<int>(argv.size()), argv.data());
  }
  std::string complaint(const std::string& posterior) const {
    write("bad.toml", text(posterior));
    try {
      input::read_fit(path("bad.toml"), {}, 1);
    } catch (const input::BadInput& error) {
      const std::string all = error.what();
      return all.substr(std::min(all.find("bad.toml:"), all.size()));
    }
    return "accepted";
  }

  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

/// What a posterior leaves that depends on the draws.
constexpr std::array<const char*, 3> files{"posterior.json", "posterior.csv",
                                           "posterior_bands.csv"};

TEST_F(PosteriorCommand, HoldsTheTruthAndPredictsWhatWasHeldOut) {
  ASSERT_EQ(command({"-o", path("out"), "--set", "posterior.draws=400"}), 0);
  const auto report = io::Json::parse(read("out/posterior.json"));
  for (const auto& [name, truth] : {std::pair{"M", 0.888}, {"kappa", 0.062}}) {
    const auto& q = report["quantities"][name];
    const double sd = q["sd"].get<double>();
    EXPECT_NEAR(q["mean"].get<double>(), truth, 4.0 * sd) << name;
    EXPECT_LT(sd, 0.1 * truth) << name;
    EXPECT_LT(q["interval_90"][0].get<double>(), q["median"].get<double>());
    EXPECT_LT(q["r_hat"].get<double>(), 1.05);
  }
  // 1 % of the range of q, known from ten rows: 1/√20, four of them
  const auto& q = report["quantities"]["noise of cu q_Pa"];
  EXPECT_GT(q["median"].get<double>(), 300.0);
  EXPECT_LT(q["median"].get<double>(), 5000.0);
  EXPECT_TRUE(report["targets"]["cd"]["held_out"].get<bool>());
  EXPECT_TRUE(report["targets"]["cd"]["channels"]["q_Pa"]["band_holds_errors"].get<bool>());
  // nothing fitted is called eps_v, and no noise is declared
  EXPECT_FALSE(report["targets"]["cd"]["channels"]["eps_v"]["band_holds_errors"].get<bool>());
  std::istringstream rows(read("out/posterior.csv"));
  std::string line;
  int lines = 0;
  while (std::getline(rows, line)) ++lines;
  EXPECT_EQ(lines, 1 + 2 * 400);
  EXPECT_EQ(io::Json::parse(read("out/summary.json"))["status"], "done");
}

TEST_F(PosteriorCommand, SharesThreadsAndStopsGiveTheSameBits) {
  ASSERT_EQ(command({"-o", path("whole")}), 0);
  ASSERT_EQ(command({"-o", path("one"), "--threads", "1"}), 0);
  for (const char* file : files)
    EXPECT_EQ(read(std::string("whole/") + file), read(std::string("one/") + file)) << file;
  // in shares
  ASSERT_EQ(command({"-o", path("a"), "--chains-to", "1"}), 0);
  ASSERT_EQ(command({"-o", path("b"), "--chains-from", "1"}), 0);
  EXPECT_FALSE(fs::exists(folder_ / "a/posterior.json"));
  ASSERT_EQ(command({"-o", path("merged"), "--merge", path("a"), path("b")}), 0);
  for (const char* file : files)
    EXPECT_EQ(read(std::string("whole/") + file), read(std::string("merged/") + file)) << file;
  // one share alone is no posterior
  ASSERT_EQ(command({"-o", path("half"), "--merge", path("a")}), 0);
  EXPECT_FALSE(fs::exists(folder_ / "half/posterior.json"));
  // as a kill would leave it: a hundred draws and a piece of one
  fs::create_directories(folder_ / "killed");
  const std::string chains = read("whole/chains.jsonl");
  std::size_t end = 0;
  for (int k = 0; k < 101; ++k) end = chains.find('\n', end) + 1;
  write("killed/chains.jsonl", chains.substr(0, end + 40));
  write("killed/starts.jsonl", read("whole/starts.jsonl"));
  ASSERT_EQ(command({"-o", path("killed"), "--resume"}), 0);
  for (const char* file : files)
    EXPECT_EQ(read(std::string("whole/") + file), read(std::string("killed/") + file)) << file;
  // more draws go on from those there are
  ASSERT_EQ(command({"-o", path("killed"), "--resume", "--set", "posterior.draws=120"}), 0);
  ASSERT_EQ(command({"-o", path("longer"), "--set", "posterior.draws=120"}), 0);
  EXPECT_EQ(read("longer/posterior.csv"), read("killed/posterior.csv"));
  // another density's draws are refused
  EXPECT_EQ(command({"-o", path("killed"), "--resume", "--set", "posterior.discrepancy=0.1"}), 2);
}

TEST_F(PosteriorCommand, IsAskedForByTheFlagAsWellAndAddsNothingElse) {
  write("fit.toml", text(""));
  ASSERT_EQ(command({"-o", path("plain")}), 0);
  EXPECT_FALSE(fs::exists(folder_ / "plain/posterior.json"));
  EXPECT_FALSE(fs::exists(folder_ / "plain/chains.jsonl"));
  ASSERT_EQ(command({"-o", path("drawn"), "--posterior", "--set", "posterior.draws=100"}), 0);
  EXPECT_TRUE(fs::exists(folder_ / "drawn/posterior.json"));
  const auto plain = io::Json::parse(read("plain/fit.json")),
             drawn = io::Json::parse(read("drawn/fit.json"));
  EXPECT_EQ(plain["parameters"], drawn["parameters"]);
  EXPECT_EQ(plain["fingerprint"], drawn["fingerprint"]);
}

TEST_F(PosteriorCommand, TellsWhatIsWrongAndWhere) {
  EXPECT_EQ(complaint("[posterior]\n"), "accepted");
  EXPECT_NE(complaint("[posterior]\nchain = 4\n").find("did you mean 'chains'?"),
            std::string::npos);
  EXPECT_NE(complaint("[posterior]\ndiscrepancy = -0.1\n").find("posterior.discrepancy"),
            std::string::npos);
  EXPECT_NE(complaint("[posterior]\nnoise = \"declared\"\n")
                .find("posterior.noise = \"declared\", but cu declares no noise of q_Pa"),
            std::string::npos);
  EXPECT_EQ(command({"-o", path("out"), "--chains-from", "2"}), 2);
  EXPECT_EQ(command({"-o", path("out"), "--starts-to", "1"}), 2);
}

}  // namespace
}  // namespace repose::app

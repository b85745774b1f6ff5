// `repose report` from the command to the browser: the page of small real results is loaded in
// Chromium without a screen, which uses it (#self-test) and must not complain.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/scratch_folder.hpp"

using repose::content_of;
using repose::ScratchFolder;

namespace {

namespace fs = std::filesystem;

/// "" if no Chromium is installed.
std::string browser() {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    for (const char* const name : {"chromium", "chromium-browser", "google-chrome"})
      if (const fs::path file = fs::path(folder) / name; ::access(file.c_str(), X_OK) == 0)
        return file;
  return "";
}

class ReportPageTest : public ::testing::Test {
 protected:
  void SetUp() override { std::ofstream(base_ / "tiny.toml") << tiny; }

  /// A command line in base_; its outputs go to out_ and err_.
  int shell(const std::string& line) {
    const std::string all = "cd '" + base_.string() + "' && " + line + " > out 2> err";
    const int status = std::system(all.c_str());
    out_ = content_of(base_ / "out");
    err_ = content_of(base_ / "err");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  int repose(const std::string& arguments) { return shell(REPOSE_COMMAND " " + arguments); }

  /// What the page says after it has used itself in a window of that width.
  std::string self_test(const std::string& page, int width) {
    std::string verdict;
    // a browser that is starved of time may print the page before it has answered
    for (int attempt = 0; attempt < 3; ++attempt) {
      verdict = verdict_of(page, width);
      if (!verdict.starts_with("no answer")) break;
    }
    return verdict;
  }
  std::string verdict_of(const std::string& page, int width) {
    shell("timeout 60 '" + browser() +
          "' --headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage "
          "--user-data-dir=profile --window-size=" +
          std::to_string(width) +
          ",900 --virtual-time-budget=5000 --enable-logging=stderr --dump-dom 'file://" +
          (base_ / page).string() + "#self-test'");
    const std::string mark = "data-self-test=\"";
    const std::size_t from = out_.find(mark);
    if (from == out_.npos) return "no answer: " + err_;
    return out_.substr(from + mark.size(), out_.find('"', from + mark.size()) - from - mark.size());
  }

  // 1000 steps of 128 points, five frames
  static constexpr const char* tiny =
      "[scene]\nend_time = 0.02\n"
      "[domain]\nsize = [0.6, 0.3]\n"
      "[[body]]\nsize = [0.1, 0.2]\n"
      "law = { name = \"mu_i\", mu_0 = 0.38, mu_d = 0.57, I_0 = 0.28, d = 5e-3, rho_p = 2000, "
      "rho_0 = 1300, K = 1e5 }\n"
      "[grid]\nh = 0.025\n"
      "[step]\ndt = 2e-5\n"
      "[output]\nseries_interval = 0.001\nframe_interval = 0.005\n";
  const ScratchFolder scratch_;
  const fs::path base_ = scratch_.path();
  std::string out_, err_;
};

TEST_F(ReportPageTest, WorksInABrowser) {
  if (browser().empty()) GTEST_SKIP() << "no Chromium here: scripts/packages check installs it";
  ASSERT_EQ(repose("run tiny.toml --quiet -o 'a<b>&\"c\"'"), 0) << err_;
  ASSERT_EQ(repose("run tiny.toml --quiet --set step.dt=4e-5 -o other"), 0) << err_;
  fs::create_directories(base_ / "map");
  std::ofstream(base_ / "map/summary.json")
      << R"({"kind": "stability", "status": "failed", "reason": "</script><b>", "warnings": ["a < b"]})";
  std::ofstream(base_ / "map/input.toml") << "# </script><script>throw 1</script>\n";
  std::ofstream map(base_ / "map/map.csv");
  map << "eps_v,eps_q,error,status\n";
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 4; ++j)
      map << i << ',' << j << ',' << (i == j ? "nan" : "0.1") << ',' << (i < j ? "ok" : "\"a,b\"")
          << '\n';
  map.close();
  ASSERT_EQ(repose("report 'a<b>&\"c\"' other map -o page.html"), 0) << err_;
  EXPECT_TRUE(out_.starts_with("page.html: 3 results, 0.")) << out_;
  for (const int width : {390, 1280}) {
    const std::string verdict = self_test("page.html", width);
    EXPECT_EQ(verdict.substr(0, 7), "passed:") << verdict << "\nin " << width << " px";
    EXPECT_NE(verdict.find(" 1 maps, 1 players"), verdict.npos) << verdict;
    EXPECT_EQ(err_.find("CONSOLE"), err_.npos) << err_;
  }
}

// Bodies, a gate that moves, probes, a tracer, what comes in; and a map with what flows over it.
TEST_F(ReportPageTest, ShowsWhatStandsAroundTheMaterial) {
  if (browser().empty()) GTEST_SKIP() << "no Chromium here: scripts/packages check installs it";
  const std::string law =
      "law = { name = \"mu_i\", mu_0 = 0.38, mu_d = 0.57, I_0 = 0.28, d = 5e-3, rho_p = 2000, "
      "rho_0 = 1300, K = 1e5 }\n";
  std::ofstream(base_ / "gate.toml")
      << "[scene]\nend_time = 0.04\n[domain]\nsize = [0.6, 0.4]\nright = \"open\"\n"
         "[[body]]\nname = \"lower\"\nsize = [0.1, 0.1]\n"
      << law << "[[body]]\nname = \"upper\"\norigin = [0.0, 0.1]\nsize = [0.1, 0.1]\n"
      << law
      << "[[surface]]\nname = \"door\"\nshape = \"polygon\"\n"
         "corners = [[0.1, 0.0], [0.175, 0.0], [0.175, 0.25], [0.1, 0.25]]\nvelocity = [0.0, 1.0]\n"
         "[[inflow]]\nedge = \"top\"\nfrom = 0.4\nto = 0.5\nspeed = 0.5\n"
         "[[probe]]\nname = \"foot\"\nplace = [0.05, 0.02]\n"
         "[[probe]]\nname = \"ahead\"\nplace = [0.25, 0.02]\n"
         "[[tracer]]\nname = \"top\"\nplace = [0.05, 0.18]\n"
         "[grid]\nh = 0.025\n[output]\nseries_interval = 0.002\nframe_interval = 0.01\n";
  std::ofstream ground(base_ / "ground.asc"), release(base_ / "release.asc");
  for (auto* const map : {&ground, &release})
    *map << "ncols 20\nnrows 12\nxllcorner 500\nyllcorner 800\ncellsize 3\n";
  for (int row = 0; row < 12; ++row)
    for (int column = 0; column < 20; ++column) {
      ground << 500.0 - 1.2 * column << (column < 19 ? ' ' : '\n');
      release << (column >= 3 && column < 7 && row >= 4 && row < 8 ? 2 : 0)
              << (column < 19 ? ' ' : '\n');
    }
  ground.close();
  release.close();
  std::ofstream(base_ / "slope.toml")
      << "[scene]\nend_time = 0.5\n[terrain]\nground = \"ground.asc\"\nrelease = \"release.asc\"\n"
         "friction = 0.2\n[[body]]\nshape = \"release\"\n[body.law]\nname = \"mu_i\"\nmu_0 = 0.38\n"
         "mu_d = 0.57\nI_0 = 0.28\nd = 0.05\nrho_p = 2000\nrho_0 = 1300\nK = 1e6\n[grid]\nh = 1.5\n"
         "[[probe]]\nname = \"road\"\nplace = [24.0, 12.0, 18.0]\n"
         "[[tracer]]\nname = \"stone\"\nplace = [15.0, 18.0, 18.0]\n"
         "[output]\nseries_interval = 0.05\nframe_interval = 0.1\n";
  ASSERT_EQ(repose("run gate.toml --quiet -o gate"), 0) << err_;
  ASSERT_EQ(repose("run slope.toml --quiet -o slope"), 0) << err_;
  struct Shown {
    const char* folder;
    const char* marks;
  };
  for (const auto& [folder, marks] : {Shown{"gate", "1 surfaces 2 probes 1 tracers no contours"},
                                      Shown{"slope", "0 surfaces 1 probes 1 tracers contours"}}) {
    ASSERT_EQ(repose(std::string("report ") + folder + " -o page.html"), 0) << err_;
    for (const int width : {390, 1280}) {
      const std::string verdict = self_test("page.html", width);
      EXPECT_EQ(verdict.substr(0, 7), "passed:") << verdict << "\nin " << width << " px";
      EXPECT_NE(verdict.find(marks), verdict.npos) << verdict;
      EXPECT_EQ(err_.find("CONSOLE"), err_.npos) << err_;
    }
    const std::string page = content_of(base_ / "page.html");
    EXPECT_EQ(page.find("the animation shows points alone"), page.npos);
  }
  // without its maps a page is made all the same, and says what it lacks
  fs::remove(base_ / "ground.asc");
  ASSERT_EQ(repose("report slope -o page.html"), 0) << err_;
  EXPECT_NE(content_of(base_ / "page.html").find("the animation shows points alone"),
            std::string::npos);
  EXPECT_EQ(self_test("page.html", 1280).substr(0, 7), "passed:");
}

TEST_F(ReportPageTest, TheSameFoldersGiveTheSamePage) {
  ASSERT_EQ(repose("run tiny.toml --quiet -o one"), 0) << err_;
  ASSERT_EQ(repose("report one --quiet"), 0) << err_;
  const std::string page = content_of(base_ / "results/report.html");
  EXPECT_NE(page.find("\"path\""), 0u);
  // what `results/*` gives the second time: the page itself is passed over, a folder given twice
  // counts once
  ASSERT_EQ(repose("report one ./one/ results/*"), 0) << err_;
  EXPECT_NE(err_.find("results/report.html is a file, left out"), err_.npos) << err_;
  EXPECT_EQ(content_of(base_ / "results/report.html"), page);
  // nothing tells where the results lay
  EXPECT_EQ(page.find(base_.string()), page.npos);
}

TEST_F(ReportPageTest, RefusesWithTheRightCode) {
  EXPECT_EQ(repose("report none"), 4);
  EXPECT_EQ(err_, "none: there is no such folder\n");
  EXPECT_EQ(repose("report tiny.toml"), 2);
  EXPECT_NE(err_.find("takes result folders, and none is given"), err_.npos) << err_;
  EXPECT_EQ(repose("report"), 2);
  fs::create_directories(base_ / "empty");
  EXPECT_EQ(repose("report empty"), 2);
  EXPECT_EQ(err_, "empty: is not a result folder: it has no summary.json\n");
  fs::create_directories(base_ / "ok");
  std::ofstream(base_ / "ok/summary.json") << "{}";
  EXPECT_EQ(repose("report ok -o empty"), 2);
  EXPECT_EQ(err_, "-o empty: is a folder; give the page a name: -o empty/report.html\n");
  EXPECT_EQ(repose("report ok -o tiny.toml/page.html"), 4);
  EXPECT_EQ(repose("report --help"), 0);
  EXPECT_NE(out_.find("\n  repose report results/"), out_.npos);
}

}  // namespace

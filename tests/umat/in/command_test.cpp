/// UMATs from input files: what `repose` says of mistakes, what a run keeps when a library fails,
/// and that results do not depend on threads or interruptions.
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/json.hpp"
#include "tests/scratch_folder.hpp"

namespace repose {
namespace {

struct Said {
  int code = -1;
  std::string text;
};

Said repose(const std::string& arguments, const std::string& before = "") {
  Said said;
  FILE* const pipe = ::popen((before + REPOSE_COMMAND " " + arguments + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return said;
  std::array<char, 4096> part{};
  while (std::fgets(part.data(), part.size(), pipe) != nullptr) said.text += part.data();
  const int status = ::pclose(pipe);
  said.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return said;
}

class UmatCommand : public testing::Test {
 protected:
  ScratchFolder scratch;

  std::string write(const std::string& name, const std::string& text) const {
    const std::string path = (scratch.path() / name).string();
    std::ofstream(path) << text;
    return path;
  }
  std::string folder(const std::string& name) const { return (scratch.path() / name).string(); }
  io::Json summary(const std::string& of) const {
    return io::Json::parse(content_of(std::filesystem::path(folder(of)) / "summary.json"));
  }
};

const std::string point_test = R"([law]
name = "umat"
library = "libvon_mises.so"
props = [1e7, 0.25, 2e4, 1e6]
names = ["E", "nu", "sigma_y", "H"]
statev = 1

[initial]
p = 100e3

[test]
kind = "triaxial"
drainage = "drained"
axial_strain = 0.02
points = 10
)";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error(from);
  return text.replace(at, from.size(), to);
}

struct Mistake {
  std::string from, to;
  std::vector<std::string> words;
};

TEST_F(UmatCommand, MistakesAreTold) {
  const std::vector<Mistake> mistakes{
      {"name = \"umat\"", "name = \"umatt\"", {":2:", "umatt", "did you mean \"umat\"?"}},
      {"libvon_mises.so",
       "libvon_misses.so",
       {":3:", "there is no", "libvon_misses.so", "did you mean libvon_mises.so?"}},
      {"library = \"libvon_mises.so\"\n", "", {"[law] needs library"}},
      {"libvon_mises.so", OTHER_NAME, {":3:", "no function umat_", "UMAT"}},
      {"libvon_mises.so", REPOSE_SOURCE_DIR "/README.md", {":3:", "cannot be loaded"}},
      {"\"H\"]", "\"H\", \"G\"]", {":5:", "5 names for 4 props"}},
      {"\"H\"]", "\"\"]", {":5:", "\"\" for PROPS(4) is no key"}},
      {"\"H\"]", "\"e e\"]", {":5:", "\"e e\" for PROPS(4) is no key"}},
      {"\"H\"]", "\"statev\"]", {":5:", "\"statev\" is a key of every umat"}},
      {"libvon_mises.so", "/dev/zero", {":3:", "no regular file"}},
      {"statev = 1", "statev = -1", {":6:", "statev", "from 0 to 53", "-1"}},
      {"statev = 1", "statev = 54", {":6:", "from 0 to 53"}},
      {"statev = 1", "state = 1", {":6:", "state", "did you mean", "statev"}},
      {"statev = 1", "statev = 1\nsigmay = 3e4", {":7:", "sigmay", "did you mean", "sigma_y"}},
      {"statev = 1", "statev = 1\ninitial_statev = [0.0, 1.0]", {":7:", "2 initial_statev for"}},
      {"statev = 1", "statev = 1\nvoid_ratio_statev = 2", {":7:", "one of the 1 state variables"}},
      {"statev = 1", "statev = 1\ntime_limit = 0", {":7:", "time_limit", "s"}},
      {"statev = 1", "statev = 1\ncontent = \"0123\"", {":7:", "not the library", "0123"}},
      {"props = [1e7, 0.25, 2e4, 1e6]\n", "E = 1e7\nnu = 0.25\nH = 1e5\n", {"sigma_y", "PROPS(3)"}},
      {"p = 100e3", "p = 100e3\ne = 0.7", {"void_ratio_statev", "e"}},
      {"p = 100e3", "p = 100e3\nocr = 2.0", {"ocr"}},
      {"[initial]", "[integration]\nmethod = \"cvode\"\n\n[initial]", {"method", "implicit"}},
  };
  for (const Mistake& mistake : mistakes) {
    const std::string file = write("test.toml", with(point_test, mistake.from, mistake.to));
    const Said said = repose("check " + file);
    EXPECT_EQ(said.code, 2) << mistake.to << "\n" << said.text;
    for (const std::string& word : mistake.words)
      EXPECT_NE(said.text.find(word), std::string::npos)
          << "\"" << word << "\" is missing for " << mistake.to << "\n"
          << said.text;
  }
  EXPECT_EQ(repose("check " + write("test.toml", point_test)).code, 0);
}

TEST_F(UmatCommand, ModelsListsIt) {
  EXPECT_NE(repose("models").text.find("umat"), std::string::npos);
  const Said said = repose("models umat");
  EXPECT_EQ(said.code, 0);
  for (const char* key : {"library", "props", "names", "statev", "void_ratio_statev", "rho_0"})
    EXPECT_NE(said.text.find(key), std::string::npos) << key;
  EXPECT_EQ(io::Json::parse(repose("models umat --json").text).at(0).at("name"), "umat");
}

TEST_F(UmatCommand, ResolvedInputGivesTheSameBits) {
  const std::string file = write("test.toml", point_test);
  ASSERT_EQ(repose("point " + file + " --no-plot -o " + folder("a")).code, 0);
  ASSERT_EQ(repose("point " + folder("a") + "/input.toml --no-plot -o " + folder("b")).code, 0);
  EXPECT_EQ(content_of(scratch.path() / "a/curve.csv"), content_of(scratch.path() / "b/curve.csv"));
  EXPECT_FALSE(content_of(scratch.path() / "a/curve.csv").empty());
  EXPECT_EQ(summary("a").at("tangents_checked"), summary("a").at("steps"));
  // one step of a hundred straddles yield: that is told, and no reason for a warning
  EXPECT_LE(summary("a").at("tangents_off").get<int>(), 1);
  EXPECT_TRUE(summary("a").at("warnings").empty());
  // a key of a name beats its place in the list
  ASSERT_EQ(repose("point " + file + " --set law.E=2e7 --no-plot -o " + folder("c")).code, 0);
  EXPECT_NE(content_of(scratch.path() / "a/curve.csv"), content_of(scratch.path() / "c/curve.csv"));
  EXPECT_NEAR(summary("c").at("input").at("law").at("E").get<double>(), 2e7, 0.0);
}

TEST_F(UmatCommand, RebuiltLibraryIsAnotherLaw) {
  std::filesystem::copy(VON_MISES, scratch.path() / "mine.so");
  const std::string file = write("test.toml", with(point_test, "libvon_mises.so", "mine.so"));
  ASSERT_EQ(repose("point " + file + " --no-plot -o " + folder("a")).code, 0);
  std::ofstream(scratch.path() / "mine.so", std::ios::app) << "one more byte";
  EXPECT_EQ(repose("point " + file + " --no-plot -o " + folder("b")).code, 0);
  const Said said = repose("point " + folder("a") + "/input.toml --no-plot -o " + folder("c"));
  EXPECT_EQ(said.code, 2);
  EXPECT_NE(said.text.find("is not the library that this input was made with"), std::string::npos)
      << said.text;
}

TEST_F(UmatCommand, FailureInAPointTestKeepsItsRows) {
  const std::string file = write("test.toml", with(with(point_test, "libvon_mises.so", MISBEHAVING),
                                                   "[1e7, 0.25, 2e4, 1e6]", "[7.0, 55.0, 0, 0]"));
  const Said said = repose("point " + file + " --no-plot -o " + folder("a"));
  EXPECT_EQ(said.code, 3) << said.text;
  EXPECT_NE(said.text.find("it crashed (SIGSEGV"), std::string::npos) << said.text;
  EXPECT_EQ(summary("a").at("status"), "failed");
  // the start, five rows of ten steps, the last good state
  EXPECT_EQ(summary("a").at("rows"), 7);
}

const std::string scene = R"([scene]
end_time = 0.02
gravity = 9.8

[domain]
size = [0.4, 0.2]
floor = "no_slip"
walls = "slip"

[[body]]
shape = "box"
origin = [0.0, 0.0]
size = [0.1, 0.1]
initial = { lithostatic = true, K0 = 0.5 }

[body.law]
name = "umat"
library = "libvon_mises.so"
props = [1e6, 0.3, 1e3, 0.0]
statev = 1
rho_0 = 1500.0

[grid]
h = 0.0125

[output]
series_interval = 0.005
)";

TEST_F(UmatCommand, SceneDoesNotDependOnThreads) {
  const std::string file = write("scene.toml", scene);
  for (const std::string threads : {"1", "2"}) {
    const Said said =
        repose("run " + file + " --no-plot --threads " + threads + " -o " + folder(threads));
    ASSERT_EQ(said.code, 0) << said.text;
  }
  const std::string series = content_of(scratch.path() / "1/series.csv");
  EXPECT_FALSE(series.empty());
  EXPECT_EQ(series, content_of(scratch.path() / "2/series.csv"));
  // SSE and SPD are the library's own, by the trapezoidal rule that the ledger uses: what is left
  // is the rotation between steps and the change of volume within one, of the order of a strain of
  // 1e-2
  EXPECT_LT(std::abs(summary("1").at("energy_error").get<double>()), 1e-2);
}

// Ctrl-C is the run's business and not its library's: it leaves a checkpoint and goes on from
// there.
TEST_F(UmatCommand, InterruptedSceneGoesOnToTheSameBits) {
  const std::string file = write("scene.toml", with(scene, "end_time = 0.02", "end_time = 1.5"));
  ASSERT_EQ(repose("run " + file + " --no-plot -o " + folder("whole")).code, 0);
  const Said cut = repose("run " + file + " --no-plot -o " + folder("cut"),
                          "timeout --preserve-status -s INT 0.4 ");
  ASSERT_EQ(cut.code, 130) << "it was to take longer than 0.4 s\n" << cut.text;
  const std::string series = content_of(scratch.path() / "whole/series.csv");
  EXPECT_NE(content_of(scratch.path() / "cut/series.csv"), series);
  const Said rest = repose("run " + file + " --no-plot --resume -o " + folder("cut"));
  ASSERT_EQ(rest.code, 0) << rest.text;
  EXPECT_EQ(content_of(scratch.path() / "cut/series.csv"), series);
}

TEST_F(UmatCommand, SceneNeedsADensityAndNoPressureAveraging) {
  const Said density = repose("check " + write("scene.toml", with(scene, "rho_0 = 1500.0\n", "")));
  EXPECT_EQ(density.code, 2);
  EXPECT_NE(density.text.find("rho_0"), std::string::npos) << density.text;
  const Said averaging =
      repose("check " + write("scene.toml", scene + "\n[step]\npressure_averaging = 1.0\n"));
  EXPECT_EQ(averaging.code, 2);
  EXPECT_NE(averaging.text.find("pressure_averaging"), std::string::npos) << averaging.text;
}

// A library that fails in step 40: exit code 3, the reason, and the state is kept.
TEST_F(UmatCommand, FramesHoldItsState) {
  const Said said = repose("run " + write("scene.toml", scene) +
                           " --no-plot --set output.frame_interval=0.01 -o " + folder("framed"));
  ASSERT_EQ(said.code, 0) << said.text;
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "framed/frames/scene_00002.hdf"));
}

TEST_F(UmatCommand, FailureInARunKeepsItsState) {
  for (const auto& [deed, words] :
       std::vector<std::pair<std::string, std::string>>{{"7.0", "it crashed (SIGSEGV"},
                                                        {"5.0", "ended its process"},
                                                        {"1.0", "it returned STRESS(2) = nan"},
                                                        {"3.0", "a call took more than 0.3 s"}}) {
    const std::string file =
        write("scene.toml",
              with(with(scene, "libvon_mises.so", MISBEHAVING), "[1e6, 0.3, 1e3, 0.0]\nstatev = 1",
                   "[" + deed + ", 40.0]\nstatev = 1\ntime_limit = 0.3"));
    const Said said = repose("run " + file + " --no-plot -o " + folder("run" + deed));
    EXPECT_EQ(said.code, 3) << said.text;
    EXPECT_NE(said.text.find(words), std::string::npos) << said.text;
    EXPECT_NE(said.text.find("step 40"), std::string::npos) << said.text;
    EXPECT_NE(said.text.find("libmisbehaving.so"), std::string::npos) << said.text;
    EXPECT_EQ(said.text.find("courant"), std::string::npos) << "no smaller step helps\n"
                                                            << said.text;
    EXPECT_EQ(summary("run" + deed).at("status"), "failed");
    EXPECT_FALSE(content_of(scratch.path() / ("run" + deed) / "series.csv").empty());
    EXPECT_TRUE(std::filesystem::exists(scratch.path() / ("run" + deed) / "checkpoint.h5"));
  }
}

/// The CPU time in seconds of each process whose command line holds a text (/proc/PID/stat,
/// proc(5)).
std::vector<double> processes_with(const std::string& text) {
  std::vector<double> times;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ifstream line_file(entry.path() / "cmdline", std::ios::binary);
    const std::string line{std::istreambuf_iterator<char>(line_file), {}};
    if (line.find(text) == std::string::npos) continue;
    std::ifstream stat_file(entry.path() / "stat");
    std::string stat{std::istreambuf_iterator<char>(stat_file), {}};
    // the name of the program, in brackets, may hold blanks; utime is the 12th word after it
    std::istringstream words(stat.substr(std::min(stat.size(), stat.rfind(')') + 1)));
    std::string word;
    for (int i = 0; i < 11; ++i) words >> word;
    double user = 0.0;
    double system = 0.0;
    words >> user >> system;
    times.push_back((user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK)));
  }
  return times;
}

TEST_F(UmatCommand, AKilledReposeLeavesNoProcessBehind) {
  const std::string library = folder("libendless.so");
  std::filesystem::copy_file(MISBEHAVING, library);
  const std::string file =
      write("endless.toml", with(with(with(point_test, "libvon_mises.so", library),
                                      "[1e7, 0.25, 2e4, 1e6]", "[3.0, 5.0]"),
                                 "names = [\"E\", \"nu\", \"sigma_y\", \"H\"]\n", ""));
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, 1);
    ::dup2(nowhere, 2);
    ::execl(REPOSE_COMMAND, REPOSE_COMMAND, "point", file.c_str(), "--no-plot", "-o",
            folder("endless").c_str(), nullptr);
    ::_exit(127);
  }
  const auto comes = [&](const auto& sight) {  // within a minute, on a machine however busy
    for (int i = 0; i < 6000; ++i, ::usleep(10'000))
      if (sight(processes_with(library))) return true;
    return false;
  };
  // A run starts its library more than once, and only one of these processes stays. It is in its
  // loop when it has computed for longer than anything else it does: 0.2 s, of the 10 s it is
  // given.
  EXPECT_TRUE(comes([](const std::vector<double>& cpu_s) {
    return std::any_of(cpu_s.begin(), cpu_s.end(), [](double s) { return s > 0.2; });
  })) << "the library never ran";
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(comes([](const std::vector<double>& cpu_s) { return cpu_s.empty(); }))
      << "its process lives on";
}

const std::string fit = R"([law]
name = "umat"
library = "libvon_mises.so"
props = [5e6, 0.25, 1e4, 1e6]
names = ["E", "nu", "sigma_y", "H"]
statev = 1

[fit]
E = { lower = 1e6, upper = 1e8, scale = "log" }
sigma_y = { lower = 1e3, upper = 1e5, scale = "log" }

[[target]]
data = "a/curve.csv"
x = "eps_a"
y = ["q_Pa"]
noise = { q_Pa = 100.0 }
test = { kind = "triaxial", drainage = "drained" }
initial = { p = 100e3 }

[solver]
global = "none"
local = "levenberg_marquardt"
starts = 2
)";

TEST_F(UmatCommand, FitFindsWhatMadeTheData) {
  ASSERT_EQ(repose("point " + write("test.toml", point_test) + " --no-plot -o " + folder("a")).code,
            0);
  const std::string file = write("fit.toml", fit);
  const Said said = repose("fit " + file + " --no-plot -o " + folder("fit"));
  ASSERT_EQ(said.code, 0) << said.text;
  const std::string fitted = content_of(scratch.path() / "fit/fitted.toml");
  const Said again = repose("point " + folder("a") + "/input.toml --set law=" + folder("fit") +
                            "/fitted.toml --no-plot -o " + folder("b"));
  ASSERT_EQ(again.code, 0) << again.text << fitted;
  const io::Json law = summary("b").at("input").at("law");
  // exact data of 100 Pa stated noise: the search ends where the objective is flat to a millionth,
  // 0.1 Pa of a q of 4e4 Pa, to which both parameters are proportional within a factor of ten
  EXPECT_NEAR(law.at("E").get<double>(), 1e7, 1e-4 * 1e7) << fitted;
  EXPECT_NEAR(law.at("sigma_y").get<double>(), 2e4, 1e-4 * 2e4) << fitted;
  const Said typo = repose("check " + write("fit.toml", with(fit, "sigma_y = {", "sigma_z = {")));
  EXPECT_EQ(typo.code, 2);
  EXPECT_NE(typo.text.find("no parameter 'sigma_z'; did you mean 'sigma_y'?"), std::string::npos)
      << typo.text;
}

}  // namespace
}  // namespace repose

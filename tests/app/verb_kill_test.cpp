// Every verb that writes a result, killed at any moment (SIGKILL, and now and then SIGINT) and
// resumed until it is done: the same figures as one that was left alone, bit for bit, no temporary
// left, and nobody else in its folder. REPOSE_KILLS: how many kills of each verb.
#include <cstdio>
#include <fstream>

#include <sys/resource.h>

#include "io/json.hpp"
#include "tests/app/killing.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

constexpr const char* scene = R"([scene]
name = "killed"
end_time = 0.3
[domain]
size = [1.0, 0.5]
[[body]]
size = [0.2, 0.2]
initial = { lithostatic = true }
[body.law]
name = "mu_i"
mu_0 = 0.38
mu_d = 0.57
I_0 = 0.279
d = 0.0053
rho_p = 2000.0
rho_0 = 1300.0
K = 254800.0
[grid]
h = 0.025
[output]
series_interval = 0.02
frame_interval = 0.1
checkpoint_interval = 0.02
)";

constexpr const char* test = R"([law]
name = "modified_cam_clay"
compression = "v-ln_p"
M = 0.888
lambda = 0.161
kappa = 0.062
nu = 0.3
Gamma = 2.759
rho_p = 2650.0
[initial]
p = 20e3
ocr = 2.0
[test]
kind = "triaxial"
drainage = "undrained"
axial_strain = 0.2
points = 200
)";

constexpr const char* fit = R"([law]
name = "modified_cam_clay"
compression = "v-ln_p"
kappa = 0.062
nu = 0.3
Gamma = 2.759
rho_p = 2650.0
[fit]
M = { lower = 0.5, upper = 1.5 }
lambda = { lower = 0.1, upper = 0.3 }
[[target]]
data = "t.csv"
x = "eps_a"
y = "q_Pa"
initial = { p = 20e3, ocr = 1.0 }
test = { kind = "triaxial", drainage = "undrained", axial_strain = 0.06 }
noise = { q_Pa = 20.0 }
[solver]
starts = 40
[uncertainty]
profile = false
)";

struct VerbCase {
  std::string name;
  std::vector<std::string> arguments;  ///< -o and --resume aside
};

void PrintTo(const VerbCase& verb, std::ostream* out) { *out << verb.name; }

const std::vector<VerbCase>& verbs() {
  static const std::vector<VerbCase> list{
      {"run_sweep",
       {"run", "scene.toml", "--set", "sweep.grid={\"body[0].law.K\" = [1e5, 2e5, 3e5, 4e5]}",
        "--threads", "1"}},
      {"point_sweep",
       {"point", "test.toml", "--set", "integration.tolerance=1e-12", "--set",
        "sweep.table=\"ocr.csv\"", "--threads", "1"}},
      {"scene_sensitivity",
       {"sensitivity", "scene.toml", "--set",
        "sensitivity={method=\"morris\", samples=2, output=\"front_99_m\", "
        "input=[{key=\"body[0].law.K\", lower=1e5, upper=4e5}]}",
        "--threads", "1"}},
      {"test_sensitivity",
       {"sensitivity", "test.toml", "--set", "integration.tolerance=1e-12", "--set",
        "sensitivity={samples=600, output=\"S_u_Pa\", "
        "input=[{key=\"initial.ocr\", lower=1.0, upper=3.0}]}",
        "--threads", "1"}},
      {"fit", {"fit", "fit.toml", "--threads", "1"}},
      {"chart_mpm",
       {"chart", "mpm", "scene.toml", "--transfers", "apic,flip", "--cells", "0.05,0.025",
        "--courants", "0.8,0.4", "--threads", "1"}},
      {"chart_fit", {"chart", "fit", "fit.toml", "--evaluations", "40"}},
      {"stability", {"stability", "--parts", "clay,mpm", "--quick"}}};
  return list;
}

/// Names of figures that a clock decides, or what was left to do when a kill had come: of any file,
/// and of a chart of optimisers, whose time_s is one of clocks and not of a simulation.
bool is_of_the_clock(std::string_view name, bool of_optimisers) {
  for (const std::string_view word :
       {"wall_s", "cpu_s", "seconds", "peak_memory_MB", "per_s", "sessions", "runs_kept",
        "driving_s", "checksum", "trace", "counts", "time_to_", "threads"})
    if (name.find(word) != name.npos) return true;
  return of_optimisers && name == "time_s";
}

/// A JSON value without what a clock or a kill decides.
void settle(io::Json& json) {
  if (json.is_object()) {
    std::vector<std::string> names;
    for (const auto& [name, value] : json.items()) names.push_back(name);
    for (const std::string& name : names)
      if (is_of_the_clock(name, false))
        json.erase(name);
      else
        settle(json[name]);
  } else if (json.is_array()) {
    for (std::size_t i = 0; i < json.size(); ++i) settle(json[i]);
  }
}

/// A table without the columns that a clock decides.
std::string without_clock(const std::string& csv) {
  const bool of_optimisers = csv.starts_with("algorithm,");
  std::istringstream lines(csv);
  std::string text;
  std::vector<bool> kept;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::size_t column = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++column) {
      if (text.find('\n') == text.npos) kept.push_back(!is_of_the_clock(cell, of_optimisers));
      if (column < kept.size() && kept[column]) text += cell + ",";
    }
    text += "\n";
  }
  return text;
}

/// What a result says, clocks aside. manifest.json has checksums of files with clocks in them.
std::map<std::string, std::string> figures_of(const fs::path& folder) {
  std::map<std::string, std::string> figures;
  for (auto& [name, bytes] : files_of(folder)) {
    if (name.ends_with("manifest.json")) continue;
    if (name.ends_with(".json") || name.ends_with(".jsonl")) {
      std::istringstream in(bytes);
      std::string text;
      if (name.ends_with(".jsonl")) {
        for (std::string line; std::getline(in, line);) {
          io::Json json = io::Json::parse(line);
          settle(json);
          text += json.dump() + "\n";
        }
      } else if (const auto parsed = io::Json::try_parse(bytes)) {
        io::Json json = *parsed;
        settle(json);
        text = json.dump();
      }
      figures[name] = text;
    } else if (name.ends_with(".csv")) {
      figures[name] = without_clock(bytes);
    } else {
      figures[name] = bytes;
    }
  }
  return figures;
}

void expect_same(const std::map<std::string, std::string>& result,
                 const std::map<std::string, std::string>& wanted, const std::string& name) {
  for (const auto& [file, text] : wanted) {
    const auto found = result.find(file);
    ASSERT_TRUE(found != result.end()) << name << " lacks " << file;
    EXPECT_TRUE(found->second == text) << file << " of " << name << " differs";
  }
  for (const auto& [file, text] : result)
    EXPECT_TRUE(wanted.contains(file)) << name << " has " << file << " as well";
}

class VerbTest : public testing::TestWithParam<VerbCase> {
 protected:
  VerbTest() {
    put("scene.toml", scene);
    put("test.toml", test);
    put("fit.toml", fit);
    put("t.csv", "eps_a,q_Pa\n0.005,6.5e3\n0.01,8e3\n0.02,9.6e3\n0.03,10.3e3\n0.05,10.9e3\n");
    std::string runs = "initial.ocr\n";
    for (int k = 0; k < 120; ++k) runs += std::to_string(1.0 + 0.01 * k) + "\n";
    put("ocr.csv", runs);
  }
  void put(const char* name, const std::string& text) const {
    std::ofstream(folder() / name) << text;
  }
  const fs::path& folder() const { return scratch_.path(); }
  std::vector<std::string> command(const std::string& out, bool resume) const {
    std::vector<std::string> all = GetParam().arguments;
    all.insert(all.end(), {"--quiet", "--no-plot", "-o", out});
    if (resume) all.emplace_back("--resume");
    return all;
  }
  int run(const std::string& out, bool resume = false) const {
    return ended(start(folder(), command(out, resume), true));
  }

 private:
  ScratchFolder scratch_;
};

TEST_P(VerbTest, KilledAtAnyMomentAndResumedGivesTheSameFigures) {
  const auto begun = std::chrono::steady_clock::now();
  ASSERT_EQ(run("straight"), 0);
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - begun;
  const auto straight = figures_of(folder() / "straight");
  EXPECT_TRUE(straight.contains("summary.json"));
  const int kills = kills_wanted(2);
  std::mt19937 random(20261129);
  std::uniform_real_distribution<double> part(0.0, 0.7);
  int killed = 0, interrupted = 0, runs = 0;
  while (killed < kills) {
    const std::string out = "run" + std::to_string(runs++);
    for (int attempt = 0; attempt < 200; ++attempt) {
      const pid_t child = start(folder(), command(out, fs::exists(folder() / out)), true);
      std::this_thread::sleep_for(std::chrono::duration<double>(part(random) * whole.count()));
      const bool interrupts = random() % 4 == 0;
      ::kill(child, interrupts ? SIGINT : SIGKILL);
      const int status = ended(child);
      if (status == 0) break;
      ASSERT_TRUE(status == -SIGKILL || status == 130 || status == -SIGINT) << status;
      ++(status == -SIGKILL ? killed : interrupted);
      if (attempt > 5) {  // what is not kept between sessions must come to its end alone
        ASSERT_EQ(run(out, true), 0);
        break;
      }
    }
    for (const auto& [file, bytes] : files_of(folder() / out)) {
      EXPECT_EQ(file.find(".repose-part"), file.npos) << out << " has " << file;
      EXPECT_EQ(file.find(".repose-lock"), file.npos) << out << " has " << file;
    }
    expect_same(figures_of(folder() / out), straight, out);
    fs::remove_all(folder() / out);
  }
  std::printf("[ measured ] %s: %d kills, %d interruptions, %d results, all of the same bits\n",
              GetParam().name.c_str(), killed, interrupted, runs);
}

// A kill between the seal of a run and the end of its process leaves the checkpoints and the lock.
class RunsTest : public VerbTest {};  // of the verbs that keep the results of single runs

TEST_P(RunsTest, WhatAFinishedRunNoLongerNeedsGoes) {
  ASSERT_EQ(run("whole"), 0);
  const auto straight = figures_of(folder() / "whole");
  fs::remove(folder() / "whole/manifest.json");
  for (const auto& one : fs::directory_iterator(folder() / "whole/runs"))
    for (const char* name : {"checkpoint.h5", "checkpoint_previous.h5", ".repose-lock"})
      std::ofstream(one.path() / name) << "of a moment before the end";
  ASSERT_EQ(run("whole", true), 0);
  expect_same(figures_of(folder() / "whole"), straight, "whole");
}

TEST_P(VerbTest, ADamagedResultIsNotTakenForOne) {
  ASSERT_EQ(run("whole"), 0);
  const auto before = figures_of(folder() / "whole");
  for (const auto& [name, text] : before) {
    if (!name.ends_with(".csv") && !name.ends_with(".json")) continue;
    if (name.find("runs/") != name.npos && name.find("0001") == name.npos) continue;
    const std::string bytes = content_of(folder() / "whole" / name);
    // another digit in the middle, and the end cut off
    std::string other = bytes;
    for (std::size_t i = other.size() / 2; i < other.size(); ++i)
      if (other[i] >= '1' && other[i] <= '8') {
        ++other[i];
        break;
      }
    for (const std::string& damaged : {other, bytes.substr(0, bytes.size() / 2)}) {
      std::ofstream(folder() / "whole" / name, std::ios::binary) << damaged;
      EXPECT_EQ(run("whole", true), 0) << name;
      EXPECT_TRUE(figures_of(folder() / "whole") == before) << name << " was taken as it was";
      if (::testing::Test::HasFailure()) return;
    }
    break;  // one file of each result; ResultFolderTest has the others
  }
}

TEST_P(VerbTest, TwoIntoOneFolderAreRefused) {
  // what is over before it can be stopped is begun again
  for (int attempt = 0; attempt < 10; ++attempt) {
    const std::string out = "shared" + std::to_string(attempt);
    const fs::path lock = folder() / out / ".repose-lock";
    const pid_t first = start(folder(), command(out, false));
    for (int k = 0; k < 20000 && content_of(lock).empty(); ++k)
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    ::kill(first, SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const bool held = fs::exists(lock);
    if (held) {
      EXPECT_EQ(run(out), 4);
      EXPECT_EQ(run(out, true), 4);
    }
    ::kill(first, SIGCONT);
    EXPECT_EQ(ended(first), 0);
    if (held) return;
  }
  ADD_FAILURE() << "it was over before anybody could look";
}

/// No file may grow beyond some bytes, as on a disk that is full: an error that names the file and
/// exit code 4, though nobody can read it where the log is on the same disk; with room again,
/// --resume comes to the same figures.
TEST_P(VerbTest, AFullDiskIsSaidAndLosesNothing) {
  ASSERT_EQ(run("straight"), 0);
  const auto straight = figures_of(folder() / "straight");
  for (const rlim_t room : {rlim_t{100}, rlim_t{2000}}) {
    const std::string out = "full" + std::to_string(room);
    const pid_t child = ::fork();
    if (child == 0) {
      const rlimit limit{room, room};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      ::signal(SIGXFSZ, SIG_IGN);  // write() then fails with EFBIG
      if (room == 100 && std::freopen("/dev/full", "w", stderr) == nullptr) ::_exit(1);
      const pid_t inner = start(folder(), command(out, false));
      ::_exit(ended(inner) & 0xff);
    }
    EXPECT_EQ(ended(child), 4) << room;
    EXPECT_EQ(run(out, fs::exists(folder() / out / "input.toml")), 0) << room;
    expect_same(figures_of(folder() / out), straight, out);
  }
}

/// Where nothing can be created: an error and exit code 4, whoever runs the tests (to root every
/// folder is open, but not /proc).
TEST_P(VerbTest, AFolderThatTakesNothingIsSaid) {
  EXPECT_EQ(run("/proc/repose"), 4);
  fs::create_directory(folder() / "closed");
  fs::permissions(folder() / "closed", fs::perms::owner_read | fs::perms::owner_exec);
  if (::geteuid() != 0) {
    EXPECT_EQ(run("closed/out"), 4);
  }
  fs::permissions(folder() / "closed", fs::perms::owner_all);
  std::ofstream(folder() / "file") << "not a folder";
  EXPECT_EQ(run("file"), 4);
  EXPECT_EQ(content_of(folder() / "file"), "not a folder");
}

INSTANTIATE_TEST_SUITE_P(Every, VerbTest, testing::ValuesIn(verbs()),
                         [](const auto& one) { return one.param.name; });
INSTANTIATE_TEST_SUITE_P(Sweeping, RunsTest, testing::Values(verbs()[0], verbs()[5]),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace repose

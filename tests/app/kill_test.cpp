// A run that is killed at any moment (SIGKILL, as a power cut or a scheduler does it) and resumed,
// several times over, leaves the same bytes as one that was left alone. REPOSE_KILLS: how many.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/scratch_folder.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

/// Clay with rows and frames, of the grid as well: everything that is carried over.
const std::string scene = R"([scene]
name = "killed"
end_time = 0.8
gravity = 9.8
[domain]
size = [1.2, 0.6]
floor = "no_slip"
walls = "slip"
[[body]]
origin = [0.0, 0.0]
size = [0.2, 0.4]
initial = { p = 2.27, ocr = 1.0 }
[body.law]
name = "modified_cam_clay"
compression = "ln_v-ln_p"
M = 0.6614
lambda = 0.0186
kappa = 0.0010
nu = 0.3
Gamma = 1.5432098765
p_ref = 1.0
rho_p = 2000.0
[grid]
h = 0.025
[output]
series_interval = 0.01
frame_interval = 0.1
grid_frames = true
checkpoint_interval = 0.02
)";

pid_t start(const fs::path& folder, const std::string& out, bool resume) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  if (::chdir(folder.c_str()) != 0) ::_exit(100);
  const char* const resumed = resume ? "--resume" : nullptr;
  ::execl(REPOSE_COMMAND, "repose", "run", "scene.toml", "--quiet", "--no-plot", "--threads", "1",
          "-o", out.c_str(), resumed, nullptr);
  ::_exit(101);
}

int ended(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// Every file of a result that a run decides, by name.
std::map<std::string, std::string> result_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().filename() != "summary.json" &&
        entry.path().filename() != "manifest.json")  // the clock is in both
      files[fs::relative(entry.path(), folder).string()] = content_of(entry.path());
  return files;
}

/// The same files of the same bytes; those of frames are not for a message.
void expect_same(const std::map<std::string, std::string>& result,
                 const std::map<std::string, std::string>& wanted, const std::string& name) {
  for (const auto& [file, bytes] : wanted) {
    const auto found = result.find(file);
    ASSERT_TRUE(found != result.end()) << name << " lacks " << file;
    EXPECT_TRUE(found->second == bytes) << file << " of " << name << " differs";
  }
  for (const auto& [file, bytes] : result)
    EXPECT_TRUE(wanted.contains(file)) << name << " has " << file << " as well";
}

TEST(Killed, AtAnyMomentAndResumedGivesTheSameBytes) {
  const ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  std::ofstream(folder / "scene.toml") << scene;
  const auto begun = std::chrono::steady_clock::now();
  ASSERT_EQ(ended(start(folder, "straight", false)), 0);
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - begun;
  const auto straight = result_of(folder / "straight");
  EXPECT_TRUE(straight.contains("series.csv"));
  EXPECT_TRUE(straight.contains("frames/killed_00008.hdf"));
  EXPECT_TRUE(straight.contains("frames/killed_grid_00008.hdf"));
  EXPECT_TRUE(straight.contains("frames/killed_grid.hdf.series"));

  const char* const asked = std::getenv("REPOSE_KILLS");
  const int kills = asked != nullptr ? std::atoi(asked) : 12;
  std::mt19937 random(20261129);
  std::uniform_real_distribution<double> part(0.0, 0.4);
  int killed = 0, runs = 0, resumed = 0;
  while (killed < kills) {
    const std::string out = "run" + std::to_string(runs++);
    bool resume = false;
    for (;;) {
      const pid_t child = start(folder, out, resume);
      const auto time = std::chrono::duration<double>(part(random) * whole.count());
      std::this_thread::sleep_for(time);
      // now and then an interruption instead, which has its own way to end
      const bool interrupts = random() % 4 == 0;
      ::kill(child, interrupts ? SIGINT : SIGKILL);
      const int status = ended(child);
      if (status == 0) break;
      ASSERT_TRUE(status == -SIGKILL || status == 130 || status == -SIGINT) << status;
      if (status == -SIGKILL) ++killed;
      // killed before it had a folder: begun again; otherwise resumed, whatever there is
      resume = fs::exists(folder / out / "input.toml");
      if (resume) ++resumed;
    }
    expect_same(result_of(folder / out), straight, out);
  }
  std::printf("[ measured ] %d kills, %d resumptions, %d runs\n", killed, resumed, runs);
}

TEST(Killed, ADamagedCheckpointGivesWayToTheOneBeforeIt) {
  const ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  std::ofstream(folder / "scene.toml") << scene;
  ASSERT_EQ(ended(start(folder, "straight", false)), 0);
  // two interruptions leave two checkpoints; each comes once there are (more) rows
  const auto size = [&] { return content_of(folder / "damaged/series.csv").size(); };
  for (const bool resume : {false, true}) {
    const std::size_t before = std::max<std::size_t>(size(), 2000);
    const pid_t child = start(folder, "damaged", resume);
    for (int k = 0; k < 4000 && size() <= before; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(child, SIGINT);
    ASSERT_EQ(ended(child), 130);
  }
  ASSERT_TRUE(fs::exists(folder / "damaged/checkpoint_previous.h5"));
  const fs::path last = folder / "damaged/checkpoint.h5";
  std::string bytes = content_of(last);
  bytes.resize(bytes.size() / 2);
  fs::remove(last);  // (the two may still be one file under two names)
  std::ofstream(last, std::ios::binary) << bytes;
  ASSERT_EQ(ended(start(folder, "damaged", true)), 0);
  expect_same(result_of(folder / "damaged"), result_of(folder / "straight"), "damaged");
}

// Killed after its last file and before it has given the folder back, a run leaves its lock.
TEST(Killed, WhatIsLeftOfTheLockGoes) {
  const ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  std::ofstream(folder / "scene.toml") << scene;
  ASSERT_EQ(ended(start(folder, "run", false)), 0);
  const auto done = result_of(folder / "run");
  std::ofstream(folder / "run/.repose-lock") << "1\n";
  ASSERT_EQ(ended(start(folder, "run", true)), 0);
  expect_same(result_of(folder / "run"), done, "run");
}

TEST(Killed, TwoRunsIntoOneFolderAreRefused) {
  const ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  std::ofstream(folder / "scene.toml") << scene;
  const pid_t first = start(folder, "shared", false);
  for (int k = 0; k < 2000 && !fs::exists(folder / "shared/series.csv"); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(first, SIGSTOP);  // so that it cannot be done before the other has looked
  EXPECT_EQ(ended(start(folder, "shared", false)), 4);
  ::kill(first, SIGCONT);
  EXPECT_EQ(ended(first), 0);
}

}  // namespace
}  // namespace repose

// The command hands over to the program compiled for another instruction set, where one is
// installed beside it: scripts that say who they are stand for those here.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "models/instruction_set.hpp"
#include "tests/scratch_folder.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

class OtherSets : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(base_ / "bin");
    fs::copy_file(REPOSE_COMMAND, base_ / "bin" / "repose");
  }
  void install(const std::string& level) const {
    const fs::path program = base_ / "lib" / "repose" / level / "repose";
    fs::create_directories(program.parent_path());
    std::ofstream(program) << "#!/bin/sh\necho " << level << " \"$@\"\n";
    fs::permissions(program, fs::perms::owner_all);
  }
  /// Exit code and everything that was said.
  std::pair<int, std::string> run(const std::string& arguments) const {
    const fs::path said = base_ / "said";
    const int status = std::system(
        ((base_ / "bin" / "repose").string() + " " + arguments + " >" + said.string() + " 2>&1")
            .c_str());
    return {WEXITSTATUS(status), content_of(said)};
  }
  const ScratchFolder scratch_;
  const fs::path base_ = scratch_.path();
  const bool wide_ = instruction_set() == "avx512";  // the program under test
};

TEST_F(OtherSets, OneAloneIsTheOneThatRuns) {
  EXPECT_EQ(run("--version").second.substr(0, 7), "repose ");
  const std::string own(instruction_set());
  EXPECT_EQ(run("--instruction-set " + own + " --version").second.substr(0, 7), "repose ");
  EXPECT_EQ(run("--instruction-set=" + own + " --version").second.substr(0, 7), "repose ");
  const std::string other = wide_ ? "avx2" : "avx512";
  const auto [exit, said] = run("--instruction-set " + other + " --version");
  EXPECT_EQ(exit, 2);
  EXPECT_EQ(said, "repose: --instruction-set " + other + ": this installation and machine have " +
                      own + "\n");
}

TEST_F(OtherSets, TheOneAskedForTakesOverWithTheArguments) {
  install("x86-64-v3");
  install("x86-64-v4");
#if !defined(__x86_64__)  // there is one set only, whatever lies beside the program
  EXPECT_EQ(run("--instruction-set avx2 --version").first, 2);
  EXPECT_EQ(run("--version").second.substr(0, 7), "repose ");
#else
  if (wide_) {
    EXPECT_EQ(run("--instruction-set avx2 run a.toml").second, "x86-64-v3 run a.toml\n");
    EXPECT_EQ(run("--version").second.substr(0, 7), "repose ");  // it is the fastest itself
  } else if (__builtin_cpu_supports("avx512vl")) {
    EXPECT_EQ(run("--instruction-set avx512 run a.toml").second, "x86-64-v4 run a.toml\n");
    EXPECT_EQ(run("run a.toml").second, "x86-64-v4 run a.toml\n");
    EXPECT_EQ(run("--instruction-set avx2 --version").second.substr(0, 7), "repose ");
  } else {
    EXPECT_EQ(run("--instruction-set avx512 --version").first, 2);
    EXPECT_EQ(run("--version").second.substr(0, 7), "repose ");
  }
#endif
}

TEST_F(OtherSets, ATypoIsToldWithWhatThereIs) {
  const auto [exit, said] = run("--instruction-set avx run a.toml");
  EXPECT_EQ(exit, 2);
  EXPECT_NE(said.find("--instruction-set avx: this installation and machine have "),
            std::string::npos);
}

TEST_F(OtherSets, ItStandsInTheHelp) {
  EXPECT_NE(run("--help").second.find("--instruction-set SET"), std::string::npos);
}

}  // namespace
}  // namespace repose

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "repose_version.hpp"
#include "tests/scratch_folder.hpp"

// The printed version starts with the release's number and, inside a checkout, names the revision.
TEST(Version, string_holds_release_and_revision) {
  const std::string release = repose::version;
  const std::string revision = repose::revision;
  const std::string expected = revision.empty() ? release : release + " (" + revision + ")";
  EXPECT_EQ(repose::version_string, expected);
}

TEST(Version, release_is_three_numbers) {
  int dots = 0;
  for (const char c : std::string(repose::version)) {
    EXPECT_TRUE(c == '.' || (c >= '0' && c <= '9')) << repose::version;
    dots += c == '.';
  }
  EXPECT_EQ(dots, 2) << repose::version;
}

namespace {

namespace fs = std::filesystem;

/// A source tree with one file of each kind.
class SolverDigest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* file :
         {"models/law.hpp", "models/law.cpp", "mpm/step/step.cpp", "mpm/grid/grid.hpp",
          "study/run/run_scene.cpp", "study/run/run_record.cpp", "app/figure.cpp",
          "cmake/Dependencies.cmake", "cmake/Flags.cmake", "README.md"})
      write(file, file);
  }
  void write(const fs::path& file, const std::string& text) {
    fs::create_directories((source_ / file).parent_path());
    std::ofstream(source_ / file) << text;
  }
  /// As the build would note it.
  std::string digest(const std::string& compiled = "g++ 12 -O3", const std::string& of = "solver") {
    const std::string line = std::string("'" REPOSE_CMAKE "' -DSOURCE_DIR='") + source_.string() +
                             "' -DVERSION=0.2.0 -DCOMPILED='" + compiled + "' -DOUTPUT='" +
                             output_.string() +
                             "' -P '" REPOSE_SOURCE_DIR "/cmake/WriteVersion.cmake'";
    EXPECT_EQ(std::system(line.c_str()), 0) << line;
    const std::string text = repose::content_of(output_), mark = of + "_digest = \"";
    const std::size_t from = text.find(mark);
    return from == text.npos ? "" : text.substr(from + mark.size(), 16);
  }

  const repose::ScratchFolder scratch_;
  const fs::path source_ = scratch_.path() / "source", output_ = scratch_.path() / "version.hpp";
};

}  // namespace

// What any result depends on: whatever computes or reads, and no picture.
TEST_F(SolverDigest, OfTheProgramChangesWithEverythingThatComputes) {
  std::string last = digest("g++ 12 -O3", "program");
  EXPECT_EQ(last.size(), 16u);
  write("app/figure.cpp", "another picture");
  EXPECT_EQ(digest("g++ 12 -O3", "program"), last);
  for (const char* file : {"models/law.cpp", "io/raw_table.cpp", "pointdriver/path/path.cpp",
                           "calibration/fit.cpp", "input/read_fit.cpp", "study/fit/search.cpp"}) {
    write(file, "changed");
    const std::string next = digest("g++ 12 -O3", "program");
    EXPECT_NE(next, last) << file;
    last = next;
  }
}

// Finished runs are kept as long as nothing that their bits depend on has changed, and no longer.
TEST_F(SolverDigest, ChangesWithWhatARunsResultDependsOn) {
  const std::string first = digest();
  EXPECT_EQ(first.size(), 16u);
  EXPECT_EQ(digest(), first);
  write("app/figure.cpp", "another picture");
  write("README.md", "another word");
  EXPECT_EQ(digest(), first);
  EXPECT_NE(digest("g++ 13 -O3"), first);
  std::string last = first;
  for (const char* file :
       {"models/law.hpp", "models/law.cpp", "mpm/step/step.cpp", "mpm/grid/grid.hpp",
        "study/run/run_scene.cpp", "study/run/run_record.cpp", "cmake/Dependencies.cmake",
        "cmake/Flags.cmake"}) {
    write(file, "changed");
    const std::string next = digest();
    EXPECT_NE(next, last) << file;
    last = next;
  }
  fs::remove(source_ / "mpm/grid/grid.hpp");
  EXPECT_NE(digest(), last);
}

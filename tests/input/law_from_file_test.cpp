// law = "fitted.toml": a law that stands in another file, as a fit leaves it; inputs known by name.

#include <gtest/gtest.h>

#include "input/read_point_test.hpp"
#include "input/read_scene.hpp"
#include "input/shipped_input.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::input {
namespace {

namespace fs = std::filesystem;

/// A shipped test in two: its [law] table, and what follows.
const std::string whole =
    content_of(REPOSE_SOURCE_DIR "/data/experiments/london_clay_drained.toml");
const std::size_t cut = whole.find("[initial]");
const std::string law = whole.substr(whole.find("[law]"), cut - whole.find("[law]"));
const std::string rest = "\n" + whole.substr(cut);

class LawFromFile : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_ / "fit"); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  /// Of the point test in a file.
  static std::string problems(const std::string& file, std::vector<std::string> sets = {}) {
    try {
      InputFile input = InputFile::read(file, sets);
      read_point_test(input);
    } catch (const BadInput& error) {
      return error.what();
    }
    return "";
  }
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

TEST_F(LawFromFile, IsTheLawThatStandsThere) {
  write("fit/fitted.toml", "# by a fit\n" + law);
  InputFile input = InputFile::read(write("t.toml", "law = \"fit/fitted.toml\"\n" + rest));
  const LawSpec spec = read_point_test(input).law;
  EXPECT_EQ(spec.name, "modified_cam_clay");
  EXPECT_EQ(spec.values.at("M"), 0.888);
  EXPECT_TRUE(input.root()["law"].is_table()) << "the resolved input needs no other file";
}

TEST_F(LawFromFile, IsChangedBySet) {
  write("fit/fitted.toml", law);
  const std::string file = write("t.toml", "law = \"fit/fitted.toml\"\n" + rest);
  const std::vector<std::string> sets{"law.M=1.1"};
  InputFile input = InputFile::read(file, sets);
  EXPECT_EQ(read_point_test(input).law.values.at("M"), 1.1);
  // and taken in place of the file's own; from where the command runs
  const std::string own = write("own.toml", law + rest);
  std::string other = law;
  other.replace(other.find("0.888"), 5, "1.250");
  const std::vector<std::string> instead{"law=" + write("other.toml", other)};
  InputFile changed = InputFile::read(own, instead);
  EXPECT_EQ(read_point_test(changed).law.values.at("M"), 1.25);
}

TEST_F(LawFromFile, ItsMistakesAreSaidToBeThere) {
  std::string wrong = law;
  wrong.replace(wrong.find("kappa = 0.062"), 13, "kapa = 0.062");
  const std::string fitted = write("fit/fitted.toml", wrong);
  const std::string file = write("t.toml", "law = \"fit/fitted.toml\"\n" + rest);
  EXPECT_NE(problems(file).find(fitted + ":6:1: "), std::string::npos) << problems(file);
  EXPECT_NE(problems(file).find("did you mean 'kappa'"), std::string::npos) << problems(file);
}

TEST_F(LawFromFile, AFileThatIsNoneOrHasNoneIsSaid) {
  const std::string file = write("t.toml", "law = \"fit/fittd.toml\"\n" + rest);
  write("fit/fitted.toml", rest);
  EXPECT_TRUE(problems(file).starts_with(file + ":1:1: ")) << problems(file);
  EXPECT_NE(problems(file).find("there is no such file; did you mean"), std::string::npos)
      << problems(file);
  EXPECT_NE(
      problems(file, {"law=" + (folder_ / "fit/fitted.toml").string()}).find("no [law] table"),
      std::string::npos);
  write("fit/fittd.toml", "law = [");
  EXPECT_NE(problems(file).find("fittd.toml:1:8: "), std::string::npos) << problems(file);
}

TEST_F(LawFromFile, ABodyOfASceneTakesOneToo) {
  write("grains.toml",
        "[law]\nname = \"newtonian\"\neta = 0.5\nK = 2e5\nalpha = 7.0\nrho_0 = 1500.0\n");
  std::string text = content_of(REPOSE_SOURCE_DIR "/data/scenes/flat_newtonian.toml");
  const std::size_t table = text.find("[body.law]"), next = text.find("\n[", table);
  ASSERT_NE(table, text.npos);
  text.erase(table, next - table);
  text.insert(text.find("[[body]]") + 8, "\nlaw = \"grains.toml\"");
  InputFile input = InputFile::read(write("s.toml", text));
  EXPECT_EQ(read_scene(input).scene.bodies.front().law.values.at("rho_0"), 1500.0);
}

TEST(ShippedInput, EveryPointTestIsKnownByNameAndSound) {
  ASSERT_GE(shipped_tests().size(), 15u);
  for (const std::string_view name : shipped_tests()) {
    InputFile input = open_test(std::string(name));
    EXPECT_EQ(read_point_test(input).name, name);
    EXPECT_EQ(open_input(std::string(name)).name(), input.name());
  }
}

TEST(ShippedInput, AMisspeltNameGetsTheNearest) {
  const auto complaint = [](auto&& open, const std::string& name) -> std::string {
    try {
      open(name, std::span<const std::string>());
    } catch (const BadInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(
      complaint(open_test, "weald_clay_undraind").find("did you mean 'weald_clay_undrained'?"),
      std::string::npos);
  EXPECT_NE(complaint(open_input, "flat_mcq").find("did you mean 'flat_mcc'?"), std::string::npos);
  EXPECT_NE(complaint(open_scene, "weald_clay_undrained").find("there is no scene"),
            std::string::npos);
}

}  // namespace
}  // namespace repose::input

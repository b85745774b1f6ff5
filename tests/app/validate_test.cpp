// `repose validate`: cases whose figures are known, what they leave, and every mistake in a case.
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/command_line.hpp"
#include "input/read_benchmark.hpp"
#include "input/shipped_input.hpp"
#include "io/json.hpp"
#include "tests/app/csv_table.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;

const std::string absent = R"(
[absent]
mu_i = "not here"
mu_i_mn = "not here"
mcc = "not here"
mcc_mn = "not here"
cs = "not here"
cs_mn = "not here"
neo_hookean = "not here"
)";

const std::string fluid = R"(
[[law]]
column = "newtonian"
name = "newtonian"
eta = 2.0
K = 1e5
rho_0 = 1000.0
parameters = "made up"
)";

const std::string point_case = R"([case]
title = "A fluid in shear"
source = "itself"
about = "tau = eta times rate"
test = "test.toml"
)" + fluid + absent + R"(
[[figure]]
name = "tau"
title = "shear stress"
unit = "Pa"
value = "tau_Pa"
minus = 1.0
over = 2.0
measured = 2.5
band = [2.4, 2.6]
band_from = "made up"

[[figure]]
name = "curve"
title = "distance"
unit = "Pa"
curve = "point"
x = "gamma"
y = "tau_Pa"
table = "table.csv"
measure = "rms"
band = [0.0, 1.0]
band_from = "made up"
)";

// At a rate of 3/s τ is 6 Pa; the table is 3 and 4 off in two rows of three.
const std::string test = R"([test]
kind = "simple_shear"
drainage = "constant_volume"
shear_strain = 0.5
rate = 3.0
points = 10
[initial]
density = 1000.0
[integration]
method = "implicit"
)";
const std::string table = "gamma,tau_Pa\n0.12,3\n0.2,10\n0.4,6\n";

const std::string scene_case = R"([case]
title = "A block"
source = "itself"
about = "It hardly moves in a millisecond."
scene = "scene.toml"
cells = [0.2, 0.1, 0.05]
)" + fluid + absent + R"(
[[figure]]
name = "mass"
title = "mass over 10 kg"
unit = "-"
value = "mass_kg_per_m"
over = 10.0
measured = 8.0
band = [7.0, 9.0]
band_from = "made up"

[[figure]]
name = "rest"
title = "line of rest"
unit = "m"
curve = "rest_line"
x = "x_m"
y = "depth_m"
threshold = 0.01
table = "line.csv"
measure = "max"
band = [0.0, 0.05]
band_from = "made up"
)";
const std::string scene = R"([scene]
end_time = 0.001
[domain]
size = [0.8, 0.8]
[[body]]
size = [0.4, 0.2]
[grid]
h = 0.1
[output]
frame_interval = 0.0001
)";

class Validate : public testing::Test {
 protected:
  Validate() {
    write("point/case.toml", point_case);
    write("point/test.toml", test);
    write("point/table.csv", table);
    write("block/case.toml", scene_case);
    write("block/scene.toml", scene);
    write("block/line.csv", "x_m,depth_m\n0.1,0.2\n0.3,0.2\n");
  }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  int run(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"repose", "validate", "-o", (folder_ / "out").string(),
                                   "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    return run_command_line(static_cast<int>(argv.size()), argv.data());
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// The row of a figure and a column.
  std::map<std::string, std::string> row(const std::string& of_case, const std::string& figure,
                                         const std::string& column = "newtonian") const {
    for (const auto& one : table_of(folder_ / "out" / of_case / "result.csv"))
      if (one.at("figure") == figure && one.at("column") == column) return one;
    ADD_FAILURE() << "no row of " << figure << " and " << column;
    return {};
  }
  /// Everything that is wrong with a case in which `right` is replaced by `wrong`.
  std::string problems(const std::string& of_case, const std::string& right,
                       const std::string& wrong) const {
    const fs::path file = folder_ / of_case / "case.toml";
    std::string text = content_of(file);
    const std::size_t at = text.find(right);
    EXPECT_NE(at, std::string::npos) << right;
    text.replace(at, right.size(), wrong);
    write(of_case + "/wrong.toml", text);
    try {
      input::InputFile input = input::InputFile::read(folder_ / of_case / "wrong.toml");
      input::read_benchmark(input);
    } catch (const input::BadInput& error) {
      std::string what = error.what();
      const std::string prefix = (folder_ / of_case).string() + "/";
      for (std::size_t k = what.find(prefix); k != std::string::npos; k = what.find(prefix))
        what.erase(k, prefix.size());
      return what;
    }
    return "";
  }
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

TEST_F(Validate, APointTestHasItsNumbersAndDistances) {
  ASSERT_EQ(run({path("point")}), 0);
  auto tau = row("point", "tau"), curve = row("point", "curve");
  EXPECT_NEAR(std::stod(tau["value"]), (6.0 - 1.0) / 2.0, 1e-12);
  EXPECT_NEAR(std::stod(tau["error_bar"]), 0.0, 1e-12);
  EXPECT_EQ(tau["verdict"], "inside");
  EXPECT_EQ(tau["measured"], "2.5");
  EXPECT_NEAR(std::stod(curve["value"]), std::sqrt(25.0 / 3.0), 1e-9);
  EXPECT_EQ(curve["verdict"], "outside");
  EXPECT_EQ(curve["measured"], "");
  EXPECT_EQ(row("point", "tau", "mcc")["verdict"], "absent");
  EXPECT_EQ(row("point", "tau", "mcc")["reason"], "not here");
  EXPECT_TRUE(fs::exists(folder_ / "out/point/runs/newtonian_test/curve.csv"));
  EXPECT_NE(content_of(folder_ / "out/point/result.svg").find("</svg>"), std::string::npos);
}

TEST_F(Validate, ASceneIsRunWithEverySize) {
  ASSERT_EQ(run({path("block"), "--no-plot"}), 0);
  auto mass = row("block", "mass"), rest = row("block", "rest");
  EXPECT_NEAR(std::stod(mass["value"]), 0.4 * 0.2 * 1000.0 / 10.0, 1e-9);
  EXPECT_NEAR(std::stod(mass["error_bar"]), 0.0, 1e-9);
  EXPECT_EQ(mass["verdict"], "inside");
  // the highest points lie h/4 below the surface, 5e-6 m deeper after a millisecond's fall at most:
  // order 1, which is extrapolated to 0 with 2 · ½ · h_f/4 for a bar
  for (const auto& [name, h] :
       {std::pair{"value_h_0.2_m", 0.2}, {"value_h_0.1_m", 0.1}, {"value_h_0.05_m", 0.05}})
    EXPECT_NEAR(std::stod(rest[name]), 0.25 * h, 1e-5) << name;
  EXPECT_NEAR(std::stod(rest["value"]), 0.0, 1e-4);
  EXPECT_NEAR(std::stod(rest["error_bar"]), 0.0125, 1e-4);
  EXPECT_EQ(rest["verdict"], "inside");
  EXPECT_FALSE(fs::exists(folder_ / "out/block/result.svg"));
}

TEST_F(Validate, WhatHasRunIsNotRunAgain) {
  ASSERT_EQ(run({path("block"), "--no-plot"}), 0);
  const fs::path summary = folder_ / "out/block/runs/newtonian_h0.1/summary.json";
  const auto written = fs::last_write_time(summary);
  const std::string before = content_of(folder_ / "out/block/result.csv");
  ASSERT_EQ(run({path("block"), "--no-plot"}), 0);
  EXPECT_EQ(fs::last_write_time(summary), written);
  EXPECT_EQ(content_of(folder_ / "out/block/result.csv"), before);
  // with another input it is
  ASSERT_EQ(run({path("block"), "--no-plot", "--set", "scene.end_time=0.002"}), 0);
  EXPECT_NE(fs::last_write_time(summary), written);
}

TEST_F(Validate, CoarseRunsOneSizeAndSaysSo) {
  ASSERT_EQ(run({path("block"), path("point"), "--no-plot", "--coarse"}), 0);
  EXPECT_EQ(row("block", "mass")["reason"], "coarsest cells alone: no error bar");
  EXPECT_EQ(row("block", "mass")["error_bar"], "");
  EXPECT_EQ(row("block", "mass")["value_h_0.05_m"], "");
  EXPECT_EQ(row("point", "tau")["reason"], "not refined: no error bar");
  EXPECT_FALSE(fs::exists(folder_ / "out/block/runs/newtonian_h0.1"));
}

TEST_F(Validate, OneColumnIsEnough) {
  ASSERT_EQ(run({path("point"), "--no-plot", "--law", "mcc"}), 0);
  EXPECT_EQ(row("point", "tau")["verdict"], "not run");
  EXPECT_EQ(run({path("point"), "--law", "mc"}), 2);
}

TEST_F(Validate, ThePageHasNoBlankCell) {
  ASSERT_EQ(run({path("point"), path("block"), "--no-plot"}), 0);
  const std::string page = content_of(folder_ / "out/validation.md");
  EXPECT_NE(page.find("| point | absent | absent | absent | absent | absent | absent | 1 of 2 "
                      "inside | absent |"),
            std::string::npos)
      << page;
  EXPECT_NE(page.find("| block |"), std::string::npos);
  EXPECT_EQ(page.find("|  |"), std::string::npos);
  EXPECT_NE(page.find("tau = eta times rate"), std::string::npos);
  const auto summary = io::Json::parse(content_of(folder_ / "out/summary.json"));
  EXPECT_EQ(summary["status"].get<std::string>(), "done");
  EXPECT_EQ(summary["cases"][0]["inside"].get<int>(), 1);
  EXPECT_EQ(summary["cases"][0]["laws"]["newtonian"]["curve"]["verdict"].get<std::string>(),
            "outside");
}

TEST_F(Validate, AFigureWithoutAValueIsTold) {
  std::string text = point_case;
  text.replace(text.find("\"tau_Pa\""), 8, "\"tau_Pb\"");
  write("point/case.toml", text);
  ASSERT_EQ(run({path("point"), "--no-plot"}), 3);
  EXPECT_EQ(row("point", "tau")["verdict"], "failed");
  EXPECT_NE(row("point", "tau")["reason"].find("did you mean 'tau_Pa'?"), std::string::npos);
  EXPECT_EQ(row("point", "curve")["verdict"], "outside");
  EXPECT_TRUE(fs::exists(folder_ / "out/validation.md"));
}

TEST_F(Validate, ATestThatCannotGoOnIsTold) {
  std::string text = point_case;
  const auto replace = [&](const std::string& right, const std::string& wrong) {
    text.replace(text.find(right), right.size(), wrong);
  };
  replace(fluid, R"(
[[law]]
column = "mcc"
name = "modified_cam_clay"
compression = "ln_v-ln_p"
M = 0.9
lambda = 0.16
kappa = 0.06
nu = 0.3
Gamma = 2.7
)");
  replace("mcc = \"not here\"", "newtonian = \"not here\"");
  write("point/case.toml", text);
  write("point/test.toml",
        "[test]\nkind = \"triaxial\"\ndrainage = \"drained\"\ncontrol = \"stress\"\n"
        "q_end = 1e6\n[initial]\np = 1e5\nocr = 1.0\n");
  ASSERT_EQ(run({path("point"), "--no-plot"}), 3);
  for (const char* const figure : {"tau", "curve"}) {
    EXPECT_EQ(row("point", figure, "mcc")["verdict"], "failed");
    EXPECT_NE(row("point", figure, "mcc")["reason"].find("strength"), std::string::npos);
  }
}

TEST_F(Validate, ACaseIsNamedByItsFolderOrItsFile) {
  EXPECT_EQ(run({path("point/case.toml"), "--no-plot"}), 0);
  EXPECT_EQ(run({"no_such_case"}), 2);
  EXPECT_EQ(run({path("point"), path("point")}), 2);  // twice
  EXPECT_EQ(run({path("block/scene.toml")}), 2);      // of another kind
}

TEST_F(Validate, CheckReadsACase) {
  const std::string file = path("block/case.toml");
  const std::array<const char*, 4> words{"repose", "check", file.c_str(), "--quiet"};
  EXPECT_EQ(run_command_line(4, words.data()), 0);
  write("block/case.toml", scene_case + "typo = 1\n");
  EXPECT_EQ(run_command_line(4, words.data()), 2);
}

/// A mistake: the case, what is replaced by what, and the message.
struct Mistake {
  const char* name;
  const char* of_case;
  const char* right;
  const char* wrong;
  const char* message;
};

const std::vector<Mistake> mistakes{
    {"UnknownKey", "point", "minus = 1.0", "minsu = 1.0",
     "wrong.toml:29:1: unknown key 'minsu' in figure[0]; did you mean 'minus'?"},
    {"NoBand", "point", "band = [2.4, 2.6]\n", "",
     "wrong.toml:24:1: figure[0] needs band, [x, y] (lower and upper end"},
    {"BandUpsideDown", "point", "[2.4, 2.6]", "[2.6, 2.4]", "the lower end comes first"},
    {"NoMeasured", "point", "measured = 2.5\n", "", "needs measured"},
    {"LawKey", "point", "eta = 2.0", "etha = 2.0", "wrong.toml:10:1: newtonian has no parameter"},
    {"NoLaw", "point", "name = \"newtonian\"", "name = \"newtonain\"", "newtonian"},
    {"ColumnLeftOut", "point", "mcc_mn = \"not here\"\n", "",
     "wrong.toml:15:2: column mcc_mn is neither a [[law]] nor in [absent]"},
    {"ColumnTwice", "point", "[absent]\n", "[absent]\nnewtonian = \"yes\"\n",
     "newtonian is a [[law]] and absent as well"},
    {"UnknownAbsent", "point", "mcc_mn =", "mcc_nm =", "did you mean 'mcc_mn'?"},
    {"UnknownColumn", "point", "column = \"newtonian\"", "column = \"newton\"",
     "wrong.toml:8:1: law[0].column must be one of \"mu_i\""},
    {"NoTable", "point", "table.csv", "tabel.csv",
     "wrong.toml:42:1: there is no file tabel.csv; "
     "did you mean table.csv?"},
    {"NoTest", "point", "test = \"test.toml\"", "test = \"tets.toml\"",
     "wrong.toml:5:1: there is no file tets.toml; did you mean test.toml?"},
    {"SceneAndTest", "point", "test = \"test.toml\"",
     "test = \"test.toml\"\nscene = \"scene.toml\"\ncells = [0.1]", "either scene"},
    {"NoColumnInTable", "point", "y = \"tau_Pa\"", "y = \"q_Pa\"", "q_Pa"},
    {"UnknownCurveColumn", "point", "x = \"gamma\"", "x = \"gama\"", "did you mean 'gamma'?"},
    {"CurveOfAScene", "point", "curve = \"point\"", "curve = \"profile\"",
     "a point test has one curve"},
    {"CurveOfATest", "block", "curve = \"rest_line\"", "curve = \"point\"", "a scene has no curve"},
    {"NumberAndCurve", "point", "curve = \"point\"", "curve = \"point\"\nvalue = \"tau_Pa\"",
     "figure 'curve' needs either value"},
    {"FigureTwice", "point", "name = \"curve\"", "name = \"tau\"",
     "there are two figures called 'tau'"},
    {"NoThreshold", "block", "threshold = 0.01\n", "", "needs threshold"},
    {"NoCells", "block", "cells = [0.2, 0.1, 0.05]\n", "", "[case] needs cells"},
    {"NoCellInList", "block", "cells = [0.2, 0.1, 0.05]", "cells = []", "wrong.toml:6:1"},
    {"CellsUpsideDown", "block", "[0.2, 0.1, 0.05]", "[0.05, 0.1, 0.2]", "from coarse to fine"},
    {"CellsOfATest", "point", "test = \"test.toml\"", "test = \"test.toml\"\ncells = [0.1]",
     "a point test has none"},
    {"SceneWithThatCell", "block", "[0.2, 0.1, 0.05]", "[0.3, 0.1]",
     "newtonian with cells of 0.3 m"},
    {"SetUnknownKey", "block",
     "parameters = ", "set = [\"scene.endtime=1\"]\nparameters = ", "did you mean 'end_time'?"},
    {"Measure", "point", "measure = \"rms\"", "measure = \"rsm\"",
     "wrong.toml:43:1: figure[1].measure must be one of \"rms\", \"max\""},
    {"OverAnotherWord", "point", "over = 2.0", "over = \"begin\"", "must be \"start\""},
    {"OverNothing", "point", "over = 2.0", "over = 0.0", "it must not be 0"},
    {"DepthOfNoFront", "point", "minus = 1.0", "depth_m = 1.0",
     "only value = \"front_at_m\" has a depth_m"},
};

TEST_F(Validate, EveryMistakeHasItsPlaceAndItsCure) {
  for (const Mistake& mistake : mistakes) {
    const std::string said = problems(mistake.of_case, mistake.right, mistake.wrong);
    EXPECT_NE(said.find(mistake.message), std::string::npos) << mistake.name << ": " << said;
    EXPECT_EQ(said.substr(0, 11), "wrong.toml:") << mistake.name << ": " << said;
  }
}

TEST_F(Validate, TheCasesAreRight) {
  EXPECT_EQ(problems("point", "made up", "made up"), "");
  EXPECT_EQ(problems("block", "made up", "made up"), "");
}

/// What is shipped can be run, and the program holds it.
TEST(ShippedCases, AreSound) {
  const fs::path folder = fs::path(REPOSE_SOURCE_DIR) / "data/benchmarks";
  std::size_t count = 0;
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (!entry.is_directory()) continue;
      ++count;
      try {
        input::InputFile file = input::InputFile::read(entry.path() / "case.toml");
        input::read_benchmark(file);
      } catch (const input::BadInput& error) {
        ADD_FAILURE() << error.what();
      }
    }
  EXPECT_EQ(input::shipped_benchmarks().size(), count);
}

}  // namespace
}  // namespace repose::app

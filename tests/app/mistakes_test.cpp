// Sixty and more mistakes that people make, and what the program says: what is wrong, where it
// stands, and how to mend it. One that says less is a failure of this test.
#include <array>
#include <cstdio>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "tests/scratch_folder.hpp"

namespace repose {
namespace {

const std::string clay = R"([law]
name = "modified_cam_clay"
compression = "v-ln_p"
M = 0.95
lambda = 0.093
kappa = 0.035
nu = 0.3
Gamma = 2.060

[initial]
p = 207e3
ocr = 1.0

[test]
kind = "triaxial"
drainage = "undrained"
axial_strain = 0.20
)";

const std::string column = R"([scene]
end_time = 0.1
gravity = 9.8

[domain]
size = [1.2, 0.5]
floor = "no_slip"
walls = "slip"

[[body]]
shape = "box"
origin = [0.0, 0.0]
size = [0.2, 0.4]

[body.law]
name = "mu_i"
mu_0 = 0.38
mu_d = 0.57
I_0 = 0.28
d = 0.0053
rho_p = 2000.0
rho_0 = 1300.0
K = 26e3

[grid]
h = 0.05
)";

const std::string fit = R"([law]
name = "modified_cam_clay"
compression = "v-ln_p"
p_ref = 1000.0

[fit]
M = { lower = 0.5, upper = 1.5 }
lambda = { lower = 0.03, upper = 0.3, scale = "log" }
kappa = { of = "lambda", lower = 0.05, upper = 0.8 }
nu = { lower = 0.0, upper = 0.45, prior = { mean = 0.3, sd = 0.05 } }
Gamma = { lower = 1.5, upper = 3.0 }

[[target]]
name = "T1"
data = "sheet.csv"
where = { LabID = "T1" }
columns = { eps_a = "Axial strain", q = "Deviator stress" }
x = "eps_a"
y = "q_Pa"
initial = { p = 207e3, ocr = 1.0 }
test = { kind = "triaxial", drainage = "undrained" }
)";

const std::string sheet =
    "LabID;Axial strain [%];Deviator stress [kPa]\nT1;0,00;0,0\nT1;0,51;57,9\nT1;0,99;87,2\n"
    "T1;1,99;115,3\nT1;5,02;127,0\n";

/// A mistake: the command, the file that it is made in with what is replaced by what, and parts of
/// the message.
struct Mistake {
  const char* name;
  const char* command;
  const char* file;  ///< "": the command line itself is wrong
  const char* right;
  const char* wrong;
  const char* where;
  const char* what;
  const char* cure;
};

constexpr const char* point = "point clay.toml";
constexpr const char* run = "run column.toml";
constexpr const char* fits = "fit fit.toml";
constexpr const char* c = "clay.toml";
constexpr const char* s = "column.toml";
constexpr const char* f = "fit.toml";
constexpr const char* t = "sheet.csv";

const std::vector<Mistake> mistakes{
    // the command line
    {"NoSuchFile", "point claay.toml", "", "", "", "claay.toml", "no such file",
     "did you mean clay.toml?"},
    {"Folder", "run .", "", "", "", ".:", "is a folder", "give the .toml file in it"},
    {"Verb", "pint clay.toml", "", "", "", "'pint'", "there is no verb", "did you mean 'point'?"},
    {"Option", "point clay.toml --outptu x", "", "", "", "'--outptu'", "was not expected",
     "did you mean '--output'?"},
    {"NoFile", "point", "", "", "", "repose", "TEST.toml is required",
     "`repose point --help` shows how it goes"},
    {"SceneForPoint", "point column.toml", "", "", "", "column.toml:1:2", "this is a scene",
     "takes a point test ([test])"},
    {"TestForRun", "run clay.toml", "", "", "", "clay.toml:14:2", "this is a point test",
     "takes a scene ([scene])"},
    {"ShippedName", "run flat_mui", "", "", "", "'flat_mui'", "there is no scene",
     "did you mean 'flat_mu_i'?"},
    {"SetWithoutValue", "point clay.toml --set initial.ocr", "", "", "", "--set initial.ocr",
     "needs the form", "key=value"},
    {"SetUnknownKey", "point clay.toml --set initial.orc=2", "", "", "", "--set initial.orc=2",
     "unknown key 'orc'", "did you mean 'ocr'?"},
    {"SetText", "point clay.toml --set law.M=big", "", "", "", "--set law.M=big", "got the string",
     "must be a number in (0, 3)"},
    {"SetNoSuchBody", "run column.toml --set body[1].law.K=1e5", "", "", "", "--set body[1]",
     "there is only", "body[0]"},
    {"AccuracyOfNothing", "run column.toml --accuracy 0.05", "", "", "", "--accuracy",
     "needs --for", "one of front, front_99"},
    {"AccuracyInPerCent", "run column.toml --accuracy 5 --for front_99", "", "", "", "--accuracy 5",
     "relative error", "a number in (0, 0.5]"},
    {"QuantityMisspelt", "run column.toml --accuracy 0.05 --for frnt_99", "", "", "",
     "--for frnt_99", "one of", "did you mean 'front_99'?"},
    {"ResumeOfNothing", "run column.toml --resume -o nothing_here", "", "", "", "nothing_here",
     "no such result to resume", "without --resume it is begun"},
    {"ResumeOfATest", "point clay.toml --resume", "", "", "", "--resume", "has none",
     "goes with a [sweep]"},
    // TOML
    {"OpenQuote", point, c, "\"triaxial\"", "\"triaxial", "clay.toml:15:", "parsing string",
     "begins with a quote ends with one"},
    {"DecimalComma", point, c, "M = 0.95", "M = 0,95", "clay.toml:4:", "saw ','",
     "a number has a point"},
    {"KeyTwice", point, c, "nu = 0.3\n", "nu = 0.3\nnu = 0.2\n", "clay.toml:8:", "'nu'",
     "the key stands twice; leave one out"},
    {"NoEqualsSign", point, c, "nu = 0.3", "nu 0.3", "clay.toml:7:", "expected '='",
     "a line is written as key = value"},
    {"UnitBehindANumber", point, c, "p = 207e3", "p = 207 kPa", "clay.toml:11:", "saw 'k'",
     "units are SI"},
    {"NumberAsText", point, c, "nu = 0.3", "nu = \"0.3\"", "clay.toml:7:1",
     "got the string \"0.3\"", "leave out the quotes"},
    {"TextWithoutQuotes", point, c, "kind = \"triaxial\"", "kind = triaxial",
     "clay.toml:15:", "saw", "texts stand in quotes"},
    // laws
    {"LawMisspelt", point, c, "modified_cam_clay", "modified_camclay", "clay.toml:2:1",
     "unknown law", "did you mean \"modified_cam_clay\"?"},
    {"ParameterMisspelt", point, c, "lambda =", "lamda =", "clay.toml:5:1", "no parameter 'lamda'",
     "did you mean 'lambda'?"},
    {"ParameterMissing", point, c, "nu = 0.3\n", "", "clay.toml:1:2", "needs nu (Poisson's ratio)",
     "a number [0, 0.5)"},
    {"KappaAboveLambda", point, c, "kappa = 0.035", "kappa = 0.35", "clay.toml:6:1", "kappa",
     "must be < lambda"},
    {"NuOfAHalf", point, c, "nu = 0.3", "nu = 0.5", "clay.toml:7:1", "law.nu = 0.5 is out of range",
     "in [0, 0.5)"},
    {"NegativeM", point, c, "M = 0.95", "M = -0.95", "clay.toml:4:1",
     "law.M = -0.95 is out of range", "in (0, 3)"},
    {"NoCompressionLines", point, c, "compression = \"v-ln_p\"\n", "", "clay.toml:1:2",
     "needs compression", "one of \"ln_v-ln_p\", \"v-ln_p\""},
    {"ParameterOfAnotherLaw", point, c, "nu = 0.3", "nu = 0.3\nmu_0 = 0.4", "clay.toml:8:1",
     "no parameter 'mu_0'", "it has: M, lambda"},
    {"NeitherGammaNorN", point, c, "Gamma = 2.060\n", "", "clay.toml:1:2",
     "initial specific volume", "needs Gamma (or N), v or density"},
    {"FrictionThatFalls", run, s, "mu_d = 0.57", "mu_d = 0.27", "column.toml:18:1", "mu_d",
     "must be >= mu_0"},
    {"NoSuchLawFile", point, c, "[law]", "law = \"clayy.toml\"\n[laws]", "clay.toml:1:1",
     "no such file", "did you mean clay.toml?"},
    // the start
    {"OcrBelowOne", point, c, "ocr = 1.0", "ocr = 0.5", "clay.toml:12:1",
     "initial.ocr = 0.5 is out of range", "in [1, 1e+06]"},
    {"NegativePressure", point, c, "p = 207e3", "p = -207e3", "clay.toml:11:1",
     "the initial p must be > p_sep", "compression is positive"},
    {"PressureTwice", point, c, "ocr = 1.0", "ocr = 1.0\nsigma_v = 2e5", "clay.toml:13:1",
     "either p or sigma_v", "p = sigma_v (1 + 2 K0)/3"},
    {"SigmaVAlone", point, c, "p = 207e3", "sigma_v = 207e3", "clay.toml:11:1", "sigma_v needs K0",
     "K0 = 1 for an isotropic state"},
    {"Contradiction", point, c, "ocr = 1.0", "ocr = 1.0\nv = 2.5", "clay.toml:13:1",
     "contradicts itself: v is 2.5", "leave out v, ocr or p"},
    {"NoStart", point, c, "p = 207e3\n", "", "clay.toml:10:2", "needs an initial",
     "p, sigma, v or density"},
    // tests
    {"PerCent", point, c, "axial_strain = 0.20", "axial_strain = 20.0", "clay.toml:17:1",
     "is 2000 %", "did you mean 0.2?"},
    {"NoEnd", point, c, "axial_strain = 0.20\n", "", "clay.toml:14:2",
     "says not where the stage ends", "axial_strain, shear_strain"},
    {"TwoEnds", point, c, "axial_strain = 0.20", "axial_strain = 0.20\nq_end = 1e5",
     "clay.toml:18:1", "a stage ends at one value",
     "test.axial_strain is given too; leave one out"},
    {"KindMisspelt", point, c, "\"triaxial\"", "\"triaxal\"", "clay.toml:15:1",
     "test.kind must be one of", "did you mean \"triaxial\"?"},
    {"DrainageOfAnotherKind", point, c, "\"undrained\"", "\"constant_volume\"", "clay.toml:16:1",
     "got the string \"constant_volume\"", "one of \"drained\", \"undrained\""},
    {"DrainageWithoutUse", point, c, "\"triaxial\"", "\"oedometer\"", "clay.toml:16:1", "drainage",
     "only triaxial and simple_shear tests have a drainage"},
    {"CyclesWithoutLimits", point, c, "axial_strain = 0.20", "cycles = 3", "clay.toml:17:1",
     "cycles need limits", "q_min and q_max"},
    {"LimitsTurnedRound", point, c, "axial_strain = 0.20", "cycles = 3\nq_min = 1e4\nq_max = -1e4",
     "clay.toml:18:1", "test.q_min", "must be < test.q_max"},
    {"NoRows", point, c, "axial_strain = 0.20", "axial_strain = 0.20\npoints = 0", "clay.toml:18:1",
     "got the integer 0", "an integer from 1 to 1000000"},
    {"HoldWithoutDuration", point, c, "axial_strain = 0.20", "hold = \"stress\"", "clay.toml:14:2",
     "needs duration", "a number > 0 s"},
    {"MethodMisspelt", point, c, "[initial]", "[integration]\nmethod = \"rk4\"\n[initial]",
     "clay.toml:11:1", "got the string \"rk4\"", "one of \"automatic\", \"adaptive\""},
    {"ToleranceOfZero", point, c, "[initial]", "[integration]\ntolerance = 0\n[initial]",
     "clay.toml:11:1", "tolerance = 0 is out of range", "in [1e-14, 0.1]"},
    {"BeyondStrength", point, c, "axial_strain = 0.20", "q_end = 500e3\ncontrol = \"stress\"",
     "stage 1 of 1", "the stress asked for lies beyond", "the strength q = 1.276e+05 Pa"},
    {"SweepWithoutList", point, c, "[initial]",
     "[sweep]\ngrid = { \"initial.ocr\" = 4.0 }\n[initial]", "clay.toml:11:1",
     "the number 4 was found", "needs a list of at least one value"},
    // scenes
    {"BodyOutside", run, s, "size = [0.2, 0.4]", "size = [0.2, 0.6]", "column.toml:13:1",
     "from y = 0 to 0.6 m", "outside the box [0, 0.5] m"},
    {"CellsThatDoNotFit", run, s, "h = 0.05", "h = 0.013", "column.toml:26:1",
     "does not divide the box's width", "h = 0.0125"},
    {"CellsOfZero", run, s, "h = 0.05", "h = 0.0", "column.toml:26:1",
     "grid.h = 0 m is out of range", "a number > 0 m"},
    {"CellsAsWideAsTheBox", run, s, "h = 0.05", "h = 1.2", "column.toml:26:1",
     "the box is 1 cells across", "h <= 0.4 m"},
    {"TooManyCells", "check column.toml", s, "h = 0.05", "h = 1e-7", "column.toml:26:1",
     "more than memory is likely to hold", "h >="},
    {"EdgeMisspelt", run, s, "walls = \"slip\"", "walls = \"slipp\"", "column.toml:8:1",
     "domain.walls must be one of", "did you mean \"slip\"?"},
    {"TransferMisspelt", run, s, "[grid]", "[step]\ntransfer = \"flipp\"\n[grid]",
     "column.toml:26:1", "step.transfer must be one of", "did you mean \"flip\"?"},
    {"CourantOfTen", run, s, "[grid]", "[step]\ncourant = 10.0\n[grid]", "column.toml:26:1",
     "step.courant = 10 is out of range", "in (0, 1.4]"},
    {"StepTwice", run, s, "[grid]", "[step]\ncourant = 0.5\ndt = 1e-4\n[grid]", "column.toml:27:1",
     "a fixed step leaves no choice", "give either step.courant or step.dt"},
    {"GravityAsAVector", run, s, "gravity = 9.8", "gravity = [0.0, -9.8]", "column.toml:3:1",
     "got a list of 2", "must be a number >= 0 m/s²"},
    {"NegativeTime", run, s, "end_time = 0.1", "end_time = -0.1", "column.toml:2:1",
     "scene.end_time = -0.1 s is out of range", "a number >= 0 s"},
    {"TwoBodiesInOnePlace", run, s, "[grid]",
     "[[body]]\norigin = [0.1, 0.1]\nsize = [0.2, 0.2]\nlaw = { name = \"newtonian\", eta = 1.0, K "
     "= 1e5, rho_0 = 1e3 }\n[grid]",
     "column.toml:2", "overlaps body[0]", "in x = [0.1, 0.2] m"},
    // fits and tables
    {"NoSuchTable", fits, f, "sheet.csv", "shet.csv", "fit.toml:15:1", "no such file",
     "did you mean sheet.csv?"},
    {"NoSuchColumn", fits, f, "\"Deviator stress\"", "\"Deviator strss\"", "sheet.csv:1",
     "there is no column \"Deviator strss\"", "did you mean \"Deviator stress\"?"},
    {"StressWithoutUnit", fits, t, "Deviator stress [kPa]", "Deviator stress",
     "sheet.csv:1: column 3", "names no unit, and q_Pa is a stress", "give the unit for q_Pa"},
    {"TextInAColumn", fits, t, "87,2", "n.d. 87", "sheet.csv:4: column 3",
     "\"n.d. 87\" is no number", "leave the cell empty"},
    {"ThousandsSeparator", fits, t, "115,3", "1.115,3", "sheet.csv:5: column 3",
     "thousands separator", "write the number without it"},
    {"RowTooLong", fits, t, "115,3", "115,3;7", "sheet.csv:5",
     "4 cells, and the header in row 1 names 3 columns", "name all columns"},
    {"EmptyTable", fits, t, "", "", "sheet.csv", "the file is empty",
     "give a table with a row of names"},
    {"NoRowPasses", fits, f, "\"T1\" }", "\"T9\" }", "fit.toml:15:1", "no row holds \"T9\"",
     "it holds \"T1\""},
    {"BoundsTurnedRound", fits, f, "lower = 0.5, upper = 1.5", "lower = 1.5, upper = 0.5",
     "fit.toml:7:", "fit.M.upper = 0.5", "must be > lower = 1.5"},
    {"FixedAndFree", fits, f, "p_ref = 1000.0", "p_ref = 1000.0\nM = 1.0", "fit.toml:8:1",
     "M is fixed in [law] and free in [fit]", "leave out one"},
    {"FreeParameterMisspelt", fits, f, "lambda = {", "lamda = {", "fit.toml:8:1",
     "no parameter 'lamda'", "did you mean 'lambda'?"},
    {"StartOutsideItsBounds", fits, f, "upper = 1.5 }", "upper = 1.5, start = 2.0 }",
     "fit.toml:7:", "fit.M.start = 2 lies outside its bounds", "0.5 to 1.5"},
    {"OptimiserMisspelt", fits, f, "[[target]]", "[solver]\nlocal = \"LD_SLSPQ\"\n[[target]]",
     "fit.toml:14:1", "is no algorithm", "did you mean \"LD_SLSQP\"?"},
    {"NoSuchQuantity", fits, f, "y = \"q_Pa\"", "y = \"w_Pa\"", "fit.toml:19:1",
     "a simulation has no column 'w_Pa'", "did you mean"},
    {"EndsBeforeTheData", fits, f, "\"undrained\" }", "\"undrained\", axial_strain = 0.03 }",
     "(line 6)", "is not on the way of the test", "leave the test's end out"},
    {"PriorWithoutAWidth", fits, f, "prior = { mean = 0.3, sd = 0.05 }", "prior = { mean = 0.3 }",
     "fit.toml:10:", "fit.nu.prior needs", "sd, in the unit of nu [-], or relative_sd"},
};

class MistakeOf : public testing::TestWithParam<Mistake> {};

TEST_P(MistakeOf, IsToldWithPlaceAndCure) {
  const Mistake& mistake = GetParam();
  const ScratchFolder scratch;
  for (const auto& [name, text] : {std::pair{c, clay}, {s, column}, {f, fit}, {t, sheet}}) {
    std::string changed = text;
    if (name == std::string(mistake.file)) {
      const std::string right = mistake.right;
      ASSERT_NE(text.find(right), std::string::npos) << "the mistake cannot be made";
      changed = right.empty() ? "" : changed.replace(text.find(right), right.size(), mistake.wrong);
    }
    std::ofstream(scratch.path() / name) << changed;
  }
  const std::string command = "cd '" + scratch.path().string() + "' && '" REPOSE_COMMAND "' " +
                              mistake.command + " 2>&1 >/dev/null";
  std::string told;
  FILE* const pipe = ::popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::array<char, 4096> part{};
  for (std::size_t n = 0; (n = std::fread(part.data(), 1, part.size(), pipe)) > 0;)
    told.append(part.data(), n);
  const int status = ::pclose(pipe);
  ASSERT_TRUE(WIFEXITED(status)) << told;
  const std::set<int> allowed{2, 3,
                              4};  // bad input, a path that breaks off, a file that is not there
  EXPECT_TRUE(allowed.contains(WEXITSTATUS(status))) << WEXITSTATUS(status) << "\n" << told;
  for (const char* const said : {mistake.where, mistake.what, mistake.cure})
    EXPECT_NE(told.find(said), std::string::npos) << "'" << said << "' is not in\n" << told;
  for (const char* const raw : {"internal error", "std::", "what():", "terminate called"})
    EXPECT_EQ(told.find(raw), std::string::npos) << told;
}

INSTANTIATE_TEST_SUITE_P(Table, MistakeOf, testing::ValuesIn(mistakes),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(Mistakes, AreSixtyAtLeast) {
  std::set<std::string> names;
  for (const Mistake& mistake : mistakes) names.insert(mistake.name);
  EXPECT_EQ(names.size(), mistakes.size());
  EXPECT_GE(mistakes.size(), 60U);
}

}  // namespace
}  // namespace repose

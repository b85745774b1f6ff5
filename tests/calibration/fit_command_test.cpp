// `repose fit` from file to result: messages, fitted.toml, shards, resumption.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "app/command_line.hpp"
#include "input/read_law.hpp"
#include "io/json.hpp"
#include "study/fit/fit_record.hpp"
#include "study/fit/twin.hpp"
#include "tests/calibration/clay_fit.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;

class FitCommand : public testing::Test {
 protected:
  void SetUp() override {
    write("cu.csv", undrained_table());
    write("fit.toml", fit_text());
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Undrained compression of London clay in kPa and per cent: units come from the names.
  static std::string undrained_table() {
    study::Twin twin = study::cam_clay_twin("ln_v-ln_p");
    const calibration::Target t = study::measure(twin, study::cam_clay_tests()[1]);
    std::string text = "# made by the law itself\neps_a_percent,q_kPa,u_kPa\n";
    for (Eigen::Index i = 0; i < t.x.size(); ++i)
      text += fmt::format("{},{},{}\n", 100.0 * t.x[i], 1e-3 * t.channels[0].observed[i],
                          1e-3 * t.channels[1].observed[i]);
    return text;
  }
  static std::string fit_text() { return clay_fit + std::string("[solver]\nstarts = 6\n"); }
  static std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const auto at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
  }

  int command(std::vector<std::string> words) const {
    words.insert(words.begin(), "repose");
    words.push_back("--quiet");
    std::vector<const char*> argv;
    for (const std::string& w : words) argv.push_back(w.c_str());
    return run_command_line(static_cast<int>(argv.size()), argv.data());
  }

  /// The complaint about a fit file.
  std::string complaint(const std::string& text) const {
    write("bad.toml", text);
    try {
      input::read_fit(path("bad.toml"), {}, 1);
    } catch (const input::BadInput& error) {
      const std::string all = error.what();
      const auto at = all.find("bad.toml:");
      return at == std::string::npos ? all : all.substr(at);
    }
    return "accepted";
  }

  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

TEST_F(FitCommand, FindsTheParametersAndWritesALawThatReadsBack) {
  ASSERT_EQ(command({"fit", path("fit.toml"), "-o", path("out")}), 0);
  const auto report = io::Json::parse(content_of(folder_ / "out/fit.json"));
  // kPa with all digits: the table is exact to round-off, the path to 1e-8 per step
  EXPECT_NEAR(report["parameters"]["M"]["value"].get<double>(), 0.888, 1e-6);
  EXPECT_NEAR(report["parameters"]["kappa"]["value"].get<double>(), 0.062, 1e-6);
  EXPECT_EQ(report["status"], "done");
  EXPECT_EQ(report["optima"].size(), 1u);
  EXPECT_TRUE(report["discrepancy"].empty());
  input::InputFile law = input::InputFile::read(folder_ / "out/fitted.toml");
  input::TomlReader root(law);
  const LawSpec spec = input::read_law(root.table("law"));
  law.throw_if_bad();
  EXPECT_EQ(spec.values.at("M"), report["parameters"]["M"]["value"].get<double>());
  EXPECT_EQ(spec.values.at("lambda"), 0.161);
  EXPECT_EQ(spec.values.at("shape"), 0.0);
}

TEST_F(FitCommand, ShardsMergeToTheSameResult) {
  ASSERT_EQ(command({"fit", path("fit.toml"), "-o", path("whole")}), 0);
  ASSERT_EQ(
      command({"fit", path("fit.toml"), "-o", path("a"), "--starts-from", "0", "--starts-to", "2"}),
      0);
  ASSERT_EQ(
      command({"fit", path("fit.toml"), "-o", path("b"), "--starts-from", "2", "--starts-to", "6"}),
      0);
  ASSERT_EQ(
      command({"fit", path("fit.toml"), "-o", path("merged"), "--merge", path("a"), path("b")}), 0);
  const auto whole = io::Json::parse(content_of(folder_ / "whole/fit.json"));
  const auto merged = io::Json::parse(content_of(folder_ / "merged/fit.json"));
  for (const char* key : {"parameters", "objective", "targets", "correlation", "optima",
                          "singular_values_of_scaled_jacobian", "fingerprint"})
    EXPECT_EQ(whole[key], merged[key]) << key;
}

TEST_F(FitCommand, ResumesAfterAKillInTheMiddleOfALine) {
  ASSERT_EQ(command({"fit", path("fit.toml"), "-o", path("whole")}), 0);
  // as a kill would leave it: two starts and a piece of the third
  std::istringstream in(content_of(folder_ / "whole/starts.jsonl"));
  std::string line, kept;
  for (int i = 0; i < 3 && std::getline(in, line); ++i) kept += line + "\n";
  std::getline(in, line);
  fs::create_directories(folder_ / "killed");
  write("killed/starts.jsonl", kept + line.substr(0, line.size() / 2));
  ASSERT_EQ(command({"fit", path("fit.toml"), "-o", path("killed"), "--resume"}), 0);
  const auto whole = io::Json::parse(content_of(folder_ / "whole/fit.json"));
  const auto again = io::Json::parse(content_of(folder_ / "killed/fit.json"));
  EXPECT_EQ(whole["parameters"], again["parameters"]);
  EXPECT_EQ(again["counts"]["starts"], 6);
  EXPECT_LT(again["counts"]["this_session"]["gradients"].get<long>(),
            whole["counts"]["this_session"]["gradients"].get<long>());
  // another fit's starts are refused, be it that one measured value has changed
  const std::string table = undrained_table();
  const std::size_t last = table.find_last_of("0123456789");
  write("cu.csv", table.substr(0, last) + (table[last] == '5' ? '6' : '5') + "\n");
  EXPECT_EQ(command({"fit", path("fit.toml"), "-o", path("killed"), "--resume"}), 2);
  write("cu.csv", table);
  EXPECT_EQ(command({"fit", path("fit.toml"), "-o", path("killed"), "--resume"}), 0);
  write("fit.toml", replaced(fit_text(), "upper = 1.8", "upper = 1.7"));
  EXPECT_EQ(command({"fit", path("fit.toml"), "-o", path("killed"), "--resume"}), 2);
}

TEST_F(FitCommand, TellsWhatIsWrongAndWhere) {
  const std::string good = fit_text();
  ASSERT_EQ(complaint(good), "accepted");
  EXPECT_EQ(complaint(replaced(good, "upper = 1.8", "upper = 0.3")),
            "bad.toml:8:20: fit.M.upper = 0.3 must be > lower = 0.4");
  EXPECT_EQ(complaint(replaced(good, "M = {", "MM = {")).find("bad.toml:"), 0u);
  EXPECT_EQ(complaint(replaced(good, "x = \"eps_a\"", "x = \"epsa\"")).find("bad.toml:12:1: "), 0u);
  EXPECT_NE(
      complaint(replaced(good, "x = \"eps_a\"", "x = \"epsa\"")).find("did you mean 'eps_a'?"),
      std::string::npos);
  EXPECT_NE(
      complaint(replaced(good, "\"u_Pa\"", "\"v\""))
          .find(
              "there is no column \"v\"; its columns are 1 (eps_a_percent), 2 (q_kPa), 3 (u_kPa)"),
      std::string::npos);
  EXPECT_NE(complaint(replaced(good, "starts = 6", "local = \"LD_SLSPQ\""))
                .find("did you mean \"LD_SLSQP\"?"),
            std::string::npos);
  EXPECT_NE(complaint(replaced(good, "starts = 6", "local = \"GN_ISRES\""))
                .find("solver.local: GN_ISRES is a global algorithm; it belongs to solver.global"),
            std::string::npos);
  EXPECT_NE(complaint(replaced(good, "nu = 0.3", "nu = 0.3\nM = 1.0"))
                .find("M is fixed in [law] and free in [fit]: leave out one"),
            std::string::npos);
  EXPECT_NE(complaint(replaced(good, "nu = 0.3", "nu = 0.3\nphi = 22.0"))
                .find("M is fixed in [law] and free in [fit]: leave out one"),
            std::string::npos);
  EXPECT_NE(complaint(replaced(good, "[fit]", "[fit]\nshape = { lower = 0.1, upper = 0.9 }"))
                .find("shape is a word, not a number: give it in [law]"),
            std::string::npos);
  EXPECT_NE(complaint(replaced(good, "axial_strain = 0.1", "axial_strain = 0.05"))
                .find("is not on the way of the test, which leads from 0 to 0.05"),
            std::string::npos);
}

/// The table with `plus` kPa on top of q in one of its rows.
std::string spoiled(const std::string& table, std::size_t row, double plus) {
  std::istringstream in(table);
  std::string line, text;
  for (std::size_t k = 0; std::getline(in, line); ++k) {
    const auto first = line.find(','), last = line.rfind(',');
    if (k == row + 2)  // below the comment and the header
      line = fmt::format("{},{}{}", line.substr(0, first), std::stod(line.substr(first + 1)) + plus,
                         line.substr(last));
    text += line + "\n";
  }
  return text;
}

TEST_F(FitCommand, RobustResidualsNameTheRowsThatAreWrongAndAreTheSameShared) {
  write("cu.csv", spoiled(spoiled(undrained_table(), 3, 60.0), 7, -80.0));
  for (const char* residuals : {"huber", "student"}) {
    write("fit.toml", fit_text() + fmt::format("residuals = \"{}\"\n[uncertainty]\nbootstrap = 4\n",
                                               residuals));
    ASSERT_EQ(command({"fit", path("fit.toml"), "-o", path("out")}), 0);
    const auto report = io::Json::parse(content_of(folder_ / "out/fit.json"));
    // the other rows are exact: their scale goes to nothing, and the outliers' pull with it
    EXPECT_NEAR(report["parameters"]["M"]["value"].get<double>(), 0.888, 1e-4) << residuals;
    EXPECT_NEAR(report["parameters"]["kappa"]["value"].get<double>(), 0.062, 1e-4) << residuals;
    ASSERT_EQ(report["outliers"].size(), 1u);
    EXPECT_EQ(report["outliers"][0]["channel"], "q_Pa");
    // row 3 stands in line 6
    EXPECT_EQ(report["outliers"][0]["lines"], (std::vector<int>{6, 10}));
    EXPECT_EQ(report["solver"]["residuals"], residuals);
    const std::string predictions = content_of(folder_ / "out/predictions.csv");
    EXPECT_EQ(predictions.find("target,held_out,x_name,channel,x,measured,fitted,weight\n"), 0u);
    ASSERT_EQ(command({"fit", path("fit.toml"), "-o", path("a"), "--starts-to", "2"}), 0);
    ASSERT_EQ(command({"fit", path("fit.toml"), "-o", path("b"), "--starts-from", "2"}), 0);
    ASSERT_EQ(
        command({"fit", path("fit.toml"), "-o", path("merged"), "--merge", path("a"), path("b")}),
        0);
    EXPECT_EQ(content_of(folder_ / "merged/fitted.toml"), content_of(folder_ / "out/fitted.toml"));
    EXPECT_EQ(content_of(folder_ / "merged/predictions.csv"), predictions);
  }
}

TEST_F(FitCommand, CandidatesTellWhichTestWouldTeachWhat) {
  const std::string candidates = R"([[candidate]]
name = "compression"
x = "p_Pa"
y = "v"
from = 200e3
to = 800e3
noise = { v = 0.002 }
test = { kind = "isotropic", p_end = 800e3 }
initial = { p = 200e3, ocr = 1.0 }
[[candidate]]
name = "drained"
x = "eps_a"
y = ["q_Pa", "eps_v"]
to = 0.2
noise = { q_Pa = 1e3, eps_v = 5e-4 }
test = { kind = "triaxial", drainage = "drained" }
initial = { p = 200e3, ocr = 1.0 }
)";
  const std::string compressed = replaced(fit_text(), "[solver]", candidates + "[solver]");
  write("fit.toml", compressed);
  ASSERT_EQ(command({"fit", path("fit.toml"), "-o", path("out")}), 0);
  const auto design = io::Json::parse(content_of(folder_ / "out/fit.json"))["design"];
  ASSERT_EQ(design["candidates"].size(), 2u);
  EXPECT_EQ(design["candidates"][0]["test"], "drained");
  EXPECT_GT(design["candidates"][0]["gain_nats"].get<double>(),
            design["candidates"][1]["gain_nats"].get<double>());
  // compression on the line depends on neither M nor κ
  EXPECT_NEAR(design["candidates"][1]["gain_nats"].get<double>(), 0.0, 1e-6);
  EXPECT_EQ(design["best_sequence"].size(), 3u);
  EXPECT_EQ(content_of(folder_ / "out/design.csv")
                .find("order,test,gain_nats,teaches_most,\"M narrower\",\"kappa narrower\"\n"),
            0u);
  // kappa as a share of lambda stands behind it, whatever the order of the file
  write("ratio.toml",
        replaced(replaced(compressed, "lambda = 0.161\n", ""),
                 "kappa = { lower = 0.02, upper = 0.15, scale = \"log\" }",
                 "kappa = { of = \"lambda\", lower = 0.1, upper = 0.8 }\nlambda = { lower = 0.08, "
                 "upper = 0.3 }"));
  ASSERT_EQ(command({"fit", path("ratio.toml"), "-o", path("ratio")}), 0);
  const auto ratio = io::Json::parse(content_of(folder_ / "ratio/fit.json"));
  ASSERT_EQ(ratio["design"]["candidates"].size(), 2u);
  for (const auto& t : ratio["design"]["candidates"]) EXPECT_FALSE(t.contains("broke_off"));
  // candidates say nothing of a start: a fit goes on with others
  write("fit.toml", fit_text());
  EXPECT_EQ(command({"fit", path("fit.toml"), "-o", path("out"), "--resume"}), 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/design.csv"));
}

TEST_F(FitCommand, KappaStaysBelowLambdaWhereBoundsOverlap) {
  std::string text = replaced(fit_text(), "lambda = 0.161\n", "");
  text = replaced(text, "kappa = { lower = 0.02, upper = 0.15, scale = \"log\" }",
                  "kappa = { lower = 0.02, upper = 0.15 }\nlambda = { lower = 0.05, upper = 0.4 }");
  write("fit.toml", text);
  const input::FitFile file = input::read_fit(path("fit.toml"), {}, 1);
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_EQ(file.notes[0],
            "kappa < lambda is kept: kappa stays between 0.02 and the smaller of 0.15 and 0.999 "
            "lambda");
  ASSERT_EQ(file.free[2].name, "kappa");
  EXPECT_EQ(file.free[2].below, 1);
  EXPECT_EQ(file.free[2].lower, 0.02);
  EXPECT_EQ(file.free[2].upper, 0.15);
  EXPECT_EQ(complaint(replaced(text, "kappa = { lower = 0.02, upper = 0.15",
                               "kappa = { lower = 0.5, upper = 0.6"))
                .find("bad.toml:8:11: kappa must be less than lambda, but kappa >= 0.5 and lambda "
                      "<= 0.4 leave no such values"),
            0u);
}

/// Drained compression of a clay, over ε_q: rows far beyond 10 % of axial strain.
std::string drained_text(const std::string& end) {
  return R"([law]
name = "modified_cam_clay"
compression = "v-ln_p"
nu = 0.3
Gamma = 2.759
kappa = 0.062
[fit]
M = { lower = 0.5, upper = 1.5 }
lambda = { lower = 0.08, upper = 0.4 }
[[target]]
data = "cd.csv"
x = "eps_q"
y = "q_Pa"
test = { kind = "triaxial", drainage = "drained")" +
         end + R"( }
initial = { p = 200e3, ocr = 1.0 }
[solver]
starts = 3
)";
}

/// The same, measured by another path: driven by stress.
std::string drained_table() {
  const LawSpec spec{
      "modified_cam_clay",
      {{"compression", "v-ln_p"}},
      {{"M", 0.888}, {"lambda", 0.161}, {"kappa", 0.062}, {"nu", 0.3}, {"Gamma", 2.759}}};
  const LawInfo& law = find_law(spec);
  const auto theta = checked_parameters(spec);
  point::Stage stage;
  stage.drive = point::Drive::stress;
  stage.goal = point::Goal{point::Quantity::q, 200e3};
  stage.points = 10;
  point::PointTest test;
  test.path = point::path_of({stage});
  test.initial.p = 200e3;
  test.initial.ocr = 1.0;
  test.settings.tolerance = 1e-10;
  point::Curve curve;
  point::simulate(law, theta, test, curve);
  std::vector<double> eps_q, q;
  point::read_column(law, theta, test, curve, point::Quantity::eps_q, eps_q);
  point::read_column(law, theta, test, curve, point::Quantity::q, q);
  std::string text = "eps_q,q_Pa\n";
  for (std::size_t i = 1; i < q.size(); ++i) text += fmt::format("{},{}\n", eps_q[i], q[i]);
  return text;
}

TEST_F(FitCommand, ATestEndsWithItsDataUnlessItSaysWhere) {
  write("cd.csv", drained_table());
  write("free.toml", drained_text(""));
  ASSERT_EQ(command({"fit", path("free.toml"), "-o", path("free"), "--no-plot"}), 0);
  const auto report = io::Json::parse(content_of(folder_ / "free/fit.json"));
  // chords between 200 rows: (Δ ln q)²/8 of q, 1e-5
  EXPECT_NEAR(report["parameters"]["M"]["value"].get<double>(), 0.888, 1e-4);
  EXPECT_NEAR(report["parameters"]["lambda"]["value"].get<double>(), 0.161, 1e-4);
  EXPECT_EQ(report["targets"].items().front().value["strain"], "logarithmic");
  EXPECT_FALSE(fs::exists(folder_ / "free/fit.svg"));
  const std::string short_end = complaint(drained_text(", axial_strain = 0.02"));
  EXPECT_NE(short_end.find("lies beyond the test, which goes from 0 to 0.0"), std::string::npos)
      << short_end;
  EXPECT_NE(short_end.find("leave the test's end out to drive it to the last row"),
            std::string::npos)
      << short_end;
}

TEST_F(FitCommand, EngineeringStrainsAreSaidToBe) {
  // ε = 1 − exp(−ε_log) of the same rows
  std::istringstream table(undrained_table());
  std::string line, text;
  std::getline(table, line);
  std::getline(table, line);
  text = line + "\n";
  while (std::getline(table, line)) {
    const auto comma = line.find(',');
    const double logarithmic = 0.01 * std::stod(line.substr(0, comma));
    text += fmt::format("{}{}\n", 100.0 * (1.0 - std::exp(-logarithmic)), line.substr(comma));
  }
  write("cu.csv", text);
  // the table ends at 1 − exp(−0.1)
  const std::string file = replaced(replaced(fit_text(), ", axial_strain = 0.1", ""), "[solver]",
                                    "strain = \"engineering\"\n[solver]");
  write("eng.toml", file);
  ASSERT_EQ(command({"fit", path("eng.toml"), "-o", path("eng"), "--no-plot"}), 0);
  const auto report = io::Json::parse(content_of(folder_ / "eng/fit.json"));
  EXPECT_NEAR(report["parameters"]["M"]["value"].get<double>(), 0.888, 1e-6);
  EXPECT_NEAR(report["parameters"]["kappa"]["value"].get<double>(), 0.062, 1e-6);
  EXPECT_EQ(report["targets"].items().front().value["strain"], "engineering");
}

TEST_F(FitCommand, AnExcessPorePressureOfADrainedTestIsDoubted) {
  write("fit.toml", replaced(fit_text(), "\"undrained\"", "\"drained\""));
  const input::FitFile file = input::read_fit(path("fit.toml"), {}, 1);
  ASSERT_FALSE(file.notes.empty());
  EXPECT_NE(file.notes[0].find("u_Pa is fitted to a test without an undrained stage"),
            std::string::npos)
      << file.notes[0];
}

TEST_F(FitCommand, EveryBoundOfKappaHoldsWhetherItOverlapsThoseOfLambdaOrNot) {
  // truth κ = 0.062; the user insists on less
  for (const char* lower : {"0.02", "0.05"}) {
    std::string text = replaced(fit_text(), "lambda = 0.161\n", "");
    text =
        replaced(text, "kappa = { lower = 0.02, upper = 0.15, scale = \"log\" }",
                 fmt::format("kappa = {{ lower = 0.005, upper = 0.03 }}\nlambda = {{ lower = {}, "
                             "upper = 0.4 }}",
                             lower));
    write("fit.toml", text);
    ASSERT_EQ(command({"fit", path("fit.toml"), "-o", path("out")}), 0);
    const auto report = io::Json::parse(content_of(folder_ / "out/fit.json"));
    const auto& kappa = report["parameters"]["kappa"];
    EXPECT_LE(kappa["value"].get<double>(), 0.03);
    EXPECT_EQ(kappa["at_bound"], "upper") << lower;
    EXPECT_TRUE(kappa["standard_error"].is_null());
    EXPECT_TRUE(kappa["recommended_95"]["upper_is_bound"].get<bool>());
    EXPECT_LT(kappa["recommended_95"]["interval"][0].get<double>(), 0.03);
    EXPECT_EQ(kappa["recommended_95"]["interval"][1].get<double>(), 0.03);
  }
}

TEST_F(FitCommand, RefusesAStartOutsideItsBoundsAndAPriorWithoutAUnit) {
  const std::string good = fit_text(), bounds = "M = { lower = 0.4, upper = 1.8 }";
  EXPECT_EQ(complaint(replaced(good, bounds, "M = { lower = 0.4, upper = 1.8, start = 2.0 }")),
            "bad.toml:8:33: fit.M.start = 2 lies outside its bounds, 0.4 to 1.8");
  const auto prior = [&](const std::string& text) {
    return complaint(
        replaced(good, bounds, "M = { lower = 0.4, upper = 1.8, prior = { " + text + " } }"));
  };
  EXPECT_EQ(prior("mean = 0.9, sd = 0.05"), "accepted");
  EXPECT_EQ(prior("mean = 0.9, relative_sd = 0.05"), "accepted");
  EXPECT_NE(prior("mean = 0.9")
                .find("fit.M.prior needs either sd, in the unit of M [-], or "
                      "relative_sd, a share of the mean"),
            std::string::npos);
  EXPECT_NE(prior("mean = 0.9, sd = 0.1, relative_sd = 0.1").find("needs either sd"),
            std::string::npos);
}

TEST_F(FitCommand, SaysNotConvergedWhereTheLimitEndedEveryStart) {
  write("fit.toml", replaced(fit_text(), "starts = 6", "starts = 3\nlocal_evaluations = 2"));
  ASSERT_EQ(command({"fit", path("fit.toml"), "-o", path("out")}), 0);
  for (const char* name : {"out/fit.json", "out/summary.json"})
    EXPECT_EQ(io::Json::parse(content_of(folder_ / name))["status"], "not converged");
  EXPECT_EQ(command({"fit", path("fit.toml"), "-o", path("out"), "--strict"}), 3);
  write("fit.toml", fit_text());
  EXPECT_EQ(command({"fit", path("fit.toml"), "-o", path("out"), "--strict"}), 0);
}

TEST_F(FitCommand, ALargeMisfitIsToldWithItsCause) {
  // kPa under a header of Pa
  write("cu.csv", replaced(replaced(undrained_table(), "q_kPa", "q_Pa"), "u_kPa", "u_Pa"));
  ASSERT_EQ(command({"fit", path("fit.toml"), "-o", path("out")}), 0);
  const auto report = io::Json::parse(content_of(folder_ / "out/fit.json"));
  std::string all;
  for (const auto& text : report["discrepancy"]) all += text.get<std::string>() + "\n";
  EXPECT_NE(all.find("q_Pa is off by"), std::string::npos) << all;
  EXPECT_NE(all.find("q_Pa and u_Pa look 1000 times too small (kPa in a column of Pa?)"),
            std::string::npos)
      << all;
}

/// The kaolin fit, with the noise of its file or estimated, and its refits at fixed values.
class Kaolin : public testing::TestWithParam<bool> {};

TEST_P(Kaolin, ProfileIntervalsAgreeWithRefitsAtFixedValues) {
  input::FitFile file =
      input::read_fit(std::string(REPOSE_SOURCE_DIR) + "/data/experiments/fit_kaolin.toml", {}, 1);
  if (!GetParam())
    for (auto& t : file.targets)
      for (auto& c : t.channels) {
        c.noise.reset();
        c.row_noise.resize(0);
      }
  calibration::Problem problem(calibration::ParameterSpace(file.free), file.targets, file.balance);
  const auto starts = calibration::run_starts(problem, file.options);
  const Eigen::VectorXd z = calibration::best_of(starts).optimum.z;
  const auto u = calibration::uncertainty(problem, z);
  calibration::Evaluation e;
  problem.evaluate(z, false, e);
  for (std::size_t i = 0; i < file.free.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto p = calibration::profile(problem, u, z, static_cast<int>(i));
    std::printf("[ measured ] %-6s %8.5f  linear %8.5f to %8.5f  profile %8.5f%s to %8.5f%s",
                file.free[i].name.c_str(), u.values[k], u.interval[i][0], u.interval[i][1], p.lower,
                p.lower_open ? "*" : "", p.upper, p.upper_open ? "*" : "");
    EXPECT_LE(p.lower, u.values[k]);
    EXPECT_GE(p.upper, u.values[k]);
    const double factor = u.released_error[k] * u.released_error[k] / u.naive[k];
    for (const bool up : {false, true}) {
      if (up ? p.upper_open : p.lower_open) continue;
      // the value pinned by bounds of 1e-9 instead of being held, from all starts afresh
      const double end = up ? p.upper : p.lower;
      std::vector<calibration::FreeParameter> pinned = file.free;
      auto& q = pinned[i];
      const double near = 1e-9 * std::abs(end);
      if (q.of >= 0) {
        // a ratio x λ = end is pinned as a value of its own, with the ratio's bounds left to λ
        auto& of = pinned[static_cast<std::size_t>(q.of)];
        of.lower = std::max(of.lower, end / q.upper);
        of.upper = std::min(of.upper, end / q.lower);
        of.start.reset();
        q.of = -1;
      }
      q.lower = end - near;
      q.upper = end + near;
      q.start.reset();
      const calibration::Problem refit(calibration::ParameterSpace(pinned), file.targets,
                                       file.balance);
      calibration::FitOptions options = file.options;
      options.starts = 6;
      const auto ends = calibration::run_starts(refit, options);
      const double excess =
          (2.0 * calibration::best_of(ends).optimum.objective - e.r.squaredNorm()) / factor;
      const double t = u.quantiles[k];
      std::printf("  %s %.3f", up ? "upper" : "lower", excess / (t * t));
      // the end is found to 1e-3 of √excess; the bounds themselves change what excess is critical
      // only within t standard errors of them
      const double room =
          std::min(end - problem.space().reach(i)[0], problem.space().reach(i)[1] - end);
      if (room > t * u.released_error[k]) {
        EXPECT_NEAR(excess / (t * t), 1.0, 0.01) << up;
      }
    }
    std::printf("\n");
  }
}
INSTANTIATE_TEST_SUITE_P(Noise, Kaolin, testing::Values(true, false),
                         [](const auto& p) { return p.param ? "Declared" : "Estimated"; });

}  // namespace
}  // namespace repose::app

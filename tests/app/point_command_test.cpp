// `repose point` from input file to result folder: messages, exit codes, files; and every ready
// test.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "app/command_line.hpp"
#include "calibration/optimise.hpp"
#include "input/read_point_test.hpp"
#include "io/json.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;

const std::string good = R"([law]
name = "modified_cam_clay"
compression = "v-ln_p"
M = 0.888
lambda = 0.161
kappa = 0.062
nu = 0.3
Gamma = 2.759
[initial]
p = 100e3
ocr = 1.0
[test]
kind = "triaxial"
drainage = "undrained"
axial_strain = 0.1
points = 20
)";

/// Everything that is wrong with a text, one line each.
std::string problems(const std::string& text, std::vector<std::string> sets = {}) {
  try {
    input::InputFile file = input::InputFile::parse(text, "t.toml", sets);
    input::read_point_test(file);
  } catch (const input::BadInput& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(ReadPointTest, reads_a_test) {
  input::InputFile file = input::InputFile::parse(good, "t.toml");
  const input::PointTestFile test = input::read_point_test(file);
  ASSERT_EQ(test.test.path.legs.size(), 1u);
  EXPECT_TRUE(test.test.path.undrained);
  EXPECT_EQ(test.test.path.legs[0].spec().points, 20);
  EXPECT_EQ(test.name, "t");
}

TEST(ReadPointTest, says_what_is_wrong_and_where) {
  EXPECT_EQ(problems(good), "");
  EXPECT_TRUE(contains(problems(good, {"test.rate=0"}), "test.rate"))
      << problems(good, {"test.rate=0"});
  EXPECT_TRUE(contains(problems(good, {"test.rate=nan"}), "test.rate"));
  EXPECT_TRUE(contains(problems(good, {"test.rates.from=1"}), "simple_shear"));
  EXPECT_TRUE(contains(problems(good, {"test.drainage=undraind"}), "undrained"));
  EXPECT_TRUE(contains(problems(good, {"test.axial_strian=0.1"}), "axial_strain"));
  EXPECT_TRUE(contains(problems(good, {"test.q_end=1e4"}), "a stage ends at one value"));
  EXPECT_TRUE(contains(problems(good, {"initial.p=-1"}), "initial p must be > p_sep"));
  EXPECT_TRUE(contains(problems(good, {"initial.ocr=0.5"}), "initial.ocr"));
  EXPECT_TRUE(contains(problems(good, {"law.kappa=0.2"}), "kappa must be < lambda"));
  EXPECT_TRUE(contains(problems(good, {"integration.method=rk4"}), "adaptive"));
  EXPECT_TRUE(contains(problems(good, {"integration.tolerance=0"}), "tolerance"));
  EXPECT_TRUE(contains(problems(good, {"test.cycles=3"}), "q_min and q_max"));
  const std::string custom = problems(good, {"test.kind=custom", "test.duration=10"});
  EXPECT_TRUE(contains(custom, "six are needed")) << custom;
  const std::string open_end = problems(good + "[test.stop]\nq_over_p = 1.0\n");
  EXPECT_EQ(open_end, "");
}

// Strains are fractions: whatever lies beyond max_strain was meant in per cent.
TEST(ReadPointTest, per_cent_are_told_from_fractions) {
  const auto message = problems(good, {"test.axial_strain=15"});
  EXPECT_TRUE(contains(message, "test.axial_strain = 15 is 1500 %; did you mean 0.15?")) << message;
  const std::string start = good.substr(0, good.find("axial_strain"));
  const auto refuses = [&](const std::string& line, const std::string& key,
                           std::vector<std::string> sets = {}) {
    const std::string text = problems(start + line, sets);
    EXPECT_TRUE(contains(text, key + " = ")) << line << ": " << text;
    EXPECT_TRUE(contains(text, "did you mean")) << line << ": " << text;
  };
  refuses("axial_strain_total = 15.0\n", "test.axial_strain_total");
  refuses("axial_strain = -15.0\n", "test.axial_strain");
  refuses("volumetric_strain = 12.0\n", "test.volumetric_strain");
  refuses("volumetric_strain_total = 12.0\n", "test.volumetric_strain_total");
  refuses("stages = [{ axial_strain = 0.1 }, { axial_strain = 15.0 }]\n",
          "test.stages[1].axial_strain");
  refuses("axial_strain = 0.1\nstop = { eps_q = 11.0 }\n", "test.stop.eps_q");
  refuses("axial_strain = 0.1\nstop = { eps_v_total = -11.0 }\n", "test.stop.eps_v_total");
  refuses("cycles = 2\naxial_strain_min = -0.1\naxial_strain_max = 15.0\n",
          "test.axial_strain_max");
  refuses("axial_strain = 0.1\nstrain_limit = 20.0\n", "test.strain_limit");
  refuses("axial_strain = 0.6\n[integration]\nmax_strain = 0.5\n", "test.axial_strain");
  const std::string shear = "[test]\nkind = \"simple_shear\"\n";
  const std::string head = good.substr(0, good.find("[test]"));
  EXPECT_TRUE(contains(problems(head + shear + "shear_strain = 20.0\n"), "did you mean 0.2?"));
  EXPECT_TRUE(
      contains(problems(head + shear + "shear_strain_total = 20.0\n"), "did you mean 0.2?"));
}

TEST(ReadPointTest, stages_count_from_their_start_and_totals_from_that_of_the_test) {
  const std::string start = good.substr(0, good.find("axial_strain"));
  const auto goal = [&](const std::string& line) {
    input::InputFile file = input::InputFile::parse(start + line, "t.toml");
    return *input::read_point_test(file).test.path.legs.back().spec().goal;
  };
  EXPECT_TRUE(goal("axial_strain = 0.1\n").of_stage);
  EXPECT_FALSE(goal("axial_strain_total = 0.1\n").of_stage);
  EXPECT_FALSE(goal("q_end = 1e4\n").of_stage);
  // −ln(1 − 0.1) in logarithmic strain
  EXPECT_NEAR(goal("strain = \"engineering\"\naxial_strain = 0.1\n").value, 0.105360516, 1e-9);
  EXPECT_TRUE(contains(problems(start + "strain = \"engineering\"\naxial_strain = 1.5\n"),
                       "an engineering strain is below 1"));
  EXPECT_TRUE(
      contains(problems(start + "strain = \"nominal\"\naxial_strain = 0.1\n"), "engineering"));
}

TEST(ReadPointTest, other_ways_to_give_the_start) {
  const auto start = [&](std::vector<std::string> lines) {
    std::string text = good;
    std::string initial;
    for (const std::string& line : lines) initial += line + "\n";
    const auto at = text.find("p = 100e3\nocr = 1.0\n");
    text.replace(at, std::string("p = 100e3\nocr = 1.0\n").size(), initial);
    return text;
  };
  const auto initial = [&](std::vector<std::string> lines) {
    const std::string text = start(std::move(lines));
    input::InputFile file = input::InputFile::parse(text, "t.toml");
    return input::read_point_test(file).test.initial;
  };
  EXPECT_EQ(initial({"sigma_v = 100e3", "K0 = 0.7"}).sigma_v, 100e3);
  EXPECT_EQ(initial({"p = 100e3", "ocr_v = 2.0", "K0 = 0.7"}).ocr_v, 2.0);
  EXPECT_EQ(initial({"p = 100e3", "e = 1.08"}).v, 2.08);
  EXPECT_TRUE(contains(problems(start({"p = 100e3", "e = 1.0", "v = 2.0"})), "either e or v"));
  EXPECT_TRUE(contains(problems(start({"sigma_v = 100e3"})), "sigma_v needs K0"));
  EXPECT_TRUE(
      contains(problems(start({"sigma_v = 100e3", "p = 1e5", "K0 = 0.7"})), "either p or sigma_v"));
  EXPECT_TRUE(contains(problems(start({"p = 100e3", "ocr = 2.0", "ocr_v = 2.0"})),
                       "either ocr = p_c/p or ocr_v"));
  // Γ = 2.759 at 1 kPa, λ = 0.161: v on the line at p = p_c = 100 kPa is 2.0862
  EXPECT_TRUE(contains(problems(start({"p = 100e3", "ocr = 1.0", "v = 1.8"})),
                       "the initial state contradicts itself: v is 1.8, and at p = 1e+05 Pa with "
                       "p_c = 1e+05 Pa the compression line (Gamma or N) says 2.0862"))
      << problems(start({"p = 100e3", "ocr = 1.0", "v = 1.8"}));
}

TEST(ReadPointTest, doubts_are_told_with_their_reason) {
  const auto notes = [](const std::string& text, std::vector<std::string> sets = {}) {
    input::InputFile file = input::InputFile::parse(text, "t.toml", sets);
    return input::read_point_test(file).notes;
  };
  EXPECT_TRUE(notes(good).empty());
  const auto low = notes(good, {"initial.p=200"});
  ASSERT_EQ(low.size(), 1u);
  EXPECT_EQ(
      low[0],
      "initial.p = 200 Pa is 0.2 kPa, and published tests start at 1 kPa and more; if 200 kPa "
      "is meant, write 200e3");
  const std::string grains = R"([law]
name = "mu_i"
mu_0 = 0.38
mu_d = 0.57
I_0 = 0.279
d = 5.3
rho_p = 1200.0
rho_0 = 1300.0
K = 254800.0
[initial]
p = 1000.0
[test]
kind = "simple_shear"
drainage = "constant_p"
shear_strain = 0.1
)";
  const auto odd = notes(grains);
  ASSERT_EQ(odd.size(), 2u);
  EXPECT_TRUE(contains(odd[0],
                       "law.d = 5.3 m: grains larger than 0.1 m are rare; if 5.3 mm is "
                       "meant, write 0.0053"));
  EXPECT_TRUE(contains(odd[1], "law.rho_p = 1200 kg/m³ is less than rho_0 = 1300 kg/m³"));
}

class PointCommand : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string read(const std::string& name) const { return content_of(folder_ / name); }
  int run(const std::string& file, const std::string& out,
          std::vector<std::string> sets = {}) const {
    std::vector<std::string> words{"repose", "point", file, "-o", (folder_ / out).string(),
                                   "--quiet"};
    for (const std::string& set : sets) {
      words.push_back("--set");
      words.push_back(set);
    }
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    return run_command_line(static_cast<int>(argv.size()), argv.data());
  }
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

TEST_F(PointCommand, writes_its_files_and_the_resolved_input_gives_the_same_bits) {
  ASSERT_EQ(run(write("t.toml", good), "a"), 0);
  const std::string curve = read("a/curve.csv");
  EXPECT_EQ(curve.substr(0, curve.find('\n')),
            "time_s,eps_a,eps_r,eps_v,eps_q,p_Pa,q_Pa,sigma_a_Pa,sigma_r_Pa,u_Pa,v,p_c_Pa");
  EXPECT_EQ(std::count(curve.begin(), curve.end(), '\n'), 22);
  const auto summary = io::Json::parse(read("a/summary.json"));
  EXPECT_EQ(summary["status"], "done");
  EXPECT_EQ(summary["method"], "adaptive");
  EXPECT_LE(summary["control_residual"].get<double>(), 1e-10);
  EXPECT_EQ(summary["input"]["test"]["axial_strain"], 0.1);
  EXPECT_TRUE(summary.contains("seed"));
  ASSERT_EQ(run((folder_ / "a/input.toml").string(), "b"), 0);
  EXPECT_EQ(read("b/curve.csv"), curve);
}

// Friction may be an angle, the cone is a word; what a result says of them runs again to the same
// bits.
TEST_F(PointCommand, friction_as_an_angle_and_the_shape_of_its_cone) {
  std::string given = good;
  given.replace(given.find("M = 0.888"), 9, "phi = 22.7\nshape = \"matsuoka_nakai\"");
  given.replace(given.find("axial_strain = 0.1"), 18, "axial_strain = -0.3");
  ASSERT_EQ(run(write("t.toml", given), "a"), 0);
  const std::string resolved = read("a/input.toml");
  EXPECT_TRUE(contains(resolved, "shape = 'matsuoka_nakai'")) << resolved;
  EXPECT_FALSE(contains(resolved, "phi")) << resolved;
  ASSERT_EQ(run((folder_ / "a/input.toml").string(), "b"), 0);
  EXPECT_EQ(read("b/curve.csv"), read("a/curve.csv"));
  // normally consolidated, so on its ellipse q² = M²p(p_c − p) from the start, with the M of
  // extension, 6 sin φ/(3 + sin φ): to the error of the steps, 1e-8 each
  const double sine = std::sin(22.7 * std::acos(-1.0) / 180.0);
  std::istringstream rows(read("a/curve.csv"));
  std::string row, last;
  while (std::getline(rows, row)) last = row;
  std::vector<double> cells;
  std::istringstream fields(last);
  for (std::string cell; std::getline(fields, cell, ',');) cells.push_back(std::stod(cell));
  const double p = cells[5], q = cells[6], p_c = cells.back();
  EXPECT_NEAR(-q / std::sqrt(p * (p_c - p)), 6.0 * sine / (3.0 + sine), 1e-6);

  EXPECT_TRUE(contains(problems(given, {"law.phi=90"}), "law.phi = 90 ° is out of range"));
  EXPECT_TRUE(contains(problems(given, {"law.M=0.9"}), "give either law.M or law.phi"));
  EXPECT_TRUE(
      contains(problems(given, {"law.shape=matsuoka_naki"}), "did you mean \"matsuoka_nakai\"?"));
  EXPECT_TRUE(contains(problems(given, {"law.shape=1"}), "got the integer 1"));
  std::string typo = given;
  typo.replace(typo.find("phi ="), 5, "phy =");
  EXPECT_TRUE(contains(problems(typo), "did you mean 'phi'?"));
  std::string none = good;
  none.replace(none.find("M = 0.888\n"), 10, "");
  EXPECT_TRUE(contains(problems(none), "or phi, its friction angle in degrees"));
}

// A law that says its own I has it as a column in every kind of test; flow beyond what it is for is
// a warning.
TEST_F(PointCommand, a_critical_state_law_has_its_I_and_says_when_it_is_fast) {
  const std::string file = write("t.toml", R"([law]
name = "critical_state_mu_i"
M = 0.888
lambda = 0.0732
kappa = 0.0282
nu = 0.3
Gamma = 2.759
d = 1e-6
M_inf = 1.154
I_M = 1e-11
I_v = 3e-10
[initial]
p = 1e5
ocr = 1.5
[test]
kind = "triaxial"
drainage = "undrained"
axial_strain = 0.1
rate = 1e-6
)");
  ASSERT_EQ(run(file, "slow"), 0);
  const std::string curve = read("slow/curve.csv");
  EXPECT_EQ(curve.substr(0, curve.find('\n')),
            "time_s,eps_a,eps_r,eps_v,eps_q,p_Pa,q_Pa,sigma_a_Pa,sigma_r_Pa,u_Pa,v,p_c_Pa,I");
  const auto slow = io::Json::parse(read("slow/summary.json"));
  EXPECT_EQ(slow["method"], "cvode");
  EXPECT_TRUE(slow["warnings"].empty()) << slow["warnings"];
  ASSERT_EQ(run(file, "fast", {"test.rate=1e-3"}), 0);
  const auto fast = io::Json::parse(read("fast/summary.json"));
  ASSERT_GE(fast["warnings"].size(), 1u);
  EXPECT_TRUE(contains(fast["warnings"][0].get<std::string>(), "of I_v: at constant volume"));
}

TEST_F(PointCommand, a_path_that_cannot_be_finished_leaves_the_part_done) {
  const std::string file = write("t.toml", good);
  EXPECT_EQ(run(file, "a",
                {"test.axial_strain=-0.5", "test.drainage=drained", "test.kind=isotropic",
                 "test.volumetric_strain=-3"}),
            2);  // two ends
  std::string text = good;
  text.replace(text.find("axial_strain = 0.1"), 18, "volumetric_strain = -3.0");
  EXPECT_EQ(run(write("u.toml", text), "b", {"test.kind=isotropic"}), 2);  // drainage has no place
  text.replace(text.find("drainage = \"undrained\"\n"), 23, "");
  EXPECT_EQ(run(write("v.toml", text), "c", {"test.kind=isotropic"}), 3);
  const auto summary = io::Json::parse(read("c/summary.json"));
  EXPECT_EQ(summary["status"], "failed");
  EXPECT_TRUE(contains(summary["reason"].get<std::string>(), "p = p_sep")) << summary["reason"];
  EXPECT_GT(summary["rows"].get<int>(), 3);
  EXPECT_FALSE(contains(read("c/curve.csv"), "nan"));
}

TEST_F(PointCommand, draws_no_picture_if_told_so) {
  const std::string file = write("t.toml", good), out = (folder_ / "a").string();
  const char* const words[] = {"repose",    "point",   file.c_str(), "-o",
                               out.c_str(), "--quiet", "--no-plot"};
  ASSERT_EQ(run_command_line(7, words), 0);
  EXPECT_TRUE(fs::exists(folder_ / "a/curve.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "a/curve.svg"));
}

// p is constant but for round-off here, whatever the pressure and the overconsolidation.
TEST_F(PointCommand, a_quantity_that_does_not_change_is_drawn) {
  std::string text = good.substr(0, good.find("[test]"));
  text +=
      "[test]\nkind = \"simple_shear\"\ndrainage = \"constant_p\"\nshear_strain = 0.2\n"
      "points = 40\n";
  const std::string file = write("t.toml", text);
  for (const char* p : {"50e3", "100e3", "123456.7", "400e3"})
    for (const char* ocr : {"1.0", "2.0", "8.0"}) {
      ASSERT_EQ(run(file, "a", {std::string("initial.p=") + p, std::string("initial.ocr=") + ocr}),
                0);
      EXPECT_TRUE(fs::exists(folder_ / "a/curve.svg") || std::system("gnuplot --version") != 0)
          << p << " " << ocr;
    }
}

TEST_F(PointCommand, a_history_and_its_mistakes) {
  std::string text = good.substr(0, good.find("[test]"));
  text += "[test]\nkind = \"custom\"\nhistory = \"h.csv\"\n";
  const std::string file = write("t.toml", text);
  EXPECT_EQ(run(file, "a"), 4);  // no such file
  write("h.csv", "time_s,eps_a,sigma_r_Pa\n0,0,1e5\n10,nan,1e5\n");
  EXPECT_EQ(run(file, "a"), 2);
  write("h.csv", "time_s,eps_a\n0,0\n10,0.1\n");
  EXPECT_EQ(run(file, "a"), 2);
  write("h.csv", "time_s,eps_a,sigma_r\n0,0,1e5\n10,0.1,1e5\n");
  EXPECT_EQ(run(file, "a"), 2);
  write("h.csv", "time_s,eps_a,sigma_r_Pa\n0,0,2e5\n10,0.1,2e5\n");
  EXPECT_EQ(run(file, "a"), 2) << "the test starts at 100 kPa";
  EXPECT_EQ(run(file, "a", {"test.history_is=change"}), 0);
  write("h.csv", "time_s,eps_a,sigma_r_Pa\n0,0,1e5\n10,0.1,1e5\n");
  EXPECT_EQ(run(file, "a"), 0);
  ASSERT_EQ(run((folder_ / "a/input.toml").string(), "b"), 0);
  EXPECT_EQ(read("a/curve.csv"), read("b/curve.csv"));
}

TEST_F(PointCommand, every_ready_test_runs) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(REPOSE_SOURCE_DIR) / "data/experiments"))
    if (entry.path().extension() == ".toml" &&
        !entry.path().filename().string().starts_with("fit_")) {
      EXPECT_EQ(run(entry.path().string(), "out"), 0) << entry.path();
      ++count;
    }
  EXPECT_GE(count, 15);
}

TEST(CheckCommand, takes_point_tests_and_fits) {
  const std::string folder = REPOSE_SOURCE_DIR "/data/experiments/";
  const auto check = [](const std::string& path, const char* set) {
    const char* const plain[] = {"repose", "check", path.c_str(), "--quiet"};
    const char* const changed[] = {"repose", "check", path.c_str(), "--quiet", "--set", set};
    return set == nullptr ? run_command_line(4, plain) : run_command_line(6, changed);
  };
  EXPECT_EQ(check(folder + "weald_clay_undrained.toml", nullptr), 0);
  EXPECT_EQ(check(folder + "weald_clay_undrained.toml", "law.M=-1"), 2);
  EXPECT_EQ(check(folder + "fit_kaolin.toml", nullptr), 0);
  EXPECT_EQ(check(folder + "fit_kaolin.toml", "solver.local=LD_SLSPQ"), 2);
}

TEST(ChartCommand, draws_the_point_driver) {
  const ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  const std::string out = folder.string();
  const char* const argv[] = {"repose", "chart", "point", "--quiet", "-o", out.c_str()};
  ASSERT_EQ(run_command_line(6, argv), 0);
  for (const char* const name : {"chart.csv", "error_map.csv"})
    EXPECT_GT(fs::file_size(folder / name), 1000u) << name;
  const toml::table input = toml::parse_file((folder / "input.toml").string());
  EXPECT_EQ(input["chart"]["kind"].value<std::string>(), "point");
}

// A short run of every algorithm: each has a trace that only ever falls, and the table says of it
// what the trace says.
TEST(ChartCommand, draws_every_algorithm_of_a_fit) {
  const ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  const std::string out = folder.string();
  const char* const argv[] = {"repose",    "chart",  "fit", "--quiet",       "-o",
                              out.c_str(), "--seed", "7",   "--evaluations", "40"};
  ASSERT_EQ(run_command_line(10, argv), 0);
  const auto rows_of = [&](const char* name) {
    std::vector<std::vector<std::string>> rows;
    std::ifstream file(folder / name);
    for (std::string line; std::getline(file, line);) {
      std::vector<std::string>& row = rows.emplace_back();
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    }
    return rows;
  };
  const auto trace = rows_of("chart.csv");
  const auto table = rows_of("table.csv");
  ASSERT_EQ(table.size(), 1 + calibration::algorithms().size());
  for (std::size_t k = 0; k < calibration::algorithms().size(); ++k) {
    const std::string name(calibration::algorithms()[k].name);
    SCOPED_TRACE(name);
    EXPECT_EQ(table[k + 1][0], name);
    EXPECT_LE(std::stol(table[k + 1][2]), 40 + 1) << "the budget, and one trial to notice its end";
    std::vector<double> objective;
    long trials = 0;
    for (const auto& row : trace) {
      if (row[0] != name) continue;
      objective.push_back(std::stod(row[4]));
      EXPECT_GE(std::stol(row[1]), trials);
      trials = std::stol(row[1]);
    }
    ASSERT_GE(objective.size(), 2u);
    for (std::size_t i = 1; i + 1 < objective.size(); ++i)
      EXPECT_LE(objective[i], objective[i - 1]);  // equal in ten digits where f falls by round-off
    // The last row is the best point evaluated afresh, without derivatives: 60 residuals that agree
    // to the paths' tolerance of 1e-9, so |√f − √f'| <= √(60/2) 1e-9.
    EXPECT_NEAR(std::sqrt(objective.back()), std::sqrt(objective[objective.size() - 2]), 5.5e-9);
    EXPECT_EQ(std::stod(table[k + 1][1]), objective.back());
    EXPECT_LE(trials, std::stol(table[k + 1][2]));
  }
  EXPECT_EQ(trace[1][0], "levenberg_marquardt");
  EXPECT_LT(std::stod(table[1][1]), 1e-20 * std::stod(trace[1][4])) << "exact data, exact fit";

  // its input.toml makes the same chart
  const std::string input = (folder / "input.toml").string(), again = out + "_again";
  const char* const same[] = {"repose", "chart", input.c_str(), "--quiet", "-o", again.c_str()};
  ASSERT_EQ(run_command_line(6, same), 0);
  const auto summary_of = [](const fs::path& result) {
    std::ifstream in(result / "summary.json");
    return io::Json::parse(std::string(std::istreambuf_iterator<char>(in), {}));
  };
  EXPECT_EQ(summary_of(folder), summary_of(again));
  fs::remove_all(again);
}

}  // namespace
}  // namespace repose::app

/// \file
/// Names of materials, what a 0 among the constants means, and that docs/umat_out.md has the tables
/// of the laws as they are.

#include <fstream>
#include <sstream>

#include "tests/umat/out/call_umat.hpp"
#include "umat/out/constants.hpp"
#include "umat/out/tables.hpp"

namespace repose::umat {
namespace {

TEST(MaterialName, IsFoundWithAndWithoutItsSuffix) {
  for (const LawInfo& law : library_laws()) {
    const std::string name = material_name(law);
    EXPECT_LE(name.size() + 10, longest_name) << name << " leaves little room for a suffix";
    std::string padded = name + "__DENSE_SAND";
    padded.resize(longest_name, ' ');
    for (const std::string& given : {name, name + "__KAOLIN-2", padded, name + "   "})
      EXPECT_EQ(&find_form(given), &law) << given;
    std::string lower = name;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    EXPECT_EQ(&find_form(lower), &law);
  }
}

TEST(MaterialName, OfSwitchesAndDefaults) {
  EXPECT_EQ(find_form("NEWTONIAN-NO_TENSION_CUTOFF").option, "false");
  EXPECT_EQ(find_form("NEWTONIAN-TENSION_CUTOFF").option, "true");
  EXPECT_EQ(find_form("NEWTONIAN").option, "true");
  EXPECT_EQ(find_form("MU_I__SAND").option, "elastoviscoplastic");
  EXPECT_EQ(find_form("MU_I-REGULARISED__SAND").option, "regularised");
  EXPECT_EQ(find_form("CRITICAL_STATE_MU_I__A").name, "critical_state_mu_i");
}

TEST(Constants, ZeroIsAbsentWhereItIsNoValue) {
  const LawInfo& clay = find_form("MODIFIED_CAM_CLAY-V-LN_P");
  const LawSpec spec{"modified_cam_clay",
                     {{"compression", "v-ln_p"}},
                     {{"M", 0.9}, {"lambda", 0.2}, {"kappa", 0.05}, {"nu", 0.0}, {"N", 3.0}}};
  const std::vector<double> props{0.9, 0.2, 0.05, 0.0, 0.0, 3.0};
  EXPECT_EQ(read_constants(clay, props).theta, checked_parameters(spec));
  // the same with all that may be absent written as 0
  std::vector<double> full = props;
  full.resize(13, 0.0);
  const Constants constants = read_constants(clay, full);
  EXPECT_EQ(constants.theta, checked_parameters(spec));
  EXPECT_FALSE(constants.start.ocr || constants.start.v);
  full[11] = 2.0;
  full[12] = 1.9;
  EXPECT_EQ(read_constants(clay, full).start.ocr, 2.0);
  EXPECT_EQ(read_constants(clay, full).start.v, 1.9);
}

TEST(Constants, OfEveryExampleAreItsParameters) {
  for (const LawInfo& law : library_laws())
    for (const LawExample& example : examples_of(law)) {
      const std::vector<double> theta = read_constants(law, props_of(example.spec)).theta;
      const std::vector<double> expected = checked_parameters(example.spec);
      ASSERT_EQ(theta.size(), expected.size());
      for (std::size_t i = 0; i < theta.size(); ++i)
        EXPECT_TRUE(theta[i] == expected[i] || (std::isnan(theta[i]) && std::isnan(expected[i])))
            << example.label << ": " << law.parameters[i].name;
    }
}

std::string page() {
  std::ifstream file(std::string(REPOSE_SOURCE_DIR) + "/docs/umat_out.md");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(UmatPage, HasTheTablesOfTheLaws) {
  const std::string text = page();
  const std::string heading = "## Every law\n\n";
  const std::size_t at = text.find(heading);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(text.substr(at + heading.size()), tables())
      << "repose models --umat prints what stands below \"" << heading << "\"";
}

/// The numbers of a data line; a comment has none.
std::vector<double> numbers_of(std::string line) {
  std::vector<double> numbers;
  if (line.starts_with("**")) return numbers;
  std::replace(line.begin(), line.end(), ',', ' ');
  std::istringstream words(line);
  for (double x; words >> x;) numbers.push_back(x);
  return numbers;
}

TEST(UmatPage, ItsInputFileMakesAMaterialThatStarts) {
  std::istringstream lines(page());
  std::string line, name, keyword;
  std::vector<double> props, stress;
  double depvar = 0.0, constants = 0.0;
  const auto after = [](const std::string& text, const std::string& key) {
    return text.substr(text.find(key) + key.size());
  };
  while (std::getline(lines, line) && !(keyword == "stress" && line == "```")) {
    if (line.starts_with("*MATERIAL")) name = after(line, "NAME=");
    if (line.starts_with("*USER MATERIAL")) {
      keyword = "props";
      constants = std::stod(after(line, "CONSTANTS="));
    } else if (line.starts_with("*DEPVAR")) {
      keyword = "depvar";
    } else if (line.starts_with("*INITIAL CONDITIONS, TYPE=STRESS")) {
      keyword = "stress";
    } else if (keyword == "props") {
      for (const double x : numbers_of(line)) props.push_back(x);
    } else if (keyword == "depvar" && depvar == 0.0) {
      depvar = numbers_of(line).at(0);
    } else if (keyword == "stress" && line.starts_with("CLAY,")) {
      stress = numbers_of(after(line, "CLAY,"));
    }
  }
  EXPECT_EQ(constants, static_cast<double>(props.size()));
  ASSERT_EQ(stress.size(), 6U);
  Host host(name, props, static_cast<std::size_t>(depvar));
  host.stress = stress;
  ASSERT_TRUE(host.step({1e-4, -2e-4, 1e-4, 0.0, 0.0, 0.0}, 1.0));
  EXPECT_GT(host.statev[0], 1000.0);
  EXPECT_NEAR(host.statev[1], 1.3e5, 1.0);  // p_c = ocr p, and the step is elastic
}

}  // namespace
}  // namespace repose::umat

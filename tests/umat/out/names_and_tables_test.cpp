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

TEST(UmatPage, HasTheTablesOfTheLaws) {
  std::ifstream file(std::string(REPOSE_SOURCE_DIR) + "/docs/umat_out.md");
  std::ostringstream page;
  page << file.rdbuf();
  const std::string text = page.str();
  const std::string heading = "## Every law\n\n";
  const std::size_t at = text.find(heading);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(text.substr(at + heading.size()), tables())
      << "repose models --umat prints what stands below \"" << heading << "\"";
}

}  // namespace
}  // namespace repose::umat

/// \file
/// Whole paths, driven from Fortran through the UMAT by a program that knows nothing of repose
/// (umat_driver.f90), against the point driver with the law's own update and the same steps: every
/// law and form in triaxial compression, an oedometer and simple shear.

#include <array>
#include <cstdio>
#include <sstream>

#include "pointdriver/integrate/simulate.hpp"
#include "tests/models/law_samples.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/umat/out/umat_props.hpp"
#include "umat/out/material_name.hpp"

namespace repose::umat {
namespace {

using point::Condition;
using point::Kind;

constexpr int steps = 20;

/// A test by both programs; components in the host's order.
struct LoadPath {
  const char* name;
  Kind kind;
  Condition condition;
  std::array<int, 6> stress_given;
  std::array<double, 6> change;  ///< of strain, of a total axial or shear strain of 1
};
const std::array<LoadPath, 5> paths{{
    {"drained triaxial",
     Kind::triaxial,
     Condition::drained,
     {1, 0, 1, 0, 0, 0},
     {0, -1, 0, 0, 0, 0}},
    {"undrained triaxial",
     Kind::triaxial,
     Condition::undrained,
     {0, 0, 0, 0, 0, 0},
     {0.5, -1, 0.5, 0, 0, 0}},
    {"oedometer", Kind::oedometer, Condition::drained, {0, 0, 0, 0, 0, 0}, {0, -1, 0, 0, 0, 0}},
    {"simple shear, constant volume",
     Kind::simple_shear,
     Condition::constant_volume,
     {0, 0, 0, 0, 0, 0},
     {0, 0, 0, 1, 0, 0}},
    {"simple shear, constant normal stress",
     Kind::simple_shear,
     Condition::constant_normal_stress,
     {0, 1, 0, 0, 0, 0},
     {0, 0, 0, 1, 0, 0}},
}};

point::Curve native(const LawExample& example, const LoadPath& path, double strain, double ocr) {
  point::Stage stage;
  stage.kind = path.kind;
  stage.condition = path.condition;
  const bool shear = path.kind == Kind::simple_shear;
  stage.goal = point::Goal{shear ? point::Quantity::gamma : point::Quantity::eps_a, strain};
  stage.rate = strain / (steps * example.time);
  stage.points = steps;
  point::PointTest test;
  test.path = point::path_of({stage});
  test.initial.p = example.pressure;
  if (ocr > 0.0) test.initial.ocr = ocr;
  test.settings.method = point::Method::implicit;
  test.settings.substeps = 1;
  const LawInfo& law = find_law(example.spec);
  const std::vector<double> theta = checked_parameters(example.spec);
  point::Curve curve;
  point::simulate(law, theta, test, curve);
  EXPECT_EQ(curve.outcome.status, point::Status::completed)
      << point::explain(law, theta, test, curve);
  EXPECT_EQ(curve.outcome.counts.rejected, 0) << "other steps than the host's";
  return curve;
}

/// What umat_driver reads.
std::string driver_input(const LawExample& example, const LoadPath& path, double strain, double ocr,
                         int nshr) {
  const LawInfo& law = find_law(example.spec);
  std::vector<double> props = props_of(example.spec);
  if (ocr > 0.0) props.push_back(ocr);
  std::ostringstream text;
  text.precision(17);
  const std::size_t states = 1 + law.state.size();
  text << "'" << material_name(law) << "__" << example.label << "'\n"
       << 3 << " " << nshr << " " << props.size() << " " << states << "\n";
  for (const double x : props) text << x << " ";
  text << "\n";
  const auto components = static_cast<std::size_t>(3 + nshr);
  for (std::size_t i = 0; i < components; ++i) text << (i < 3 ? -example.pressure : 0.0) << " ";
  text << "\n";
  for (std::size_t i = 0; i < states; ++i) text << "0 ";
  text << "\n1\n" << steps << " " << example.time << "\n";
  for (std::size_t i = 0; i < components; ++i) text << path.stress_given[i] << " ";
  text << "\n";
  for (std::size_t i = 0; i < components; ++i) text << strain * path.change[i] << " ";
  text << "\n";
  return text.str();
}

struct DriverRow {
  int calls = 0;
  std::array<double, 3> misses{};
  std::vector<double> stress, strain, statev;
  double sse = 0.0, spd = 0.0, scd = 0.0;
};

/// What umat_driver printed; `status` its exit status.
std::vector<DriverRow> drive(const std::string& input, std::size_t components, std::size_t states,
                             int& status, std::string& errors) {
  const ScratchFolder folder;
  const auto in = folder.path() / "in", err = folder.path() / "err", out = folder.path() / "out";
  std::ofstream(in) << input;
  std::string driver;
#ifdef REPOSE_UMAT_DRIVER
  driver = REPOSE_UMAT_DRIVER;
#endif
  const std::string command =
      driver + " < " + in.string() + " > " + out.string() + " 2> " + err.string();
  const int result = std::system(command.c_str());
  status = WEXITSTATUS(result);
  errors = content_of(err);
  std::vector<DriverRow> rows;
  std::istringstream text(content_of(out));
  for (DriverRow row; text >> row.calls;) {
    const auto read = [&](std::vector<double>& values, std::size_t count) {
      values.resize(count);
      for (double& x : values) text >> x;
    };
    for (double& x : row.misses) text >> x;
    read(row.stress, components);
    read(row.strain, components);
    read(row.statev, states);
    text >> row.sse >> row.spd >> row.scd;
    rows.push_back(row);
  }
  return rows;
}

class UmatDriver : public ::testing::Test {
 protected:
  void SetUp() override {
#ifndef REPOSE_UMAT_DRIVER
    GTEST_SKIP() << "built without a Fortran compiler (gfortran of scripts/packages check)";
#endif
  }
};

double largest_of(const std::vector<double>& values) {
  double most = 0.0;
  for (const double x : values) most = std::max(most, std::abs(x));
  return most;
}

/// The host's stresses and energies are the point driver's, row by row.
void compare(const std::vector<DriverRow>& rows, const point::Curve& curve, const LawInfo& law,
             double& worst) {
  constexpr std::array<std::size_t, 6> order{0, 1, 2, 3, 5, 4};
  ASSERT_EQ(rows.size() + 1, curve.rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const point::Row<double>& expected = curve.rows[r + 1];
    const double size = largest_of(rows[r].stress);
    for (std::size_t i = 0; i < rows[r].stress.size(); ++i) {
      const double off = std::abs(rows[r].stress[i] - expected.stress.c[order[i]]) / size;
      worst = std::max(worst, off);
      // both meet their prescription to 1e-12 (Implicit) or better in each of 20 steps
      EXPECT_LE(off, 1e-10) << "row " << r << ", component " << i;
    }
    for (std::size_t k = 0; k < law.state.size(); ++k)
      EXPECT_NEAR(rows[r].statev[1 + k], expected.state[k], 1e-10 * std::abs(expected.state[k]))
          << "row " << r << ", " << law.state[k].name;
    // the point driver counts per initial volume, from the start
    const double J = curve.rows[0].density / expected.density;
    const double energy = std::abs(expected.work) + J * rows[r].sse;
    EXPECT_NEAR(J * (rows[r].spd + rows[r].scd), expected.dissipated, 1e-10 * energy) << r;
    if (r == 0) continue;
    const double J_first = curve.rows[0].density / curve.rows[1].density;
    EXPECT_NEAR(J * rows[r].sse - J_first * rows[0].sse, expected.stored - curve.rows[1].stored,
                1e-10 * energy)
        << r;
  }
}

/// Newton's method with DDSDDE: every miss is of the order of the square of the one before. Of the
/// last three misses those count that are small enough for the law's curvature and above round-off.
void expect_quadratic(const std::vector<DriverRow>& rows, int& pairs) {
  for (const DriverRow& row : rows)
    for (std::size_t k = 0; k < 2; ++k) {
      if (!(row.misses[k] < 1e-3 && row.misses[k] > 1e-7)) continue;
      ++pairs;
      // linear convergence, however fast, would leave a constant share
      EXPECT_LT(row.misses[k + 1], std::max(1e-14, std::pow(row.misses[k], 1.5)));
    }
}

TEST_F(UmatDriver, FindsTheStressesOfThePointDriver) {
  double worst = 0.0;
  int most_calls = 0, pairs = 0, driven = 0;
  for (const LawInfo& law : library_laws())
    for (const LawExample& example : examples_of(law))
      for (const LoadPath& path : paths)
        for (const int nshr : {3, 1}) {
          SCOPED_TRACE(material_name(law) + " " + example.label + ", " + path.name);
          const double ocr = law.state.empty() ? 0.0 : 1.3;
          const double strain = 5.0 * example.strain;
          const point::Curve curve = native(example, path, strain, ocr);
          int status = 0;
          std::string errors;
          const std::vector<DriverRow> rows =
              drive(driver_input(example, path, strain, ocr, nshr),
                    static_cast<std::size_t>(3 + nshr), 1 + law.state.size(), status, errors);
          EXPECT_EQ(status, 0) << errors;
          compare(rows, curve, law, worst);
          expect_quadratic(rows, pairs);
          for (const DriverRow& row : rows) most_calls = std::max(most_calls, row.calls);
          ++driven;
        }
  std::printf("%d paths, largest difference %.1e, %d calls per step at most, %d pairs\n", driven,
              worst, most_calls, pairs);
  EXPECT_GT(pairs, 50);
  EXPECT_LE(most_calls, 10);
}

TEST_F(UmatDriver, IsStoppedByAMaterialThatIsNone) {
  int status = 0;
  std::string errors;
  const auto rows = drive(
      "'MU_I-REGULARIZED'\n 3 3 1 1\n 0.5\n 0 0 0 0 0 0\n 0\n 1\n 1 1\n 0 0 0 0 0 0\n 0 0 0 0 0 "
      "0\n",
      6, 1, status, errors);
  EXPECT_TRUE(rows.empty());
  EXPECT_EQ(status, 2);
  EXPECT_NE(errors.find("did you mean MU_I-REGULARISED?"), std::string::npos) << errors;
}

}  // namespace
}  // namespace repose::umat

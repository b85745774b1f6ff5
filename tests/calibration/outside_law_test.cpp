/// A law from outside in everything that takes a law: it must do there what the same law does as
/// the library's own.
#include <numeric>

#include <gtest/gtest.h>

#include "calibration/fit.hpp"
#include "calibration/path_derivatives.hpp"
#include "input/law_tables.hpp"
#include "input/read_scene.hpp"
#include "models/modified_cam_clay.hpp"
#include "mpm/step/simulation.hpp"
#include "pointdriver/integrate/gradient.hpp"
#include "pointdriver/integrate/register_law.hpp"
#include "pointdriver/integrate/sensitivity.hpp"

namespace repose {
namespace {

using Own = ModifiedCamClay<Compression::v_ln_p>;

/// Modified Cam-Clay by another name.
struct OutsideClay : Own {
  static constexpr std::string_view name = "outside_clay";
  static constexpr std::string_view option_key = "";
  static constexpr std::string_view option = "";
};

/// The same, registered without a point driver.
struct UndrivenClay : OutsideClay {
  static constexpr std::string_view name = "undriven_clay";
};

class OutsideLawInUse : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    point::register_law<OutsideClay>();
    repose::register_law<UndrivenClay>();
  }

  std::map<std::string, double> values{{"M", 0.95},      {"lambda", 0.093}, {"kappa", 0.035},
                                       {"nu", 0.3},      {"Gamma", 2.06},   {"p_ref", 1e3},
                                       {"rho_p", 2700.0}};
  LawSpec own{"modified_cam_clay", {{"compression", "v-ln_p"}}, values};
  LawSpec outside{"outside_clay", {}, values};
  LawSpec undriven{"undriven_clay", {}, values};
  std::vector<double> theta = checked_parameters(own);

  static point::PointTest drained(int points) {
    point::Stage shear;
    shear.condition = point::Condition::drained;
    shear.goal = point::Goal{point::Quantity::eps_a, 0.1};
    shear.points = points;
    point::PointTest test;
    test.path = point::path_of({shear});
    test.initial.p = 2e5;
    test.initial.ocr = 1.5;
    return test;
  }
};

/// Two compilations of the same formulas round differently (contraction to fused operations), by a
/// few units in the last place of each of some 1e3 steps: 1e3 · 4 · 1.1e-16 < 1e-12, and what is
/// differentiated or fitted is as well conditioned here; 1e-9 leaves room for the error control to
/// choose other steps, within its tolerance of 1e-8 a step, of which the global error is a part.
constexpr double same = 1e-9;

void expect_same(const std::vector<double>& a, const std::vector<double>& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  ASSERT_FALSE(a.empty()) << what;
  double size = 0.0;
  for (const double x : a) size = std::max(size, std::abs(x));
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], same * size) << what << i;
}

TEST_F(OutsideLawInUse, IsDrivenAlongAPath) {
  for (const point::Method method :
       {point::Method::automatic, point::Method::adaptive, point::Method::implicit,
        point::Method::cvode, point::Method::ida, point::Method::arkode}) {
    point::PointTest test = drained(20);
    test.settings.method = method;
    EXPECT_EQ(point::method_for(find_law(outside), method),
              point::method_for(find_law(own), method));
    point::Curve a, b;
    ASSERT_EQ(point::simulate(find_law(own), theta, test, a).status, point::Status::completed);
    ASSERT_EQ(point::simulate(find_law(outside), theta, test, b).status, point::Status::completed);
    for (const point::Quantity q :
         {point::Quantity::q, point::Quantity::eps_v, point::Quantity::v, point::Quantity::p_c}) {
      std::vector<double> x, y;
      point::read_column(find_law(own), theta, test, a, q, x);
      point::read_column(find_law(outside), theta, test, b, q, y);
      expect_same(x, y, point::column_name(q).data());
    }
  }
  point::PointTest bad = drained(20);
  bad.initial.ocr = 0.5;
  point::Curve curve;
  EXPECT_EQ(point::simulate(find_law(outside), theta, bad, curve).status,
            point::Status::bad_initial);
  EXPECT_NE(point::explain(find_law(outside), theta, bad, curve).find("ocr"), std::string::npos);
}

TEST_F(OutsideLawInUse, HasDerivatives) {
  const point::PointTest test = drained(10);
  std::vector<int> which(5);
  std::iota(which.begin(), which.end(), 0);
  const std::vector<point::Quantity> wanted{point::Quantity::q, point::Quantity::eps_v,
                                            point::Quantity::v};
  std::vector<double> given = theta;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (!values.contains(std::string(Own::parameters[i].name)) &&
        Own::parameters[i].need == Need::optional)
      given[i] = std::nan("");
  std::vector<point::GradientColumn> a, b;
  point::simulate_columns_with_gradient(find_law(own), given, which, test, wanted, a);
  point::simulate_columns_with_gradient(find_law(outside), given, which, test, wanted, b);
  for (std::size_t c = 0; c < wanted.size(); ++c) {
    expect_same(a[c].values, b[c].values, "value ");
    expect_same(a[c].derivatives, b[c].derivatives, "derivative ");
  }
}

TEST_F(OutsideLawInUse, IsFitted) {
  point::PointTest test = drained(10);
  point::Curve curve;
  point::simulate(find_law(own), theta, test, curve);
  calibration::Experiment experiment;
  experiment.name = "drained";
  experiment.test = drained(1);
  std::vector<double> q;
  point::read_column(find_law(own), theta, test, curve, point::Quantity::q, q);
  q.erase(q.begin());
  for (std::size_t i = 0; i < q.size(); ++i) {
    experiment.abscissae.push_back(0.01 * static_cast<double>(i + 1));
    q[i] += (i % 2 == 0 ? 300.0 : -300.0);
  }
  experiment.measured = {{point::Quantity::q, q, 300.0}};
  std::vector<calibration::FreeParameter> free(2);
  free[0] = {"M", "-", 0.6, 1.4};
  free[1] = {"ocr", "-", 1.0, 3.0};
  std::vector<calibration::FitResult> results;
  for (LawSpec spec : {own, outside}) {
    spec.values.erase("M");
    results.push_back(calibration::fit(spec, free, {experiment}, {.starts = 2}));
    EXPECT_FALSE(results.back().failed);
    // M from ten rows of ±300 Pa in a q of 1.5e5 to 2.5e5 Pa: off by 1e-3 at the most
    EXPECT_NEAR(results.back().values[0].value, 0.95, 0.01);
  }
  for (std::size_t i = 0; i < free.size(); ++i) {
    // the search ends where the objective is flat to 1e-14: parameters agree to its root
    EXPECT_NEAR(results[0].values[i].value, results[1].values[i].value, 1e-6);
    EXPECT_NEAR(results[0].values[i].standard_error, results[1].values[i].standard_error,
                1e-3 * results[0].values[i].standard_error);
  }
  free[0].name = "N";
  free[0].name += "o";
  EXPECT_THROW(calibration::fit(outside, free, {experiment}), InputError);
}

TEST_F(OutsideLawInUse, IsReadFromASceneAndCollapses) {
  const auto scene_of = [](const std::string& law) {
    input::InputFile file = input::InputFile::parse(
        "[scene]\nend_time = 0.01\n[domain]\nsize = [0.2, 0.1]\n[[body]]\norigin = [0.0, 0.0]\n"
        "size = [0.05, 0.05]\ninitial = { p = 100.0, ocr = 1.0 }\n[body.law]\n" +
            law +
            "\nM = 0.95\nlambda = 0.093\nkappa = 0.035\nnu = 0.3\nGamma = 2.06\np_ref = 1e3\n"
            "rho_p = 2700.0\n[grid]\nh = 0.0125\n",
        "heap.toml");
    return input::read_scene(file).scene;
  };
  std::vector<double> fronts;
  for (const char* law :
       {"name = \"modified_cam_clay\"\ncompression = \"v-ln_p\"", "name = \"outside_clay\""}) {
    mpm::Simulation simulation(scene_of(law), 1);
    while (simulation.time() < 0.01) simulation.step(0.01);
    fronts.push_back(simulation.diagnostics().kinetic_J_per_m);
    EXPECT_GT(fronts.back(), 0.0);
  }
  EXPECT_NEAR(fronts[0], fronts[1], same * fronts[0]);
  EXPECT_NE(input::law_list().find("outside_clay"), std::string::npos);
  EXPECT_NE(input::law_description("outside_clay").find("lambda"), std::string::npos);
}

TEST_F(OutsideLawInUse, WithoutADriverSaysSo) {
  EXPECT_NO_THROW(make_material(undriven));
  const LawInfo& law = find_law(undriven);
  const point::PointTest test = drained(5);
  point::Curve curve;
  std::vector<calibration::Column> columns;
  std::vector<int> legs;
  point::GradientCurve gradient;
  std::vector<point::CvodesRow> rows;
  const std::vector<int> which{0};
  std::vector<double> inputs = theta;
  inputs.resize(theta.size() + calibration::initial_input_count, std::nan(""));
  const std::vector<point::Quantity> wanted{point::Quantity::q};
  const auto expect_error = [](const char* mark, auto&& action) {
    try {
      action();
      ADD_FAILURE() << "nothing was thrown";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(mark), std::string::npos) << error.what();
    }
  };
  const char* mark = "without a point driver";
  expect_error(mark, [&] { point::simulate(law, theta, test, curve); });
  expect_error(mark, [&] { point::method_for(law, point::Method::automatic); });
  expect_error(mark, [&] { point::check_start(law, theta, test); });
  expect_error(mark, [&] { point::simulate_with_gradient(law, theta, which, test, gradient); });
  expect_error(mark, [&] {
    calibration::simulate_with_derivatives(law, test.initial, inputs, which, test, wanted, columns,
                                           legs);
  });
  expect_error("library's own",
               [&] { point::cvodes_gradient(find_law(outside), theta, 0, test, rows); });
}

}  // namespace
}  // namespace repose

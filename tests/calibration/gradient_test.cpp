// Exact derivatives of residuals against finite differences, through yield and from the initial
// state; interpolation and distance; parameter coordinates.

#include <gtest/gtest.h>

#include "calibration/path_derivatives.hpp"
#include "study/fit/twin.hpp"
#include "tests/calibration/toy.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Central differences of order 4 in each coordinate.
MatrixXd differences(const Problem& problem, const VectorXd& z, double h) {
  MatrixXd J(problem.size(), z.size());
  Evaluation e;
  for (Index j = 0; j < z.size(); ++j) {
    const auto at = [&](double shift) {
      VectorXd moved = z;
      moved[j] += shift;
      problem.evaluate(moved, false, e);
      return e.r;
    };
    J.col(j) = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
  }
  return J;
}

void expect_exact(const Problem& problem, const VectorXd& z, double h, double tolerance,
                  const std::string& what) {
  Evaluation e;
  problem.evaluate(z, true, e);
  ASSERT_FALSE(e.failed) << what;
  const MatrixXd expected = differences(problem, z, h);
  for (Index j = 0; j < z.size(); ++j) {
    const double size = expected.col(j).norm();
    const double error = (e.J.col(j) - expected.col(j)).norm() / size;
    EXPECT_LT(error, tolerance) << what << ": "
                                << problem.space()[static_cast<std::size_t>(j)].name;
    std::printf("[ measured ] %s, %s: derivative differs by %.1e\n", what.c_str(),
                problem.space()[static_cast<std::size_t>(j)].name.c_str(), error);
  }
}

// Paths to 1e-12 per step leave 1e-11 in r; over 12 h/8 = 4.5e-4 of central differences that is
// 2e-8, and the truncation h⁴ f⁽⁵⁾/30 ~ 1e-11: 1e-6 leaves room for rows right after yield.
TEST(Gradient, IsExactThroughYieldForEveryParameterAndTheInitialState) {
  for (const char* compression : {"v-ln_p", "ln_v-ln_p"}) {
    study::Twin twin = study::cam_clay_twin(compression);
    std::vector<study::TwinTest> tests = study::cam_clay_tests();
    for (study::TwinTest& t : tests) t.tolerance = 1e-12;
    std::vector<Target> targets;
    for (const study::TwinTest& t : tests) targets.push_back(study::measure(twin, t));
    // the overconsolidated test starts inside the yield surface and yields on its way
    FreeParameter ocr;
    ocr.name = "ocr of drained";
    ocr.lower = 1.0;
    ocr.upper = 8.0;
    twin.free.push_back(ocr);
    targets[2].bindings.push_back(
        {static_cast<int>(twin.theta.size()) + input_ocr, static_cast<int>(twin.free.size()) - 1});
    FreeParameter p;
    p.name = "p of undrained";
    p.unit = "Pa";
    p.lower = 100e3;
    p.upper = 400e3;
    p.scale = Scale::log;
    twin.free.push_back(p);
    targets[1].bindings.push_back(
        {static_cast<int>(twin.theta.size()) + input_p, static_cast<int>(twin.free.size()) - 1});
    const Problem problem(ParameterSpace(twin.free), targets);
    VectorXd z(7);
    z << 0.41, 0.6, 0.45, 0.55, 0.48, 0.37, 0.52;
    expect_exact(problem, z, 3e-4, 1e-6, compression);
  }
}

// At ocr = 1, the least that is admissible, v = N − λ ln(ocr p/p_ref) + κ ln ocr has the slope κ −
// λ.
TEST(Gradient, IsOfSecondOrderAtABoundOfTheInitialState) {
  const LawSpec spec{"modified_cam_clay",
                     {{"compression", "v-ln_p"}},
                     {{"M", 1.0}, {"lambda", 0.2}, {"kappa", 0.04}, {"nu", 0.3}, {"N", 3.0}}};
  const LawInfo& law = find_law(spec);
  std::vector<double> inputs = checked_parameters(spec);
  const auto n = static_cast<int>(inputs.size());
  inputs.resize(inputs.size() + initial_input_count, std::nan(""));
  inputs[static_cast<std::size_t>(n + input_p)] = 1e5;
  inputs[static_cast<std::size_t>(n + input_ocr)] = 1.0;
  point::Stage stage;
  stage.goal = point::Goal{point::Quantity::eps_a, 0.01};
  point::PointTest test;
  test.path = point::path_of({stage});
  const std::array<int, 1> wanted{n + input_ocr};
  const std::array<point::Quantity, 1> quantities{point::Quantity::v};
  std::vector<Column> columns;
  std::vector<int> legs;
  simulate_with_derivatives(law, {}, inputs, wanted, test, quantities, columns, legs);
  ASSERT_GT(columns[0].slope.rows(), 0);
  // one-sided with h = 1e-5: h²/3 v′′′ = 1e-11, and 4 ε v/h = 2e-10; to first order h/2 v″ = 8e-7
  EXPECT_NEAR(columns[0].slope(0, 0), 0.04 - 0.2, 1e-9);
}

TEST(Gradient, IsExactForTheFlowCurve) {
  study::Twin twin;
  const LawSpec spec{"mu_i",
                     {{"form", "elastoviscoplastic"}},
                     {{"mu_0", 0.38},
                      {"mu_d", 0.64},
                      {"I_0", 0.279},
                      {"d", 5e-4},
                      {"rho_p", 2500.0},
                      {"rho_0", 1500.0},
                      {"K", 5e6}}};
  twin.law = &find_law(spec);
  twin.theta = checked_parameters(spec);
  twin.make_free("mu_d", 0.5, 1.2);
  twin.make_free("mu_0", 0.1, 0.95, Scale::linear, 0);
  twin.make_free("I_0", 0.01, 3.0, Scale::log);
  study::TwinTest curve;
  curve.name = "flow curve";
  const std::vector<double> rates{3.0, 30.0, 300.0, 3000.0};
  curve.path = flow_curve_path(rates, point::Condition::constant_volume, 0.5);
  curve.initial.p = 5e3;
  curve.x = point::Quantity::shear_rate;
  curve.y = {point::Quantity::tau};
  curve.rows = Rows::leg_ends;
  const Problem problem = study::twin_problem(twin, {curve});
  VectorXd z(3);
  z << 0.3, 0.6, 0.5;
  expect_exact(problem, z, 1e-3, 1e-6, "mu(I)");
}

/// A parabola x = t, y = a t² + b (rows along, not at the data).
class Parabola final : public Simulator {
 public:
  const std::vector<std::string>& inputs() const override {
    static const std::vector<std::string> names{"a", "b"};
    return names;
  }
  bool has_derivatives() const override { return true; }
  void simulate(std::span<const double> in, std::span<const int> wanted,
                Response& r) const override {
    r = {};
    r.x = VectorXd::LinSpaced(201, 0.0, 2.0);
    r.y = (in[0] * r.x.array().square() + in[1]).matrix();
    r.dx = MatrixXd::Zero(201, static_cast<Index>(wanted.size()));
    r.dy.assign(1, r.dx);
    for (std::size_t k = 0; k < wanted.size(); ++k)
      r.dy[0].col(static_cast<Index>(k)) =
          wanted[k] == 0 ? VectorXd(r.x.array().square()) : VectorXd::Ones(201);
  }
};

Problem parabola(Compare compare) {
  Target t;
  t.name = "parabola";
  t.simulator = std::make_shared<Parabola>();
  t.inputs = {1.0, 0.0};
  t.bindings = {{0, 0}, {1, 1}};
  t.compare = compare;
  t.x = (VectorXd(4) << 0.333, 0.8123, 1.307, 1.655).finished();
  t.channels.push_back({"y", (VectorXd(4) << 0.3, 0.5, 2.1, 2.2).finished(), {}, 1.0});
  return Problem(ParameterSpace({free_parameter("a", 0.5, 2.0), free_parameter("b", -1.0, 1.0)}),
                 {t});
}

TEST(Gradient, OfInterpolationAndDistance) {
  const VectorXd z = (VectorXd(2) << 0.4, 0.55).finished();
  // values are linear in a and b between rows: differences are exact to round-off 1e-16/1e-5
  expect_exact(parabola(Compare::interpolate), z, 1e-5, 1e-9, "interpolate");
  // the foot point moves within its segment, and the normal there is constant: exact as well
  expect_exact(parabola(Compare::distance), z, 1e-5, 1e-6, "distance");
}

TEST(Residuals, DistanceIsMeasuredAlongTheNormal) {
  Problem problem = parabola(Compare::distance);
  Evaluation e;
  // y = x² + 0 at the data's scaled axes
  VectorXd z = problem.space().coordinates((VectorXd(2) << 1.0, 0.0).finished());
  problem.evaluate(z, false, e);
  const Target& t = problem.targets()[0];
  const double sy = scale_of(t.channels[0]), sx = t.x.maxCoeff() - t.x.minCoeff();
  for (Index i = 0; i < 4; ++i) {
    double least = 1e9;
    for (double x = 0.0; x <= 2.0; x += 1e-5)
      least =
          std::min(least, std::hypot((x - t.x[i]) / sx, (x * x - t.channels[0].observed[i]) / sy));
    // chords of 0.01 lie (0.01)²/4 = 2.5e-5 above the parabola, scaled by 1/sy ~ 0.5
    EXPECT_NEAR(std::abs(e.r[i]), least, 2e-5) << i;
    // above the curve: simulated − observed < 0
    const double vertical = t.x[i] * t.x[i] - t.channels[0].observed[i];
    EXPECT_EQ(e.r[i] < 0.0, vertical < 0.0) << i;
  }
}

TEST(Residuals, ManyRowsDoNotDrownFew) {
  const auto target = [](int n, double offset) {
    std::vector<double> x;
    for (int i = 0; i < n; ++i) x.push_back(i / (n - 1.0));
    Target t;
    t.simulator = std::make_shared<Line>(x);
    t.inputs = {0.0, 0.0};
    t.bindings = {{0, 0}};
    t.x = Eigen::Map<VectorXd>(x.data(), n);
    Channel c{"y", VectorXd::Constant(n, offset), 1.0, 1.0};
    t.channels.push_back(c);
    return t;
  };
  // one says a = 0 with 10 rows, the other a = 1 with 1000: balanced, the answer lies between
  const ParameterSpace space({free_parameter("a", -5.0, 5.0)});
  const Problem balanced(space, {target(10, 0.0), target(1000, 1.0)});
  const Problem by_rows(space, {target(10, 0.0), target(1000, 1.0)}, false);
  const VectorXd z = VectorXd::Constant(1, 0.5);
  EXPECT_NEAR(space.values(levenberg_marquardt(balanced, z).z)[0], 0.5, 1e-9);
  EXPECT_NEAR(space.values(levenberg_marquardt(by_rows, z).z)[0], 1000.0 / 1010.0, 1e-9);
}

TEST(ParameterSpace, RatiosKeepTheOrderEverywhere) {
  const study::Twin twin = study::cam_clay_twin();
  const ParameterSpace space(twin.free);
  for (std::size_t k = 0; k < 200; ++k) {
    const VectorXd z = space.spread_point(k, 3);
    const VectorXd v = space.values(z);
    EXPECT_LT(v[2], v[1]);  // κ < λ
    EXPECT_LT((space.coordinates(v) - z).cwiseAbs().maxCoeff(), 1e-12);
    const MatrixXd slopes = space.slopes(z);
    for (Index j = 0; j < 5; ++j) {
      VectorXd a = z, b = z;
      a[j] += 1e-5;
      b[j] -= 1e-5;
      EXPECT_LT(((space.values(a) - space.values(b)) / 2e-5 - slopes.col(j)).cwiseAbs().maxCoeff(),
                1e-8);  // h² f‴/6 with f‴ < 20
    }
  }
}

TEST(ParameterSpace, SaysWhatIsWrong) {
  const auto message = [](FreeParameter p) {
    try {
      ParameterSpace({p});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message(free_parameter("M", 2.0, 1.0)), "M needs finite bounds with lower < upper");
  EXPECT_EQ(message(free_parameter("lambda", 0.0, 1.0, Scale::log)),
            "lambda: a logarithmic scale needs lower > 0");
  FreeParameter p = free_parameter("M", 0.0, 1.0);
  p.prior = Prior{0.5, 0.0};
  EXPECT_EQ(message(p), "M: a prior needs a finite mean and sd > 0");
}

TEST(PointSimulator, RowsStandExactlyAtTheData) {
  const study::Twin twin = study::cam_clay_twin();
  for (const study::TwinTest& test : study::cam_clay_tests()) {
    const Target t = study::measure(twin, test);
    ASSERT_EQ(t.x.size(), static_cast<Index>(test.abscissae.size()));
    for (Index i = 0; i < t.x.size(); ++i)
      // ends of legs are timed, x = rate · time: round-off of the time only
      EXPECT_NEAR(t.x[i], test.abscissae[static_cast<std::size_t>(i)],
                  1e-9 * std::abs(test.abscissae.back()) * 10.0)
          << test.name;
  }
}

TEST(PointSimulator, RefusesRowsThatTheTestDoesNotPass) {
  study::TwinTest test = study::cam_clay_tests()[0];
  test.abscissae = {100e3, 900e3};
  try {
    study::measure(study::cam_clay_twin(), test);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "the row at p_Pa = 900000 is not on the way of the test, which leads from 50000 to "
              "800000, 100000: rows must stand in the order of the test; leave the test's end out "
              "to drive it to the last row");
  }
}

}  // namespace
}  // namespace repose::calibration

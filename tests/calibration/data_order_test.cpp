// Where rows of data stand on the path of their test: the first row and the start, rows of a loop,
// rows beyond the end, readings that scatter, engineering strains.

#include <gtest/gtest.h>

#include "calibration/multistart.hpp"
#include "study/fit/twin.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using point::Condition;
using point::Drive;
using point::Kind;
using point::Quantity;
using study::stage;
using study::Twin;
using study::TwinTest;

/// M = 1, λ = 0.2, κ = 0.04, ν = 0.3, N = 3 on v – ln p lines.
Twin clay() {
  const LawSpec spec{"modified_cam_clay",
                     {{"compression", "v-ln_p"}},
                     {{"M", 1.0}, {"lambda", 0.2}, {"kappa", 0.04}, {"nu", 0.3}, {"N", 3.0}}};
  Twin twin;
  twin.law = &find_law(spec);
  twin.theta = checked_parameters(spec);
  // Gamma follows from N, which may be free
  twin.theta[static_cast<std::size_t>(twin.index("Gamma"))] = std::nan("");
  return twin;
}

PointExperiment experiment(const Twin& twin, const TwinTest& test) {
  PointExperiment e;
  e.law = twin.law;
  e.theta = twin.theta;
  e.test.path = point::path_of(test.stages);
  e.test.initial = test.initial;
  e.test.settings.tolerance = test.tolerance;
  e.x = test.x;
  e.y = test.y;
  e.rows = test.rows;
  e.abscissae = test.abscissae;
  return e;
}

Response simulated(const Twin& twin, const PointExperiment& e) {
  const auto simulator = make_point_simulator(e);
  std::vector<double> inputs = twin.theta;
  inputs.resize(inputs.size() + initial_input_count, std::nan(""));
  Response r;
  simulator->simulate(inputs, {}, r);
  return r;
}

Target target_of(const Twin& twin, const PointExperiment& e, const VectorXd& x,
                 const VectorXd& observed, double noise) {
  Target t;
  t.name = "data";
  t.simulator = make_point_simulator(e);
  t.inputs = twin.theta;
  t.inputs.resize(t.inputs.size() + initial_input_count, std::nan(""));
  for (std::size_t i = 0; i < twin.free.size(); ++i)
    t.bindings.push_back({twin.index(twin.free[i].name), static_cast<int>(i)});
  t.x = x;
  t.channels.push_back({"y", observed, noise, 1.0});
  return t;
}

VectorXd best(const Twin& twin, Target target) {
  const Problem problem(ParameterSpace(twin.free), {std::move(target)});
  FitOptions options;
  options.starts = 4;
  const auto results = run_starts(problem, options);
  const StartResult* least = &results.front();
  for (const StartResult& r : results)
    if (r.optimum.objective < least->optimum.objective) least = &r;
  return problem.space().values(least->optimum.z);
}

TwinTest from_K0() {
  TwinTest test;
  test.initial.p = 80e3;
  test.initial.K0 = 0.7;  // σ_v = 3·80/2.4 = 100 kPa, q = 30 kPa
  return test;
}

// The first row lies 20 kPa beyond the start: it is no image of the start.
TEST(FirstRow, IsReachedFromTheStartOfAnOedometer) {
  const Twin twin = clay();
  TwinTest test = from_K0();
  test.stages = {
      stage(Kind::oedometer, Condition::drained, Quantity::sigma_a, 400e3, Drive::stress)};
  test.x = Quantity::sigma_a;
  test.y = {Quantity::eps_a, Quantity::v};
  test.abscissae = {120e3, 150e3, 200e3, 250e3, 300e3, 400e3};
  const Response r = simulated(twin, experiment(twin, test));
  ASSERT_EQ(r.x.size(), 6);
  // from another integration of the same law, given to eight digits
  EXPECT_NEAR(r.y(0, 0), 0.0175779046, 1e-8);
  EXPECT_NEAR(r.y(0, 1), 2.065907095, 1e-8);
  EXPECT_NEAR(r.y(5, 0), 0.141525938, 1e-8);
}

TEST(FirstRow, MayLieOnTheOtherSideOfZero) {
  const Twin twin = clay();
  TwinTest test = from_K0();
  test.stages = {stage(Kind::triaxial, Condition::drained, Quantity::q, -20e3, Drive::stress)};
  test.x = Quantity::q;
  test.y = {Quantity::eps_a};
  test.abscissae = {20e3, 10e3, 0.0, -10e3, -20e3};
  const Response r = simulated(twin, experiment(twin, test));
  ASSERT_EQ(r.x.size(), 5);
  // from another integration, nine digits
  EXPECT_NEAR(r.y(0, 0), -0.00202337859, 1e-8);
  EXPECT_NEAR(r.y(4, 0), -0.0110864464, 1e-8);
}

// The start follows from v and the compression line, which is fitted: v = N − λ ln p.
TEST(FirstRow, IsReachedFromAStartThatMovesWithTheParameters) {
  Twin twin = clay();
  TwinTest test;
  test.initial.v = 3.0 - 0.2 * std::log(50.0);
  test.initial.ocr = 1.0;
  test.stages = {stage(Kind::isotropic, Condition::drained, Quantity::p, 400e3, Drive::stress)};
  test.x = Quantity::p;
  test.y = {Quantity::v};
  test.abscissae = {100e3, 150e3, 200e3, 300e3, 400e3};
  PointExperiment e = experiment(twin, test);
  e.start_moves = true;
  VectorXd x(5), v(5);
  for (Index i = 0; i < 5; ++i) {
    x[i] = test.abscissae[static_cast<std::size_t>(i)];
    v[i] = 3.0 - 0.2 * std::log(1e-3 * x[i]);
  }
  EXPECT_NEAR(v[0], 2.07897, 5e-6);
  const Response r = simulated(twin, e);
  for (Index i = 0; i < 5; ++i) EXPECT_NEAR(r.y(i, 0), v[i], 1e-8) << i;
  twin.make_free("lambda", 0.1, 0.5);
  twin.make_free("N", 2.0, 4.0);
  const VectorXd found = best(twin, target_of(twin, e, x, v, 1e-3));
  // 1e-9 per step in v of 2, slopes of v to λ and N of 5 and 1
  EXPECT_NEAR(found[0], 0.2, 1e-6);
  EXPECT_NEAR(found[1], 3.0, 1e-5);
}

/// Loading, unloading and reloading in confined compression, by strain: rows every 0.01.
struct Loop {
  VectorXd x, sigma_a;
};
Loop measured_loop(const Twin& twin) {
  TwinTest test;
  test.initial.p = 50e3;
  test.initial.ocr = 1.0;
  for (const double end : {0.1, 0.08, 0.15})
    test.stages.push_back(stage(Kind::oedometer, Condition::drained, Quantity::eps_a, end));
  test.x = Quantity::eps_a;
  test.y = {Quantity::sigma_a};
  test.abscissae = {0.02,  0.04, 0.06, 0.08, 0.1,  0.095, 0.09,
                    0.085, 0.08, 0.09, 0.1,  0.11, 0.13,  0.15};
  const Response r = simulated(twin, experiment(twin, test));
  return {r.x, r.y.col(0)};
}

// Driven by stress and compared over strain: every row has three places on the curve, and the order
// of the rows says which.
TEST(Interpolation, FollowsThePathWhereXTurnsRound) {
  Twin twin = clay();
  const Loop loop = measured_loop(twin);
  TwinTest test;
  test.initial.p = 50e3;
  test.initial.ocr = 1.0;
  for (const Index turn : {4, 8, 13})
    test.stages.push_back(stage(Kind::oedometer, Condition::drained, Quantity::sigma_a,
                                loop.sigma_a[turn], Drive::stress));
  test.x = Quantity::eps_a;
  test.y = {Quantity::sigma_a};
  test.rows = Rows::along;
  twin.make_free("lambda", 0.05, 0.5);
  twin.make_free("kappa", 0.05, 0.8, Scale::linear, 0);
  Target t = target_of(twin, experiment(twin, test), loop.x, loop.sigma_a, 1e3);
  t.compare = Compare::interpolate;
  t.continues = true;
  const VectorXd found = best(twin, t);
  // 200 rows per stage: chords of an exponential miss by (Δ ln σ)²/8 = (1.3/200)²/8 = 5e-6 of σ,
  // and σ changes by its own size over λ
  EXPECT_NEAR(found[0], 0.2, 1e-4);
  EXPECT_NEAR(found[1], 0.04, 1e-4);
}

/// y = x along x = 0 → turn → back to `back`.
class OutAndBack final : public Simulator {
 public:
  explicit OutAndBack(double back) : back_(back) {}
  const std::vector<std::string>& inputs() const override {
    static const std::vector<std::string> names{"turn"};
    return names;
  }
  bool has_derivatives() const override { return false; }
  void simulate(std::span<const double> in, std::span<const int>, Response& r) const override {
    r = {};
    r.x = (VectorXd(3) << 0.0, in[0], back_).finished();
    r.y = (VectorXd(3) << 0.0, in[0], in[0] + 10.0 * (back_ - in[0])).finished();
    r.dx = Eigen::MatrixXd::Zero(3, 0);
    r.dy.assign(1, r.dx);
  }

 private:
  double back_;
};

TEST(Interpolation, ContinuesABranchThatEndsTooEarly) {
  Target t;
  t.simulator = std::make_shared<OutAndBack>(0.5);
  t.x = (VectorXd(4) << 0.5, 1.0, 0.9, 0.6).finished();
  t.channels.push_back({"y", VectorXd::LinSpaced(4, 0.0, 1.0), 1.0, 1.0});
  t.compare = Compare::interpolate;
  t.continues = true;
  Response r;
  Misfit m;
  const auto at = [&](double turn) {
    t.simulator->simulate(std::span(&turn, 1), {}, r);
    misfit(t, r, m);
  };
  at(1.0);
  const std::array<double, 4> expected{0.5, 1.0, 0.0, -3.0};
  for (Index i = 0; i < 4; ++i)
    EXPECT_NEAR(m.simulated(i, 0), expected[static_cast<std::size_t>(i)], 1e-14) << i;
  EXPECT_EQ(m.beyond, 0);
  at(0.8);  // 1.0 on the continuation of the way out, 0.9 of the way back
  EXPECT_NEAR(m.simulated(1, 0), 1.0, 1e-15);
  EXPECT_NEAR(m.simulated(2, 0), 0.8 + 10.0 * 0.1, 1e-14);
  EXPECT_EQ(m.beyond, 2);
  t.continues = false;
  at(0.8);
  EXPECT_EQ(m.simulated(1, 0), 0.8) << "the end of the branch itself";
}

point::Path oedometer_path(std::initializer_list<double> ends, bool of_stage) {
  std::vector<point::Stage> stages;
  for (const double end : ends) {
    stages.push_back(stage(Kind::oedometer, Condition::drained, Quantity::eps_a, end));
    stages.back().goal->of_stage = of_stage;
  }
  return point::path_of(stages);
}

std::vector<double> ends_of(const point::Path& path) {
  std::vector<double> ends;
  for (const point::Leg& leg : path.legs) ends.push_back(leg.spec().goal->value);
  return ends;
}

TEST(Split, StageStrainsCountFromTheStartOfTheStage) {
  std::vector<int> legs;
  const std::vector<double> x{0.05, 0.1, 0.09, 0.08, 0.1};
  const point::Path path =
      split_at(oedometer_path({0.1, -0.02, 0.03}, true), Quantity::eps_a, 0.0, x, {}, legs);
  EXPECT_EQ(ends_of(path), (std::vector<double>{0.05, 0.1, 0.09, 0.08, 0.1}));
  EXPECT_EQ(legs, (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(Split, ReadingsThatScatterAreNoReversals) {
  std::vector<int> legs;
  const std::vector<double> x{-0.0002, 0.0, 0.02, 0.04, 0.0399, 0.05, 0.1};
  const point::Path path = split_at(oedometer_path({0.1}, true), Quantity::eps_a, 0.0, x, {}, legs);
  EXPECT_EQ(ends_of(path), (std::vector<double>{0.02, 0.0399, 0.04, 0.05, 0.1}));
  EXPECT_EQ(legs, (std::vector<int>{-1, -1, 0, 2, 1, 3, 4}));
}

// Just before a reversal a small step back is the reversal.
TEST(Split, ASmallStepBackThatIsNotMadeGoodBelongsToTheNextStage) {
  std::vector<int> legs;
  const std::vector<double> x{0.05, 0.1, 0.0995, 0.09};
  const point::Path path =
      split_at(oedometer_path({0.1, -0.02}, true), Quantity::eps_a, 0.0, x, {}, legs);
  EXPECT_EQ(ends_of(path), (std::vector<double>{0.05, 0.1, 0.0995, 0.09}));
  EXPECT_EQ(path.legs[2].spec().continues, false);
  EXPECT_EQ(path.legs[3].spec().continues, true);
}

TEST(Split, RowsThatOnlyTotalsPassAreTakenAsTotals) {
  const Twin twin = clay();
  TwinTest test;
  test.initial.p = 50e3;
  test.x = Quantity::eps_a;
  test.abscissae = {0.05, 0.1, 0.09, 0.08, 0.12};
  test.stages = {stage(Kind::oedometer, Condition::drained, Quantity::eps_a, 0.1)};
  PointExperiment e = experiment(twin, test);
  e.test.path = oedometer_path({0.1, 0.08, 0.15}, true);
  EXPECT_TRUE(take_stage_strains_as_totals(e));
  EXPECT_EQ(ends_of(e.test.path), (std::vector<double>{0.1, 0.08, 0.15}));
  EXPECT_FALSE(e.test.path.legs[1].spec().goal->of_stage);
  e.test.path = oedometer_path({0.1, -0.02, 0.07}, true);
  EXPECT_FALSE(take_stage_strains_as_totals(e)) << "the rows agree with the stages";
  e.test.path = oedometer_path({0.1, -0.01, 0.07}, true);
  EXPECT_FALSE(take_stage_strains_as_totals(e)) << "neither does";
}

// A sample that is 14 % shorter has the logarithmic strain −ln 0.86; its table says 0.14.
TEST(EngineeringStrain, IsComparedWithTheSame) {
  Twin twin = clay();
  const Loop loop = measured_loop(twin);
  TwinTest test;
  test.initial.p = 50e3;
  test.initial.ocr = 1.0;
  for (const double end : {0.1, 0.08, 0.15})
    test.stages.push_back(stage(Kind::oedometer, Condition::drained, Quantity::eps_a, end));
  test.x = Quantity::eps_a;
  test.y = {Quantity::sigma_a};
  for (const double x : loop.x)
    test.abscissae.push_back(x);  // where the path is split: logarithmic
  PointExperiment e = experiment(twin, test);
  e.test.path.measure = point::StrainMeasure::engineering;
  const Response r = simulated(twin, e);
  for (Index i = 0; i < r.x.size(); ++i) {
    EXPECT_NEAR(r.x[i], 1.0 - std::exp(-loop.x[i]), 1e-12) << i;
    EXPECT_NEAR(r.y(i, 0), loop.sigma_a[i], 1e-6) << i;
  }
}

}  // namespace
}  // namespace repose::calibration

#pragma once
/// \file
/// Twin experiments: data made by a law with known parameters, then fitted.

#include <random>

#include "calibration/multistart.hpp"
#include "calibration/path_derivatives.hpp"
#include "calibration/point_simulator.hpp"
#include "models/registry.hpp"

namespace repose::study {

/// A law with the parameters that made the data, and which of them are free.
struct Twin {
  const LawInfo* law = nullptr;
  std::vector<double> theta;  ///< truth, table order
  std::vector<calibration::FreeParameter> free;
  std::vector<double> truth;  ///< of the free ones

  int index(std::string_view name) const {
    for (std::size_t i = 0; i < law->parameters.size(); ++i)
      if (law->parameters[i].name == name) return static_cast<int>(i);
    return -1;
  }
  void make_free(std::string name, double lower, double upper, Scale scale = Scale::linear,
                 int of = -1) {
    truth.push_back(theta[static_cast<std::size_t>(index(name))]);
    calibration::FreeParameter p;
    p.name = std::move(name);
    p.lower = lower;
    p.upper = upper;
    p.scale = scale;
    p.of = of;
    free.push_back(p);
  }
  Eigen::VectorXd truth_vector() const {
    return Eigen::Map<const Eigen::VectorXd>(truth.data(), static_cast<Eigen::Index>(truth.size()));
  }
};

/// What a twin test is made of; data are added by measure().
struct TwinTest {
  std::string name;
  std::vector<point::Stage> stages;
  InitialConditions initial;
  point::Quantity x;
  std::vector<point::Quantity> y;
  std::vector<double> abscissae{};
  std::optional<point::Path> path{};  ///< instead of stages
  calibration::Rows rows = calibration::Rows::at_data;
  double tolerance = 1e-9;
};

inline std::vector<double> evenly(double from, double to, int n) {
  std::vector<double> x;
  for (int i = 1; i <= n; ++i) x.push_back(from + (to - from) * i / n);
  return x;
}

/// The target with data from the truth; noise: relative to each channel's range, declared as such.
inline calibration::Target measure(const Twin& twin, const TwinTest& test, double noise = 0.0,
                                   std::uint64_t seed = 1) {
  calibration::PointExperiment e;
  e.law = twin.law;
  e.theta = twin.theta;
  // N follows from Gamma: it must not stay behind when Gamma moves
  if (const int n = twin.index("N"); n >= 0) e.theta[static_cast<std::size_t>(n)] = std::nan("");
  e.test.path = test.path ? *test.path : point::path_of(test.stages);
  e.test.initial = test.initial;
  e.test.settings.tolerance = test.tolerance;
  e.x = test.x;
  e.y = test.y;
  e.rows = test.rows;
  e.abscissae = test.abscissae;
  calibration::Target t;
  t.name = test.name;
  std::vector<double> inputs = e.theta;
  inputs.resize(inputs.size() + calibration::initial_input_count, std::nan(""));
  t.inputs = inputs;
  t.simulator = calibration::make_point_simulator(std::move(e));
  for (std::size_t i = 0; i < twin.free.size(); ++i)
    t.bindings.push_back({twin.index(twin.free[i].name), static_cast<int>(i)});
  calibration::Response r;
  t.simulator->simulate(inputs, {}, r);
  t.x = r.x;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t c = 0; c < test.y.size(); ++c) {
    calibration::Channel channel;
    channel.name = std::string(point::column_name(test.y[c]));
    channel.observed = r.y.col(static_cast<Eigen::Index>(c));
    if (noise > 0.0) {
      const double sd = noise * (channel.observed.maxCoeff() - channel.observed.minCoeff());
      for (double& y : channel.observed) y += sd * normal(random);
      channel.noise = sd;
    }
    t.channels.push_back(std::move(channel));
  }
  return t;
}

inline point::Stage stage(point::Kind kind, point::Condition condition, point::Quantity goal,
                          double value, point::Drive drive = point::Drive::strain) {
  point::Stage s;
  s.kind = kind;
  s.condition = condition;
  s.drive = drive;
  s.goal = point::Goal{goal, value};
  return s;
}

/// Five free parameters of modified Cam-Clay (London clay) on either compression line.
inline Twin cam_clay_twin(const char* compression = "v-ln_p") {
  const LawSpec spec{
      "modified_cam_clay",
      {{"compression", compression}},
      {{"M", 0.888}, {"lambda", 0.161}, {"kappa", 0.062}, {"nu", 0.3}, {"Gamma", 2.759}}};
  Twin twin;
  twin.law = &find_law(spec);
  twin.theta = checked_parameters(spec);
  twin.make_free("M", 0.4, 1.8);
  twin.make_free("lambda", 0.03, 0.4, Scale::log);
  twin.make_free("kappa", 0.02, 0.9, Scale::linear, 1);  // a ratio to lambda
  twin.make_free("nu", 0.05, 0.45);
  twin.make_free("Gamma", 1.8, 3.6);
  return twin;
}

/// Isotropic loading and unloading, undrained compression, drained compression of overconsolidated
/// clay: together they determine all five.
inline std::vector<TwinTest> cam_clay_tests() {
  using point::Condition;
  using point::Drive;
  using point::Kind;
  using point::Quantity;
  std::vector<TwinTest> list(3);
  list[0].name = "isotropic";
  list[0].stages = {stage(Kind::isotropic, Condition::drained, Quantity::p, 800e3, Drive::stress),
                    stage(Kind::isotropic, Condition::drained, Quantity::p, 100e3, Drive::stress)};
  list[0].initial.p = 50e3;
  list[0].initial.ocr = 1.0;
  list[0].x = Quantity::p;
  list[0].y = {Quantity::v};
  list[0].abscissae = {100e3, 200e3, 300e3, 400e3, 600e3, 800e3, 500e3, 300e3, 200e3, 100e3};
  list[1].name = "undrained";
  list[1].stages = {stage(Kind::triaxial, Condition::undrained, Quantity::eps_a, 0.1)};
  list[1].initial.p = 200e3;
  list[1].initial.ocr = 1.0;
  list[1].x = Quantity::eps_a;
  list[1].y = {Quantity::q, Quantity::u};
  list[1].abscissae = evenly(0.0, 0.1, 10);
  list[2].name = "drained";
  list[2].stages = {stage(Kind::triaxial, Condition::drained, Quantity::eps_a, 0.15)};
  list[2].initial.p = 100e3;
  list[2].initial.ocr = 3.0;
  list[2].x = Quantity::eps_a;
  list[2].y = {Quantity::q, Quantity::eps_v};
  list[2].abscissae = evenly(0.0, 0.15, 10);
  return list;
}

inline calibration::Problem twin_problem(const Twin& twin, const std::vector<TwinTest>& tests,
                                         double noise = 0.0, std::uint64_t seed = 1) {
  std::vector<calibration::Target> targets;
  for (std::size_t k = 0; k < tests.size(); ++k)
    targets.push_back(measure(twin, tests[k], noise, seed * 1000 + k));
  return calibration::Problem(calibration::ParameterSpace(twin.free), std::move(targets));
}

/// Largest relative error of the free parameters.
inline double worst_error(const Twin& twin, const Eigen::VectorXd& values) {
  return ((values - twin.truth_vector()).array() / twin.truth_vector().array()).abs().maxCoeff();
}

}  // namespace repose::study

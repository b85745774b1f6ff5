#pragma once
/// \file
/// Laws and tests that several test files drive.

#include "models/registry.hpp"
#include "pointdriver/integrate/simulate.hpp"
#include "tests/pointdriver/exact_solutions.hpp"

namespace repose::point {

/// A law with its completed parameter vector.
struct Law {
  const LawInfo* info;
  std::vector<double> theta;
};

inline Law make_law(const LawSpec& spec) { return {&find_law(spec), checked_parameters(spec)}; }

/// London clay (Schofield & Wroth 1968) on either compression line
inline exact::CamClay london(bool v_ln_p) { return {0.888, 0.161, 0.062, 0.3, v_ln_p}; }

inline Law cam_clay(const exact::CamClay& c) {
  return make_law(
      {"modified_cam_clay",
       {{"compression", c.v_ln_p ? "v-ln_p" : "ln_v-ln_p"}},
       {{"M", c.M}, {"lambda", c.lambda}, {"kappa", c.kappa}, {"nu", c.nu}, {"Gamma", 2.759}}});
}

inline Law mu_i(const char* form) {
  return make_law({"mu_i",
                   {{"form", form}},
                   {{"mu_0", 0.3819},
                    {"mu_d", 0.5718},
                    {"I_0", 0.279},
                    {"d", 0.0053},
                    {"rho_p", 2000.0},
                    {"rho_0", 1300.0},
                    {"K", 254800.0}}});
}

inline PointTest make_test(const std::vector<Stage>& stages, double p, double ocr, Method method,
                           double tolerance = 1e-10) {
  PointTest test;
  test.path = path_of(stages);
  test.initial.p = p;
  if (ocr > 0.0) test.initial.ocr = ocr;
  test.settings.method = method;
  test.settings.tolerance = tolerance;
  return test;
}

inline std::vector<double> column(const Law& law, const PointTest& test, const Curve& curve,
                                  Quantity quantity) {
  std::vector<double> values;
  read_column(*law.info, law.theta, test, curve, quantity, values);
  return values;
}

inline Curve run(const Law& law, const PointTest& test) {
  Curve curve;
  simulate(*law.info, law.theta, test, curve);
  return curve;
}

inline Stage triaxial(Condition condition, double axial_strain, int points = 50) {
  Stage stage;
  stage.kind = Kind::triaxial;
  stage.condition = condition;
  stage.goal = Goal{Quantity::eps_a, axial_strain};
  stage.points = points;
  return stage;
}

}  // namespace repose::point

#pragma once
/// \file
/// Laws from the libraries that the tests build.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pointdriver/integrate/simulate.hpp"
#include "umat/in/library_law.hpp"

namespace repose::umat {

struct TestLaw {
  LawSpec spec;
  const LawInfo* info = nullptr;
  std::vector<double> theta;
};

inline Description describe(const std::string& file, std::size_t props, std::size_t statev) {
  Description d;
  d.library.file = file;
  d.library.content = content_of(file);
  d.library.nprops = props;
  d.library.nstatv = statev;
  d.initial_statev.assign(statev, 0.0);
  return d;
}

inline TestLaw make_law(const Description& d, const std::vector<double>& props,
                        double density = 2000.0) {
  TestLaw law;
  law.spec.name = law_name;
  law.spec.options["library"] = make_known(d);
  for (std::size_t i = 0; i < props.size(); ++i) law.spec.values[prop_name(d, i)] = props[i];
  law.spec.values[std::string(density_name)] = density;
  law.info = &find_law(law.spec);
  law.theta = checked_parameters(law.spec);
  return law;
}

inline TestLaw make_law(const std::string& file, const std::vector<double>& props,
                        std::size_t statev = 0) {
  return make_law(describe(file, props.size(), statev), props);
}

/// Drained triaxial compression to ε_a, in that many rows; extension where it is negative.
inline point::PointTest triaxial(double p, double axial_strain, int rows,
                                 point::Condition condition = point::Condition::drained) {
  point::Stage stage;
  stage.kind = point::Kind::triaxial;
  stage.condition = condition;
  stage.goal = point::Goal{point::Quantity::eps_a, axial_strain};
  stage.points = rows;
  point::PointTest test;
  test.path = point::path_of({stage});
  test.initial.p = p;
  return test;
}

inline std::vector<double> column(const TestLaw& law, const point::PointTest& test,
                                  const point::Curve& curve, point::Quantity quantity) {
  std::vector<double> values;
  point::read_column(*law.info, law.theta, test, curve, quantity, values);
  return values;
}

}  // namespace repose::umat

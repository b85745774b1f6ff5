// A laboratory test at one material point: undrained triaxial compression of normally consolidated
// Weald clay (modified Cam-Clay, Schofield & Wroth 1968). All numbers are in SI units.
#include <cmath>
#include <cstdio>

#include <repose/models/registry.hpp>
#include <repose/pointdriver/integrate/simulate.hpp>

using namespace repose;

int main() {
  // A law is asked for as an input file does: name, options, parameters. What is wrong with them
  // (a misspelt name, kappa >= lambda) is an InputError whose text says how to mend it.
  const double M = 0.95, lambda = 0.093, kappa = 0.035, p0 = 207e3;
  const LawSpec clay{"modified_cam_clay",
                     {{"compression", "v-ln_p"}},
                     {{"M", M},
                      {"lambda", lambda},
                      {"kappa", kappa},
                      {"nu", 0.3},
                      {"Gamma", 2.060},
                      {"p_ref", 1e3}}};
  const LawInfo& law = find_law(clay);
  const std::vector<double> theta = checked_parameters(clay);

  // A test is a path of stages and the state it starts from. This one has one stage: axial strain
  // (compression positive, like every laboratory quantity) to 20 % without change of volume.
  point::Stage shear;
  shear.kind = point::Kind::triaxial;
  shear.condition = point::Condition::undrained;
  shear.goal = point::Goal{point::Quantity::eps_a, 0.20};
  shear.points = 10;
  point::PointTest test;
  test.path = point::path_of({shear});
  test.initial.p = p0;     // isotropic, and
  test.initial.ocr = 1.0;  // never loaded higher

  // The outcome says how it ended; it throws nothing for numbers, so that a fit can drive millions.
  point::Curve curve;
  const point::Outcome outcome = point::simulate(law, theta, test, curve);
  if (point::is_failure(outcome.status)) {
    std::fprintf(stderr, "%s\n", point::explain(law, theta, test, curve).c_str());
    return 1;
  }

  // A curve is rows of tensors; read_column() reads laboratory quantities from them.
  std::vector<double> eps_a, q, p, u;
  point::read_column(law, theta, test, curve, point::Quantity::eps_a, eps_a);
  point::read_column(law, theta, test, curve, point::Quantity::q, q);
  point::read_column(law, theta, test, curve, point::Quantity::p, p);
  point::read_column(law, theta, test, curve, point::Quantity::u, u);
  std::puts("eps_a [-]   q [kPa]   p' [kPa]   u [kPa]");
  for (std::size_t i = 0; i < q.size(); ++i)
    std::printf("%9.3f %9.2f %10.2f %9.2f\n", eps_a[i], q[i] / 1e3, p[i] / 1e3, u[i] / 1e3);

  // Where it must end: at the critical state of its volume, p0/2^(1 - kappa/lambda) and q = M p'.
  const double p_c = p0 * std::exp2(kappa / lambda - 1.0);
  std::printf("critical state: q = %.2f kPa at p' = %.2f kPa\n", M * p_c / 1e3, p_c / 1e3);
  return std::abs(q.back() / (M * p_c) - 1.0) < 0.01 ? 0 : 1;
}

// Synthetic data from every law, fitted from random starts: the parameters must come back.

#include "study/fit/twin.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace repose::calibration {
namespace {

/// How many of n random starts bring every parameter back to 1e-6 relative.
struct Recovery {
  int good = 0, starts = 0;
  double seconds = 0.0;
  Spent spent;
};

Recovery recover(const study::Twin& twin, const Problem& problem, int starts) {
  FitOptions options;
  options.starts = starts + 1;
  options.starts_from = 1;  // start 0 is the middle of the bounds, the others are random
  options.local_evaluations = 400;
  const auto begin = std::chrono::steady_clock::now();
  const auto results = run_starts(problem, options);
  Recovery r;
  r.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const StartResult& s : results)
    if (study::worst_error(twin, problem.space().values(s.optimum.z)) < 1e-6) ++r.good;
  r.starts = static_cast<int>(results.size());
  r.spent = problem.spent();
  return r;
}

void report(const char* what, const Recovery& r) {
  std::printf(
      "[ measured ] %s: %d of %d starts, %.2f s, %ld evaluations, %ld gradients, %ld paths\n", what,
      r.good, r.starts, r.seconds, r.spent.evaluations, r.spent.gradients, r.spent.paths);
}

// 1e-6: the paths are integrated to 1e-9 per step, and the worst determined parameter (ν) enlarges
// residuals 100-fold at most.
TEST(Twin, CamClayComesBackFrom19Of20Starts) {
  for (const char* compression : {"v-ln_p", "ln_v-ln_p"}) {
    const study::Twin twin = study::cam_clay_twin(compression);
    const Problem problem = study::twin_problem(twin, study::cam_clay_tests());
    const Recovery r = recover(twin, problem, 20);
    report(compression, r);
    EXPECT_GE(r.good, 19) << compression;
  }
}

study::Twin flow_twin(const LawSpec& spec) {
  study::Twin twin;
  twin.law = &find_law(spec);
  twin.theta = checked_parameters(spec);
  return twin;
}

std::map<std::string, double> glass_beads(bool regularised) {
  std::map<std::string, double> values{{"mu_0", 0.3819}, {"mu_d", 0.6435},  {"I_0", 0.279},
                                       {"d", 5.3e-4},    {"rho_p", 2500.0}, {"rho_0", 1500.0},
                                       {"K", 5e6}};
  if (regularised) values["r"] = 1e-4;
  return values;
}

study::TwinTest flow_curve(std::vector<double> rates, double p) {
  study::TwinTest s;
  s.name = "flow curve";
  s.path = flow_curve_path(rates, point::Condition::constant_volume, 0.5);
  s.initial.p = p;
  s.x = point::Quantity::I;
  s.y = {point::Quantity::mu};
  s.rows = Rows::leg_ends;
  return s;
}

std::vector<double> rates(double from, double to, int n) {
  std::vector<double> list;
  for (int i = 0; i < n; ++i) list.push_back(from * std::pow(to / from, i / (n - 1.0)));
  return list;
}

TEST(Twin, FlowCurveOfMuIComesBackFrom19Of20Starts) {
  for (const bool regularised : {false, true}) {
    study::Twin twin = flow_twin({"mu_i",
                                  {{"form", regularised ? "regularised" : "elastoviscoplastic"}},
                                  glass_beads(regularised)});
    twin.make_free("mu_d", 0.3, 1.2);
    twin.make_free("mu_0", 0.1, 0.95, Scale::linear, 0);  // a ratio to mu_d
    twin.make_free("I_0", 0.01, 3.0, Scale::log);
    // I from 1e-3 to 10 at 5 kPa: γ̇ = I √(p/ρ_p)/d = 2700 I
    const Problem problem = study::twin_problem(twin, {flow_curve(rates(2.7, 2.7e4, 25), 5e3)});
    const Recovery r = recover(twin, problem, 20);
    report(regularised ? "mu(I), regularised" : "mu(I)", r);
    EXPECT_GE(r.good, 19) << regularised;
  }
}

TEST(Twin, NewtonianComesBackFrom19Of20Starts) {
  study::Twin twin =
      flow_twin({"newtonian", {}, {{"eta", 0.5}, {"K", 26e3}, {"alpha", 7.0}, {"rho_0", 1e3}}});
  twin.make_free("eta", 1e-3, 1e2, Scale::log);
  twin.make_free("K", 1e3, 1e6, Scale::log);
  study::TwinTest shear;
  shear.name = "shear";
  shear.path = flow_curve_path(rates(0.1, 100.0, 10), point::Condition::constant_volume, 0.5);
  shear.initial.p = 1e3;
  shear.x = point::Quantity::shear_rate;
  shear.y = {point::Quantity::tau};
  shear.rows = Rows::leg_ends;
  study::TwinTest squeeze;
  squeeze.name = "squeeze";
  squeeze.stages = {study::stage(point::Kind::isotropic, point::Condition::drained,
                                 point::Quantity::eps_v, 0.05)};
  squeeze.initial.density = 1000.0;
  squeeze.x = point::Quantity::eps_v;
  squeeze.y = {point::Quantity::p};
  squeeze.abscissae = study::evenly(0.0, 0.05, 10);
  const Problem problem = study::twin_problem(twin, {shear, squeeze});
  const Recovery r = recover(twin, problem, 20);
  report("newtonian", r);
  EXPECT_GE(r.good, 19);
}

/// Trials, with and without derivatives, until the objective is at most f; −1 if never.
long trials_to(const Optimum& o, double f) {
  for (const TracePoint& t : o.trace)
    if (t.objective <= f) return t.evaluations + t.gradients;
  return -1;
}

// The same objective from the same starts: 1e-10 of the middle's, where every parameter is right to
// 1e-4 or better.
TEST(Twin, GradientsNeedAFifthOfBobyqasPaths) {
  const study::Twin twin = study::cam_clay_twin();
  const Problem problem = study::twin_problem(twin, study::cam_clay_tests());
  Evaluation e;
  problem.evaluate(Eigen::VectorXd::Constant(5, 0.5), false, e);
  const double goal = 1e-10 * e.objective();
  OptimiseOptions options;
  options.max_evaluations = 4000;
  options.x_tolerance = 1e-12;
  std::vector<double> lm, slsqp;
  for (std::size_t k = 0; k < 6; ++k) {
    const Eigen::VectorXd z = problem.space().spread_point(k, 11);
    const long without = trials_to(optimise(problem, "LN_BOBYQA", z, options), goal);
    const long with_lm = trials_to(optimise(problem, "levenberg_marquardt", z, options), goal);
    const long with_slsqp = trials_to(optimise(problem, "LD_SLSQP", z, options), goal);
    std::printf("[ measured ] start %zu: BOBYQA %ld, Levenberg-Marquardt %ld, SLSQP %ld trials\n",
                k, without, with_lm, with_slsqp);
    const double spent = static_cast<double>(without < 0 ? options.max_evaluations : without);
    ASSERT_GT(with_lm, 0);
    ASSERT_GT(with_slsqp, 0);
    lm.push_back(spent / static_cast<double>(with_lm));
    slsqp.push_back(spent / static_cast<double>(with_slsqp));
  }
  EXPECT_GE(*std::min_element(lm.begin(), lm.end()), 5.0);
  EXPECT_GE(*std::min_element(slsqp.begin(), slsqp.end()), 5.0);
}

// Every algorithm on the same problem from the same start: none fails, and all improve on it.
TEST(Twin, EveryAlgorithmWorksOnCamClay) {
  const study::Twin twin = study::cam_clay_twin();
  const Problem problem = study::twin_problem(twin, study::cam_clay_tests());
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(5, 0.5);
  Evaluation e;
  problem.evaluate(start, false, e);
  for (const Algorithm& a : algorithms()) {
    OptimiseOptions options;
    options.max_evaluations = 300;
    const Optimum o = optimise(problem, a.name, start, options);
    std::printf("[ measured ] %-28s objective %.2e after %4ld + %4ld gradients, %.2f s, %s\n",
                std::string(a.name).c_str(), o.objective, o.evaluations, o.gradients, o.seconds,
                o.why.c_str());
    EXPECT_LT(o.objective, e.objective()) << a.name;
  }
}

}  // namespace
}  // namespace repose::calibration

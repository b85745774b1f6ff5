#pragma once
/// \file
/// Error against time: the integrators on equal terms, and the error of single return steps.

#include <algorithm>

#include "models/registry.hpp"
#include "pointdriver/integrate/simulate.hpp"

namespace repose::point {

/// A path that the integrators are compared on.
struct WorkPath {
  std::string name;
  LawSpec law;
  PointTest test;
};

/// Six paths of modified Cam-Clay: undrained and drained triaxial compression, normally and heavily
/// overconsolidated, isotropic load - unload - reload, one-dimensional compression; one in its
/// other form; two of μ(I), sheared from rest into flow; one of the neo-Hookean solid. The laws
/// that remain have no memory: their stress follows from the rates, and there is nothing to
/// integrate.
std::vector<WorkPath> work_paths();

struct WorkPoint {
  std::string path;
  Method method = Method::adaptive;
  double tolerance = 0.0;     ///< of the adaptive methods
  int substeps = 0;           ///< implicit: steps per row
  double stress_error = 0.0;  ///< largest in any row: |σ − σ_ref| over |σ_ref| [-]
  /// Largest in any row: state variables, density and strain, each over its largest [-]
  double state_error = 0.0;
  double seconds = 0.0;             ///< median of the repeats, in process
  double lower = 0.0, upper = 0.0;  ///< quartiles of the repeats [s]
  int repeats = 0;
  double error() const { return std::max(stress_error, state_error); }
  long steps = 0, rates = 0;
  bool completed = false;
};

/// How much is measured.
struct WorkEffort {
  double seconds_each = 0.02;  ///< repeats of one setting, at least three
  int digits_apart = 1;        ///< tolerances of 1e-3, 1e-4, ... or every so many digits
};

/// Runs one path with every method over its tolerances (steps). The reference is `adaptive` at
/// 1e-13, which the tests hold against the closed forms.
std::vector<WorkPoint> work_precision(const WorkPath& path, const WorkEffort& effort);

/// One cell of an iso-error map.
struct StepError {
  double eps_v, eps_q;  ///< the increment, compression positive [-]
  double error;         ///< |σ − σ_ref|/|σ_ref| of one update against the integrated path [-]
};

/// One-step errors of the law's update for n×n increments from the given start, deviatoric strain
/// in triaxial compression, Δε_v in ±reach, Δε_q in 0 … reach.
std::vector<StepError> step_error_map(const LawInfo& law, std::span<const double> theta,
                                      const InitialConditions& start, double reach, int n);

}  // namespace repose::point

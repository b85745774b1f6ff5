#pragma once
/// \file
/// Error against time: the integrators on equal terms, and the error of single return steps.

#include "models/registry.hpp"
#include "pointdriver/simulate.hpp"

namespace repose::point {

/// A path that the integrators are compared on.
struct WorkPath {
  std::string name;
  LawSpec law;
  PointTest test;
};

/// Six paths of modified Cam-Clay: undrained and drained triaxial compression, normally and heavily
/// overconsolidated, isotropic load - unload - reload, one-dimensional compression.
std::vector<WorkPath> work_paths();

struct WorkPoint {
  std::string path;
  Method method = Method::adaptive;
  double tolerance = 0.0;  ///< of the adaptive methods
  int substeps = 0;        ///< implicit: steps per row
  double error = 0.0;      ///< largest error in any row: p and q over p, ε_v over its largest [-]
  double seconds = 0.0;    ///< shortest of the repeats, in process
  long steps = 0, rates = 0;
  bool completed = false;
};

/// Runs one path with every method over its tolerances (steps). The reference is `adaptive` at
/// 1e-13, which the tests hold against the closed forms. Each setting is repeated for
/// `seconds_each`, at least three times.
std::vector<WorkPoint> work_precision(const WorkPath& path, double seconds_each);

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

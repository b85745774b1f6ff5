#pragma once
/// \file
/// `repose chart fit`: every algorithm of calibration/optimise.hpp on one fit from one start.

#include <array>
#include <string>
#include <vector>

#include "calibration/optimise.hpp"
#include "calibration/problem.hpp"
#include "input/read_fit.hpp"

namespace repose::study {

/// What is fitted and from where.
struct FitTask {
  std::string name;
  calibration::Problem problem;
  Eigen::VectorXd start;
  std::string input;  ///< the fit as TOML; empty: the twin
};
/// Five parameters of London clay from three tests without noise: the least objective is 0. The
/// start lies off every symmetry of the cube.
FitTask twin_task();
FitTask task_of(const input::FitFile& file);
/// At the task's start.
double first_objective(const FitTask& task);

struct AlgorithmRun {
  calibration::Algorithm algorithm;
  calibration::Optimum optimum;
};

/// Shares of the first objective that the table tells the cost of.
constexpr std::array objective_levels{1e-2, 1e-6, 1e-12};
/// Trials, with or without derivatives.
long trials(const calibration::TracePoint& point);
/// The first point of a trace at or below an objective; null if it never came there.
const calibration::TracePoint* first_below(const calibration::Optimum& optimum, double objective);

/// chart.csv: a row per improvement of every run.
std::string trace_csv(const std::vector<AlgorithmRun>& runs);
/// table.csv: a row per run, with what it took to every level of the first objective.
std::string table_csv(const std::vector<AlgorithmRun>& runs, double first);

}  // namespace repose::study

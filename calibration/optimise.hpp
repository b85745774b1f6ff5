#pragma once
/// \file
/// One optimisation from one point: Levenberg-Marquardt on the residual vector, or an algorithm of
/// NLopt by name on the objective. All work in the unit cube, keep the best point whatever happens
/// and never throw.

#include <string>
#include <string_view>
#include <vector>

#include "calibration/problem.hpp"

namespace repose::calibration {

struct OptimiseOptions {
  long max_evaluations = 2000;  ///< residual vectors, with or without derivatives
  double x_tolerance = 1e-9;    ///< of z
  double f_tolerance = 1e-14;   ///< relative, of the objective
  std::uint64_t seed = 1;
  std::string inner = "LN_BOBYQA";  ///< local algorithm inside MLSL
  std::vector<bool> fixed;          ///< coordinates to leave as they are (Levenberg-Marquardt)
};

/// The best objective after so many trials and seconds.
struct TracePoint {
  long evaluations = 0, gradients = 0;
  double seconds = 0.0, objective = 0.0;
};

struct Optimum {
  Eigen::VectorXd z;
  double objective = 0.0;
  std::string why;  ///< "converged", "round-off", "evaluations", "interrupted", "error: …"
  long evaluations = 0, gradients = 0;
  double seconds = 0.0;
  bool failed = false;  ///< even the best point is a path that broke off
  std::vector<TracePoint> trace;
};

struct Algorithm {
  std::string_view name;
  bool global = false;
  bool gradient = false;
  std::string_view doc;
};
inline constexpr std::string_view levenberg_marquardt_name = "levenberg_marquardt";
/// Every algorithm that fits by name; the first is levenberg_marquardt, the others NLopt's.
std::span<const Algorithm> algorithms();
const Algorithm* find_algorithm(std::string_view name);

/// Levenberg (1944), Marquardt (1963) with Nielsen's damping (1999) and a projected active set at
/// the bounds; the linear step by QR of the damped Jacobian, so that digits are not squared away.
Optimum levenberg_marquardt(const Problem& problem, const Eigen::VectorXd& start,
                            const OptimiseOptions& options = {});

/// An algorithm of algorithms() by name. A start outside the cube begins on its surface.
/// Errors: std::invalid_argument for an unknown name.
Optimum optimise(const Problem& problem, std::string_view algorithm, const Eigen::VectorXd& start,
                 const OptimiseOptions& options = {});

}  // namespace repose::calibration

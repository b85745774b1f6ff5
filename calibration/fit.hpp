#pragma once
/// \file
/// The front door of a fit of laboratory tests, in plain numbers: a law with some parameters free
/// and what was measured in, values with their uncertainty out.
///
/// ```cpp
/// std::vector<calibration::Experiment> tests;  // what was measured
/// const LawSpec law{"neo_hookean", {}, {{"nu", 0.3}, {"rho_0", 1000.0}}};
/// std::vector<calibration::FreeParameter> free(1);
/// free[0] = {"E", "Pa", 1e5, 1e8, Scale::log};
/// const calibration::FitResult result = calibration::fit(law, free, tests);
/// for (const calibration::FittedValue& v : result.values)
///   std::printf("%s = %g +- %g\n", v.name.c_str(), v.value, v.standard_error);
/// ```

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibration/free_parameter.hpp"
#include "models/registry.hpp"
#include "pointdriver/integrate/simulate.hpp"

namespace repose::calibration {

/// One measured quantity over the rows of an experiment.
struct Measured {
  point::Quantity quantity = point::Quantity::q;
  std::vector<double> values;   ///< rows; in the quantity's unit
  std::optional<double> noise;  ///< standard deviation, the same unit; absent: from the scatter
  double weight = 1.0;
};

/// One laboratory test and what was measured in it.
struct Experiment {
  std::string name;
  point::PointTest test;  ///< its stages must lead to x at a known rate (ε_a under a strain rate)
  point::Quantity x = point::Quantity::eps_a;
  std::vector<double> abscissae;  ///< x of each row, in the order of the test
  std::vector<Measured> measured;
  bool held_out = false;  ///< predicted and scored, not fitted
};

struct FitSettings {
  int starts = 1;  ///< the given start and so many more, less one, spread over the bounds
  std::uint64_t seed = 1;
  long max_evaluations = 1000;                    ///< per start
  std::string algorithm = "levenberg_marquardt";  ///< or one of NLopt's, by name
};

struct FittedValue {
  std::string name;
  double value = 0.0;
  double standard_error = 0.0;       ///< infinite where the data say nothing, NaN at a bound
  std::array<double, 2> interval{};  ///< 95 %, within the bounds
  int at_bound = 0;                  ///< −1 lower, +1 upper, 0 inside
};

/// How well a measured quantity is met.
struct FitScore {
  std::string experiment;
  point::Quantity quantity = point::Quantity::q;
  double rms = 0.0;           ///< of simulated − measured, in the quantity's unit
  double relative_rms = 0.0;  ///< over the range of the measured values
};

struct FitResult {
  std::vector<FittedValue> values;  ///< in the order of the free parameters
  double objective = 0.0;           ///< ½ rᵀr
  std::string why;                  ///< "converged", "round-off", "evaluations", …
  long evaluations = 0;             ///< of all starts, with or without derivatives
  bool failed = false;              ///< even the best parameters do not drive a test to its end
  std::vector<FitScore> scores;     ///< every quantity of every experiment, held-out ones too
};

/// Fits the law's parameters `free` (their names; p, ocr, v, K0 and p_c0 of the initial state, one
/// value for all experiments, too); the others are those of `law`. Starts run in parallel; the
/// result does not depend on the number of threads. Throws InputError: key "fit" for a name that is
/// free twice or that the law lacks, a parameter's name for bounds that make none and for a value
/// that is missing or out of range, "target" or "data" for measured values that do not fit the
/// test.
FitResult fit(const LawSpec& law, const std::vector<FreeParameter>& free,
              const std::vector<Experiment>& experiments, const FitSettings& settings = {});

}  // namespace repose::calibration

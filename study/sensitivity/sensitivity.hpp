#pragma once
/// \file
/// What `repose sensitivity` computes: the runs that a [sensitivity] asks for, and what their
/// results say of its inputs.

#include <optional>
#include <string>
#include <vector>

#include "input/read_sensitivity.hpp"
#include "input/read_sweep.hpp"
#include "io/json.hpp"
#include "study/point/point_sweep.hpp"
#include "study/run/scene_sweep.hpp"
#include "study/sensitivity/chaos.hpp"
#include "study/sensitivity/morris.hpp"

namespace repose::study {

/// The value of an input of which a share u of all values is smaller, 0 < u < 1.
double value_at(const input::UncertainInput& input, double u);

/// The place z of its range, 0 to 1, that Morris moves it to: on its scale; of a normal
/// distribution two standard deviations to either side, as far as the bounds let it.
double value_within(const input::UncertainInput& input, double z);

/// The runs, and where in the unit cube each lies.
struct SensitivityPlan {
  input::SensitivityInput asked;
  std::uint64_t seed = 1;
  Eigen::MatrixXd points;     ///< a run per row
  input::ParameterSets sets;  ///< the same as keys of the file

  SensitivityPlan(input::SensitivityInput given, std::uint64_t random_seed);
};

/// The outputs of every run, a column each; NaN where a run has none. Errors: BadInput if no run
/// that is done has such a figure, with the nearest name.
Eigen::MatrixXd outputs_of(const PointSweep& sweep, const SensitivityPlan& plan);
/// What the runs say of one output.
struct OutputSensitivity {
  std::string name;
  Eigen::Index lost = 0;               ///< runs that have no such value
  double mean = 0.0, deviation = 0.0;  ///< of the values there are
  std::optional<PolynomialChaos> surrogate{};
  std::vector<VarianceShares> shares{};      ///< of every input, by the method "sobol"
  std::vector<ElementaryEffects> effects{};  ///< by "morris"
  std::string not_shown{};                   ///< why there are neither; "" if there are
};

/// More lost runs than this share leave no indices: what is left is no longer the ranges that were
/// asked for.
inline constexpr double most_lost = 0.1;
/// A polynomial that misses more than 1 − this of the variance says nothing of the rest.
inline constexpr double least_q2 = 0.9;

/// values: of outputs_of(). Indices of blocks, effects and polynomials hold the runs that have a
/// value; what they then are of is told by lost_words().
std::vector<OutputSensitivity> sensitivities(const SensitivityPlan& plan,
                                             const Eigen::MatrixXd& values);

/// sensitivity.json's list of outputs, and sensitivity.csv.
io::Json sensitivity_json(const SensitivityPlan& plan,
                          const std::vector<OutputSensitivity>& outputs);
std::string sensitivity_csv(const SensitivityPlan& plan,
                            const std::vector<OutputSensitivity>& outputs);

/// What is said of them: per output a headline and a table, a row per input from the first to the
/// last by ranked().
std::vector<std::string> sensitivity_words(const SensitivityPlan& plan,
                                           const std::vector<OutputSensitivity>& outputs);

/// "7 of 512 runs have no s_u_Pa; …": a line per output that has lost any, with what then is left
/// out, and the input at whose large or small values the lost runs lie.
std::vector<std::string> lost_words(const SensitivityPlan& plan, const Eigen::MatrixXd& values);

/// Inputs from the largest total share, or size of effect, to the smallest; as given where an
/// output has neither.
std::vector<std::size_t> ranked(const SensitivityPlan& plan, const OutputSensitivity& output);

}  // namespace repose::study

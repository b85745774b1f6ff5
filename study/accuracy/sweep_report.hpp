#pragma once
/// \file
/// The tables of `repose chart mpm`, and its answers: does the run-out depend on the step, and what
/// accuracy does a second buy?

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/json.hpp"
#include "study/accuracy/errors.hpp"

namespace repose::study {

/// chart.csv: a row per run that has a result; the changes are those from the run with the shortest
/// step of the same transfer, kernel and cells, and empty until all of these have a result.
std::string sweep_csv(std::span<const SweepRun> runs);

/// history.csv: every row of the runs' series.
std::string history_csv(std::span<const SweepRun> runs);

/// What the answer is measured by: front, height and profile may change by 1 % (of themselves, of
/// H_0) when the step is quartered.
constexpr double allowed_change = 0.01;

/// Per transfer, kernel and cell size: the ends at the longest and shortest step, the changes
/// between both and when the step is quartered, and whether the latter stay below allowed_change.
io::Json sweep_answer(const std::vector<SweepSeries>& series);

/// The answer as a table for people.
std::string answer_text(const io::Json& answer);

/// errors.csv: a row per finished run with its error in every quantity that has a reference, the
/// ledger's, its CPU seconds, and whether it lies on the Pareto front of each quantity.
std::string errors_csv(std::span<const SweepRun> runs, const SweepReference& reference);

/// The extrapolated profile (x_m,depth_m) or kinetic energy (time_s,kinetic_J_per_m).
std::string curve_csv(const Eigen::VectorXd& shares, Quantity q, const mpm::Scene& scene,
                      double bin);

/// history.csv, and where there is a reference errors.csv and reference_QUANTITY.csv of every curve
/// that it has: name and text.
std::vector<std::pair<std::string, std::string>> outcome_tables(
    std::span<const SweepRun> runs, const std::optional<SweepReference>& reference);

/// What the runs warn of and why they failed, each with its name.
std::vector<std::string> warnings_of(std::span<const SweepRun> runs);

/// The reference with its error bars, and per family and quantity the observed orders and the
/// constants of the error model.
io::Json errors_answer(std::span<const SweepRun> runs, const SweepReference& reference);

/// The same as a table for people.
std::string errors_text(const io::Json& answer);

}  // namespace repose::study

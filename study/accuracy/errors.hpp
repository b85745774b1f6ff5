#pragma once
/// \file
/// What the runs of a sweep tend to, how far each is from it, and how that depends on the cells.

#include <optional>

#include "study/accuracy/error_model.hpp"
#include "study/accuracy/quantity.hpp"

namespace repose::study {

/// Runs of one transfer, kernel and points per cell, by cell size: what h tells apart.
struct SweepFamily {
  std::vector<const SweepRun*> runs;  ///< finished ones with a Courant number, coarse cells first
  const mpm::Scene& scene() const { return runs.front()->scene(); }
  std::string name() const;  ///< "relaxed, cubic"
  /// A quantity's values by cell size, coarse to fine.
  std::vector<Resolution> levels(Quantity q, double bin) const;
  std::vector<double> cells() const;
};
/// Those with at least one finished run, in the order of the sweep.
std::vector<SweepFamily> families_of(std::span<const SweepRun> runs);

/// The columns that profiles are compared in: the coarsest cells.
double common_bin(std::span<const SweepRun> runs);

/// What the runs tend to as cells and steps shrink together.
struct SweepReference {
  std::optional<input::ExactFlow> exact;  ///< an exact solution, and nothing is extrapolated
  std::size_t family = 0;                 ///< of families_of(): the one it is extrapolated from
  std::array<double, 3> cells{};          ///< those that count [m]
  std::size_t steps = 0;                  ///< the least number of Courant numbers that any has
  std::array<std::optional<Reference>, quantity_count> values;
  /// "relaxed, cubic", or "the exact couette".
  std::string name(std::span<const SweepFamily> families) const;
};
/// The exact solution of a flow (exact_flow.hpp); absent as long as no run is done. InputError
/// where the scene is another flow.
std::optional<SweepReference> exact_reference(std::span<const SweepRun> runs,
                                              input::ExactFlow flow);
/// From the family with the finest cells that has at least three sizes (of several, that of the
/// first variant, transfer and kernel, then the first); absent if there is none.
std::optional<SweepReference> reference_of(std::span<const SweepRun> runs, const mpm::Scene& scene);

/// What a sweep is measured by: the exact solution where it names one, else extrapolation.
std::optional<SweepReference> reference_of(std::span<const SweepRun> runs, const mpm::Scene& scene,
                                           const input::Sweep& sweep);

/// Relative error of a run; NaN where the reference has no such value.
double error_of(const SweepRun& run, Quantity q, const SweepReference& reference, double bin);

/// Which runs no other beats in CPU seconds or this error without being worse in the other.
std::vector<bool> pareto_front(std::span<const SweepRun> runs, Quantity q,
                               const SweepReference& reference);

/// What a family's runs show for the constants of the error model, against the reference.
ShownErrors shown_errors(const SweepFamily& family, Quantity q, const SweepReference& reference,
                         double bin);

}  // namespace repose::study

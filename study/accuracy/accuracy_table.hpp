#pragma once
/// \file
/// Measured constants of the error model (study/accuracy/error_model.hpp) per law, kernel, transfer
/// and quantity, and what they advise. docs/accuracy.md says how they were measured.

#include <vector>

#include "study/accuracy/error_model.hpp"
#include "study/accuracy/quantity.hpp"

namespace repose::study {

/// A way to run a scene, and what is known of its errors.
struct Candidate {
  mpm::Kernel kernel;
  mpm::Transfer transfer;
  double courant;  ///< the longest step that keeps still what should be still
  ErrorModel model;
};

/// The orders that a quantity's errors follow, and the caution of its error bars; no constants.
ErrorModel error_form(Quantity q);

/// The measured ways to run scenes of these laws; of several bodies' laws, the largest constants
/// and the shortest step count. Where a law, or its form, has none of its own, those of all laws
/// stand in: enough to plan with, not to promise (trained_domain.hpp). In space steps are
/// space_share times as long.
std::vector<Candidate> candidates_for(const mpm::Scene& scene, Quantity q);
/// √(2/3), by which what is stable in space is shorter (mpm/step/step_size.hpp).
inline constexpr double space_share = 0.816;

/// The scene run so, with cells of h; of a few runs of the same, the k-th: steps differ by 4 %
/// each.
mpm::Scene scene_with(mpm::Scene scene, const Candidate& candidate, double h, int k = 0);

/// Cells to choose from, coarse to fine: the scene's own, doubled as long as they divide the box
/// and every body is at least 4 of them across, and halved down to `most_points` points; between
/// one and its half, four fifths and two thirds of it where they fit.
std::vector<double> sizes_for(const mpm::Scene& scene, double most_points = 4e6);

}  // namespace repose::study

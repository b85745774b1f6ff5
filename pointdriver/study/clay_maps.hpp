#pragma once
/// \file
/// Where the stress update of modified Cam-Clay converges and how far it is off: single steps and
/// whole paths, with the law's own update and, for contrast, with the linearised one
/// (linearised_cam_clay.hpp), against the adaptive integrator at a tight tolerance.

#include "models/registry.hpp"
#include "pointdriver/integrate/simulate.hpp"

namespace repose::point {

/// Which update.
enum class ClayUpdate : std::uint8_t { exact, linearised };

/// One step, or a path of equal steps.
struct ClayOutcome {
  bool converged = false;  ///< the update(s) went through with p >= 0 and p_c > 0
  int evaluations = 0;     ///< of the return's equation, over all steps; 0 for elastic ones
  /// |σ − σ_ref|/|σ_ref|; NaN where the update failed or the reference did
  double error = std::numeric_limits<double>::quiet_NaN();
  double p = 0.0;  ///< at the end [Pa]
};

/// A start on the isotropic axis.
struct ClayStart {
  double p;    ///< [Pa]
  double ocr;  ///< p_c/p
};

/// A step by ε_v (compression positive) and ε_q in triaxial compression.
struct ClayStep {
  double eps_v, eps_q;
};

/// Drives law (a form of modified_cam_clay) with parameters theta along straight steps in strain,
/// each in `substeps` equal updates. `linearised` stands for ln v – ln p lines; for v – ln p ones
/// it takes λ and κ over the specific volume at the start. Throws InputError for a start that the
/// law does not accept.
ClayOutcome drive_clay(const LawInfo& law, std::span<const double> theta, const ClayStart& start,
                       std::span<const ClayStep> steps, int substeps, ClayUpdate update);

/// The two for all of `starts` and `steps`: rows for every start, step and update in that order.
struct ClayCell {
  ClayStart start;
  ClayStep step;
  ClayUpdate update;
  ClayOutcome outcome;
};
std::vector<ClayCell> clay_step_map(const LawInfo& law, std::span<const double> theta,
                                    std::span<const ClayStart> starts,
                                    std::span<const ClayStep> steps);

}  // namespace repose::point

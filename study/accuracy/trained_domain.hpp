#pragma once
/// \file
/// The kind of scene that the constants of the error model were measured on, and how often answers
/// about scenes of this kind held when they were predicted by the others (docs/accuracy.md).

#include <optional>
#include <string>
#include <vector>

#include "study/accuracy/quantity.hpp"

namespace repose::study {

/// Whether scenes of this law and form were charted.
bool is_charted(const LawSpec& law);

/// Why the constants do not speak for a scene, each reason in words ("mu_i of the form
/// barker_gray"); empty where they do. They speak for one rectangular body at rest at the left
/// wall, in the plane, of a law and form that was charted, with end time over √(H/g), H/L, tilt and
/// parameters within what was charted (to 1 %).
std::vector<std::string> beyond_training(const mpm::Scene& scene);

/// Answers about training scenes, each predicted with the constants of the others.
struct Rehearsed {
  int answers = 0;
  int held = 0;  ///< within 1.5 times the target
  /// At least 20 answers, 95 of 100 of which held.
  bool shown() const { return answers >= 20 && 100 * held >= 95 * answers; }
};
/// Of this law and form (LawInfo::option), for the largest rehearsed target that is not above this
/// one; absent where none was.
std::optional<Rehearsed> rehearsed(std::string_view law, std::string_view form, Quantity q,
                                   double target);

}  // namespace repose::study

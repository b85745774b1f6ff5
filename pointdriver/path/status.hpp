#pragma once
/// \file
/// How an integration ended: typed and without text, so that a fit can run millions of paths; words
/// are made from it on demand (report.hpp).

#include <cstdint>
#include <string_view>

namespace repose::point {

enum class Status : std::uint8_t {
  completed,       ///< every leg of the path was driven to its end
  stopped,         ///< a stop condition of the test was met (not an error)
  separated,       ///< p fell to the pressure at which the material parts
  beyond_limit,    ///< the prescribed stress asks for more than the material can carry
  no_response,     ///< at yield neither an elastic nor a plastic rate satisfies the prescription
  goal_not_met,    ///< a leg reached its strain limit before the stress it was to reach
  step_limit,      ///< more steps than allowed (a stiff law under an explicit method, for example)
  step_underflow,  ///< the step that the tolerance asks for is too small for the time's digits
  not_converged,   ///< Newton's method failed at the smallest step
  not_finite,      ///< the law returned no finite number
  bad_initial,     ///< the law cannot start from the initial conditions with these parameters
  unsupported,     ///< this integrator cannot treat this law
  law_failed,      ///< the law itself broke down (a foreign one: Outcome::fault)
};

constexpr bool is_failure(Status status) {
  return status != Status::completed && status != Status::stopped;
}

/// What the integration cost.
struct Counts {
  long steps = 0;     ///< accepted
  long rejected = 0;  ///< tried again with a smaller step
  long rates = 0;     ///< right-hand sides (solutions of the control equations)
  long updates = 0;   ///< stress updates (implicit)
  long events = 0;    ///< located changes of branch, goals and stops
  /// Steps whose tangent was compared with differences of the update, and those where it was off by
  /// more than a tenth: foreign laws, where Settings::check_tangent asks for it
  long tangents_checked = 0, tangents_off = 0;
};

struct Outcome {
  Status status = Status::completed;
  double fraction = 0.0;     ///< finished part of the path, 1 if completed (legs count alike)
  double time = 0.0;         ///< test time at the end [s]
  int leg = 0;               ///< the leg in which it ended
  int stop = -1;             ///< which stop condition of that leg, if stopped
  std::string_view fault{};  ///< if law_failed: how, in a word of static text ("umat_crashed")
  Counts counts;
};

}  // namespace repose::point

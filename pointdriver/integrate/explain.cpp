#include <cstdio>

#include "pointdriver/integrate/simulate.hpp"
#include "pointdriver/integrate/strength.hpp"

namespace repose::point {
namespace {

std::string number(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", x);
  return text.data();
}

/// Where the element is: "eps_a = …, p = … Pa, q = … Pa"
std::string place(const LawInfo& law, std::span<const double> theta, const PointTest& test,
                  const Curve& curve) {
  if (curve.rows.empty()) return "the start";
  Curve last;
  last.rows = {curve.rows.front(), curve.rows.back()};
  std::vector<double> values;
  std::string text;
  const bool shear = test.path.frame != Frame::axisymmetric;
  for (const Quantity q : {shear ? Quantity::gamma : Quantity::eps_a, Quantity::p, Quantity::q}) {
    read_column(law, theta, test, last, q, values);
    text += (text.empty() ? "" : ", ") + std::string(column_name(q)) + " = " + number(values[1]);
  }
  return text;
}

std::string why(const LawInfo& law, std::span<const double> theta, const PointTest& test,
                const Curve& curve) {
  const Outcome& outcome = curve.outcome;
  switch (outcome.status) {
    case Status::completed:
      return "completed";
    case Status::stopped: {
      const auto& stops = test.path.legs[static_cast<std::size_t>(outcome.leg)].spec().stops;
      const Goal& stop = stops[static_cast<std::size_t>(outcome.stop)];
      return "stopped where " + std::string(column_name(stop.quantity)) + " reached " +
             number(stop.value) + (stop.of_stage ? ", counted from the start of the stage" : "");
    }
    case Status::separated:
      return "reached p = p_sep, where the material parts and carries no stress";
    case Status::beyond_limit:
      return "the prescribed stress cannot be carried any further: the tangent is singular or the "
             "strain runs away";
    case Status::no_response:
      return "no rate satisfies the prescription: at yield the material softens, and neither an "
             "elastic nor a plastic response follows the prescribed stress";
    case Status::goal_not_met:
      return "the stage's end value was not reached within its strain limit";
    case Status::step_limit:
      return "more steps than max_steps: the law is too stiff for this method or tolerance (cvode "
             "and implicit take stiff laws)";
    case Status::step_underflow:
      return "the step that the tolerance asks for falls below round-off (cvode and implicit take "
             "the stiffest laws)";
    case Status::not_converged:
      return "Newton's method did not converge at the smallest step: the prescribed stress may lie "
             "beyond what the material can carry";
    case Status::not_finite:
      return "the law gave no finite number";
    case Status::unsupported:
      return "method \"" + std::string(name_of(test.settings.method)) +
             "\" cannot treat a law whose stress follows the strain rate at once; use implicit";
    case Status::law_failed:
      return curve.said;
    case Status::bad_initial:
      try {
        check_start(law, theta, test);
        return "the law cannot start from the initial conditions";
      } catch (const InputError& error) {
        return "the law cannot start: " + std::string(error.what());
      }
  }
  return "";
}

/// A stress that the material cannot carry, with the figure; empty if that is not the reason.
std::string beyond_strength(const LawInfo& law, std::span<const double> theta,
                            const PointTest& test, const Curve& curve) {
  const auto strength = strength_exceeded(law, theta, test, curve);
  if (!strength) return "";
  const std::string name(column_name(strength->quantity));
  std::string text =
      "the stress asked for lies beyond the strength q = " + number(strength->q) + " Pa (";
  if (strength->quantity != Quantity::q) text += name + " = " + number(strength->carried) + ", ";
  text += "asked for: " + name + " = " + number(strength->asked);
  const bool viscous = law.has_stress_memory ? law.state.empty() : true;
  if (viscous) text += "; found at a strain rate of " + number(strength->rate) + " 1/s";
  text += ")";
  if (curve.outcome.status == Status::no_response)
    text += ": at yield the material softens, and no rate follows the prescribed stress";
  return text;
}

}  // namespace

std::string explain(const LawInfo& law, std::span<const double> theta, const PointTest& test,
                    const Curve& curve) {
  const Outcome& outcome = curve.outcome;
  std::string text = why(law, theta, test, curve);
  if (outcome.status == Status::completed || outcome.status == Status::bad_initial ||
      outcome.status == Status::unsupported)
    return text;
  if (outcome.status == Status::law_failed) {
    // nothing to find out about strength
  } else if (std::string told = beyond_strength(law, theta, test, curve); !told.empty())
    text = std::move(told);
  const Leg& leg = test.path.legs[static_cast<std::size_t>(outcome.leg)];
  return leg.spec().name + ": " + text + "; at " + place(law, theta, test, curve) + " (stage " +
         std::to_string(outcome.leg + 1) + " of " + std::to_string(test.path.legs.size()) +
         ", t = " + number(outcome.time) + " s, " + number(100.0 * outcome.fraction) +
         " % of the path)";
}

}  // namespace repose::point

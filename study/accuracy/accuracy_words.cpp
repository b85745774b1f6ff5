#include "study/accuracy/accuracy_words.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/number_text.hpp"
#include "io/progress.hpp"

namespace repose::study {
namespace {

std::string about(double x) { return fmt::format("{:g}", io::two_digits(x)); }
std::string seconds_text(double s) { return s < 60.0 ? about(s) + " s" : io::duration_text(s); }

/// "cells of 50, 25 and 12.5 mm, 2 runs each"
std::string words_for(const Plan& plan) {
  std::string cells;
  int most = 1;
  for (std::size_t k = 0; k < plan.levels.size(); ++k) {
    cells += fmt::format("{}{:.4g}",
                         k == 0                        ? ""
                         : k + 1 == plan.levels.size() ? " and "
                                                       : ", ",
                         1e3 * plan.levels[k].h);
    most = std::max(most, plan.levels[k].runs);
  }
  return fmt::format("cells of {} mm, {} each", cells,
                     most == 1 ? std::string("1 run") : fmt::format("{} runs", most));
}

/// "  not shown for ...: its own runs decide", or nothing.
std::string not_shown(const std::vector<std::string>& reasons) {
  if (reasons.empty()) return "";
  return fmt::format("  not shown for {}: its own runs decide\n", fmt::join(reasons, "; "));
}

std::string promise_words(const AccurateRun& work, const Answer& answer) {
  if (!answer.met)
    return fmt::format("cannot promise {}: {}", percent(work.goal().target),
                       answer.reasons.empty()
                           ? "no plan reaches it"
                           : fmt::format("its own runs show {}", bar_words(answer.estimate.error)));
  if (const auto shown = work.shown())
    return fmt::format("{} of {} such answers were within 1.5 of the target", shown->held,
                       shown->answers);
  return "by its own runs alone";
}

}  // namespace

std::string percent(double x) { return about(100.0 * x) + " %"; }

std::string bar_words(double error) {
  return std::isfinite(error) ? percent(error) : "no error bar at all (one size of cells)";
}

std::string refusal(const AccurateRun& work) {
  const AccuracyGoal& goal = work.goal();
  const double budget = goal.budget.value_or(HUGE_VAL);
  const auto [needed, within, steadier] = work.instead();
  std::string text = fmt::format("{} to {}", name_of(goal.quantity), percent(goal.target));
  if (needed.error <= goal.target)
    text += fmt::format(" needs about {} of CPU ({}), more than the budget of {}",
                        seconds_text(needed.cost), words_for(needed), seconds_text(budget));
  else
    text += fmt::format(" is out of reach: cells down to {:.3g} mm, 8 runs each, give about {}",
                        1e3 * needed.levels.back().h, percent(needed.error));
  if (within.cost <= budget && needed.error <= goal.target)
    text += fmt::format("; within it, about {} can be had ({}): --accuracy {}",
                        percent(within.error), words_for(within), about(within.error));
  if (needed.error <= goal.target)
    text += fmt::format("; or --budget {}", about(1.2 * needed.cost));
  if (steadier)
    text += fmt::format(
        "; front reads a thin tongue, which scatters: --for front_99 (where 99 % of the mass lies) "
        "needs about {}",
        seconds_text(steadier->cost));
  return text;
}

std::string plan_words(const AccurateRun& work) {
  const AccuracyGoal& goal = work.goal();
  const Candidate& way = work.choice().candidate;
  const Plan& plan = work.choice().plan;
  const std::vector<std::string>& reasons = work.choice().reasons;
  // a prediction is the charted scenes', of which this one is none where there are reasons
  const std::string expected =
      reasons.empty()
          ? fmt::format("predicted: {} to an error bar of {}, about {} of CPU", words_for(plan),
                        percent(plan.error), seconds_text(plan.cost))
          : fmt::format("from coarse to fine, until they show {}, for at most {} of CPU",
                        percent(goal.target), seconds_text(goal.budget.value_or(default_budget_s)));
  return fmt::format(
      "{}: {} to {}\n{}"
      "  {}\n"
      "  with kernel {}, transfer {}, courant {:g} (in place of the scene's h, kernel "
      "and step)\n",
      goal.file.scene.name, name_of(goal.quantity), percent(goal.target), not_shown(reasons),
      expected, mpm::name_of(way.kernel), mpm::name_of(way.transfer), way.courant);
}

std::string run_words(Quantity quantity, const SweepRun& run) {
  std::string figure;
  if (!is_curve(quantity))
    figure = fmt::format(", {} {:.4f} {}", name_of(quantity), run.figure(column_of(quantity)),
                         unit_of(quantity, run.scene().dimensions()));
  return fmt::format("  h {:.4g} mm, courant {:.3g}{}, {:.2g} s of CPU\n", 1e3 * run.scene().h,
                     run.scene().courant, figure, run.figure("cpu_s"));
}

std::string answer_words(const AccurateRun& work, const Answer& answer) {
  const AccuracyGoal& goal = work.goal();
  const Estimate& estimate = answer.estimate;
  const bool predicted = work.choice().reasons.empty();
  const std::string value =
      is_curve(goal.quantity)
          ? fmt::format("{} ± {} (of the area under the curve)", name_of(goal.quantity),
                        bar_words(estimate.error))
          : fmt::format("{} = {:.4g} ± {:.2g} {} ({})", name_of(goal.quantity), estimate.value[0],
                        estimate.error * std::abs(estimate.value[0]),
                        unit_of(goal.quantity, goal.file.scene.dimensions()),
                        bar_words(estimate.error));
  return fmt::format(
      "  {}; {}\n{}"
      "  from all runs; cells of {:.4g} mm alone are about {} off\n"
      "  {} of CPU{}\n",
      value, promise_words(work, answer), predicted ? not_shown(answer.reasons) : "",
      1e3 * work.convergence().levels().back().h, percent(work.finest_alone(estimate)),
      seconds_text(work.cpu_s()),
      predicted ? fmt::format(" (predicted {})", seconds_text(work.choice().plan.cost)) : "");
}

io::Json promise_json(const AccurateRun& work, const Answer& answer) {
  io::Json promise{{"kept_to", answer.met ? io::Json(work.goal().target) : io::Json()},
                   {"text", promise_words(work, answer)}};
  if (const auto shown = work.shown()) {
    promise["answers"] = shown->answers;
    promise["held"] = shown->held;
  }
  return promise;
}

}  // namespace repose::study

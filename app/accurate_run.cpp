#include "app/accurate_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "input/resolved_scene.hpp"
#include "io/json.hpp"
#include "io/number_text.hpp"
#include "io/progress.hpp"
#include "io/result_folder.hpp"
#include "report/picture/accuracy_picture.hpp"

namespace repose::app {
namespace {

using Json = io::Json;
using study::AccurateRun;

std::string about(double x) { return fmt::format("{:g}", io::two_digits(x)); }
std::string percent(double x) { return about(100.0 * x) + " %"; }
std::string seconds_text(double s) { return s < 60.0 ? about(s) + " s" : io::duration_text(s); }

/// "cells of 50, 25 and 12.5 mm, 2 runs each"
std::string words_for(const study::Plan& plan) {
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

/// Why a goal is refused before anything is run, and what could be asked for instead.
std::string refusal(const AccurateRun& work) {
  const study::AccuracyGoal& goal = work.goal();
  const double budget = goal.budget.value_or(HUGE_VAL);
  const auto [needed, within, steadier] = work.instead();
  std::string text = fmt::format("{} to {}", study::name_of(goal.quantity), percent(goal.target));
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

/// What is written and said of an AccurateRun.
class AccuracyCommand {
 public:
  explicit AccuracyCommand(const AccuracyRequest& request) : request_(request), work_(request) {
    if (work_.made_implicit())
      warnings_.push_back(
          "an explicit viscosity would make the steps very short: it is solved for instead "
          "(step.viscosity = \"implicit\")");
  }

  io::ExitCode run() {
    if (!work_.meets(work_.choice())) throw input::BadInput({refusal(work_)});
    tell_plan();
    const io::ResultFolder folder(request_.folder);
    const io::FolderClaim claim(folder);
    folder.remove_old_outputs();
    folder.write_file("input.toml", input::resolved_input(request_.file, request_.origin));
    const AccurateRun::End end = work_.run([&](const study::SweepRun& run) { tell_run(run); });
    switch (end) {
      case AccurateRun::End::interrupted:
        return stop_at_interrupt(folder);
      case AccurateRun::End::failed:
        return stop_at_failure(folder);
      case AccurateRun::End::met:
      case AccurateRun::End::missed:
        break;
    }
    return finish(folder);
  }

 private:
  void say(const std::string& text) const {
    if (!request_.quiet && !request_.json) fmt::print("{}", text);
    std::fflush(stdout);
  }
  void event(const Json& line) const {
    if (request_.json) fmt::print("{}\n", line.dump());
    std::fflush(stdout);
  }

  void tell_plan() const {
    const study::Candidate& way = work_.choice().candidate;
    const study::Plan& plan = work_.choice().plan;
    const std::vector<std::string>& reasons = work_.choice().reasons;
    // a prediction is the charted scenes', of which this one is none where there are reasons
    const std::string expected =
        reasons.empty()
            ? fmt::format("predicted: {} to an error bar of {}, about {} of CPU", words_for(plan),
                          percent(plan.error), seconds_text(plan.cost))
            : fmt::format("from coarse to fine, until they show {}, for at most {} of CPU",
                          percent(request_.target),
                          seconds_text(request_.budget.value_or(study::default_budget_s)));
    say(fmt::format(
        "{}: {} to {}\n{}"
        "  {}\n"
        "  with kernel {}, transfer {}, courant {:g} (in place of the scene's h, kernel "
        "and step)\n",
        scene().name, quantity(), percent(request_.target), not_shown(reasons), expected,
        mpm::name_of(way.kernel), mpm::name_of(way.transfer), way.courant));
    for (const std::string& warning : warnings_)
      if (!request_.quiet) fmt::print(stderr, "warning: {}\n", warning);
    event({{"event", "plan"},
           {"name", scene().name},
           {"quantity", quantity()},
           {"target", request_.target},
           {"error_bar", plan.error},
           {"cpu_s", plan.cost},
           {"finest_h_m", plan.levels.back().h},
           {"reasons", reasons}});
  }

  /// "  not shown for ...: its own runs decide", or nothing.
  static std::string not_shown(const std::vector<std::string>& reasons) {
    if (reasons.empty()) return "";
    return fmt::format("  not shown for {}: its own runs decide\n", fmt::join(reasons, "; "));
  }

  void tell_run(const study::SweepRun& run) const {
    std::string figure;
    if (!study::is_curve(request_.quantity))
      figure =
          fmt::format(", {} {:.4f} {}", quantity(), run.figure(study::column_of(request_.quantity)),
                      study::unit_of(request_.quantity, scene().dimensions()));
    say(fmt::format("  h {:.4g} mm, courant {:.3g}{}, {:.2g} s of CPU\n", 1e3 * run.scene().h,
                    run.scene().courant, figure, run.figure("cpu_s")));
    event({{"event", "run"},
           {"h_m", run.scene().h},
           {"courant", run.scene().courant},
           {"cpu_s", run.figure("cpu_s")}});
  }

  io::ExitCode finish(const io::ResultFolder& folder) {
    const study::Answer answer = work_.answer();
    const study::Estimate& estimate = answer.estimate;
    const double alone = work_.finest_alone(estimate);
    if (work_.front_at_far_wall())
      warnings_.push_back(
          "the material has reached the far wall: its front says nothing any more; a shorter "
          "scene.end_time or --for profile does");
    if (work_.stopped_by_budget()) warnings_.push_back("the budget ended a run before its end");
    folder.write_file("accuracy.csv", work_.runs_csv(estimate));
    folder.write_file("estimate.csv", work_.estimate_csv(estimate));
    folder.write_file(
        "advised.toml",
        input::resolved_input(work_.advised(),
                              fmt::format("The finest run behind an estimate of {}; it alone is "
                                          "about {} off.",
                                          quantity(), percent(alone))));
    if (request_.picture && std::isfinite(estimate.error)) draw(folder, estimate);
    const double h = work_.convergence().levels().back().h;
    Json s = work_.summary("done", request_.seed);
    s["met"] = answer.met;
    s["basis"] = study::name_of(answer.basis);
    s["reasons"] = answer.reasons;
    s["promise"] = promise_of(answer);
    if (!study::is_curve(request_.quantity)) s["value"] = estimate.value[0];
    s["error_bar"] = estimate.error;
    s["finest_alone"] = alone;
    s["finest_h_m"] = h;
    s["warnings"] = warnings_;
    folder.write_file("summary.json", s.dump(2) + "\n");
    event(s);
    tell_answer(folder, answer, alone);
    if (!request_.quiet && !request_.json)
      for (const std::string& warning : warnings_) fmt::print(stderr, "warning: {}\n", warning);
    if (answer.met) return io::ExitCode::done;
    fmt::print(stderr,
               "{}: cannot promise {} to {}, only to {}; a larger --budget goes on from the runs "
               "made\n",
               scene().name, quantity(), percent(request_.target), bar_text(estimate.error));
    return io::ExitCode::numerical_failure;
  }

  void draw(const io::ResultFolder& folder, const study::Estimate& estimate) {
    try {
      report::accuracy_picture(work_.runs(), request_.quantity, work_.convergence(), estimate,
                               request_.target, work_.bin())
          .render_svg(folder.file("accuracy.svg"));
    } catch (const report::PlotError& error) {
      warnings_.push_back(fmt::format("accuracy.svg could not be drawn: {}", error.what()));
    }
  }

  static std::string bar_text(double error) {
    return std::isfinite(error) ? percent(error) : "no error bar at all (one size of cells)";
  }

  /// What summary.json calls promise: kept_to is the target, or null where it cannot be promised.
  Json promise_of(const study::Answer& answer) const {
    Json promise{{"kept_to", answer.met ? Json(request_.target) : Json()},
                 {"text", promise_text(answer)}};
    if (const auto shown = work_.shown()) {
      promise["answers"] = shown->answers;
      promise["held"] = shown->held;
    }
    return promise;
  }

  std::string promise_text(const study::Answer& answer) const {
    if (!answer.met)
      return fmt::format("cannot promise {}: {}", percent(request_.target),
                         answer.reasons.empty() ? "no plan reaches it"
                                                : fmt::format("its own runs show {}",
                                                              bar_text(answer.estimate.error)));
    if (const auto shown = work_.shown())
      return fmt::format("{} of {} such answers were within 1.5 of the target", shown->held,
                         shown->answers);
    return "by its own runs alone";
  }

  void tell_answer(const io::ResultFolder& folder, const study::Answer& answer,
                   double alone) const {
    const study::Estimate& estimate = answer.estimate;
    const std::string value =
        study::is_curve(request_.quantity)
            ? fmt::format("{} ± {} (of the area under the curve)", quantity(),
                          bar_text(estimate.error))
            : fmt::format("{} = {:.4g} ± {:.2g} {} ({})", quantity(), estimate.value[0],
                          estimate.error * std::abs(estimate.value[0]),
                          study::unit_of(request_.quantity, scene().dimensions()),
                          bar_text(estimate.error));
    say(fmt::format(
        "  {}; {}\n{}"
        "  from all runs; cells of {:.4g} mm alone are about {} off\n"
        "  {} of CPU{}\n"
        "  {}: estimate.csv, accuracy.svg; `repose run {}` is the finest run\n",
        value, promise_text(answer),
        work_.choice().reasons.empty() ? not_shown(answer.reasons) : "",
        1e3 * work_.convergence().levels().back().h, percent(alone), seconds_text(work_.cpu_s()),
        work_.choice().reasons.empty()
            ? fmt::format(" (predicted {})", seconds_text(work_.choice().plan.cost))
            : "",
        folder.path().string(), folder.file("advised.toml").string()));
  }

  io::ExitCode stop_at_interrupt(const io::ResultFolder& folder) const {
    folder.write_file("summary.json", work_.summary("interrupted", request_.seed).dump(2) + "\n");
    if (!request_.quiet && !request_.json)
      fmt::print(stderr, "interrupted after {} runs; the same command with --resume continues\n",
                 work_.runs().size());
    return io::ExitCode::interrupted;
  }

  io::ExitCode stop_at_failure(const io::ResultFolder& folder) const {
    folder.write_file("summary.json", work_.summary("failed", request_.seed).dump(2) + "\n");
    if (work_.runs().empty()) {
      fmt::print(stderr, "{}: the budget ended the first run; a larger --budget is needed\n",
                 scene().name);
      return io::ExitCode::numerical_failure;
    }
    const study::SweepRun& run = work_.runs().back();
    fmt::print(
        stderr, "{}: failed: {}\n", run.scene().name,
        run.summary.reason.empty()
            ? fmt::format("it has no {}", study::column_of(request_.quantity, scene().dimensions()))
            : run.summary.reason);
    return io::ExitCode::numerical_failure;
  }

  const mpm::Scene& scene() const { return request_.file.scene; }
  std::string_view quantity() const { return study::name_of(request_.quantity); }

  const AccuracyRequest& request_;
  AccurateRun work_;
  std::vector<std::string> warnings_;
};

}  // namespace

io::ExitCode run_to_accuracy(const AccuracyRequest& request) {
  return AccuracyCommand(request).run();
}

}  // namespace repose::app

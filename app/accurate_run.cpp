#include "app/accurate_run.hpp"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "input/resolved_scene.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "report/picture/accuracy_picture.hpp"
#include "study/accuracy/accuracy_words.hpp"

namespace repose::app {
namespace {

using Json = io::Json;
using study::AccurateRun;

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
    if (!work_.meets(work_.choice())) throw input::BadInput({study::refusal(work_)});
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
    say(study::plan_words(work_));
    for (const std::string& warning : warnings_)
      if (!request_.quiet) fmt::print(stderr, "warning: {}\n", warning);
    event({{"event", "plan"},
           {"name", scene().name},
           {"quantity", quantity()},
           {"target", request_.target},
           {"error_bar", work_.choice().plan.error},
           {"cpu_s", work_.choice().plan.cost},
           {"finest_h_m", work_.choice().plan.levels.back().h},
           {"reasons", work_.choice().reasons}});
  }

  void tell_run(const study::SweepRun& run) const {
    say(study::run_words(request_.quantity, run));
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
                                          quantity(), study::percent(alone))));
    if (request_.picture && std::isfinite(estimate.error)) draw(folder, estimate);
    const double h = work_.convergence().levels().back().h;
    Json s = work_.summary("done", request_.seed);
    s["met"] = answer.met;
    s["basis"] = study::name_of(answer.basis);
    s["reasons"] = answer.reasons;
    s["promise"] = study::promise_json(work_, answer);
    if (!study::is_curve(request_.quantity)) s["value"] = estimate.value[0];
    s["error_bar"] = estimate.error;
    s["finest_alone"] = alone;
    s["finest_h_m"] = h;
    s["warnings"] = warnings_;
    folder.write_file("summary.json", s.dump(2) + "\n");
    event(s);
    say(study::answer_words(work_, answer) +
        fmt::format("  {}: estimate.csv, accuracy.svg; `repose run {}` is the finest run\n",
                    folder.path().string(), folder.file("advised.toml").string()));
    if (!request_.quiet && !request_.json)
      for (const std::string& warning : warnings_) fmt::print(stderr, "warning: {}\n", warning);
    if (answer.met) return io::ExitCode::done;
    fmt::print(stderr,
               "{}: cannot promise {} to {}, only to {}; a larger --budget goes on from the runs "
               "made\n",
               scene().name, quantity(), study::percent(request_.target),
               study::bar_words(estimate.error));
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

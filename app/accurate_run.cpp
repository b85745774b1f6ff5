#include "app/accurate_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "input/resolved_scene.hpp"
#include "io/interrupt.hpp"
#include "io/result_folder.hpp"
#include "mpm/step/simulation.hpp"
#include "mpm/study/estimate.hpp"
#include "report/picture/accuracy_picture.hpp"
#include "repose_version.hpp"
#include "study/accuracy/accuracy_table.hpp"
#include "study/accuracy/sweep_report.hpp"
#include "study/run/run_record.hpp"

namespace repose::app {
namespace {

using study::Convergence;
using study::Outcome;
using study::Plan;
using Json = nlohmann::ordered_json;

/// 2 significant digits: "about" figures must not look exact.
std::string about(double x) { return fmt::format("{:g}", std::stod(fmt::format("{:.1e}", x))); }
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

/// CPU seconds of one run with each of these cells and a Courant number of 1: measured on a few
/// steps with cells that make some thousand points, and 8 times as much for half of them (twice the
/// steps, four times the points). The kernels take equally long per step.
std::vector<double> costs_of(const mpm::Scene& scene, const study::Candidate& candidate,
                             const std::vector<double>& sizes, int threads) {
  constexpr double enough_points = 2000.0;
  const double area = std::pow(study::length_of(scene), 2);
  std::size_t at = 0;
  while (at + 1 < sizes.size() &&
         scene.points_per_cell * area / std::pow(sizes[at], 2) < enough_points)
    ++at;
  mpm::Scene tried = study::scene_with(scene, candidate, sizes[at]);
  mpm::raise_top_to_cells(tried);
  const study::Usage before = study::usage();
  const mpm::Estimate estimate = mpm::estimate(tried, threads);
  const study::Usage after = study::usage();
  // the estimate is in wall time, which other programs of the machine lengthen
  const double share = std::min(static_cast<double>(threads),
                                (after.cpu_s - before.cpu_s) / (after.wall_s - before.wall_s));
  std::vector<double> costs;
  for (std::size_t k = 0; k < sizes.size(); ++k)
    costs.push_back(share * estimate.seconds * candidate.courant *
                    std::pow(sizes[at] / sizes[k], 3));
  return costs;
}

class AccurateRun {
 public:
  explicit AccurateRun(const AccuracyRequest& request)
      : request_(request),
        scene_(request.file.scene),
        quantity_(request.quantity),
        budget_(request.budget.value_or(HUGE_VAL)),
        sizes_(study::sizes_for(scene_)) {
    if (sizes_.size() < 2)
      throw input::BadInput(
          {"there is no second cell size to compare with: neither twice nor half of "
           "grid.h fits the box and the bodies"});
    choose(quantity_, candidate_, plan_, costs_);
  }

  io::ExitCode run() {
    refuse_if_hopeless();
    tell_plan();
    const io::ResultFolder folder(request_.folder);
    folder.remove_old_outputs();
    folder.write_file("input.toml", input::resolved_input(request_.file, request_.origin));
    study::Convergence so_far(candidate_.model, study::length_of(scene_));
    const io::InterruptGuard interrupt;
    bool interrupted = false;
    const study::Outcome outcome = study::run_to_target(
        so_far, sizes_, costs_, request_.target, budget_,
        [&](const study::Level& next) -> std::optional<Eigen::VectorXd> {
          study::SweepRun run = study::run_of(
              request_.file, study::scene_with(scene_, candidate_, next.h, next.runs));
          interrupted = interrupt.requested() ||
                        study::carry_out(run, request_.runs, request_.threads, request_.resume) ==
                            io::ExitCode::interrupted;
          if (interrupted) return {};
          runs_.push_back(run);
          if (!run.done()) return {};
          Eigen::VectorXd value = study::shares_of(run, quantity_, sizes_.front());
          if (!value.allFinite()) return {};
          if (auto start = study::start_of(run, quantity_, sizes_.front()))
            so_far.starts_from(std::move(*start));
          learn_cost(run);
          tell_run(run);
          return value;
        });
    if (interrupted) return stop_at_interrupt(folder);
    if (outcome == study::Outcome::stopped) return stop_at_failure(folder, runs_.back());
    return finish(folder, so_far, outcome == study::Outcome::met);
  }

 private:
  /// The cheapest of the measured ways to run the scene.
  void choose(study::Quantity q, study::Candidate& chosen, study::Plan& plan,
              std::vector<double>& costs) {
    bool first = true, measured = true;
    const std::vector<study::Candidate> candidates = study::candidates_for(scene_, q, measured);
    // timed once, so that what is chosen does not depend on the moment
    if (unit_costs_.empty())
      unit_costs_ = costs_of(scene_, candidates.front(), sizes_, request_.threads);
    for (const study::Candidate& candidate : candidates) {
      std::vector<double> its_costs = unit_costs_;
      for (double& seconds : its_costs) seconds /= candidate.courant;
      const study::Plan its_plan =
          study::cheapest_plan(study::Convergence(candidate.model, study::length_of(scene_)),
                               sizes_, its_costs, request_.target, budget_);
      const auto rank = [&](const study::Plan& p) {
        const bool meets = p.error <= request_.target;
        return std::pair(!meets, meets ? p.cost : p.error);
      };
      if (!first && rank(its_plan) >= rank(plan)) continue;
      first = false;
      chosen = candidate;
      plan = its_plan;
      costs = its_costs;
    }
    if (!measured && q == quantity_)
      warnings_.push_back(
          "the errors of this law have not been measured: the largest of all laws' stand in");
  }

  void refuse_if_hopeless() {
    if (plan_.error <= request_.target && plan_.cost <= budget_) return;
    std::string text = fmt::format("{} to {}", study::name_of(quantity_), percent(request_.target));
    // what it would take without the budget
    const study::Convergence nothing(candidate_.model, study::length_of(scene_));
    const study::Plan needed =
        study::cheapest_plan(nothing, sizes_, costs_, request_.target, HUGE_VAL);
    const study::Plan within = study::cheapest_plan(nothing, sizes_, costs_, 0.0, budget_);
    if (needed.error <= request_.target)
      text += fmt::format(" needs about {} of CPU ({}), more than the budget of {}",
                          seconds_text(needed.cost), words_for(needed), seconds_text(budget_));
    else
      text += fmt::format(" is out of reach: cells down to {:.3g} mm, 8 runs each, give about {}",
                          1e3 * needed.levels.back().h, percent(needed.error));
    if (within.cost <= budget_ && needed.error <= request_.target)
      text += fmt::format("; within it, about {} can be had ({}): --accuracy {}",
                          percent(within.error), words_for(within), about(within.error));
    if (needed.error <= request_.target)
      text += fmt::format("; or --budget {}", about(1.2 * needed.cost));
    // a steadier measure of the same
    if (quantity_ == study::Quantity::front) {
      study::Candidate candidate;
      study::Plan plan;
      std::vector<double> costs;
      choose(study::Quantity::front_99, candidate, plan, costs);
      if (plan.error <= request_.target && plan.cost <= budget_)
        text += fmt::format(
            "; front reads a thin tongue, which scatters: --for front_99 (where 99 % of the mass "
            "lies) needs about {}",
            seconds_text(plan.cost));
    }
    throw input::BadInput({text});
  }

  void say(const std::string& text) const {
    if (!request_.quiet && !request_.json) fmt::print("{}", text);
    std::fflush(stdout);
  }
  void event(const Json& line) const {
    if (request_.json) fmt::print("{}\n", line.dump());
    std::fflush(stdout);
  }

  void tell_plan() const {
    say(fmt::format(
        "{}: {} to {}\n"
        "  predicted: {} to an error bar of {}, about {} of CPU\n"
        "  with kernel {}, transfer {}, courant {:g} (in place of the scene's h, kernel "
        "and step)\n",
        scene_.name, study::name_of(quantity_), percent(request_.target), words_for(plan_),
        percent(plan_.error), seconds_text(plan_.cost), mpm::name_of(candidate_.kernel),
        mpm::name_of(candidate_.transfer), candidate_.courant));
    for (const std::string& warning : warnings_)
      if (!request_.quiet) fmt::print(stderr, "warning: {}\n", warning);
    event({{"event", "plan"},
           {"name", scene_.name},
           {"quantity", study::name_of(quantity_)},
           {"target", request_.target},
           {"error_bar", plan_.error},
           {"cpu_s", plan_.cost},
           {"finest_h_m", plan_.levels.back().h}});
  }

  void tell_run(const study::SweepRun& run) const {
    std::string figure;
    if (!study::is_curve(quantity_))
      figure = fmt::format(", {} {:.4f} {}", study::name_of(quantity_),
                           run.figure(study::column_of(quantity_)), study::unit_of(quantity_));
    say(fmt::format("  h {:.4g} mm, courant {:.3g}{}, {:.2g} s of CPU\n", 1e3 * run.scene().h,
                    run.scene().courant, figure, run.figure("cpu_s")));
    event({{"event", "run"},
           {"h_m", run.scene().h},
           {"courant", run.scene().courant},
           {"cpu_s", run.figure("cpu_s")}});
  }

  /// What a run took tells better than a few steps what others will take. One factor for all: which
  /// of them are run does not depend on it, unless there is a budget.
  void learn_cost(const study::SweepRun& run) {
    constexpr double enough_points = 500.0;  // below, writing counts for more than stepping
    if (run.figure("points") < enough_points) return;
    const auto at = std::min_element(sizes_.begin(), sizes_.end(), [&](double a, double b) {
      return std::abs(a - run.scene().h) < std::abs(b - run.scene().h);
    });
    const double factor =
        run.figure("cpu_s") / costs_[static_cast<std::size_t>(at - sizes_.begin())];
    for (double& seconds : costs_) seconds *= factor;
  }

  double spent() const {
    double sum = 0.0;
    for (const study::SweepRun& run : runs_) sum += run.figure("cpu_s");
    return sum;
  }

  double point_steps() const {
    double sum = 0.0;
    for (const study::SweepRun& run : runs_) sum += run.point_steps();
    return sum;
  }

  /// Where the far wall has stopped the front, it no longer tells how far the material runs.
  void look_at_wall() {
    if (quantity_ != study::Quantity::front && quantity_ != study::Quantity::front_99) return;
    const study::SweepRun& run = runs_.back();
    if (run.scene().right.kind == mpm::Wall::Kind::periodic) return;
    if (run.figure("front_m") > run.scene().domain[0] - run.scene().h)
      warnings_.push_back(
          "the material has reached the far wall: its front says nothing any more; a shorter "
          "scene.end_time or --for profile does");
  }

  Json summary(const std::string& status) const {
    Json levels = Json::array();
    for (const study::SweepRun& run : runs_)
      levels.push_back({{"run", run.scene().name},
                        {"h_m", run.scene().h},
                        {"courant", run.scene().courant},
                        {"status", run.status()},
                        {"cpu_s", run.figure("cpu_s")}});
    return {{"repose", version_string},
            {"kind", "accuracy"},
            {"status", status},
            {"name", scene_.name},
            {"seed", request_.seed},
            {"quantity", study::name_of(quantity_)},
            {"target", request_.target},
            {"kernel", mpm::name_of(candidate_.kernel)},
            {"transfer", mpm::name_of(candidate_.transfer)},
            {"courant", candidate_.courant},
            {"predicted",
             {{"error_bar", plan_.error},
              {"cpu_s", plan_.cost},
              {"finest_h_m", plan_.levels.back().h},
              {"runs_each", plan_.levels.back().runs}}},
            {"cpu_s", spent()},
            {"point_steps", point_steps()},
            {"runs", levels}};
  }

  io::ExitCode finish(const io::ResultFolder& folder, const study::Convergence& so_far, bool met) {
    const study::Estimate estimate = so_far.estimate();
    look_at_wall();
    const double h = so_far.levels().back().h;
    const double alone = study::relative_distance(so_far.levels().back().mean(), estimate.value);
    std::string table = "h_m,courant,points,steps,cpu_s,difference_from_estimate\n";
    for (const study::SweepRun& run : runs_)
      table += fmt::format("{},{},{},{},{},{:.6g}\n", run.scene().h, run.scene().courant,
                           run.figure("points"), run.figure("steps"), run.figure("cpu_s"),
                           study::relative_distance(
                               study::shares_of(run, quantity_, sizes_.front()), estimate.value));
    folder.write_file("accuracy.csv", table);
    std::string values;
    if (study::is_curve(quantity_)) {
      values = study::curve_csv(estimate.value, quantity_, runs_.back().scene(), sizes_.front());
    } else {
      values = fmt::format("{0},{0}_error_bar\n{1:.10g},{2:.6g}\n", study::column_of(quantity_),
                           estimate.value[0], estimate.error * std::abs(estimate.value[0]));
    }
    folder.write_file("estimate.csv", values);
    input::SceneFile advised = request_.file;
    advised.scene = study::scene_with(scene_, candidate_, h);
    mpm::raise_top_to_cells(advised.scene);
    folder.write_file(
        "advised.toml",
        input::resolved_input(advised,
                              fmt::format("The finest run behind an estimate of {}; it alone is "
                                          "about {} off.",
                                          study::name_of(quantity_), percent(alone))));
    try {
      if (request_.picture)
        report::accuracy_picture(runs_, quantity_, so_far, estimate, request_.target,
                                 sizes_.front())
            .render_svg(folder.file("accuracy.svg"));
    } catch (const report::PlotError& error) {
      warnings_.push_back(fmt::format("accuracy.svg could not be drawn: {}", error.what()));
    }
    Json s = summary("done");
    s["met"] = met;
    if (!study::is_curve(quantity_)) s["value"] = estimate.value[0];
    s["error_bar"] = estimate.error;
    s["finest_alone"] = alone;
    s["finest_h_m"] = h;
    s["warnings"] = warnings_;
    folder.write_file("summary.json", s.dump(2) + "\n");
    event(s);
    const std::string value =
        study::is_curve(quantity_)
            ? fmt::format("{} ± {} (of the area under the curve)", study::name_of(quantity_),
                          percent(estimate.error))
            : fmt::format("{} = {:.4g} ± {:.2g} {} ({})", study::name_of(quantity_),
                          estimate.value[0], estimate.error * std::abs(estimate.value[0]),
                          study::unit_of(quantity_), percent(estimate.error));
    say(
        fmt::format("  {}; nine of ten such answers are within 1.5 of it\n"
                    "  from all runs; cells of {:.4g} mm alone are about {} off\n"
                    "  {} of CPU (predicted {})\n"
                    "  {}: estimate.csv, accuracy.svg; `repose run {}` is the finest run\n",
                    value, 1e3 * h, percent(alone), seconds_text(spent()), seconds_text(plan_.cost),
                    folder.path().string(), folder.file("advised.toml").string()));
    if (!request_.quiet && !request_.json)
      for (const std::string& warning : warnings_) fmt::print(stderr, "warning: {}\n", warning);
    if (met) return io::ExitCode::done;
    fmt::print(stderr,
               "{}: {} is not known to {}: this scene converges more slowly than those measured; "
               "a larger --budget goes on from the runs made\n",
               scene_.name, study::name_of(quantity_), percent(request_.target));
    return io::ExitCode::numerical_failure;
  }

  io::ExitCode stop_at_interrupt(const io::ResultFolder& folder) const {
    folder.write_file("summary.json", summary("interrupted").dump(2) + "\n");
    if (!request_.quiet && !request_.json)
      fmt::print(stderr, "interrupted after {} runs; the same command with --resume continues\n",
                 runs_.size());
    return io::ExitCode::interrupted;
  }

  io::ExitCode stop_at_failure(const io::ResultFolder& folder, const study::SweepRun& run) const {
    folder.write_file("summary.json", summary("failed").dump(2) + "\n");
    fmt::print(stderr, "{}: failed: {}\n", run.scene().name,
               run.summary.reason.empty() ? fmt::format("it has no {}", study::column_of(quantity_))
                                          : run.summary.reason);
    return io::ExitCode::numerical_failure;
  }

  const AccuracyRequest& request_;
  const mpm::Scene& scene_;
  study::Quantity quantity_;
  double budget_;
  std::vector<double> sizes_, costs_, unit_costs_;
  study::Candidate candidate_{};
  study::Plan plan_;
  std::vector<study::SweepRun> runs_;
  std::vector<std::string> warnings_;
};

}  // namespace

io::ExitCode run_to_accuracy(const AccuracyRequest& request) { return AccurateRun(request).run(); }

}  // namespace repose::app

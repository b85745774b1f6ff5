#include "study/accuracy/accurate_run.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "io/interrupt.hpp"
#include "io/json.hpp"
#include "models/instruction_set.hpp"
#include "mpm/study/estimate.hpp"
#include "repose_version.hpp"
#include "study/accuracy/sweep_report.hpp"
#include "study/run/run_record.hpp"

namespace repose::study {
namespace {

using Json = io::Json;

/// A few steps with cells that make some thousand points, and what bounds them.
EstimatedCost estimated_cost(const mpm::Scene& scene, const Candidate& candidate,
                             const std::vector<double>& sizes, int threads) {
  constexpr double enough_points = 2000.0;
  const double area = std::pow(length_of(scene), 2);
  std::size_t at = 0;
  while (at + 1 < sizes.size() &&
         scene.points_per_cell * area / std::pow(sizes[at], 2) < enough_points)
    ++at;
  mpm::Scene tried = scene_with(scene, candidate, sizes[at]);
  mpm::raise_top_to_cells(tried);
  const Usage before = usage();
  const mpm::Estimate estimate = mpm::estimate(tried, threads);
  const Usage after = usage();
  // the estimate is in wall time, which other programs of the machine lengthen
  const double share = std::min(static_cast<double>(threads),
                                (after.cpu_s - before.cpu_s) / (after.wall_s - before.wall_s));
  return {sizes[at], share * estimate.seconds, estimate.wave_dt_s / tried.courant,
          estimate.viscous_dt_s, scene.dimensions()};
}

/// Whether the front has ever come within a cell of the far wall.
bool touches_far_wall(const SweepRun& run) {
  if (run.scene().right.kind == mpm::Wall::Kind::periodic) return false;
  const auto front = run.series.find("front_m");
  if (front == run.series.end()) return false;
  const double wall = run.scene().domain[0] - run.scene().h;
  return std::any_of(front->second.begin(), front->second.end(),
                     [&](double x) { return x > wall; });
}

/// sizes_for(), of which there must be two.
std::vector<double> comparable_sizes(const mpm::Scene& scene) {
  std::vector<double> sizes = sizes_for(scene);
  if (sizes.size() < 2)
    throw input::BadInput(
        {"there is no second cell size to compare with: neither twice nor half of "
         "grid.h fits the box and the bodies"});
  return sizes;
}

}  // namespace

AccurateRun::AccurateRun(const AccuracyGoal& goal)
    : goal_(goal),
      scene_(goal.file.scene),
      sizes_(comparable_sizes(scene_)),
      question_{goal.target, goal.budget.value_or(HUGE_VAL), {}},
      so_far_(ErrorModel{}, length_of(scene_)) {
  estimate_costs();
  choice_ = choose(goal.quantity);
  costs_ = choice_.costs;
  question_.reasons = choice_.reasons;
  if (!question_.reasons.empty()) question_.budget = goal.budget.value_or(default_budget_s);
  so_far_ = Convergence(choice_.candidate.model, length_of(scene_));
}

/// Timed once, so that what is chosen does not depend on the moment. Where an explicit viscosity
/// would make the steps much shorter than the signals do, it is solved for instead if it can be.
void AccurateRun::estimate_costs() {
  // an implicit step takes 70 to 100 iterations where that happens (docs/implicit_viscosity.md)
  constexpr double worth_a_solve = 30.0;
  const Candidate candidate = candidates_for(scene_, goal_.quantity).front();
  unit_cost_ = estimated_cost(scene_, candidate, sizes_, goal_.threads);
  if (unit_cost_.wave_dt_s < worth_a_solve * unit_cost_.viscous_dt_s) return;
  mpm::Scene implicit = scene_;
  implicit.viscosity = mpm::Viscosity::implicit_solve;
  try {
    mpm::Scene tried = scene_with(implicit, candidate, scene_.h);
    mpm::raise_top_to_cells(tried);
    mpm::validate(tried);
  } catch (const InputError&) {
    return;
  }
  scene_ = std::move(implicit);
  made_implicit_ = true;
  unit_cost_ = estimated_cost(scene_, candidate, sizes_, goal_.threads);
}

/// Why the model does not speak for the scene and this target.
std::vector<std::string> AccurateRun::reasons_for(Quantity q) const {
  std::vector<std::string> reasons = beyond_training(scene_);
  if (!reasons.empty()) return reasons;
  const LawInfo& law = find_law(scene_.bodies.front().law);
  const auto known = rehearsed(law.name, law.option, q, goal_.target);
  if (!known)
    reasons.push_back(
        fmt::format("{} of {} to {:g} %", name_of(q), law.name, 100.0 * goal_.target));
  else if (!known->shown())
    reasons.push_back(fmt::format("{} of {} to {:g} %, where {} of {} answers held", name_of(q),
                                  law.name, 100.0 * goal_.target, known->held, known->answers));
  return reasons;
}

/// The cheapest of the ways to run the scene.
Choice AccurateRun::choose(Quantity q) const {
  const std::vector<std::string> reasons = reasons_for(q);
  std::optional<Choice> best;
  for (const Candidate& candidate : candidates_for(scene_, q)) {
    Choice its{candidate, {}, {}, reasons};
    for (const double h : sizes_)
      its.costs.push_back(seconds_with(unit_cost_, h, candidate.courant));
    const Convergence nothing(candidate.model, length_of(scene_));
    its.plan = reasons.empty() ? cheapest_plan(nothing, sizes_, its.costs, goal_.target,
                                               goal_.budget.value_or(HUGE_VAL))
                               : expected_own_runs(nothing, goal_.target, sizes_, its.costs);
    const auto rank = [&](const Plan& p) {
      const bool meets = p.error <= goal_.target;
      return std::pair(!meets, meets ? p.cost : p.error);
    };
    if (!best || rank(its.plan) < rank(best->plan)) best = std::move(its);
  }
  return *std::move(best);
}

bool AccurateRun::meets(const Choice& choice) const {
  if (!choice.reasons.empty()) return true;
  return choice.plan.error <= goal_.target && choice.plan.cost <= goal_.budget.value_or(HUGE_VAL);
}

std::optional<Rehearsed> AccurateRun::shown() const {
  if (answer().basis != Basis::measured) return {};
  const LawInfo& law = find_law(scene_.bodies.front().law);
  return rehearsed(law.name, law.option, goal_.quantity, goal_.target);
}

AccurateRun::Instead AccurateRun::instead() const {
  const Convergence nothing(choice_.candidate.model, length_of(scene_));
  Instead other{cheapest_plan(nothing, sizes_, costs_, goal_.target, HUGE_VAL),
                cheapest_plan(nothing, sizes_, costs_, 0.0, question_.budget),
                {}};
  if (goal_.quantity == Quantity::front) {
    const Choice steadier = choose(Quantity::front_99);
    if (meets(steadier)) other.steadier = steadier.plan;
  }
  return other;
}

std::optional<Eigen::VectorXd> AccurateRun::value_of_next(
    const Level& next, const std::function<void(const SweepRun&)>& after_run) {
  const io::InterruptGuard interrupt;
  SweepRun run = run_of(goal_.file, scene_with(scene_, choice_.candidate, next.h, next.runs));
  const double begun = usage().cpu_s;
  const io::ExitCode code =
      carry_out(run, goal_.runs, goal_.threads, goal_.resume, question_.budget - cpu_s());
  if (code == io::ExitCode::interrupted) {
    interrupted_ = interrupt.requested();
    stopped_by_budget_ = !interrupted_;
    stopped_s_ += usage().cpu_s - begun;
    return {};
  }
  runs_.push_back(run);
  if (!run.done()) return {};
  Eigen::VectorXd value = shares_of(run, goal_.quantity, bin());
  if (!value.allFinite()) return {};
  if (auto start = start_of(run, goal_.quantity, bin())) so_far_.starts_from(std::move(*start));
  // what reaches the far wall comes back from it: no training scene did that
  if (question_.reasons.empty() && touches_far_wall(run))
    question_.reasons.emplace_back("material that reaches the far wall");
  learn_cost(run);
  after_run(run);
  return value;
}

AccurateRun::End AccurateRun::run(const std::function<void(const SweepRun&)>& after_run) {
  const io::InterruptGuard interrupt;
  const Outcome outcome = run_to_target(so_far_, question_, sizes_, costs_, [&](const Level& next) {
    return value_of_next(next, after_run);
  });
  if (interrupted_ || interrupt.requested()) return End::interrupted;
  if (outcome == Outcome::met) return End::met;
  if (outcome == Outcome::out_of_reach || stopped_by_budget_)
    return so_far_.levels().empty() ? End::failed : End::missed;
  return End::failed;
}

/// What a run took tells better than a few steps what others will take. One factor for all: which
/// of them are run does not depend on it, unless there is a budget.
void AccurateRun::learn_cost(const SweepRun& run) {
  constexpr double enough_points = 500.0;  // below, writing counts for more than stepping
  if (run.figure("points") < enough_points) return;
  const auto at = std::min_element(sizes_.begin(), sizes_.end(), [&](double a, double b) {
    return std::abs(a - run.scene().h) < std::abs(b - run.scene().h);
  });
  const double factor = run.figure("cpu_s") / costs_[static_cast<std::size_t>(at - sizes_.begin())];
  for (double& seconds : costs_) seconds *= factor;
}

double AccurateRun::cpu_s() const {
  double sum = stopped_s_;
  for (const SweepRun& run : runs_) sum += run.figure("cpu_s");
  return sum;
}

double AccurateRun::point_steps() const {
  double sum = 0.0;
  for (const SweepRun& run : runs_) sum += run.point_steps();
  return sum;
}

bool AccurateRun::front_at_far_wall() const {
  if (goal_.quantity != Quantity::front && goal_.quantity != Quantity::front_99) return false;
  const SweepRun& run = runs_.back();
  return run.scene().right.kind != mpm::Wall::Kind::periodic &&
         run.figure("front_m") > run.scene().domain[0] - run.scene().h;
}

double AccurateRun::finest_alone(const Estimate& estimate) const {
  return relative_distance(so_far_.levels().back().mean(), estimate.value);
}

input::SceneFile AccurateRun::advised() const {
  input::SceneFile file = goal_.file;
  file.scene = scene_with(scene_, choice_.candidate, so_far_.levels().back().h);
  mpm::raise_top_to_cells(file.scene);
  return file;
}

Json AccurateRun::summary(const std::string& status, std::uint64_t seed) const {
  Json levels = Json::array();
  for (const SweepRun& run : runs_)
    levels.push_back({{"run", run.scene().name},
                      {"h_m", run.scene().h},
                      {"courant", run.scene().courant},
                      {"status", run.status()},
                      {"cpu_s", run.figure("cpu_s")}});
  return {{"repose", version_string},
          {"instruction_set", std::string(instruction_set())},
          {"kind", "accuracy"},
          {"status", status},
          {"name", scene_.name},
          {"seed", seed},
          {"quantity", name_of(goal_.quantity)},
          {"target", goal_.target},
          {"kernel", mpm::name_of(choice_.candidate.kernel)},
          {"transfer", mpm::name_of(choice_.candidate.transfer)},
          {"courant", choice_.candidate.courant},
          {"predicted",
           {{"error_bar", choice_.plan.error},
            {"cpu_s", choice_.plan.cost},
            {"finest_h_m", choice_.plan.levels.back().h},
            {"runs_each", choice_.plan.levels.back().runs}}},
          {"cpu_s", cpu_s()},
          {"point_steps", point_steps()},
          {"runs", levels}};
}

std::string AccurateRun::runs_csv(const Estimate& estimate) const {
  std::string table = "h_m,courant,points,steps,cpu_s,difference_from_estimate\n";
  for (const SweepRun& run : runs_)
    table += fmt::format("{},{},{},{},{},{:.6g}\n", run.scene().h, run.scene().courant,
                         run.figure("points"), run.figure("steps"), run.figure("cpu_s"),
                         relative_distance(shares_of(run, goal_.quantity, bin()), estimate.value));
  return table;
}

std::string AccurateRun::estimate_csv(const Estimate& estimate) const {
  if (is_curve(goal_.quantity))
    return curve_csv(estimate.value, goal_.quantity, runs_.back().scene(), bin());
  return fmt::format("{0},{0}_error_bar\n{1:.10g},{2:.6g}\n", column_of(goal_.quantity),
                     estimate.value[0], estimate.error * std::abs(estimate.value[0]));
}

}  // namespace repose::study

#include "study/accuracy/accurate_run.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "io/interrupt.hpp"
#include "io/json.hpp"
#include "mpm/study/estimate.hpp"
#include "repose_version.hpp"
#include "study/accuracy/sweep_report.hpp"
#include "study/run/run_record.hpp"

namespace repose::study {
namespace {

using Json = io::Json;

/// CPU seconds of one run with each of these cells and a Courant number of 1: measured on a few
/// steps with cells that make some thousand points, and 8 times as much for half of them (twice the
/// steps, four times the points). The kernels take equally long per step.
std::vector<double> costs_of(const mpm::Scene& scene, const Candidate& candidate,
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
  std::vector<double> costs;
  for (std::size_t k = 0; k < sizes.size(); ++k)
    costs.push_back(share * estimate.seconds * candidate.courant *
                    std::pow(sizes[at] / sizes[k], 3));
  return costs;
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
      budget_(goal.budget.value_or(HUGE_VAL)),
      sizes_(comparable_sizes(scene_)),
      so_far_(ErrorModel{}, length_of(scene_)) {
  bool measured = true;
  // timed once, so that what is chosen does not depend on the moment
  unit_costs_ = costs_of(scene_, candidates_for(scene_, goal.quantity, measured).front(), sizes_,
                         goal.threads);
  choice_ = choose(goal.quantity);
  costs_ = choice_.costs;
  so_far_ = Convergence(choice_.candidate.model, length_of(scene_));
}

/// The cheapest of the measured ways to run the scene.
Choice AccurateRun::choose(Quantity q) const {
  std::optional<Choice> best;
  bool measured = true;
  for (const Candidate& candidate : candidates_for(scene_, q, measured)) {
    Choice its{candidate, {}, unit_costs_, true};
    for (double& seconds : its.costs) seconds /= candidate.courant;
    its.plan = cheapest_plan(Convergence(candidate.model, length_of(scene_)), sizes_, its.costs,
                             goal_.target, budget_);
    const auto rank = [&](const Plan& p) {
      const bool meets = p.error <= goal_.target;
      return std::pair(!meets, meets ? p.cost : p.error);
    };
    if (!best || rank(its.plan) < rank(best->plan)) best = std::move(its);
  }
  best->measured = measured;
  return *std::move(best);
}

bool AccurateRun::meets(const Choice& choice) const {
  return choice.plan.error <= goal_.target && choice.plan.cost <= budget_;
}

AccurateRun::Instead AccurateRun::instead() const {
  const Convergence nothing(choice_.candidate.model, length_of(scene_));
  Instead other{cheapest_plan(nothing, sizes_, costs_, goal_.target, HUGE_VAL),
                cheapest_plan(nothing, sizes_, costs_, 0.0, budget_),
                {}};
  if (goal_.quantity == Quantity::front) {
    const Choice steadier = choose(Quantity::front_99);
    if (meets(steadier)) other.steadier = steadier.plan;
  }
  return other;
}

AccurateRun::End AccurateRun::run(const std::function<void(const SweepRun&)>& after_run) {
  const io::InterruptGuard interrupt;
  bool interrupted = false;
  const Outcome outcome = run_to_target(
      so_far_, sizes_, costs_, goal_.target, budget_,
      [&](const Level& next) -> std::optional<Eigen::VectorXd> {
        SweepRun run = run_of(goal_.file, scene_with(scene_, choice_.candidate, next.h, next.runs));
        interrupted = interrupt.requested() || carry_out(run, goal_.runs, goal_.threads,
                                                         goal_.resume) == io::ExitCode::interrupted;
        if (interrupted) return {};
        runs_.push_back(run);
        if (!run.done()) return {};
        Eigen::VectorXd value = shares_of(run, goal_.quantity, bin());
        if (!value.allFinite()) return {};
        if (auto start = start_of(run, goal_.quantity, bin()))
          so_far_.starts_from(std::move(*start));
        learn_cost(run);
        after_run(run);
        return value;
      });
  if (interrupted) return End::interrupted;
  if (outcome == Outcome::stopped) return End::failed;
  return outcome == Outcome::met ? End::met : End::missed;
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
  double sum = 0.0;
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

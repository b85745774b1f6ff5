#include "calibration/multistart.hpp"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "calibration/uncertainty.hpp"

namespace repose::calibration {
namespace {

using Eigen::VectorXd;

OptimiseOptions local_options(const FitOptions& options, int index) {
  OptimiseOptions o;
  o.max_evaluations = options.local_evaluations;
  o.x_tolerance = options.x_tolerance;
  o.seed = options.seed + static_cast<std::uint64_t>(index);
  return o;
}

StartResult run_one(const Problem& problem, const FitOptions& options, int index) {
  StartResult result;
  result.index = index;
  result.from =
      index == 0 ? problem.space().start()
                 : problem.space().spread_point(static_cast<std::size_t>(index - 1), options.seed);
  // A start whose paths break off is drawn towards the given one until they finish: where none even
  // begins, the penalty is flat and leads nowhere.
  Evaluation e;
  for (int halvings = 0; index > 0 && halvings < 8; ++halvings) {
    problem.evaluate(result.from, false, e);
    if (!e.failed) break;
    result.from = 0.5 * (result.from + problem.space().start());
  }
  VectorXd z = result.from;
  const bool search = index == 0 && options.global != "none";
  if (search) {
    OptimiseOptions o = local_options(options, index);
    o.max_evaluations = options.global_evaluations;
    o.x_tolerance = 1e-6;
    // linkage restarts its inner local search: with gradients where the fit's own algorithm uses
    // them
    const Algorithm* local = find_algorithm(options.local);
    if (local != nullptr && local->name.starts_with("L")) o.inner = local->name;
    result.global = optimise(problem, options.global, z, o);
    z = result.global.z;
  }
  if (options.local == "none") {
    if (!search) {
      result.optimum = Optimum{};
      problem.evaluate(z, false, e);
      result.optimum.z = z;
      result.optimum.objective = e.objective();
      result.optimum.failed = e.failed;
      result.optimum.evaluations = 1;
      result.optimum.why = "converged";
    } else {
      result.optimum = result.global;
    }
    return result;
  }
  result.optimum = optimise(problem, options.local, z, local_options(options, index));
  return result;
}

}  // namespace

std::vector<StartResult> run_starts(const Problem& problem, const FitOptions& options,
                                    const std::vector<StartResult>& done,
                                    const std::function<void(const StartResult&)>& after) {
  const int to =
      options.starts_to < 0 ? options.starts : std::min(options.starts_to, options.starts);
  std::vector<StartResult> results = done;
  std::vector<int> open;
  for (int i = options.starts_from; i < to; ++i)
    if (std::none_of(done.begin(), done.end(), [&](const StartResult& r) { return r.index == i; }))
      open.push_back(i);
  std::mutex mutex;
  tbb::parallel_for(std::size_t{0}, open.size(), [&](std::size_t k) {
    if (problem.interrupted()) return;
    StartResult result = run_one(problem, options, open[k]);
    const std::lock_guard lock(mutex);
    // a start that was cut off is kept as the best known, but not as done
    if (after && result.optimum.why != "interrupted") after(result);
    results.push_back(std::move(result));
  });
  std::sort(results.begin(), results.end(),
            [](const StartResult& a, const StartResult& b) { return a.index < b.index; });
  return results;
}

const StartResult& best_of(const std::vector<StartResult>& starts) {
  return *std::min_element(starts.begin(), starts.end(),
                           [](const StartResult& a, const StartResult& b) {
                             return a.optimum.objective < b.optimum.objective;
                           });
}

std::vector<Cluster> clusters(const Problem& problem, const std::vector<StartResult>& starts) {
  std::vector<const StartResult*> order;
  for (const StartResult& s : starts) order.push_back(&s);
  std::stable_sort(order.begin(), order.end(), [](const StartResult* a, const StartResult* b) {
    return a->optimum.objective < b->optimum.objective;
  });
  std::vector<Cluster> list;
  // objectives below round-off of the residuals are all zero
  const double floor = 1e-12 * static_cast<double>(problem.size());
  for (const StartResult* s : order) {
    const auto same = [&](const Cluster& c) {
      return (c.z - s->optimum.z).cwiseAbs().maxCoeff() < 0.01 &&
             std::abs(c.objective - s->optimum.objective) <= 1e-3 * c.objective + floor;
    };
    const auto found = std::find_if(list.begin(), list.end(), same);
    if (found != list.end()) {
      found->starts.push_back(s->index);
      continue;
    }
    Cluster c;
    c.z = s->optimum.z;
    c.objective = s->optimum.objective;
    c.starts = {s->index};
    c.same_prediction = !list.empty() && c.objective - list.front().objective <=
                                             1e-3 * list.front().objective + floor;
    list.push_back(std::move(c));
  }
  return list;
}

namespace {

/// Scales of the channels whose noise is not declared, from their residuals at z.
VectorXd settled_scales(const Problem& problem, const VectorXd& z) {
  Evaluation e;
  problem.with_loss({}).evaluate(z, false, e);
  const double share =
      static_cast<double>(problem.parameters()) / static_cast<double>(problem.data_rows());
  VectorXd scales = problem.scales();
  for (std::size_t k = 0; k < problem.blocks().size(); ++k) {
    const Block& b = problem.blocks()[k];
    if (problem.targets()[b.target].channels[b.channel].noise) continue;
    constexpr double least = 1e-8;  // of the range: what the integrator leaves
    const VectorXd r = e.r.segment(b.first, b.rows);
    scales[static_cast<Eigen::Index>(k)] = settled_scale(
        problem.loss(), r, share * static_cast<double>(b.rows), median_scale(r), least * b.factor);
  }
  return scales;
}

}  // namespace

void settle(Problem& problem, const FitOptions& options, std::vector<StartResult>& starts) {
  const bool priors = problem.prior_weights().size() > 0, robust = problem.loss().robust();
  if ((!priors && !robust) || starts.empty() || options.local == "none") return;
  // by differences an optimiser that minds their noise is the user's choice
  const bool exact =
      std::all_of(problem.targets().begin(), problem.targets().end(),
                  [](const Target& t) { return t.held_out || t.simulator->has_derivatives(); });
  const auto refit = [&](StartResult& s) {
    const OptimiseOptions o = local_options(options, s.index);
    Optimum again = exact ? levenberg_marquardt(problem, s.optimum.z, o)
                          : optimise(problem, options.local, s.optimum.z, o);
    again.evaluations += s.optimum.evaluations;
    again.gradients += s.optimum.gradients;
    again.seconds += s.optimum.seconds;
    again.trace = std::move(s.optimum.trace);
    if (s.optimum.why == "interrupted") again.why = s.optimum.why;
    s.optimum = std::move(again);
  };
  auto best = starts.begin() + (&best_of(starts) - starts.data());
  StartResult leading = *best;
  for (int round = 0; round < 40 && !problem.interrupted(); ++round) {
    double change = 0.0;
    const auto settled = [&](const VectorXd& from, const VectorXd& to) {
      const VectorXd before = from.array().log();
      VectorXd after = to.array().log();
      // a misfit that counts as noise in one round and not in the next goes half way
      if (round > 10) after = 0.5 * (before + after);
      change = std::max(change, (after - before).cwiseAbs().maxCoeff());
      return VectorXd(after.array().exp());
    };
    if (robust)
      problem.set_scales(settled(problem.scales(), settled_scales(problem, leading.optimum.z)));
    if (priors)
      problem.set_prior_weights(
          settled(problem.prior_weights(), weighed_priors(problem, leading.optimum.z)));
    refit(leading);
    if (change < 1e-6) break;
  }
  tbb::parallel_for(std::size_t{0}, starts.size(), [&](std::size_t k) {
    if (starts[k].index != leading.index) refit(starts[k]);
  });
  *best = std::move(leading);
}

bool converged(const Problem& problem, const std::vector<StartResult>& starts) {
  const auto ended = [](const StartResult& s) {
    return s.optimum.why == "converged" || s.optimum.why == "round-off";
  };
  const std::vector<int> same = clusters(problem, starts).front().starts;
  return std::any_of(starts.begin(), starts.end(), [&](const StartResult& s) {
    return ended(s) && std::find(same.begin(), same.end(), s.index) != same.end();
  });
}

}  // namespace repose::calibration

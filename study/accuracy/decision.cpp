#include "study/accuracy/decision.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "study/accuracy/own_runs.hpp"

namespace repose::study {
namespace {

/// Runs of one size that own runs average at most: each further one would add less than an eighth.
constexpr int most_own_runs = 4;
/// Own bars over the bias of the finest size, as they come out where errors are regular of order 1:
/// half of what is extrapolated and half of what the last step moved it.
constexpr double own_caution = 0.8;

bool is_power_of_two(double ratio) {
  const double halvings = std::log2(ratio);
  return std::abs(halvings - std::round(halvings)) < 1e-6;
}

/// Whether own runs make use of a size: a half, a quarter, ... of the coarsest or of two thirds of
/// it.
bool is_own_size(const std::vector<double>& sizes, double h) {
  return is_power_of_two(sizes.front() / h) || is_power_of_two(2.0 * sizes.front() / (3.0 * h));
}

std::size_t index_of(const std::vector<double>& sizes, double h) {
  const auto at = std::min_element(sizes.begin(), sizes.end(), [&](double a, double b) {
    return std::abs(a - h) < std::abs(b - h);
  });
  return static_cast<std::size_t>(at - sizes.begin());
}

Answer from_own_runs(const Convergence& so_far, const Question& question,
                     std::vector<std::string> reasons) {
  Answer answer;
  answer.basis = Basis::own_runs;
  answer.reasons = std::move(reasons);
  const std::vector<Resolution>& levels = so_far.levels();
  const auto own = own_estimate(levels, so_far.scatter_at(levels.back().h));
  if (!own) {
    answer.estimate = {levels.back().mean(), HUGE_VAL, {}};
    return answer;
  }
  answer.estimate = {own->value, own->error, {}};
  answer.scattered = own->scattered;
  answer.met = own->sizes == 3 && own->error <= question.target;
  return answer;
}

}  // namespace

Answer answer_of(const Convergence& so_far, const Question& question) {
  if (!question.reasons.empty()) return from_own_runs(so_far, question, question.reasons);
  const double shown = so_far.shown_over_expected();
  if (shown > most_shown)
    return from_own_runs(
        so_far, question,
        {fmt::format("its runs differ by {:.2g} times what such scenes' do", shown)});
  Answer answer;
  answer.estimate = so_far.estimate();
  if (so_far.levels().size() < 2) {
    answer.estimate.error = HUGE_VAL;
    return answer;
  }
  const auto own = own_estimate(so_far.levels(), so_far.scatter_at(so_far.levels().back().h));
  if (own && own->sizes == 3 &&
      relative_distance(answer.estimate.value, own->value) > answer.estimate.error + own->error)
    return from_own_runs(so_far, question,
                         {"its runs tend to something else than such scenes' do"});
  answer.met = answer.estimate.error <= question.target;
  return answer;
}

namespace {

std::optional<Level> next_of_plan(const Convergence& so_far, const Question& question,
                                  const std::vector<double>& sizes,
                                  const std::vector<double>& seconds) {
  const std::vector<Resolution>& have = so_far.levels();
  const Plan plan = cheapest_plan(so_far, sizes, seconds, question.target, question.budget);
  if (have.size() >= 2 && (plan.error > question.target || plan.cost > question.budget)) return {};
  for (std::size_t k = 0; k < plan.levels.size(); ++k) {
    const int made = k < have.size() ? static_cast<int>(have[k].runs.size()) : 0;
    if (made < plan.levels[k].runs) return Level{plan.levels[k].h, made};
  }
  return {};
}

std::optional<Level> next_own_run(const Convergence& so_far, const Answer& answer,
                                  const Question& question, const std::vector<double>& sizes,
                                  const std::vector<double>& seconds) {
  const std::vector<Resolution>& have = so_far.levels();
  double spent = 0.0;
  for (const Resolution& level : have)
    spent += static_cast<double>(level.runs.size()) * seconds[index_of(sizes, level.h)];
  const auto affordable = [&](double h) {
    return spent + seconds[index_of(sizes, h)] <= question.budget;
  };
  if (!have.empty()) {
    const auto made = static_cast<int>(have.back().runs.size());
    // an error bar is a root of squares: beyond 1/√2 of it, scatter is the larger part
    const bool scatters = answer.scattered > std::sqrt(0.5) * answer.estimate.error;
    if (scatters && made < most_own_runs && affordable(have.back().h))
      return Level{have.back().h, made};
  }
  for (const double h : sizes) {
    if (!have.empty() && h > 0.999 * have.back().h) continue;
    if (!is_own_size(sizes, h)) continue;
    if (!affordable(h)) return {};
    return Level{h, 0};
  }
  return {};
}

}  // namespace

std::optional<Level> next_run(const Convergence& so_far, const Question& question,
                              const std::vector<double>& sizes,
                              const std::vector<double>& seconds) {
  if (so_far.levels().empty() && question.reasons.empty())
    return next_of_plan(so_far, question, sizes, seconds);
  const Answer answer = so_far.levels().empty() ? Answer{} : answer_of(so_far, question);
  if (answer.basis == Basis::measured && question.reasons.empty())
    return next_of_plan(so_far, question, sizes, seconds);
  return next_own_run(so_far, answer, question, sizes, seconds);
}

Plan expected_own_runs(const Convergence& nothing_yet, double target,
                       const std::vector<double>& sizes, const std::vector<double>& seconds) {
  Plan plan;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    if (!is_own_size(sizes, sizes[k])) continue;
    plan.levels.push_back({sizes[k], 1});
    plan.cost += seconds[k];
    plan.error = own_caution * nothing_yet.bias_at(sizes[k]);
    if (plan.error <= target && plan.levels.size() >= 4) break;
  }
  return plan;
}

Outcome run_to_target(Convergence& so_far, const Question& question,
                      const std::vector<double>& sizes, const std::vector<double>& seconds,
                      const std::function<std::optional<Eigen::VectorXd>(const Level&)>& run) {
  for (;;) {
    if (!so_far.levels().empty() && answer_of(so_far, question).met) return Outcome::met;
    const std::optional<Level> next = next_run(so_far, question, sizes, seconds);
    if (!next) return Outcome::out_of_reach;
    std::optional<Eigen::VectorXd> value = run(*next);
    if (!value) return Outcome::stopped;
    so_far.add(next->h, std::move(*value));
  }
}

}  // namespace repose::study

#include "calibration/error_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace repose::calibration {
namespace {

using Eigen::VectorXd;

/// What the model's constants weigh beside the bias that one size shows, and beside one run more of
/// a size.
constexpr double model_biases = 0.5;
constexpr double model_runs = 3.0;
/// Four fifths of a normal distribution lie within so many standard deviations.
constexpr double four_fifths = 1.2816;
/// Sizes closer than this are no pair to extrapolate from.
constexpr double least_ratio = 1.9;

/// The finest of the sizes, coarse to fine, that is coarse enough beside sizes[fine]; −1: none.
template <class Sizes>
std::ptrdiff_t partner(const Sizes& sizes, std::size_t fine) {
  for (std::size_t k = fine; k-- > 0;)
    if (sizes[k].h >= least_ratio * sizes[fine].h) return static_cast<std::ptrdiff_t>(k);
  return -1;
}

double squared(double x) { return x * x; }

}  // namespace

double ErrorModel::expected_bias(double x) const { return bias * std::pow(x, order); }
double ErrorModel::expected_scatter(double x) const { return scatter * std::pow(x, scatter_order); }

void Convergence::add(double h, VectorXd value) {
  const auto same = std::find_if(levels_.begin(), levels_.end(), [&](const Resolution& level) {
    return std::abs(level.h / h - 1.0) < 1e-9;
  });
  if (same == levels_.end())
    levels_.push_back({h, {std::move(value)}});
  else
    same->runs.push_back(std::move(value));
}

double Convergence::scatter_at(double h) const {
  double squares = model_runs, count = model_runs;
  for (const Resolution& level : levels_) {
    if (level.runs.size() < 2) continue;
    const double more = static_cast<double>(level.runs.size() - 1);
    squares += more * squared(level.scatter() / model_.expected_scatter(level.h / length_));
    count += more;
  }
  return model_.expected_scatter(h / length_) * std::sqrt(squares / count);
}

double Convergence::bias_at(double h) const {
  double squares = model_biases * squared(model_.expected_bias(h / length_));
  double count = model_biases;
  for (std::size_t fine = 1; fine < levels_.size(); ++fine) {
    const std::ptrdiff_t coarse = partner(levels_, fine);
    if (fine + 2 < levels_.size() || coarse < 0) continue;  // the last two sizes count
    const Resolution &c = levels_[static_cast<std::size_t>(coarse)], &f = levels_[fine];
    const double noise = squared(scatter_at(f.h)) / static_cast<double>(f.runs.size()) +
                         squared(scatter_at(c.h)) / static_cast<double>(c.runs.size());
    const double change = squared(relative_distance(c.mean(), f.mean()));
    const double shown =
        std::max(0.0, change - noise) * squared(richardson_weight(c.h, f.h, model_.order));
    squares += shown * std::pow(h / f.h, 2.0 * model_.order);
    count += 1.0;
  }
  return std::sqrt(squares / count);
}

Convergence::Weighted Convergence::best_weight(const Level& coarse, const Level& fine) const {
  const double B = squared(bias_at(fine.h));
  const double w_1 = richardson_weight(coarse.h, fine.h, model_.order);
  const double s_f = squared(scatter_at(fine.h)) / fine.runs;
  const double s_c = squared(scatter_at(coarse.h)) / coarse.runs;
  const double w = std::max(0.0, (B / w_1 - s_f) / (B / squared(w_1) + s_f + s_c));
  const double E = B * squared(1.0 - w / w_1) + s_f * squared(1.0 + w) + s_c * squared(w);
  return {w, std::sqrt(squared(model_.remainder) * B + squared(four_fifths) * E)};
}

double Convergence::predicted_error(const std::vector<Level>& levels) const {
  const std::ptrdiff_t coarse = partner(levels, levels.size() - 1);
  if (coarse < 0) return std::numeric_limits<double>::infinity();
  return best_weight(levels[static_cast<std::size_t>(coarse)], levels.back()).error;
}

Estimate Convergence::estimate() const {
  const Resolution& f = levels_.back();
  const std::ptrdiff_t coarse = partner(levels_, levels_.size() - 1);
  if (coarse < 0) return {f.mean(), std::numeric_limits<double>::infinity(), 0.0};
  const Resolution& c = levels_[static_cast<std::size_t>(coarse)];
  const Weighted best =
      best_weight({c.h, static_cast<int>(c.runs.size())}, {f.h, static_cast<int>(f.runs.size())});
  const VectorXd u = f.mean();
  return {u + best.weight * (u - c.mean()), best.error, best.weight};
}

ShownErrors shown_errors(std::span<const Resolution> levels, const VectorXd& tends_to,
                         double length) {
  ShownErrors shown;
  double biases = 0.0, scatters = 0.0, scattered = 0.0;
  for (const Resolution& level : levels) {
    biases += squared(relative_distance(level.mean(), tends_to) * length / level.h);
    if (level.runs.size() < 2) continue;
    scatters += squared(level.scatter());
    scattered += 1.0;
  }
  shown.bias = std::sqrt(biases / static_cast<double>(levels.size()));
  shown.scatter = std::max(1e-4, scattered > 0.0 ? std::sqrt(scatters / scattered) : 0.0);
  Convergence so_far({shown.bias, 1.0, 0.0, shown.scatter, 0.0}, length);
  const std::size_t last = levels.size() > 2 ? levels.size() - 1 : levels.size();
  for (std::size_t k = 0; k < last; ++k) {
    for (const VectorXd& run : levels[k].runs) so_far.add(levels[k].h, run);
    const Estimate estimate = so_far.estimate();
    if (std::isfinite(estimate.error))
      shown.remainders.push_back(relative_distance(estimate.value, tends_to) /
                                 so_far.bias_at(levels[k].h));
  }
  return shown;
}

ErrorModel pooled_model(std::span<const ShownErrors> scenes) {
  ErrorModel model;
  double biases = 0.0, scatters = 0.0, remainders = 0.0, count = 0.0;
  for (const ShownErrors& scene : scenes) {
    biases += squared(scene.bias);
    scatters += squared(scene.scatter);
    for (const double r : scene.remainders) remainders += squared(r);
    count += static_cast<double>(scene.remainders.size());
  }
  model.bias = std::sqrt(biases / static_cast<double>(scenes.size()));
  model.scatter = std::sqrt(scatters / static_cast<double>(scenes.size()));
  model.remainder = four_fifths * std::sqrt(remainders / count);
  return model;
}

Plan cheapest_plan(const Convergence& so_far, const std::vector<double>& sizes,
                   const std::vector<double>& seconds, double target, double budget,
                   int most_runs) {
  const std::vector<Resolution>& have = so_far.levels();
  Plan best, nearest, cheapest;
  // of the sizes up to `finest`: how many runs have been made, and whether it belongs to the plan
  const auto made = [&](double h) {
    const auto found = std::find_if(have.begin(), have.end(), [&](const Resolution& level) {
      return std::abs(level.h / h - 1.0) < 1e-9;
    });
    return found == have.end() ? 0 : static_cast<int>(found->runs.size());
  };
  const auto is_doubling = [&](double h) {
    const double doublings = std::log2(sizes.front() / h);
    return std::abs(doublings - std::round(doublings)) < 1e-6;
  };
  for (std::size_t finest = 1; finest < sizes.size(); ++finest) {
    if (!have.empty() && sizes[finest] > 1.001 * have.back().h) continue;
    for (int runs = 1; runs <= most_runs; ++runs) {
      Plan plan;
      for (std::size_t k = 0; k <= finest; ++k) {
        const int there = made(sizes[k]);
        if (there == 0 && k != finest && !is_doubling(sizes[k])) continue;
        // a size that was passed by cannot be added, Convergence goes from coarse to fine
        if (there == 0 && !have.empty() && sizes[k] > have.back().h) continue;
        plan.levels.push_back({sizes[k], std::max(runs, there)});
        plan.cost += plan.levels.back().runs * seconds[k];
      }
      plan.error = so_far.predicted_error(plan.levels);
      const auto take = [&](Plan& into, bool better) {
        if (into.levels.empty() || better) into = plan;
      };
      if (plan.error <= target) take(best, plan.cost < best.cost);
      if (plan.cost <= budget) take(nearest, plan.error < nearest.error);
      take(cheapest, plan.cost < cheapest.cost);
    }
  }
  return !best.levels.empty() ? best : !nearest.levels.empty() ? nearest : cheapest;
}

}  // namespace repose::calibration

#include "study/accuracy/error_model.hpp"

#include <algorithm>
#include <cmath>

namespace repose::study {
namespace {

using Eigen::ArrayXd;
using Eigen::VectorXd;

/// How many pairs of sizes the model's bias weighs, and how many further runs of a size its
/// scatter.
constexpr double model_pairs = 1.0;
constexpr double model_runs = 3.0;
/// Pairs that seem to agree show at least so much of the model's bias.
constexpr double least_shown = 0.1;
/// Pairs of sizes that show a bias: closer ones show their irregularity, others are far from fine.
constexpr double least_ratio = 1.4, largest_ratio = 4.5;
/// Motions are not told apart below.
constexpr double least_motion = 0.02;

double squared(double x) { return x * x; }

double motion_of(const VectorXd& u, const VectorXd& start) {
  return std::max(least_motion, relative_distance(start, u));
}

}  // namespace

double ErrorModel::expected_bias(double x, double scene_motion) const {
  return bias * std::pow(std::max(least_motion, scene_motion), motion_order) * std::pow(x, order);
}
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

double Convergence::motion() const {
  if (!start_ || levels_.empty()) return model_.motion;
  return motion_of(levels_.back().mean(), *start_);
}

std::pair<double, double> Convergence::shown_square() const {
  const Resolution& f = levels_.back();
  const auto noise = [&](const Resolution& level) {
    return squared(scatter_at(level.h)) / static_cast<double>(level.runs.size());
  };
  double squares = 0.0, count = 0.0;
  for (const Resolution& c : levels_) {
    const double ratio = c.h / f.h;
    if (ratio < least_ratio || ratio > largest_ratio) continue;
    const double x = std::pow(ratio, model_.order);
    const double change = squared(relative_distance(c.mean(), f.mean()));
    squares += std::max(0.0, change - noise(c) - noise(f)) /
               (squared(x - 1.0) + squared(model_.irregularity) * (x * x + 1.0));
    count += 1.0;
  }
  return {count > 0.0 ? squares / count : 0.0, count};
}

double Convergence::shown_over_expected() const {
  if (levels_.empty()) return 0.0;
  return std::sqrt(shown_square().first) /
         model_.expected_bias(levels_.back().h / length_, motion());
}

double Convergence::bias_at(double h) const {
  if (levels_.empty()) return model_.expected_bias(h / length_, motion());
  const Resolution& f = levels_.back();
  const auto [square, count] = shown_square();
  const double expected = model_.expected_bias(f.h / length_, motion());
  if (count == 0.0) return expected * std::pow(h / f.h, model_.order);
  const double shown = std::max(std::sqrt(square), least_shown * expected);
  const double share = model_pairs / (model_pairs + count);
  return std::pow(expected, share) * std::pow(shown, 1.0 - share) * std::pow(h / f.h, model_.order);
}

Convergence::Weighted Convergence::best_weights(const std::vector<Level>& levels) const {
  const auto count = static_cast<Eigen::Index>(levels.size());
  const double h_f = levels.back().h;
  const double B = bias_at(h_f);
  // M = B² x xᵀ + diag(s²); M⁻¹ 1 by Sherman and Morrison's formula
  ArrayXd x(count), s_2(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Level& level = levels[static_cast<std::size_t>(k)];
    x[k] = std::pow(level.h / h_f, model_.order);
    s_2[k] = squared(model_.irregularity * B * x[k]) + squared(scatter_at(level.h)) / level.runs;
  }
  const double common = B * B * (x / s_2).sum() / (1.0 + B * B * (x.square() / s_2).sum());
  const ArrayXd w = (1.0 - common * x) / s_2;
  const double sum = w.sum();
  return {(w / sum).matrix(), model_.caution / std::sqrt(sum)};
}

double Convergence::predicted_error(const std::vector<Level>& levels) const {
  return best_weights(levels).error;
}

Estimate Convergence::estimate() const {
  std::vector<Level> levels;
  for (const Resolution& level : levels_)
    levels.push_back({level.h, static_cast<int>(level.runs.size())});
  Weighted best = best_weights(levels);
  VectorXd value = VectorXd::Zero(levels_.back().runs.front().size());
  for (std::size_t k = 0; k < levels_.size(); ++k)
    value += best.weights[static_cast<Eigen::Index>(k)] * levels_[k].mean();
  return {std::move(value), best.error, std::move(best.weights)};
}

namespace {

/// How far the sizes' errors over x^order, x = h/length, are from their mean, over that mean.
double shown_irregularity(std::span<const Resolution> levels, const VectorXd& tends_to,
                          double least, double length, double order) {
  std::vector<VectorXd> slopes;
  const double size = tends_to.lpNorm<1>();
  for (const Resolution& level : levels) {
    const VectorXd error = (level.mean() - tends_to) / size;
    if (error.lpNorm<1>() < least) continue;
    slopes.push_back(error * std::pow(length / level.h, order));
  }
  if (slopes.size() < 3) return std::nan("");
  VectorXd mean = VectorXd::Zero(tends_to.size());
  double squares = 0.0;
  for (const VectorXd& slope : slopes) mean += slope / static_cast<double>(slopes.size());
  for (const VectorXd& slope : slopes) squares += squared((slope - mean).lpNorm<1>());
  const double apart = std::sqrt(squares / static_cast<double>(slopes.size() - 1));
  return apart / std::hypot(mean.lpNorm<1>(), apart);
}

bool is_halving(double coarsest, double h) {
  const double halvings = std::log2(coarsest / h);
  return std::abs(halvings - std::round(halvings)) < 1e-6;
}

}  // namespace

ShownErrors shown_errors(std::span<const Resolution> levels, const VectorXd& tends_to,
                         double uncertainty, double length, const ErrorModel& form,
                         const std::optional<VectorXd>& start) {
  ShownErrors shown;
  if (start) shown.motion = motion_of(tends_to, *start);
  double biases = 0.0, scatters = 0.0, scattered = 0.0;
  for (const Resolution& level : levels) {
    biases +=
        squared(relative_distance(level.mean(), tends_to) * std::pow(length / level.h, form.order));
    if (level.runs.size() < 2) continue;
    scatters += squared(level.scatter());
    scattered += 1.0;
  }
  shown.bias = std::sqrt(biases / static_cast<double>(levels.size())) /
               std::pow(shown.motion, form.motion_order);
  shown.scatter = std::max(1e-4, scattered > 0.0 ? std::sqrt(scatters / scattered) : 0.0);
  const double least = 2.0 * std::max(uncertainty, shown.scatter);
  shown.irregularity = shown_irregularity(levels, tends_to, least, length, form.order);
  return shown;
}

ErrorModel pooled_model(std::span<const ShownErrors> scenes, const ErrorModel& form) {
  double biases = 0.0, motions = 0.0, scatters = 0.0, irregularities = 0.0, irregular = 0.0;
  for (const ShownErrors& scene : scenes) {
    biases += std::log(scene.bias);
    motions += std::log(scene.motion);
    scatters += squared(scene.scatter);
    if (!std::isfinite(scene.irregularity)) continue;
    irregularities += squared(scene.irregularity);
    irregular += 1.0;
  }
  const auto number = static_cast<double>(scenes.size());
  ErrorModel model = form;
  model.bias = std::exp(biases / number);
  model.motion = std::exp(motions / number);
  model.scatter = std::sqrt(scatters / number);
  model.irregularity = std::sqrt(irregularities / irregular);
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
  for (std::size_t finest = 1; finest < sizes.size(); ++finest) {
    if (!have.empty() && sizes[finest] > 1.001 * have.back().h) continue;
    for (int runs = 1; runs <= most_runs; ++runs) {
      Plan plan;
      for (std::size_t k = 0; k <= finest; ++k) {
        const int there = made(sizes[k]);
        if (there == 0 && k != finest && !is_halving(sizes.front(), sizes[k])) continue;
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

}  // namespace repose::study

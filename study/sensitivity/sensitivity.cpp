#include "study/sensitivity/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "calibration/quantiles.hpp"
#include "input/toml_text.hpp"
#include "study/fit/journal.hpp"
#include "study/run/run_record.hpp"
#include "study/sensitivity/low_discrepancy.hpp"

namespace repose::study {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using input::SensitivityMethod;
using input::SurrogateKind;
using input::UncertainInput;
using io::Json;

double normal_probability(double x) { return 0.5 * std::erfc(-x * std::sqrt(0.5)); }

/// The standard normal variable of a value, and back.
double standardised(const calibration::Prior& prior, double value) {
  if (!prior.relative) return (value - prior.mean) / prior.sd;
  return value > 0.0 ? std::log(value / prior.mean) / prior.sd : -HUGE_VAL;
}
double from_standard(const calibration::Prior& prior, double x) {
  return prior.relative ? prior.mean * std::exp(prior.sd * x) : prior.mean + prior.sd * x;
}

double between(const UncertainInput& input, double z) {
  return input.scale == Scale::log ? input.lower * std::pow(input.upper / input.lower, z)
                                   : input.lower + z * (input.upper - input.lower);
}

MatrixXd points_of(const input::SensitivityInput& asked, std::uint64_t seed) {
  const auto inputs = static_cast<int>(asked.inputs.size());
  if (asked.method == SensitivityMethod::morris)
    return morris_points(inputs, asked.samples, asked.levels, seed);
  if (asked.surrogate == SurrogateKind::none) return variance_points(inputs, asked.samples, seed);
  const LowDiscrepancy sequence(asked.inputs.size(), seed);
  MatrixXd points(asked.samples, inputs);
  for (int i = 0; i < asked.samples; ++i)
    points.row(i) = sequence.point(static_cast<std::uint32_t>(i)).transpose();
  return points;
}

std::vector<Orthonormal> families_of(const SensitivityPlan& plan) {
  std::vector<Orthonormal> list;
  for (const UncertainInput& one : plan.asked.inputs)
    list.push_back(one.prior && !std::isfinite(one.lower) && !std::isfinite(one.upper)
                       ? Orthonormal::hermite
                       : Orthonormal::legendre);
  return list;
}

/// The polynomial of the runs that have a value, or why there is none.
void replace_runs(const SensitivityPlan& plan, const VectorXd& y, OutputSensitivity& output) {
  std::vector<Index> there;
  for (Index i = 0; i < y.size(); ++i)
    if (std::isfinite(y[i])) there.push_back(i);
  if (static_cast<Index>(there.size()) < 2 * (plan.points.cols() + 1)) {
    output.not_shown = "too few runs have a value";
    return;
  }
  const MatrixXd points = plan.points(there, Eigen::all);
  output.surrogate.emplace(points, families_of(plan), y(there));
  if (!(output.surrogate->q2() >= least_q2)) {
    output.not_shown = fmt::format(
        "the polynomial misses {:.2g} % of the variance, more than {:.0f} %: more samples, a "
        "smoother output, or surrogate = \"none\"",
        100.0 * (1.0 - output.surrogate->q2()), 100.0 * (1.0 - least_q2));
    return;
  }
  output.shares = output.surrogate->shares(plan.seed);
}

Json interval(const Bounded& figure) {
  return Json(Json::Array{number(figure.interval_95[0]), number(figure.interval_95[1])});
}

/// A share has three digits behind the point, anything else three in all.
std::string with_interval(const Bounded& figure, bool share) {
  const auto [low, high] = figure.interval_95;
  return share ? fmt::format("{:6.3f} ({:.3f} to {:.3f})", figure.value, low, high)
               : fmt::format("{:9.3g} ({:.3g} to {:.3g})", figure.value, low, high);
}

/// A share of the longest, as a bar of text.
std::string text_bar(double share) {
  constexpr int longest = 20;
  const int length = static_cast<int>(std::lround(longest * std::clamp(share, 0.0, 1.0)));
  std::string bar;
  for (int k = 0; k < length; ++k) bar += "█";
  return bar;
}

std::string headline(const SensitivityPlan& plan, const OutputSensitivity& output) {
  std::string text =
      fmt::format("{}: {:.4g} ± {:.2g} (s.d.)", output.name, output.mean, output.deviation);
  if (output.surrogate)
    text += fmt::format("; a polynomial of degree {}, {} terms, misses {:.2g} % of the variance",
                        output.surrogate->degree(), output.surrogate->terms(),
                        100.0 * (1.0 - output.surrogate->q2()));
  if (!output.not_shown.empty()) return text + "; no indices: " + output.not_shown;
  double first = 0.0;
  for (const VarianceShares& share : output.shares) first += share.first.value;
  if (!output.shares.empty())
    text += fmt::format("; {:.3g} % by inputs alone, the rest by several together", 100.0 * first);
  if (plan.asked.method == SensitivityMethod::morris)
    text += fmt::format("; {} trajectories", plan.asked.samples);
  return text;
}

/// The figure that an input is ranked by.
double weight_of(const OutputSensitivity& output, std::size_t j) {
  return output.effects.empty() ? output.shares[j].total.value : output.effects[j].mean_size.value;
}

}  // namespace

double value_at(const UncertainInput& input, double u) {
  if (!input.prior) return between(input, u);
  const double low = normal_probability(standardised(*input.prior, input.lower));
  const double high = normal_probability(standardised(*input.prior, input.upper));
  return std::clamp(
      from_standard(*input.prior, calibration::normal_quantile(low + u * (high - low))),
      input.lower, input.upper);
}

double value_within(const UncertainInput& input, double z) {
  if (!input.prior) return between(input, z);
  const double low = std::max(-2.0, standardised(*input.prior, input.lower));
  const double high = std::min(2.0, standardised(*input.prior, input.upper));
  return from_standard(*input.prior, low + z * (high - low));
}

SensitivityPlan::SensitivityPlan(input::SensitivityInput given, std::uint64_t random_seed)
    : asked(std::move(given)),
      seed(random_seed),
      points(points_of(asked, seed)) {
  for (const UncertainInput& one : asked.inputs)
    sets.keys.insert(sets.keys.end(), one.keys.begin(), one.keys.end());
  for (Index run = 0; run < points.rows(); ++run) {
    std::vector<std::string>& values = sets.values.emplace_back();
    for (std::size_t j = 0; j < asked.inputs.size(); ++j) {
      const UncertainInput& one = asked.inputs[j];
      const double place = points(run, static_cast<Index>(j));
      const double value = asked.method == SensitivityMethod::morris ? value_within(one, place)
                                                                     : value_at(one, place);
      values.insert(values.end(), one.keys.size(), input::toml_number(value));
    }
  }
}

MatrixXd outputs_of(const PointSweep& sweep, const SensitivityPlan& plan) {
  std::set<std::string> names;
  MatrixXd values = MatrixXd::Constant(plan.points.rows(),
                                       static_cast<Index>(plan.asked.outputs.size()), std::nan(""));
  for (std::size_t run = 0; run < sweep.finished().size(); ++run) {
    const PointFigures& one = sweep.finished()[run];
    if (one.status != "done") continue;
    for (const Json::Member& figure : one.figures.items())
      if (figure.value.is_number()) names.insert(figure.key);
    for (std::size_t k = 0; k < plan.asked.outputs.size(); ++k)
      if (const Json* const figure = one.figures.find(plan.asked.outputs[k]);
          figure != nullptr && figure->is_number())
        values(static_cast<Index>(run), static_cast<Index>(k)) = figure->get<double>();
  }
  if (!names.empty()) require_outputs(plan.asked.outputs, names, plan.asked.output_place);
  return values;
}

std::vector<OutputSensitivity> sensitivities(const SensitivityPlan& plan, const MatrixXd& values) {
  std::vector<OutputSensitivity> list;
  for (std::size_t k = 0; k < plan.asked.outputs.size(); ++k) {
    OutputSensitivity& output = list.emplace_back();
    output.name = plan.asked.outputs[k];
    const VectorXd y = values.col(static_cast<Index>(k));
    double there = 0.0, square = 0.0;
    for (const double x : y)
      if (std::isfinite(x)) output.mean += (x - output.mean) / ++there;
    for (const double x : y)
      if (std::isfinite(x)) square += (x - output.mean) * (x - output.mean);
    output.deviation = std::sqrt(square / (there - 1.0));
    output.lost = y.size() - static_cast<Index>(there);
    const auto lost = static_cast<double>(output.lost);
    if (lost > most_lost * static_cast<double>(y.size()))
      output.not_shown = fmt::format("{} of {} runs have no value, more than {:.0f} %", output.lost,
                                     y.size(), 100.0 * most_lost);
    else if (!(output.deviation > 1e-12 * std::abs(output.mean)))
      output.not_shown = "it is the same in all runs";
    else if (plan.asked.method == SensitivityMethod::morris)
      output.effects = elementary_effects(plan.points, y, plan.seed);
    else if (plan.asked.surrogate == SurrogateKind::chaos)
      replace_runs(plan, y, output);
    else
      output.shares = variance_shares(static_cast<int>(plan.points.cols()), y, plan.seed);
  }
  return list;
}

std::vector<std::size_t> ranked(const SensitivityPlan& plan, const OutputSensitivity& output) {
  std::vector<std::size_t> order(plan.asked.inputs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (!output.not_shown.empty()) return order;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return weight_of(output, a) > weight_of(output, b);
  });
  return order;
}

Json sensitivity_json(const SensitivityPlan& plan, const std::vector<OutputSensitivity>& outputs) {
  Json list = Json::array();
  for (const OutputSensitivity& output : outputs) {
    Json one{{"output", output.name},
             {"runs", plan.points.rows() - output.lost},
             {"runs_lost", output.lost},
             {"mean", number(output.mean)},
             {"sd", number(output.deviation)}};
    if (output.surrogate)
      one["surrogate"] = {{"degree", output.surrogate->degree()},
                          {"norm", output.surrogate->norm()},
                          {"terms", output.surrogate->terms()},
                          {"q2", number(output.surrogate->q2())},
                          {"mean", number(output.surrogate->mean())},
                          {"sd", number(std::sqrt(output.surrogate->variance()))}};
    if (!output.not_shown.empty()) one["not_shown"] = output.not_shown;
    Json inputs = Json::array();
    for (const std::size_t j : ranked(plan, output)) {
      Json row{{"input", plan.asked.inputs[j].name()}};
      if (!output.shares.empty())
        row.update({{"first", number(output.shares[j].first.value)},
                    {"first_95", interval(output.shares[j].first)},
                    {"total", number(output.shares[j].total.value)},
                    {"total_95", interval(output.shares[j].total)}});
      if (!output.effects.empty())
        row.update({{"mu_star", number(output.effects[j].mean_size.value)},
                    {"mu_star_95", interval(output.effects[j].mean_size)},
                    {"mu", number(output.effects[j].mean)},
                    {"sigma", number(output.effects[j].spread.value)},
                    {"sigma_95", interval(output.effects[j].spread)},
                    {"effects", output.effects[j].count}});
      inputs.push_back(row);
    }
    one["inputs"] = inputs;
    list.push_back(one);
  }
  return list;
}

std::string sensitivity_csv(const SensitivityPlan& plan,
                            const std::vector<OutputSensitivity>& outputs) {
  const bool morris = plan.asked.method == SensitivityMethod::morris;
  std::string text = morris ? "output,input,mu_star,mu_star_low,mu_star_high,mu,sigma,sigma_low,"
                              "sigma_high,effects\n"
                            : "output,input,first,first_low,first_high,total,total_low,"
                              "total_high\n";
  const auto bounded = [](const Bounded& figure) {
    return fmt::format("{},{},{}", figure.value, figure.interval_95[0], figure.interval_95[1]);
  };
  for (const OutputSensitivity& output : outputs)
    for (const std::size_t j : ranked(plan, output)) {
      text += output.name + "," + plan.asked.inputs[j].name() + ",";
      if (morris) {
        ElementaryEffects one;
        one.mean = std::nan("");
        if (!output.effects.empty()) one = output.effects[j];
        text += fmt::format("{},{},{},{}\n", bounded(one.mean_size), one.mean, bounded(one.spread),
                            one.count);
      } else {
        const VarianceShares one = output.shares.empty() ? VarianceShares{} : output.shares[j];
        text += fmt::format("{},{}\n", bounded(one.first), bounded(one.total));
      }
    }
  return text;
}

std::vector<std::string> sensitivity_words(const SensitivityPlan& plan,
                                           const std::vector<OutputSensitivity>& outputs) {
  std::size_t width = 5;
  for (const UncertainInput& one : plan.asked.inputs) width = std::max(width, one.name().size());
  const bool morris = plan.asked.method == SensitivityMethod::morris;
  std::vector<std::string> lines;
  for (const OutputSensitivity& output : outputs) {
    lines.push_back(headline(plan, output));
    if (!output.not_shown.empty()) continue;
    const int cell = morris ? 34 : 29;
    lines.push_back(fmt::format("  {:{}}  {:{}}{}", "input", width,
                                morris ? "       μ* (95 %)" : " first (95 %)", cell,
                                morris ? "        σ (95 %)" : " total (95 %)"));
    const std::vector<std::size_t> order = ranked(plan, output);
    const double largest = weight_of(output, order.front());
    for (const std::size_t j : order) {
      const Bounded& left = morris ? output.effects[j].mean_size : output.shares[j].first;
      const Bounded& right = morris ? output.effects[j].spread : output.shares[j].total;
      lines.push_back(fmt::format("  {:{}}  {:{}}{:{}}{}", plan.asked.inputs[j].name(), width,
                                  with_interval(left, !morris), cell, with_interval(right, !morris),
                                  cell, text_bar(weight_of(output, j) / (morris ? largest : 1.0))));
    }
  }
  return lines;
}

std::vector<std::string> lost_words(const SensitivityPlan& plan, const MatrixXd& values) {
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < plan.asked.outputs.size(); ++k) {
    std::vector<Index> lost;
    for (Index i = 0; i < values.rows(); ++i)
      if (!std::isfinite(values(i, static_cast<Index>(k)))) lost.push_back(i);
    if (lost.empty()) continue;
    std::string text = fmt::format("{} of {} runs have no {}; what is told is of the others alone",
                                   lost.size(), values.rows(), plan.asked.outputs[k]);
    // the mean of n even places has a standard deviation of 1/√(12 n): three of them are no chance
    const VectorXd shift = plan.points(lost, Eigen::all).colwise().mean().array() - 0.5;
    Index j = 0;
    if (shift.cwiseAbs().maxCoeff(&j) * std::sqrt(12.0 * static_cast<double>(lost.size())) > 3.0)
      text += fmt::format("; the lost ones lie at {} {}", shift[j] > 0.0 ? "large" : "small",
                          plan.asked.inputs[static_cast<std::size_t>(j)].name());
    lines.push_back(text);
  }
  return lines;
}

}  // namespace repose::study

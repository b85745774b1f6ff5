#include "report/picture/sensitivity_picture.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace repose::report {
namespace {

using study::Bounded;
using study::OutputSensitivity;

/// A bar from zero between two heights, and its interval as a line.
void bar(Axes& axes, const std::string& name, const Bounded& share, double low, double high,
         Colour colour) {
  const double length = std::max(share.value, 0.0), middle = 0.5 * (low + high);
  axes.band(name, std::vector<double>{0.0, length}, std::vector<double>{low, low},
            std::vector<double>{high, high}, {colour});
  axes.line("", std::vector<double>{0.0, length, length, 0.0},
            std::vector<double>{low, low, high, high}, {colour, 1.2});
  axes.line("", share.interval_95, std::vector<double>{middle, middle}, {Colour::black, 1.2});
}

/// Inputs from top to bottom by their total share, which begins at the upper of two bars.
void share_panel(Axes& axes, const study::SensitivityPlan& plan, const OutputSensitivity& output) {
  const std::vector<std::size_t> order = study::ranked(plan, output);
  const auto n = static_cast<double>(order.size());
  axes.x = {"share of the variance", AxisScale::linear, {}, 1.0};
  axes.y = {"inputs, the first on top", AxisScale::linear, 0.0, n};
  double least = 0.0, most = 1.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const study::VarianceShares& shares = output.shares[order[k]];
    const double top = n - static_cast<double>(k);
    bar(axes, k == 0 ? "total" : "", shares.total, top - 0.5, top - 0.1, Colour::blue);
    bar(axes, k == 0 ? "first order" : "", shares.first, top - 0.9, top - 0.5, Colour::vermillion);
    for (const Bounded& one : {shares.first, shares.total}) {
      least = std::min(least, one.interval_95[0]);
      most = std::max(most, one.interval_95[1]);
    }
    axes.label({std::max({shares.total.value, shares.total.interval_95[1], 0.0}), top - 0.5,
                plan.asked.inputs[order[k]].name()});
  }
  axes.x.lower = least;
  axes.x.upper = most;
  axes.legend = Legend::bottom_right;  // bars grow shorter downwards
}

void effect_panel(Axes& axes, const study::SensitivityPlan& plan, const OutputSensitivity& output) {
  axes.x.label = "μ*, mean size of the effect over the range";
  axes.y.label = "σ, spread of the effect";
  axes.x.lower = axes.y.lower = 0.0;
  double most = 0.0;
  for (std::size_t j = 0; j < output.effects.size(); ++j) {
    const study::ElementaryEffects& one = output.effects[j];
    const double x = one.mean_size.value, y = one.spread.value;
    const Colour colour = cycle_colour(j);
    axes.line("", one.mean_size.interval_95, std::vector<double>{y, y}, {colour, 1.2});
    axes.line("", std::vector<double>{x, x}, one.spread.interval_95, {colour, 1.2});
    axes.points(plan.asked.inputs[j].name(), std::vector<double>{x}, std::vector<double>{y},
                {colour});
    most = std::max(most, x);
  }
  // effects that scatter by more than their size: the input acts through others, or back and forth
  const std::vector<double> ends{0.0, most};
  axes.dashed("σ = μ*", ends, ends, {Colour::grey, 1.2});
  axes.legend = Legend::right;
}

}  // namespace

Figure sensitivity_picture(const study::SensitivityPlan& plan,
                           const std::vector<OutputSensitivity>& outputs, const std::string& name) {
  const bool morris = plan.asked.method == input::SensitivityMethod::morris;
  Figure figure(
      name, fmt::format("{} of {} runs; lines: 95 %",
                        morris ? "elementary effects" : "shares of variance", plan.points.rows()));
  figure.columns = outputs.size() == 1 ? 1 : 2;
  figure.panel_height_px =
      morris ? 300.0 : std::max(160.0, 44.0 * static_cast<double>(plan.asked.inputs.size()));
  for (const OutputSensitivity& output : outputs) {
    if (!output.not_shown.empty()) continue;
    Axes& axes = figure.add_axes();
    axes.title = output.name;
    if (output.surrogate)
      axes.title += fmt::format(" (polynomial, Q^{{2}} = {:.4f})", output.surrogate->q2());
    (morris ? effect_panel : share_panel)(axes, plan, output);
  }
  if (figure.panels().empty()) throw std::logic_error("no output has indices");
  return figure;
}

}  // namespace repose::report

#include "report/picture/propagation_picture.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace repose::report {
namespace {

/// "front_99_m" → "front_99 (m)"
std::string axis_name(const std::string& output) {
  for (const char* unit : {"_m", "_m2", "_J", "_kg"})
    if (output.ends_with(unit)) {
      const std::string name = output.substr(0, output.size() - std::string(unit).size());
      return fmt::format("{} ({})", name, std::string(unit) == "_m2" ? "m^{2}" : unit + 1);
    }
  return output;
}

/// The share of values up to each, as a staircase of at most some hundred steps.
void distribution(Axes& axes, const std::string& name, const std::vector<double>& ascending,
                  Colour colour) {
  constexpr std::size_t most_steps = 400;
  const std::size_t n = ascending.size(), step = (n + most_steps - 1) / most_steps;
  std::vector<double> x, y;
  double before = 0.0;
  for (std::size_t k = step - 1; k < n; k += step) {
    const double share = 100.0 * static_cast<double>(k + 1) / static_cast<double>(n);
    for (const double height : {before, share}) {
      x.push_back(ascending[k]);
      y.push_back(height);
    }
    before = share;
  }
  axes.line(name, x, y, {colour});
}

}  // namespace

Figure propagation_picture(const study::PropagationPlan& plan,
                           const study::PropagationResult& result, const std::string& name) {
  Figure figure(
      name, fmt::format("{} draws of the posterior with cells of {:.4g} m, {} of them with "
                        "{:.4g} m",
                        plan.draws.size(), plan.asked.coarsen * plan.h, plan.fine.size(), plan.h));
  std::size_t panels = 0;
  for (std::size_t k = 0; k < result.outputs.size(); ++k) {
    const study::Propagated& p = result.outputs[k];
    if (p.pairs < study::fewest_pairs) continue;
    ++panels;
    Axes& axes = figure.add_axes();
    axes.title =
        fmt::format("{:.4g}, 90 %: {:.4g} to {:.4g}", p.median, p.interval_90[0], p.interval_90[1]);
    axes.x.label = axis_name(plan.asked.outputs[k]);
    axes.y = {"draws up to here (%)", AxisScale::linear, 0.0, 100.0};
    std::vector<double> coarse;
    for (const double x : result.coarse.col(static_cast<Eigen::Index>(k)))
      if (std::isfinite(x)) coarse.push_back(x);
    std::sort(coarse.begin(), coarse.end());
    distribution(axes, "coarse runs", coarse, Colour::grey);
    distribution(axes, "fine, by both", result.values[k], Colour::blue);
    const std::vector<double> ends{p.median, p.median + p.change / (plan.asked.coarsen - 1.0)};
    axes.line("left to finer cells", ends, std::vector<double>{50.0, 50.0},
              {Colour::vermillion, 3.0});
  }
  if (!result.depth.x.empty()) {
    ++panels;
    const study::DepthBand& band = result.depth;
    Axes& axes = figure.add_axes();
    axes.title = "deposit at the end";
    axes.x.label = "x (m)";
    axes.y.label = "depth (m)";
    axes.band("90 %", band.x, band.lower, band.upper, {Colour::blue});
    axes.line("median", band.x, band.median, {Colour::blue});
  }
  if (panels == 0) throw std::logic_error("no output has enough runs");
  figure.columns = panels == 1 ? 1 : 2;
  figure.panel_height_px = 260.0;
  return figure;
}

}  // namespace repose::report

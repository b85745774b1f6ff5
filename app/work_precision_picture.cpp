#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/mpm_sweep_picture.hpp"

namespace repose::app {
namespace {

/// One colour per transfer, as in the other pictures; the kernel and the points are markers.
Style style_of(const mpm::Scene& scene) {
  Style style;
  style.colour = cycle_colour(static_cast<std::size_t>(scene.transfer));
  style.marker = scene.kernel == mpm::Kernel::cubic ? Marker::circle : Marker::triangle;
  if (scene.points_per_cell != mpm::Scene{}.points_per_cell) style.marker = Marker::square;
  style.marker_px = 5.0;
  return style;
}

struct Dots {
  std::vector<double> x, y;
  void add(double a, double b) {
    if (!(a > 0.0) || !(b > 0.0)) return;
    x.push_back(a);
    y.push_back(b);
  }
};

/// Every run of a family with its longest step, over the cells.
bool has_longest_step(const SweepRun& run, const SweepFamily& family) {
  return std::none_of(family.runs.begin(), family.runs.end(), [&](const SweepRun* other) {
    return other->scene().h == run.scene().h && other->scene().courant > run.scene().courant;
  });
}

}  // namespace

Figure work_precision_figure(std::span<const SweepRun> runs, const SweepReference& reference,
                             const std::string& name) {
  const std::vector<SweepFamily> families = families_of(runs);
  Figure figure(
      "What accuracy a second buys",
      fmt::format("{}; from {}, extrapolated; lines: the longest steps; rings: nothing is "
                  "both cheaper and closer; grey: within the reference's error bar",
                  name, families[reference.family].name()));
  figure.columns = 3;
  figure.panel_width_px = 340.0;
  figure.panel_height_px = 280.0;
  const double bin = common_bin(runs);
  std::vector<Quantity> quantities;
  for (std::size_t q = 0; q < quantity_count; ++q)
    if (reference.values[q]) quantities.push_back(static_cast<Quantity>(q));
  const auto panel = [&](const std::string& title, const auto& error) -> Axes& {
    Axes& axes = figure.add_axes();
    axes.title = title;
    axes.x = {"CPU time (s)", AxisScale::logarithmic};
    axes.y = {"relative error", AxisScale::logarithmic};
    axes.legend = figure.panels().size() == std::min<std::size_t>(3, quantities.size() + 1)
                      ? Legend::right
                      : Legend::none;
    for (const SweepFamily& family : families) {
      Dots line, others;
      for (const SweepRun* run : family.runs)
        (has_longest_step(*run, family) ? line : others).add(run->figure("cpu_s"), error(*run));
      Style style = style_of(family.scene());
      axes.line(family.name(), line.x, line.y, style);
      style.marker_px = 3.0;
      if (!others.x.empty()) axes.points("", others.x, others.y, style);
    }
    return axes;
  };
  for (const Quantity q : quantities) {
    Axes& axes = panel(std::string(name_of(q)),
                       [&](const SweepRun& run) { return error_of(run, q, reference, bin); });
    const std::vector<bool> front = pareto_front(runs, q, reference);
    Dots rings;
    double first = HUGE_VAL, last = 0.0, least = HUGE_VAL;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (!runs[i].done()) continue;
      first = std::min(first, runs[i].figure("cpu_s"));
      last = std::max(last, runs[i].figure("cpu_s"));
      const double error = error_of(runs[i], q, reference, bin);
      if (error > 0.0) least = std::min(least, error);
      if (front[i]) rings.add(runs[i].figure("cpu_s"), error);
    }
    Style ring;
    ring.colour = Colour::black;
    ring.marker = Marker::ring;
    ring.marker_px = 10.0;
    axes.points(q == quantities.front() || quantities.size() > 2 ? "Pareto front" : "", rings.x,
                rings.y, ring);
    const double bar = reference.values[static_cast<std::size_t>(q)]->error;
    Style grey;
    grey.colour = Colour::grey;
    const std::array xs{first, last}, top{bar, bar};
    const double floor = 0.5 * std::min(least, bar);
    const std::array bottom{floor, floor};
    axes.band("", xs, bottom, top, grey);
  }
  panel("energy ledger", [](const SweepRun& run) { return run.figure("energy_error"); });
  return figure;
}

}  // namespace repose::app

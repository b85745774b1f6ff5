#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "report/picture/sweep_picture.hpp"

namespace repose::report {
namespace {

/// One colour per transfer, as in the other pictures, or per family where there are few or more
/// than transfer and kernel is varied; the kernel is a marker.
Style style_of(const study::SweepFamily& family, const std::vector<study::SweepFamily>& families) {
  const bool by_family =
      std::any_of(families.begin(), families.end(), [](const study::SweepFamily& f) {
        return f.scene().points_per_cell != mpm::Scene{}.points_per_cell ||
               !f.runs.front()->varied.empty();
      });
  const auto k = by_family ? static_cast<std::size_t>(&family - families.data())
                           : static_cast<std::size_t>(family.scene().transfer);
  Style style;
  style.colour = cycle_colour(k);
  style.marker = family.scene().kernel == mpm::Kernel::quadratic ? Marker::triangle
                 : k >= 7                                        ? Marker::open_square
                                                                 : Marker::circle;
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
bool has_longest_step(const study::SweepRun& run, const study::SweepFamily& family) {
  return std::none_of(family.runs.begin(), family.runs.end(), [&](const study::SweepRun* other) {
    return other->scene().h == run.scene().h && other->scene().courant > run.scene().courant;
  });
}

}  // namespace

Figure work_precision_figure(std::span<const study::SweepRun> runs,
                             const study::SweepReference& reference, const std::string& name) {
  const std::vector<study::SweepFamily> families = study::families_of(runs);
  Figure figure(
      "What accuracy a second buys",
      fmt::format("{}; against {}{}; lines: the longest steps; rings: nothing is both cheaper and "
                  "closer{}",
                  name, reference.name(families), reference.exact ? "" : ", extrapolated",
                  reference.exact ? "" : "; grey: within the reference's error bar"));
  figure.columns = 4;
  figure.panel_width_px = 340.0;
  figure.panel_height_px = 280.0;
  const double bin = study::common_bin(runs);
  std::vector<study::Quantity> quantities;
  for (std::size_t q = 0; q < study::quantity_count; ++q)
    if (reference.values[q]) quantities.push_back(static_cast<study::Quantity>(q));
  const auto panel = [&](const std::string& title, const auto& error) -> Axes& {
    Axes& axes = figure.add_axes();
    axes.title = title;
    axes.x = {"CPU time (s)", AxisScale::logarithmic};
    axes.y = {"relative error", AxisScale::logarithmic};
    axes.legend = figure.panels().size() == std::min<std::size_t>(4, quantities.size() + 1)
                      ? Legend::right
                      : Legend::none;
    for (const study::SweepFamily& family : families) {
      Dots line, others;
      for (const study::SweepRun* run : family.runs)
        (has_longest_step(*run, family) ? line : others).add(run->figure("cpu_s"), error(*run));
      Style style = style_of(family, families);
      axes.line(family.name(), line.x, line.y, style);
      style.marker_px = 3.0;
      if (!others.x.empty()) axes.points("", others.x, others.y, style);
    }
    return axes;
  };
  for (const study::Quantity q : quantities) {
    Axes& axes = panel(std::string(study::name_of(q)), [&](const study::SweepRun& run) {
      return study::error_of(run, q, reference, bin);
    });
    const std::vector<bool> front = study::pareto_front(runs, q, reference);
    Dots rings;
    double first = HUGE_VAL, last = 0.0, least = HUGE_VAL;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (!runs[i].done()) continue;
      first = std::min(first, runs[i].figure("cpu_s"));
      last = std::max(last, runs[i].figure("cpu_s"));
      const double error = study::error_of(runs[i], q, reference, bin);
      if (error > 0.0) least = std::min(least, error);
      if (front[i]) rings.add(runs[i].figure("cpu_s"), error);
    }
    Style ring;
    ring.colour = Colour::black;
    ring.marker = Marker::ring;
    ring.marker_px = 10.0;
    axes.points(q == quantities.front() || quantities.size() > 2 ? "Pareto front" : "", rings.x,
                rings.y, ring);
    if (reference.exact) continue;
    const double bar = reference.values[static_cast<std::size_t>(q)]->error;
    Style grey;
    grey.colour = Colour::grey;
    const std::array xs{first, last}, top{bar, bar};
    const double floor = 0.5 * std::min(least, bar);
    const std::array bottom{floor, floor};
    axes.band("", xs, bottom, top, grey);
  }
  panel("energy ledger", [](const study::SweepRun& run) { return run.figure("energy_error"); });
  return figure;
}

Figure flow_figure(std::span<const study::SweepRun> runs, const study::SweepReference& reference,
                   const std::string& name) {
  const std::vector<study::SweepFamily> families = study::families_of(runs);
  Figure figure("A flow against its exact solution",
                name +
                    "; black: exact; lines: the longest step of the first method, from coarse "
                    "cells to fine");
  figure.columns = 2;
  figure.panel_width_px = 400.0;
  figure.panel_height_px = 280.0;
  const double bin = study::common_bin(runs);
  for (const study::Quantity q : {study::Quantity::momentum, study::Quantity::kinetic}) {
    const auto& value = reference.values[static_cast<std::size_t>(q)];
    if (!value || families.empty()) continue;
    const std::string what =
        q == study::Quantity::momentum ? "momentum along x (kg/s)" : "kinetic energy (J/m)";
    Axes& history = figure.add_axes();
    history.x.label = "time (s)";
    history.y.label = what;
    std::size_t colour = 0;
    for (const study::SweepRun* run : families.front().runs) {
      if (!has_longest_step(*run, families.front())) continue;
      Style style;
      style.colour = cycle_colour(colour++);
      history.line(fmt::format("h = {:.4g} mm", 1e3 * run->scene().h),
                   run->series.find("time_s")->second,
                   run->series.find(study::column_of(q, run->scene().dimensions()))->second, style);
    }
    const study::QuantityCurve exact = study::curve_of(value->value, q, runs.front().scene(), bin);
    history.dashed("exact", exact.x, exact.y, {Colour::black, 1.2});
    Axes& errors = figure.add_axes();
    errors.title = fmt::format("error of the {}",
                               q == study::Quantity::momentum ? "momentum" : "kinetic energy");
    errors.x = {"h (mm)", AxisScale::logarithmic};
    errors.y = {"relative error", AxisScale::logarithmic};
    for (const study::SweepFamily& family : families) {
      Dots line, others;
      for (const study::SweepRun* run : family.runs)
        (has_longest_step(*run, family) ? line : others)
            .add(1e3 * run->scene().h, study::error_of(*run, q, reference, bin));
      Style style = style_of(family, families);
      errors.line(family.name(), line.x, line.y, style);
      style.marker_px = 3.0;
      if (!others.x.empty()) errors.points("", others.x, others.y, style);
      if (&family != &families.front() || line.x.empty()) continue;
      for (const double order : {1.0, 2.0}) {  // slopes through the coarsest run
        std::vector<double> y;
        for (const double h : line.x)
          y.push_back(line.y.front() * std::pow(h / line.x.front(), order));
        errors.dashed(order == 1.0 ? "h and h^{2}" : "", line.x, y, {Colour::grey, 1.0});
      }
    }
  }
  return figure;
}

}  // namespace repose::report

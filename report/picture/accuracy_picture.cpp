#include "report/picture/accuracy_picture.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace repose::report {

Figure accuracy_picture(const std::vector<study::SweepRun>& runs, study::Quantity q,
                        const study::Convergence& so_far, const study::Estimate& estimate,
                        double target, double bin) {
  Figure figure(fmt::format("What {} tends to", study::name_of(q)),
                fmt::format("error bar {:.2g} %, asked for {:.2g} %", 100.0 * estimate.error,
                            100.0 * target));
  Axes& axes = figure.add_axes();
  const auto& levels = so_far.levels();
  Style black;
  black.colour = Colour::black;
  if (study::is_curve(q)) {
    const mpm::Scene& scene = runs.back().scene();
    axes.x.label = q == study::Quantity::profile ? "x (m)" : "time (s)";
    axes.y.label = q == study::Quantity::profile
                       ? "solid depth (m)"
                       : fmt::format("kinetic energy ({})", study::unit_of(q, scene.dimensions()));
    axes.legend = Legend::top_right;
    for (const auto& level : levels) {
      const study::QuantityCurve curve = study::curve_of(level.mean(), q, scene, bin);
      axes.line(fmt::format("h = {:.4g} mm", 1e3 * level.h), curve.x, curve.y);
    }
    const study::QuantityCurve curve = study::curve_of(estimate.value, q, scene, bin);
    axes.dashed("extrapolated", curve.x, curve.y, black);
    return figure;
  }
  axes.x = {"cell size (mm)", AxisScale::linear, 0.0, 1.08e3 * levels.front().h};
  axes.x.lower = -0.04e3 * levels.front().h;
  axes.y.label = fmt::format("{} ({})", study::name_of(q),
                             study::unit_of(q, runs.back().scene().dimensions()));
  std::vector<double> h, value, mean_h, mean;
  for (const study::SweepRun& run : runs) {
    h.push_back(1e3 * run.scene().h);
    value.push_back(run.figure(study::column_of(q)));
  }
  for (const auto& level : levels) {
    mean_h.push_back(1e3 * level.h);
    mean.push_back(level.mean()[0]);
  }
  axes.line("mean of the runs", mean_h, mean);
  Style dots;
  dots.colour = Colour::blue;
  axes.points("runs", h, value, dots);
  const double at = estimate.value[0], bar = estimate.error * std::abs(at);
  const std::array on{mean_h.back(), 0.0}, towards{mean.back(), at};
  axes.dashed("extrapolated", on, towards, black);
  const std::array zero{0.0, 0.0}, ends{at - bar, at + bar};
  Style bar_style = black;
  bar_style.width_px = 3.0;
  axes.line("estimate and error bar", zero, ends, bar_style);
  const std::array place{0.0}, centre{at};
  Style dot = black;
  dot.marker = Marker::diamond;
  axes.points("", place, centre, dot);
  return figure;
}

}  // namespace repose::report

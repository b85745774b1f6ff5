#include "report/picture/point_chart_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

namespace repose::report {

Figure work_figure(const std::vector<point::WorkPoint>& points) {
  Figure figure("Work and precision of the integrators",
                "one path with 50 rows, in process; largest error of stress and state in any row; "
                "median of the repeats, bars: quartiles");
  figure.columns = 3;
  figure.panel_width_px = 330.0;
  figure.panel_height_px = 250.0;
  std::vector<std::string> paths;
  for (const point::WorkPoint& p : points)
    if (paths.empty() || paths.back() != p.path) paths.push_back(p.path);
  for (const std::string& path : paths) {
    Axes& axes = figure.add_axes();
    axes.title = path;
    axes.x = {"error (relative)", AxisScale::logarithmic};
    axes.y = {"time (µs)", AxisScale::logarithmic};
    axes.legend = figure.panels().size() == 3 ? Legend::right : Legend::none;
    std::size_t colour = 0;
    for (const point::Method method :
         {point::Method::adaptive, point::Method::cvode, point::Method::ida, point::Method::arkode,
          point::Method::implicit}) {
      std::vector<double> error, time;
      for (const point::WorkPoint& p : points)
        if (p.path == path && p.method == method && p.completed && p.error() > 0.0) {
          error.push_back(p.error());
          time.push_back(1e6 * p.seconds);
        }
      Style style;
      style.colour = cycle_colour(colour++);
      style.marker = Marker::circle;
      style.marker_px = 5.0;
      if (!error.empty()) axes.line(std::string(point::name_of(method)), error, time, style);
      style.marker.reset();
      style.width_px = 1.0;
      for (const point::WorkPoint& p : points) {
        if (p.path != path || p.method != method || !p.completed || !(p.error() > 0.0)) continue;
        const std::array at{p.error(), p.error()}, bar{1e6 * p.lower, 1e6 * p.upper};
        axes.line("", at, bar, style);
      }
    }
  }
  return figure;
}

Figure error_map_figure(const std::vector<study::ErrorMap>& maps) {
  Figure figure("Error of one stress update",
                "log10 |σ − σ_{exact}|/|σ_{exact}| of a single implicit step, London clay");
  figure.columns = 2;
  for (const study::ErrorMap& map : maps) {
    Axes& axes = figure.add_axes();
    axes.title = map.name;
    axes.x.label = "Δε_{v} (%), compression positive";
    axes.y.label = "Δε_{q} (%)";
    std::vector<double> x, y, z;
    for (const point::StepError& c : map.cells) {
      x.push_back(100.0 * c.eps_v);
      y.push_back(100.0 * c.eps_q);
      z.push_back(c.error >= 0.0 ? std::log10(std::max(c.error, 1e-12)) : std::nan(""));
    }
    ScatterStyle style;
    style.diameter = 200.0 * (map.cells.back().eps_v - map.cells.front().eps_v) /
                     (2.0 * (std::sqrt(static_cast<double>(map.cells.size())) - 1.0));
    axes.scatter(x, y, z, Axis{"log_{10} error"}, style);
  }
  return figure;
}

Figure tangent_figure(const std::vector<point::TangentTest>& tests) {
  Figure figure("Convergence of the laws' tangents",
                "remainder of Taylor's first order around one step; of second order where the "
                "tangent is the derivative of the update");
  figure.panel_width_px = 560.0;
  figure.panel_height_px = 360.0;
  Axes& axes = figure.add_axes();
  axes.x = {"perturbation over the step", AxisScale::logarithmic};
  axes.y = {"remainder over change", AxisScale::logarithmic};
  axes.legend = Legend::right;
  std::size_t colour = 0;
  for (const point::TangentTest& test : tests) {
    std::vector<double> h, remainder;
    for (const point::TangentPoint& p : test.points)
      if (p.remainder > 0.0) {
        h.push_back(p.h);
        remainder.push_back(p.remainder);
      }
    Style style;
    style.colour = cycle_colour(colour++);
    if (colour > 7) style.marker = Marker::circle;  // one more than colours tell apart
    if (!h.empty())
      axes.line(fmt::format("{}: {:.2f}", test.name, test.order), h, remainder, style);
  }
  const std::array ends{1e-5, 1e-1}, second{1e-12, 1e-4};
  axes.dashed("second order", ends, second, {Colour::black, 1.2});
  return figure;
}

}  // namespace repose::report

#include "report/picture/fit_chart_picture.hpp"

#include <algorithm>

#include <fmt/core.h>

namespace repose::report {
namespace {

/// Below this share of the first objective nothing but round-off is left; the pictures end here.
constexpr double floor_of_chart = 1e-20;

/// At most seven algorithms share a panel: as many as colours tell apart.
std::string_view group_of(const calibration::Algorithm& a) {
  const auto has = [&](std::string_view part) { return a.name.find(part) != a.name.npos; };
  if (has("DIRECT") || has("STOGO")) return "global: dividing rectangles, branch and bound";
  if (has("TNEWTON")) return "local, with gradients: truncated Newton";
  if (a.global) return "global: random and clustering";
  return a.gradient ? "local, with gradients" : "local, without gradients";
}

}  // namespace

Figure fit_chart_figure(const std::vector<study::AlgorithmRun>& runs, const std::string& task,
                        double first) {
  Figure figure("Algorithms of a fit", task + "; best objective so far over the first one");
  figure.columns = 2;
  std::vector<std::string_view> groups;
  for (const study::AlgorithmRun& run : runs)
    if (const std::string_view g = group_of(run.algorithm);
        std::find(groups.begin(), groups.end(), g) == groups.end())
      groups.push_back(g);
  for (const std::string_view group : groups)
    for (const bool over_time : {false, true}) {
      Axes& axes = figure.add_axes();
      axes.title = std::string(group);
      axes.x = {over_time ? "time (ms)" : "trials, with or without gradient",
                AxisScale::logarithmic};
      axes.y = {"objective / first", AxisScale::logarithmic};
      std::size_t colour = 0;
      for (const study::AlgorithmRun& run : runs) {
        if (group_of(run.algorithm) != group) continue;
        std::vector<double> x, y;
        for (const calibration::TracePoint& p : run.optimum.trace) {
          x.push_back(over_time ? std::max(1e3 * p.seconds, 1e-3)
                                : static_cast<double>(study::trials(p)));
          y.push_back(std::max(p.objective / first, floor_of_chart));
        }
        if (x.empty()) continue;
        Style style;
        style.colour = cycle_colour(colour++);
        axes.line(std::string(run.algorithm.name), x, y, style);
      }
    }
  return figure;
}

}  // namespace repose::report

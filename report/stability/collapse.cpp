#include <fmt/core.h>

#include "report/stability/pictures.hpp"

namespace repose::report {

std::vector<Figure> collapse_figures(const study::CollapseMaps& maps) {
  Figure figure("Failures of published runs, and mended",
                fmt::format("the paper's column, {} m cells", maps.h));
  figure.columns = 2;
  Axes* axes = nullptr;
  for (const study::ClayCollapse& run : maps.clay) {
    if (run.linearised) {
      axes = &figure.add_axes();
      axes->title = fmt::format("Cam-Clay, {}°, Δt = {} s", run.tilt_deg, run.dt);
      axes->x.label = "time (s)";
      axes->y = {"points without stress", AxisScale::linear, 0.0, {}};
    }
    std::vector<double> t, y;
    for (const mpm::SeriesRow& r : run.history.rows) {
      t.push_back(r.time_s);
      y.push_back(static_cast<double>(r.points_separated));
    }
    axes->line(run.linearised ? "linearised: lost for good" : "exact: apart, and back again", t, y);
  }
  Axes& creep = figure.add_axes();
  creep.title = "μ(I): does it come to rest?";
  creep.x.label = "time (s)";
  creep.y = {"kinetic energy (J/m)", AxisScale::logarithmic, 1e-7, 1e2};
  for (const study::GrainCollapse& run : maps.grains) {
    std::vector<double> t, y;
    for (const mpm::SeriesRow& r : run.history.rows) {
      t.push_back(r.time_s);
      y.push_back(r.kinetic_J_per_m);
    }
    creep.line(run.title, t, y);
  }
  std::vector<Figure> figures;
  figures.push_back(std::move(figure));
  return figures;
}

}  // namespace repose::report

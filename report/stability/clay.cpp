#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "report/stability/pictures.hpp"

namespace repose::report {
namespace {

/// log10 of an error as a map shows it; NaN where there is none.
double shown(const point::ClayOutcome& o) {
  return o.converged ? std::log10(std::max(o.error, 1e-12)) : std::nan("");
}

const Axis error_colours{"log_{10} error", AxisScale::linear, -12.0, 0.0};

Figure steps_figure(const study::ClayMaps& maps) {
  Figure figure("One step of modified Cam-Clay",
                fmt::format("log_{{10}} of the stress error of a single update; crosses: no "
                            "result. κ = {:.3g}",
                            maps.kappa));
  figure.columns = 3;
  figure.panel_width_px = figure.panel_height_px = 260.0;
  for (const point::ClayUpdate update : study::clay_updates)
    for (const point::ClayStart& start : maps.starts) {
      Axes& axes = figure.add_axes();
      axes.title = fmt::format("{}, OCR {}", study::name_of(update), start.ocr);
      axes.x.label = "Δε_{v}/κ, compression positive";
      axes.y.label = "Δε_{q}/κ";
      std::vector<double> x, y, z;
      for (const point::ClayCell& c : maps.steps) {
        if (c.update != update || c.start.ocr != start.ocr) continue;
        x.push_back(c.step.eps_v / maps.kappa);
        y.push_back(c.step.eps_q / maps.kappa);
        z.push_back(shown(c.outcome));
      }
      ScatterStyle style;
      style.diameter = 6.0 / (static_cast<double>(maps.cells_across) - 1.0);
      axes.scatter(x, y, z, error_colours, style);
    }
  return figure;
}

Figure sweep_figure(const study::ClayMaps& maps) {
  Figure figure("One step in compression and shear, Δε_{q} = Δε_{v}, from the yield surface",
                "a line ends where the update has no result");
  figure.columns = 2;
  for (const point::ClayUpdate update : study::clay_updates) {
    Axes& axes = figure.add_axes();
    axes.title = study::name_of(update);
    axes.x = {"Δε_{v}/κ", AxisScale::logarithmic};
    axes.y = {"stress error (relative)", AxisScale::logarithmic, 1e-6, 10.0};
    for (const study::ClaySweep& sweep : maps.sweeps)
      if (sweep.update == update)
        axes.line(fmt::format("κ = {:.2g}", sweep.kappa), sweep.strain, sweep.error);
  }
  return figure;
}

Figure paths_figure(const study::ClayMaps& maps) {
  Figure figure("Paths of modified Cam-Clay in equal steps",
                "log_{10} of the stress error at the end; crosses: no result");
  figure.columns = 2;
  figure.panel_width_px = 320.0;
  figure.panel_height_px = 240.0;
  for (const study::ClayPath& path : maps.paths) {
    Axes& axes = figure.add_axes();
    axes.title = fmt::format("{}: {}", study::name_of(path.update), path.title);
    axes.x = {"steps per leg", AxisScale::logarithmic, 0.7, 1.4 * maps.most_steps};
    axes.y = {"OCR", AxisScale::logarithmic, 0.85, 38.0};
    std::vector<double> z;
    for (const point::ClayOutcome& o : path.outcomes) z.push_back(shown(o));
    ScatterStyle style;
    style.marker_px = 14.0;
    axes.scatter(path.steps, path.ocr, z, error_colours, style);
  }
  return figure;
}

}  // namespace

std::vector<Figure> clay_figures(const study::ClayMaps& maps) {
  std::vector<Figure> figures;
  figures.push_back(steps_figure(maps));
  figures.push_back(sweep_figure(maps));
  figures.push_back(paths_figure(maps));
  return figures;
}

}  // namespace repose::report

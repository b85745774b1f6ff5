#include <fmt/core.h>

#include "report/stability/pictures.hpp"

namespace repose::report {
namespace {

const Style measured{Colour::automatic, 1.6, Marker::circle, 5.0};

void over_counts(Axes& axes, const char* title, const char* label, AxisScale scale,
                 const std::vector<study::FailureCurve>& curves) {
  axes.title = title;
  axes.x = {"points per cell", AxisScale::linear, 0.0, 17.0};
  axes.y = {label, scale};
  for (const study::FailureCurve& c : curves)
    axes.line(fmt::format("{}, {}", mpm::name_of(c.kernel), mpm::name_of(c.transfer)), c.counts,
              c.values, measured);
}

}  // namespace

std::vector<Figure> mpm_figures(const study::FailureMaps& maps) {
  Figure figure("Failures of the method over points per cell and cell size");
  figure.columns = 2;
  over_counts(figure.add_axes(), "cell crossing", "rms error of the density, stretched by half",
              AxisScale::logarithmic, maps.cell_crossing);
  over_counts(figure.add_axes(), "numerical fracture",
              "stretch at which the density is off by 10 %", AxisScale::linear, maps.fracture);
  Axes& locking = figure.add_axes();
  locking.title = "locking: bulge of a block under its weight";
  locking.x = {"cells across the block", AxisScale::logarithmic};
  locking.y.label = "bulge over that of the finest cells";
  for (const study::LockingCurve& c : maps.locking)
    locking.line(fmt::format("ν = {}", c.nu), c.cells, c.over_finest, measured);
  Axes& ringing = figure.add_axes();
  ringing.title = "ringing: pressure noise of the heap at rest";
  ringing.x = {"points per cell", AxisScale::linear, 0.0, 17.0};
  ringing.y = {"noise of p over the overburden, rms (%)", AxisScale::linear, 0.0, {}};
  for (const study::RingingCurve& c : maps.ringing)
    ringing.line(fmt::format("h = {} m", c.h), c.counts, c.percent, measured);
  std::vector<Figure> figures;
  figures.push_back(std::move(figure));
  return figures;
}

}  // namespace repose::report

#include <fmt/core.h>

#include "report/stability/pictures.hpp"

namespace repose::report {

std::vector<Figure> step_figures(const study::StepMaps& maps) {
  Figure figure("Largest stable Courant number cΔt/h, measured by blow-up",
                "dashed: theory of the bulk (two directions) and of an isolated point");
  figure.columns = 2;
  const Style measured{Colour::automatic, 1.5, Marker::circle, 5.0};
  for (const study::StepsInABox& box : maps.in_a_box) {
    Axes& axes = figure.add_axes();
    axes.title =
        fmt::format("{}, {}, fluid", box.place == mpm::Place::bulk ? "bulk" : "free surface",
                    mpm::name_of(box.kernel));
    axes.x = {"points per cell", AxisScale::linear, 0.0, 17.0};
    axes.y = {"cΔt/h", AxisScale::linear, 0.0, {}};
    axes.legend = Legend::right;
    for (const study::StepsInABox::Curve& curve : box.curves)
      axes.line(std::string(mpm::name_of(curve.transfer)), box.counts, curve.measured, measured);
    const std::vector<double> ends{0.0, 17.0}, level{box.theory, box.theory};
    axes.dashed("theory", ends, level, {Colour::black, 1.2});
  }
  Axes* axes = nullptr;
  for (const study::StepsAlone& alone : maps.alone) {
    if (!alone.solid) {
      axes = &figure.add_axes();
      axes->title = fmt::format("isolated point, {}", mpm::name_of(alone.kernel));
      axes->x.label = "position in its cell (h)";
      axes->y = {"cΔt/h", AxisScale::linear, 0.0, {}};
      axes->legend = Legend::right;
    }
    const char* const material = alone.solid ? "solid" : "fluid";
    for (const study::StepsInABox::Curve& curve : alone.curves)
      axes->line(fmt::format("{}, {}", material, mpm::name_of(curve.transfer)), alone.offsets,
                 curve.measured, measured);
    const std::vector<double> ends{0.0, 0.5}, level{alone.theory, alone.theory};
    axes->dashed(fmt::format("theory, {}", material), ends, level, {Colour::automatic, 1.2});
  }
  std::vector<Figure> figures;
  figures.push_back(std::move(figure));
  return figures;
}

}  // namespace repose::report

#include <algorithm>

#include <fmt/core.h>

#include "report/stability/pictures.hpp"

namespace repose::report {
namespace {

Figure boundary_figure(const study::GrainMaps& maps) {
  Figure figure("Ill-posed flow of μ(I): fastest growth of short waves in plane shear",
                "colour: measured with the law's update, in units of ηk²/ρ; rings: C > 0, "
                "ill-posed");
  figure.columns = 2;
  for (const study::GrowthMap& map : maps.boundary) {
    Axes& axes = figure.add_axes();
    axes.title = map.ratio ? fmt::format("μ_{{0}} = {:.4g}", map.mu_0)
                           : fmt::format("μ_{{d}}/μ_{{0}} = {:.4g}", map.mu_d / map.mu_0);
    axes.x = {"I", AxisScale::logarithmic, 7e-4, 14.0};
    axes.y.label = map.ratio ? "μ_{d}/μ_{0}" : "μ_{0}";
    std::vector<double> z, ill_x, ill_y;
    for (std::size_t i = 0; i < map.I.size(); ++i) {
      z.push_back(std::clamp(map.measured[i], -0.1, 0.1));
      if (map.C[i] > 0.0) {
        ill_x.push_back(map.I[i]);
        ill_y.push_back(map.second[i]);
      }
    }
    ScatterStyle style;
    style.marker_px = 10.0;
    axes.legend = Legend::none;
    axes.scatter(map.I, map.second, z, Axis{"growth", AxisScale::linear, -0.1, 0.1}, style);
    axes.points("C > 0", ill_x, ill_y, {Colour::black, 1.0, Marker::ring, 12.0});
  }
  return figure;
}

Figure refinement_figure(const study::GrainMaps& maps) {
  Figure figure(
      fmt::format("Growth over the wavelength, I = {}, p = {:.3g} Pa", maps.spectrum_I, maps.p),
      "the fastest direction; dashed: incompressible, gηk²/ρ");
  Axes& axes = figure.add_axes();
  axes.x = {"wavelength/d", AxisScale::logarithmic};
  axes.y = {"growth rate/γ̇", AxisScale::logarithmic};
  for (const study::GrowthSpectrum& s : maps.spectra)
    axes.line(fmt::format("K = {:.3g} Pa", s.K), s.wavelength_over_d, s.rate_over_shear_rate,
              {Colour::automatic, 1.8, Marker::circle, 5.0});
  axes.dashed("incompressible", maps.incompressible.wavelength_over_d,
              maps.incompressible.rate_over_shear_rate, {Colour::black, 1.2});
  return figure;
}

Colour colour_of_form(const std::string& form) {
  if (form == "elastoviscoplastic") return Colour::blue;
  return form == "regularised" ? Colour::orange : Colour::vermillion;
}

Figure curves_figure(const study::GrainMaps& maps) {
  Figure figure("Growth of short waves for the forms of μ(I)",
                "points: measured, lines: predicted; in units of ηk²/ρ; > 0 is ill-posed");
  figure.columns = 2;
  Axes& over_I = figure.add_axes();
  over_I.title = "flow curves";
  over_I.x = {"I", AxisScale::logarithmic};
  over_I.y = {"fastest growth", AxisScale::linear, -0.4, 0.15};
  const std::vector<double> ends{maps.numbers.front(), maps.numbers.back()}, zero{0.0, 0.0};
  over_I.line("", ends, zero, {Colour::grey, 1.0});
  for (const study::GrowthCurve& c : maps.curves) {
    const Colour colour = colour_of_form(c.form);
    over_I.line("", c.I, c.predicted, {colour, 1.2});
    over_I.points(c.form, c.I, c.measured, {colour, 1.0, Marker::circle, 5.0});
  }
  Axes& over_r = figure.add_axes();
  over_r.title = fmt::format("regularised, I = {}", maps.over_r.I);
  over_r.x = {"r/γ̇", AxisScale::logarithmic};
  over_r.y.label = "fastest growth";
  over_r.line("predicted", maps.over_r.ratio, maps.over_r.predicted, {Colour::orange, 1.2});
  over_r.points("measured", maps.over_r.ratio, maps.over_r.measured,
                {Colour::orange, 1.0, Marker::circle, 5.0});
  return figure;
}

Figure collapse_figure(const study::IllPosedCollapse& collapse) {
  Figure figure("Ill-posed points of the flat column",
                fmt::format("{} points, h = {} m", collapse.x_m.size(), collapse.h));
  figure.columns = 1;
  figure.panel_width_px = 620.0;
  figure.panel_height_px = 220.0;
  Axes& shares = figure.add_axes();
  shares.x.label = "time (s)";
  shares.y.label = "share of mass (%)";
  shares.line("flows", collapse.time, collapse.flowing_percent, {Colour::blue});
  shares.line("C > 0, ill-posed", collapse.time, collapse.ill_percent, {Colour::vermillion});
  if (collapse.x_m.empty()) return figure;
  Axes& picture = figure.add_axes();
  picture.title = fmt::format("{:.2f} s; crosses: no flow", collapse.shown_time);
  picture.x.label = "x (m)";
  picture.y.label = "y (m)";
  picture.equal_aspect = true;
  std::vector<double> shown = collapse.C;
  for (double& C : shown) C = std::clamp(C, -0.2, 0.2);
  ScatterStyle style;
  style.diameter = 0.9 * collapse.point_spacing;
  picture.scatter(collapse.x_m, collapse.y_m, shown, Axis{"C", AxisScale::linear, -0.2, 0.2},
                  style);
  return figure;
}

}  // namespace

std::vector<Figure> mu_i_figures(const study::GrainMaps& maps) {
  std::vector<Figure> figures;
  figures.push_back(boundary_figure(maps));
  figures.push_back(refinement_figure(maps));
  figures.push_back(curves_figure(maps));
  for (Figure& figure : shear_cell_figures(maps.shear_cell)) figures.push_back(std::move(figure));
  figures.push_back(collapse_figure(maps.collapse));
  return figures;
}

}  // namespace repose::report

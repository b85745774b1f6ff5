#include <algorithm>

#include <fmt/core.h>

#include "report/stability/pictures.hpp"

namespace repose::report {
namespace {

/// Of the two inertial numbers that are refined: the ill-posed one and the other.
Colour colour_of(double I) { return I < 0.05 ? Colour::vermillion : Colour::blue; }

Figure signs_figure(const study::ShearCellMaps& maps) {
  Figure figure("Ill-posed flow of μ(I): growth of a wave in a Material Point shear cell",
                fmt::format("eight cells to a wave, K = {} p; in units of ηk²/ρ",
                            study::shear_cell_stiffness));
  figure.columns = 2;
  Axes& over_I = figure.add_axes();
  over_I.title = "lines: theory at the same K, points: measured";
  over_I.x = {"I", AxisScale::logarithmic};
  over_I.y = {"growth", AxisScale::linear, -0.25, 0.15};
  over_I.line("", std::vector{maps.numbers.front(), maps.numbers.back()}, std::vector{0.0, 0.0},
              {Colour::grey, 1.0});
  for (const study::CellCurve& c : maps.curves) {
    const Colour colour = c.form == "elastoviscoplastic" ? Colour::blue : Colour::vermillion;
    over_I.line("", c.I, c.theory, {colour, 1.2});
    over_I.points(c.form, c.I, c.measured, {colour, 1.0, Marker::circle, 5.0});
  }
  if (!maps.map) return figure;
  Axes& map = figure.add_axes();
  map.title = "colour: measured; rings: C > 0, ill-posed";
  map.x = {"I", AxisScale::logarithmic, 7e-4, 14.0};
  map.y.label = "μ_{d}/μ_{0}";
  map.legend = Legend::none;
  std::vector<double> z, ill_x, ill_y;
  for (std::size_t i = 0; i < maps.map->I.size(); ++i) {
    z.push_back(std::clamp(maps.map->measured[i], -0.1, 0.1));
    if (maps.map->C[i] <= 0.0) continue;
    ill_x.push_back(maps.map->I[i]);
    ill_y.push_back(maps.map->ratio[i]);
  }
  map.scatter(maps.map->I, maps.map->ratio, z, Axis{"growth", AxisScale::linear, -0.1, 0.1},
              {10.0, {}});
  map.points("", ill_x, ill_y, {Colour::black, 1.0, Marker::ring, 12.0});
  return figure;
}

Figure refinement_figure(const study::ShearCellMaps& maps) {
  Figure figure("Growth in a Material Point shear cell under refinement",
                fmt::format("p = {:g} Pa; points: measured", maps.p));
  figure.columns = 2;
  Axes& one_wave = figure.add_axes();
  one_wave.title = fmt::format("one wave, ηk²/ρ = {} ck", study::shear_cell_acoustic_share);
  one_wave.x.label = "cells to the wavelength";
  one_wave.y.label = "rate over that of theory";
  for (const study::CellConvergence& c : maps.convergence) {
    one_wave.dashed("", c.cells, c.expected, {colour_of(c.I), 1.2});
    one_wave.points(fmt::format("I = {}", c.I), c.cells, c.measured,
                    {colour_of(c.I), 1.0, Marker::circle, 6.0});
  }
  Axes& growing = figure.add_axes();
  Axes& decaying = figure.add_axes();
  growing.title = "ill-posed, I = 0.01: growth of waves of eight cells";
  decaying.title = "well-posed: decay of waves of eight cells";
  for (Axes* axes : {&growing, &decaying}) {
    axes->x = {"h/d", AxisScale::logarithmic};
    axes->y = {"rate/γ̇", AxisScale::logarithmic};
  }
  for (const study::CellRefinement& r : maps.refinement) {
    Axes& axes = r.growing ? growing : decaying;
    const Colour colour = cycle_colour(axes.series().size() / 2);
    axes.line("", r.h_over_d, r.theory, {colour, 1.2});
    axes.points(r.name, r.h_over_d, r.measured, {colour, 1.0, Marker::circle, 6.0});
  }
  Axes& noise = figure.add_axes();
  noise.title = "noise; from right to left h, h/2, h/4";
  noise.x.label = "ηk²t/ρ of waves of eight cells of size h";
  noise.y.label = "ln of its size";
  for (const study::CellNoise& n : maps.noise)
    noise.line(n.coarsest ? fmt::format("I = {}", n.I) : "", n.time, n.log_size,
               {colour_of(n.I), 1.5});
  return figure;
}

}  // namespace

std::vector<Figure> shear_cell_figures(const study::ShearCellMaps& maps) {
  std::vector<Figure> figures;
  figures.push_back(signs_figure(maps));
  figures.push_back(refinement_figure(maps));
  return figures;
}

}  // namespace repose::report

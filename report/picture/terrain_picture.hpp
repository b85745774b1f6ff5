#pragma once

#include <filesystem>
#include <vector>

#include "io/level_lines.hpp"
#include "mpm/step/simulation.hpp"
#include "report/plot/figure.hpp"

namespace repose::report {

/// Between contours of the ground, a round figure [m]; 0 on level ground.
double contour_step(const mpm::Terrain& terrain);

/// The elevations of these contours.
std::vector<double> contour_levels(const mpm::Terrain& terrain);
/// The outlines of what is released.
std::vector<io::Region> released(const mpm::Terrain& terrain);
/// A map's values at the middles of its cells.
io::Lattice middles(const io::Raster& map);

/// Panels of one size, beside or below one another as the map is tall or wide.
void size_for_plan(Figure& figure, const mpm::Terrain& terrain);

/// A panel with the ground from above, shaded, with contours. Its axes start at the lower left
/// corner of the map: a place (x, z) of the scene is at (x, ground_map.height() − z).
Axes& add_plan(Figure& figure, const mpm::Terrain& terrain);

/// Places of a scene as that panel shows them.
std::vector<mpm::Probe> from_above(const mpm::Terrain& terrain, std::vector<mpm::Probe> places);

/// The outline of what is released.
void draw_release(Axes& axes, const mpm::Terrain& terrain);

/// A flow over a terrain from above: largest depth and the deposit as it is, on shaded ground with
/// contours, with the outlines of what was released and reached, probes, and tracers where their
/// points are; as SVG. Errors: PlotError, IoError.
void draw_terrain_picture(const mpm::Simulation& simulation, const std::filesystem::path& path);

}  // namespace repose::report

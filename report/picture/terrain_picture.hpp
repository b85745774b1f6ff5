#pragma once

#include <filesystem>

#include "mpm/step/simulation.hpp"

namespace repose::report {

/// A flow over a terrain from above: largest depth and the deposit as it is, on shaded ground with
/// contours and the outlines of what was released and reached; as SVG. Errors: PlotError, IoError.
void draw_terrain_picture(const mpm::Simulation& simulation, const std::filesystem::path& path);

}  // namespace repose::report

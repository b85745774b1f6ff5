#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "input/read_scene.hpp"
#include "mpm/step/simulation.hpp"
#include "report/picture/scene_drawing.hpp"

namespace repose::report {

/// The state of a scene at one moment, in the plane of its section. Lengths in m; x_m, y_m and
/// value have one entry for each material point.
struct HeapPicture {
  std::string title, subtitle;
  mpm::Scene scene;
  Section section;
  std::span<const double> x_m, y_m;
  std::span<const double> value;
  std::string value_label;  // with its unit: "von Mises stress (kPa)"
  /// The bodies of the points, which then give the colours, with a legend; no value is needed.
  std::span<const std::int32_t> body;
};

/// Draws the points coloured by value, or by body, in their box, to scale, as SVG. If a few extreme
/// values would take up most of the colours, those end at the 0.5 % and 99.5 % quantiles and the
/// subtitle says so. Errors: std::invalid_argument for a box or spacing that is not positive or
/// arrays that differ in length; PlotError; IoError.
void write_heap_picture(const std::filesystem::path& path, const HeapPicture& picture);

/// The points of a simulation as they are, coloured by what the scene's [output] asks for; in space
/// a slice of one cell's width, over a terrain a map (terrain_picture.hpp). False if there is
/// nothing in it. Errors: PlotError, IoError.
bool draw_final_picture(const input::SceneFile& scene, const mpm::Simulation& simulation,
                        const std::filesystem::path& path);

}  // namespace repose::report

#pragma once
/// \file
/// A scene file: what the simulation needs and what the command makes of its results.

#include "input/input_file.hpp"
#include "input/keys.hpp"
#include "mpm/scene/scene.hpp"
#include "mpm/step/simulation.hpp"

namespace repose::input {

/// What colours the points of final.svg.
enum class PictureField { mises, density, body };
constexpr std::array<std::string_view, 3> picture_field_names{"mises", "density", "body"};

struct SceneFile {
  mpm::Scene scene;
  mpm::Stress stress = mpm::Stress::averaged;  ///< of frames and final.svg
  PictureField colour = PictureField::mises;   ///< unless given, body where there are several
  double checkpoint_interval = 60.0;  ///< wall-clock time between checkpoints, 0 for none [s]
  bool final_state = false;           ///< whether it leaves a final_state.h5
  std::vector<std::string> notes;     ///< what was made of the input that the user may not expect
};

/// Every key of a scene file but [chart] (read_chart.hpp).
void scene_keys(Keys& keys, SceneFile& file);

/// An edge of the box as [domain] writes it: "slip", { friction = 0.4 }, ... What is none is
/// reported, and `fallback` returned.
mpm::Wall read_wall(TomlReader& table, std::string_view key, const mpm::Wall& fallback);

/// Reads and validates a scene. Throws BadInput with everything that is wrong.
SceneFile read_scene(InputFile& file);

}  // namespace repose::input

#pragma once
/// \file
/// A scene file: what the simulation needs and what the command makes of its results.

#include "input/input_file.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::input {

/// What colours the points of final.svg.
enum class PictureField { mises, density };

struct SceneFile {
  mpm::Scene scene;
  PictureField colour = PictureField::mises;
  std::vector<std::string> notes;  ///< what was made of the input that the user may not expect
};

/// Reads and validates a scene. Throws BadInput with everything that is wrong.
SceneFile read_scene(InputFile& file);

}  // namespace repose::input

#pragma once
/// \file
/// [terrain] of a scene: ground and release from maps.

#include "input/keys.hpp"
#include "mpm/scene/terrain.hpp"

namespace repose::input {

/// The keys of [terrain]; while reading, the maps that they name are read too.
void terrain_keys(Keys& keys, mpm::Terrain& terrain);

}  // namespace repose::input

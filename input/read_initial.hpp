#pragma once
/// \file
/// An [initial] table: shared by scenes, point tests and fits.

#include "input/keys.hpp"
#include "models/law.hpp"

namespace repose::input {

void initial_keys(Keys& keys, InitialConditions& initial);

}  // namespace repose::input

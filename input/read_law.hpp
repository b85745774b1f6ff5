#pragma once
/// \file
/// A [law] table: shared by scenes, point tests and fits.

#include "input/toml_reader.hpp"
#include "models/registry.hpp"

namespace repose::input {

/// The law with its form and every parameter default written out; parameters that the law derives
/// when they are absent (G = 4K) stay absent, so that they follow what they are derived from.
/// Reports unknown keys, wrong types, ranges, missing parameters and conditions between them.
LawSpec read_law(TomlReader law);

}  // namespace repose::input

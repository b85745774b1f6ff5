#pragma once
/// \file
/// Inputs that the program holds: the scenes of data/scenes, and the set of charts of `repose chart
/// all`.

#include "input/input_file.hpp"

namespace repose::input {

/// Their names: "flat_mu_i", ...
std::vector<std::string_view> shipped_scenes();

/// A shipped scene by its name, or a file. Errors: those of InputFile; for a name that is neither,
/// BadInput with the nearest one.
InputFile open_scene(const std::string& name_or_file, std::span<const std::string> overrides = {});

/// data/charts/all.toml as it was built in.
std::string_view shipped_chart_set();

}  // namespace repose::input

#pragma once
/// \file
/// Inputs that the program holds: the scenes of data/scenes, the point tests of data/experiments,
/// the cases of data/benchmarks, and the set of charts of `repose chart all`.

#include <optional>

#include "input/input_file.hpp"

namespace repose::input {

/// Their names: "flat_mu_i", ...
std::vector<std::string_view> shipped_scenes();

std::vector<std::string_view> shipped_tests();

/// A shipped scene or test by its name, or a file. Errors: those of InputFile; for a name that is
/// neither, BadInput with the nearest one.
InputFile open_scene(const std::string& name_or_file, std::span<const std::string> overrides = {});
InputFile open_test(const std::string& name_or_file, std::span<const std::string> overrides = {});
/// Either of them, as `repose check` takes it.
InputFile open_input(const std::string& name_or_file, std::span<const std::string> overrides = {});

/// A map of data/scenes by its file's name, "valley.asc".
std::optional<std::string_view> shipped_map(std::string_view name);

/// data/charts/all.toml as it was built in.
std::string_view shipped_chart_set();

/// The cases of `repose validate`: the folders of data/benchmarks, in their order there.
std::vector<std::string_view> shipped_benchmarks();
/// The case.toml of one of them by its name, whose files are written into output/NAME first, or of
/// a folder, or the file itself. Errors: IoError; for a name that is neither, BadInput with the
/// nearest one.
std::filesystem::path find_benchmark(const std::string& name_or_path,
                                     const std::filesystem::path& output);

}  // namespace repose::input

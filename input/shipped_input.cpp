#include "input/shipped_input.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "embedded_inputs.hpp"

namespace repose::input {

std::vector<std::string_view> shipped_scenes() {
  std::vector<std::string_view> names;
  for (const EmbeddedInput& scene : embedded_scenes) names.push_back(scene.name);
  return names;
}

InputFile open_scene(const std::string& name_or_file, std::span<const std::string> overrides) {
  const auto found =
      std::find_if(embedded_scenes.begin(), embedded_scenes.end(),
                   [&](const EmbeddedInput& scene) { return scene.name == name_or_file; });
  if (found != embedded_scenes.end())
    return InputFile::parse(found->text, name_or_file + ".toml", overrides);
  // a file without a dot or slash is likelier a misspelt name
  if (name_or_file.find_first_of("./") == std::string::npos &&
      !std::filesystem::exists(name_or_file)) {
    const std::string near = closest(name_or_file, shipped_scenes());
    throw BadInput({fmt::format("there is no scene '{}': {}, or a .toml file{}", name_or_file,
                                fmt::join(shipped_scenes(), ", "),
                                near.empty() ? "" : fmt::format("; did you mean '{}'?", near))});
  }
  return InputFile::read(name_or_file, overrides);
}

std::string_view shipped_chart_set() { return embedded_chart_set; }

}  // namespace repose::input

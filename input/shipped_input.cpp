#include "input/shipped_input.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "embedded_inputs.hpp"

namespace repose::input {
namespace {

std::vector<std::string_view> names_of(std::span<const EmbeddedInput> inputs) {
  std::vector<std::string_view> names;
  for (const EmbeddedInput& input : inputs) names.push_back(input.name);
  return names;
}

/// what: "scene", for the message.
InputFile open(std::string_view what, std::span<const EmbeddedInput> shipped,
               const std::string& name_or_file, std::span<const std::string> overrides) {
  for (const EmbeddedInput& input : shipped)
    if (input.name == name_or_file)
      return InputFile::parse(input.text, name_or_file + ".toml", overrides);
  // a file without a dot or slash is likelier a misspelt name
  if (name_or_file.find_first_of("./") == std::string::npos &&
      !std::filesystem::exists(name_or_file)) {
    const std::vector<std::string_view> names = names_of(shipped);
    const std::string near = closest(name_or_file, names);
    throw BadInput({fmt::format("there is no {} '{}': {}, or a .toml file{}", what, name_or_file,
                                fmt::join(names, ", "),
                                near.empty() ? "" : fmt::format("; did you mean '{}'?", near))});
  }
  return InputFile::read(name_or_file, overrides);
}

}  // namespace

std::vector<std::string_view> shipped_scenes() { return names_of(embedded_scenes); }
std::vector<std::string_view> shipped_tests() { return names_of(embedded_tests); }

InputFile open_scene(const std::string& name_or_file, std::span<const std::string> overrides) {
  return open("scene", embedded_scenes, name_or_file, overrides);
}

InputFile open_test(const std::string& name_or_file, std::span<const std::string> overrides) {
  return open("point test", embedded_tests, name_or_file, overrides);
}

InputFile open_input(const std::string& name_or_file, std::span<const std::string> overrides) {
  std::vector<EmbeddedInput> both(embedded_scenes.begin(), embedded_scenes.end());
  both.insert(both.end(), embedded_tests.begin(), embedded_tests.end());
  return open("scene or point test", both, name_or_file, overrides);
}

std::string_view shipped_chart_set() { return embedded_chart_set; }

}  // namespace repose::input

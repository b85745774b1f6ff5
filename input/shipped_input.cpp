#include "input/shipped_input.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "embedded_inputs.hpp"
#include "io/atomic_file.hpp"

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

/// Writes the files of a case into a folder. Errors: IoError.
void unpack_benchmark(std::string_view name, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw io::IoError(folder, "cannot create", error.value());
  for (const EmbeddedInput& input : embedded_benchmarks) {
    const std::size_t slash = input.name.find('/');
    if (input.name.substr(0, slash) == name)
      io::write_atomically(folder / input.name.substr(slash + 1), input.text, io::Outlives::kill);
  }
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

std::optional<std::string_view> shipped_map(std::string_view name) {
  for (const EmbeddedInput& map : embedded_maps)
    if (map.name == name) return map.text;
  return {};
}

std::string_view shipped_chart_set() { return embedded_chart_set; }

std::vector<std::string_view> shipped_benchmarks() {
  std::vector<std::string_view> names;
  for (const EmbeddedInput& input : embedded_benchmarks) {
    const std::string_view name = input.name.substr(0, input.name.find('/'));
    if (names.empty() || names.back() != name) names.push_back(name);
  }
  return names;
}

std::filesystem::path find_benchmark(const std::string& name_or_path,
                                     const std::filesystem::path& output) {
  namespace fs = std::filesystem;
  const std::vector<std::string_view> shipped = shipped_benchmarks();
  if (std::find(shipped.begin(), shipped.end(), name_or_path) != shipped.end()) {
    unpack_benchmark(name_or_path, output / name_or_path);
    return output / name_or_path / "case.toml";
  }
  if (name_or_path.find_first_of("./") == std::string::npos && !fs::exists(name_or_path)) {
    const std::string near = closest(name_or_path, shipped);
    throw BadInput(
        {fmt::format("there is no case '{}': {}a folder with a case.toml is needed{}", name_or_path,
                     shipped.empty() ? "" : fmt::format("one of {}, or ", fmt::join(shipped, ", ")),
                     near.empty() ? "" : fmt::format("; did you mean '{}'?", near))});
  }
  return fs::is_directory(name_or_path) ? fs::path(name_or_path) / "case.toml"
                                        : fs::path(name_or_path);
}

}  // namespace repose::input

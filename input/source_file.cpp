#include "input/source_file.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "input/shipped_input.hpp"
#include "io/atomic_file.hpp"
#include "io/fingerprint.hpp"
#include "io/seal.hpp"

namespace repose::input {

std::optional<std::string> read_source(TomlReader& table, std::string_view key,
                                       mpm::SourceFile& file) {
  namespace fs = std::filesystem;
  const Origin origin = table.file().origin(table.path_of(key));
  fs::path path = file.name;
  if (!origin.is_override() && path.is_relative())
    path = fs::path(origin.source).parent_path() / path;
  std::string bytes;
  if (fs::exists(path)) {
    try {
      bytes = io::read_bytes(path, most_source_bytes);
    } catch (const io::IoError& error) {
      table.report(key, error.what());
      return {};
    }
    file.name = fs::absolute(path).lexically_normal().string();
  } else if (const auto shipped = shipped_map(file.name)) {
    bytes = *shipped;
  } else {
    const std::string near = similar_file(path);
    table.report(key, fmt::format("{}: there is no such file{}", path.string(),
                                  near.empty() ? "" : fmt::format("; did you mean {}?", near)));
    return {};
  }
  const std::string content = io::fingerprint_of(bytes);
  if (!file.content.empty() && file.content != content) {
    table.report(key, fmt::format("{}: this is not the file that the scene was made with (its "
                                  "content is {}, and was {})",
                                  path.string(), content, file.content));
    return {};
  }
  file.content = content;
  return bytes;
}

}  // namespace repose::input

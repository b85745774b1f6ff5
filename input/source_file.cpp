#include "input/source_file.hpp"

#include <fmt/format.h>

#include "input/shipped_input.hpp"
#include "io/fingerprint.hpp"
#include "io/seal.hpp"

namespace repose::input {
namespace {

constexpr std::size_t most_bytes = 1'000'000'000;  // as of a table (io/raw_table.cpp)

}  // namespace

std::optional<SourcePlace> find_source(TomlReader& table, std::string_view key,
                                       mpm::SourceFile& file) {
  namespace fs = std::filesystem;
  const Origin origin = table.file().origin(table.path_of(key));
  fs::path path = file.name;
  if (!origin.is_override() && path.is_relative())
    path = fs::path(origin.source).parent_path() / path;
  if (fs::exists(path)) {
    file.name = fs::absolute(path).lexically_normal().string();
    return SourcePlace{path};
  }
  if (const auto shipped = shipped_map(file.name)) return SourcePlace{path, std::string(*shipped)};
  const std::string near = similar_file(path);
  table.report(key, fmt::format("{}: there is no such file{}", path.string(),
                                near.empty() ? "" : fmt::format("; did you mean {}?", near)));
  return {};
}

bool is_same_source(TomlReader& table, std::string_view key, mpm::SourceFile& file,
                    const SourcePlace& place, const std::string& content) {
  if (!file.content.empty() && file.content != content) {
    table.report(key, fmt::format("{}: this is not the file that the scene was made with (its "
                                  "content is {}, and was {})",
                                  place.path.string(), content, file.content));
    return false;
  }
  file.content = content;
  return true;
}

std::string bytes_of(const SourcePlace& place, std::string& content) {
  std::string bytes = place.shipped ? *place.shipped : io::read_bytes(place.path, most_bytes);
  content = io::fingerprint_of(bytes);
  return bytes;
}

}  // namespace repose::input

#pragma once
/// \file
/// Files that a scene names: maps, tables of points, meshes.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "input/toml_reader.hpp"
#include "io/atomic_file.hpp"
#include "io/table_error.hpp"
#include "mpm/scene/nearest.hpp"

namespace repose::input {

/// A file that a key names: where it lies, or the content of one that comes with repose.
struct SourcePlace {
  std::filesystem::path path;
  std::optional<std::string> shipped{};
};

/// Looks beside the scene's file and among the files that come with repose; the file's name becomes
/// one that holds from anywhere. Nothing, reported, if there is none.
std::optional<SourcePlace> find_source(TomlReader& table, std::string_view key,
                                       mpm::SourceFile& file);

/// Keeps the fingerprint that was found; false, reported, where the scene was made with another.
bool is_same_source(TomlReader& table, std::string_view key, mpm::SourceFile& file,
                    const SourcePlace& place, const std::string& content);

/// What read(place, content) makes of a file, with the fingerprint that it leaves in `content`; its
/// complaint is reported, and that it is not the file that the scene was made with.
template <class Read>
auto read_source(TomlReader& table, std::string_view key, mpm::SourceFile& file, Read&& read)
    -> std::optional<decltype(read(SourcePlace{}, file.content))> {
  const std::optional<SourcePlace> place = find_source(table, key, file);
  if (!place) return {};
  try {
    std::string content;
    auto made = read(*place, content);
    if (!is_same_source(table, key, file, *place, content)) return {};
    return made;
  } catch (const io::TableError& error) {
    table.report(key, error.what());
  } catch (const io::IoError& error) {
    table.report(key, error.what());
  }
  return {};
}

/// Its bytes, with their fingerprint. Errors: IoError.
std::string bytes_of(const SourcePlace& place, std::string& content);

/// What parse(bytes, name) makes of a file.
template <class Parse>
auto parsed(TomlReader& table, std::string_view key, mpm::SourceFile& file, Parse&& parse) {
  return read_source(table, key, file, [&](const SourcePlace& place, std::string& content) {
    std::string bytes = bytes_of(place, content);
    return parse(std::move(bytes), file.name);
  });
}

}  // namespace repose::input

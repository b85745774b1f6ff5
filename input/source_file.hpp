#pragma once
/// \file
/// Files that a scene names: maps, tables of points, meshes.

#include <optional>
#include <string>
#include <string_view>

#include "input/toml_reader.hpp"
#include "io/table_error.hpp"
#include "mpm/scene/nearest.hpp"

namespace repose::input {

constexpr std::size_t most_source_bytes = 1'000'000'000;  // as of a table (io/raw_table.cpp)

/// The bytes of a file that a key names, beside the scene's file or one of those that come with
/// repose; its name becomes one that holds from anywhere, and its content the fingerprint. Nothing,
/// reported, if there is none, or if its content was another.
std::optional<std::string> read_source(TomlReader& table, std::string_view key,
                                       mpm::SourceFile& file);

/// What parse(bytes, name) makes of such a file; its complaint is reported.
template <class Parse>
auto parsed(TomlReader& table, std::string_view key, mpm::SourceFile& file, Parse&& parse)
    -> std::optional<decltype(parse(std::string(), std::string()))> {
  std::optional<std::string> bytes = read_source(table, key, file);
  if (!bytes) return {};
  try {
    return parse(std::move(*bytes), file.name);
  } catch (const io::TableError& error) {
    table.report(key, error.what());
    return {};
  }
}

}  // namespace repose::input

#pragma once
/// \file
/// What the key tables say, for editors and for people.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "input/key_info.hpp"

namespace repose::input {

enum class SchemaKind : std::uint8_t { scene, test, fit, chart, benchmark };
constexpr std::array<std::string_view, 5> schema_names{"scene", "test", "fit", "chart", "case"};

/// The kind of that name. Errors: BadInput, with the names there are.
SchemaKind schema_kind(std::string_view name);

/// Every key of a kind of input.
std::vector<KeyInfo> keys_of(SchemaKind kind);

/// A JSON Schema (draft 7) that editors complete and check files of this kind from.
std::string json_schema(SchemaKind kind);

/// The reference page: a table of keys for every table of every kind of input (Markdown).
std::string key_page();

}  // namespace repose::input

#pragma once
/// \file
/// The [law] table of a foreign UMAT (umat/in): its keys are its own, and its parameters are what
/// they name.

#include "input/key_info.hpp"
#include "input/toml_reader.hpp"
#include "models/registry.hpp"

namespace repose::input {

/// Reads the table, loads the library once to see that it can be, and makes the law known. Reports
/// a library that is not there or has no such function, counts that do not fit, unknown keys.
LawSpec read_umat(TomlReader law);

/// The keys as a file has them, PROPS by their names. The library stands there in full, with the
/// fingerprint of its content: reading them again is an error where the file has changed since.
std::string umat_lines(const LawSpec& spec);
/// Of these, what comes before the parameters.
std::string umat_head(const LawSpec& spec);

/// For the schema, the reference page and `repose models`.
std::vector<KeyInfo> umat_infos();

/// The path in full and the fingerprint, as keys of a table that names a library relative to
/// `folder`; the table is left alone where there is no such file.
void anchor_umat(toml::table& law, const std::filesystem::path& folder);

}  // namespace repose::input

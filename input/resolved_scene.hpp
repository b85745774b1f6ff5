#pragma once
/// \file
/// The resolved input: a scene file with every default written out, kept in the result folder.

#include <toml++/toml.h>

#include "input/read_scene.hpp"

namespace repose::input {

/// The scene as a TOML text. Numbers read back as the same doubles, so that running it again gives
/// the same bits. Values that a law derives from others (G = 4K) stand in comments, so that they
/// follow when the file is edited. origin: one line telling where it comes from.
std::string resolved_input(const SceneFile& file, const std::string& origin);

/// A law as a table of that name ("law", "body.law"), every parameter with unit and meaning.
std::string law_table(const LawSpec& spec, std::string_view table);

/// What differs between two inputs, one line each: "grid.h: 0.00625 there, 0.0125 here". Numbers
/// are compared by value. Empty if nothing does.
std::vector<std::string> differences(const toml::table& there, const toml::table& here);

}  // namespace repose::input

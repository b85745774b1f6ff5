#pragma once
/// \file
/// A [law] table: shared by scenes, point tests and fits.

#include "input/keys.hpp"
#include "input/toml_reader.hpp"
#include "models/registry.hpp"

namespace repose::input {

/// The law with its form and every parameter default written out; parameters that the law derives
/// when they are absent (G = 4K) stay absent, so that they follow what they are derived from.
/// Reports unknown keys, wrong types, ranges, missing parameters and conditions between them.
LawSpec read_law(TomlReader law);

/// The lines of a [law] table: every parameter with unit and meaning. Values that the law derives
/// from others (G = 4K) stand in comments, so that they follow when the file is edited.
std::string law_lines(const LawSpec& spec);

/// What stands in a [law] table between its name and its parameters, for a law whose keys there are
/// its own (umat); empty for others, whose LawSpec::options are keys.
std::string own_option_lines(const LawSpec& spec);

/// The word of a parameter that has words, by its value.
std::string word_of(const ParamInfo& parameter, double x);

/// A [law] table as keys: the parameters of every law, from the registry.
void law_keys(Keys& keys, LawSpec& spec);

}  // namespace repose::input

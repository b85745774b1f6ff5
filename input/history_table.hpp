#pragma once
/// \file
/// The table that a point test's `history` names, as the path wants it.

#include "input/toml_reader.hpp"
#include "pointdriver/path/history.hpp"

namespace repose::input {

/// Columns in SI units under the names that history_path() knows: those that `columns` chooses
/// (time among them), or else every column of the file. A blank cell between two others is the
/// value of the straight line over time through both, as between any two rows. Reports what is
/// wrong; nothing then.
std::optional<point::Table> read_history_table(TomlReader& test, const std::string& file);

}  // namespace repose::input

#pragma once

#include <string>

#include "input/keys.hpp"

namespace repose::input {

/// The text of an input file with every key that applies, its unit and its meaning behind it.
/// Reading it gives the same variables, to the last bit.
std::string write_keys(const std::function<void(Keys&)>& keys);

/// "key = value", and in a column behind it a comment.
std::string key_line(std::string_view key, std::string_view value, std::string_view comment = "");
/// "m, cell size": a comment.
std::string unit_and_doc(std::string_view unit, std::string_view doc);

}  // namespace repose::input

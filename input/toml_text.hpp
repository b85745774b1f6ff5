#pragma once
/// \file
/// Values as TOML text.

#include <array>
#include <string>
#include <string_view>

namespace repose::input {

/// A basic string, quotes included.
std::string toml_string(std::string_view text);
/// The fewest digits that read back as the same double; always a TOML float.
std::string toml_number(double x);
/// [x, y] or [x, y, z].
std::string toml_vector(const std::array<double, 3>& x, std::size_t axes);

}  // namespace repose::input

#pragma once
/// \file
/// The laws as text, from their parameter tables alone.

#include <string>
#include <string_view>

namespace repose::input {

/// One line per form of every law: name, option, what it is.
std::string law_list();

/// Every form of a law: its parameters with symbol, key, unit, default, range and meaning, and its
/// state variables. Throws BadInput for an unknown name, with the nearest one.
std::string law_description(std::string_view name);

/// The same for programs; all laws if the name is empty.
std::string laws_as_json(std::string_view name);

}  // namespace repose::input

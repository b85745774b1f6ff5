#pragma once
/// \file
/// What a user of the UMAT must know of each law, as docs/umat_out.md has it.

#include <string>
#include <string_view>

namespace repose::umat {

/// Names of materials, constants and state variables of the forms of a law, or where `name` is
/// empty of all, in Markdown.
std::string tables(std::string_view name = "");

}  // namespace repose::umat

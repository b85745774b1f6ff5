#pragma once
/// \file
/// The functions that a shared library offers, read from its file.

#include <string>
#include <vector>

namespace repose::umat {

/// Names of the functions defined in the dynamic symbol table of an ELF file of this machine's word
/// size; empty for any other file.
std::vector<std::string> exported_functions(const std::string& library);

/// Of those, what somebody who looks for `wanted` may have meant: the same letters but for case and
/// underscores first, then what contains "umat"; at most eight.
std::vector<std::string> similar_symbols(const std::vector<std::string>& functions,
                                         const std::string& wanted);

}  // namespace repose::umat

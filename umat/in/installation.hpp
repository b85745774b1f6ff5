#pragma once
/// \file
/// Where repose's own files lie, seen from the program that runs.

#include <filesystem>
#include <string_view>
#include <vector>

namespace repose::umat {

/// `beside` in the folder of the program; then, from the folder that has bin and lib, and from the
/// one that has lib/repose/SET of a program compiled for another instruction set
/// (app/other_sets.hpp), bin/`beside` and `below`. An empty `beside` is left out.
std::vector<std::filesystem::path> places(std::string_view beside, std::string_view below);

}  // namespace repose::umat

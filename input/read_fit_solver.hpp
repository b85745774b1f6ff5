#pragma once
/// \file
/// The [solver], [uncertainty] and [posterior] tables of a fit.

#include <cstdint>

#include "input/read_fit.hpp"
#include "input/toml_reader.hpp"

namespace repose::input {

/// Algorithms, budgets and random numbers. seed: where the table names none.
void read_solver(TomlReader solver, std::uint64_t seed, FitFile& out);

void read_uncertainty(TomlReader table, FitFile& out);

/// A table that is there, once the targets are read: noise = "declared" needs theirs.
void read_posterior(TomlReader table, FitFile& out);

}  // namespace repose::input

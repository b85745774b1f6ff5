#pragma once
/// \file
/// [sweep]: many tests, or runs of a scene, that differ in keys of the file.

#include <optional>
#include <string>
#include <vector>

#include "input/input_file.hpp"
#include "input/keys.hpp"

namespace repose::input {

/// The runs of a sweep: run k sets keys[i] = values[k][i].
struct ParameterSets {
  std::vector<std::string> keys;                 ///< "initial.ocr", "law.M"
  std::vector<std::vector<std::string>> values;  ///< TOML text; "" where a run leaves a key alone

  /// Of run k, as --set takes them.
  std::vector<std::string> sets(std::size_t k) const;
  /// Of run k, as a table shows them: texts without their quotes.
  std::vector<std::string> shown(std::size_t k) const;
};

/// Most runs of a sweep.
inline constexpr std::size_t most_sweep_runs = 20'000;

/// The [sweep] of a test or scene, which has one of
///     grid = { "initial.ocr" = [1, 2, 4], "law.M" = [0.9, 1.0] }    every combination; the first
///                                                                   key changes slowest
///     list = [{ "initial.ocr" = 1, "law.M" = 0.9 }, …]              run by run
///     table = "sets.csv"                                            a row per run, keys as headers
/// Keys may be written out as tables ([sweep.grid] initial.ocr = [1, 2]). Without [sweep] nothing,
/// and the table counts as known in either case. Mistakes are reported.
std::optional<ParameterSets> read_sweep(InputFile& file);

/// Its table, for the schema and the page.
void sweep_keys(Keys& keys);

}  // namespace repose::input

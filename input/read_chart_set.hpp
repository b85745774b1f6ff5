#pragma once
/// \file
/// A set of charts: a file of [[chart]] entries (docs/interface.md, Sets of charts).

#include <filesystem>

#include "input/input_file.hpp"
#include "input/keys.hpp"

namespace repose::input {

enum class PartKind : std::uint8_t { point, fit, mpm, stability };
/// Their names, in the same order.
constexpr std::array<std::string_view, 4> part_kinds{"point", "fit", "mpm", "stability"};

/// One entry: what `repose chart KIND INPUT` or `repose stability INPUT` makes with `sets`.
struct ChartPart {
  std::string name;  ///< of its sub-folder
  PartKind kind = PartKind::point;
  std::string input;              ///< a file, a shipped scene, or "": the kind's default
  std::vector<std::string> set;   ///< of the entry
  std::vector<std::string> sets;  ///< the entry's other keys as keys of [chart] or [stability],
                                  ///< then its `set`, as --set takes them
  Origin origin;

  /// The same as a command.
  std::string command() const;
};

struct ChartSet {
  std::vector<ChartPart> parts;
  std::string text;  ///< as a file: with quick, [chart.quick] has taken its keys' places
};

/// The keys of a [[chart]] entry beside those of [chart] and [stability].
void chart_part_keys(Keys& keys, ChartPart& part);

/// Has it [[chart]] entries rather than a [chart] table?
bool is_chart_set(const InputFile& file);

/// Reads the entries; what is in them beside name, kind, input and set is for the chart itself to
/// check. Inputs that are files lie relative to `folder`. quick: the keys of an entry's quick table
/// replace its own. Throws BadInput.
ChartSet read_chart_set(InputFile& file, const std::filesystem::path& folder, bool quick);

}  // namespace repose::input

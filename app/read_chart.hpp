#pragma once
/// \file
/// The [chart] table of an input file: which chart, and what it varies (docs/interface.md, Charts).

#include <optional>

#include "app/input_file.hpp"
#include "mpm/scene.hpp"

namespace repose::app {

enum class ChartKind : std::uint8_t { point, fit, mpm };
/// Their names, in the same order.
constexpr std::array<std::string_view, 3> chart_names{"point", "fit", "mpm"};

/// What `repose chart mpm` varies; every combination is run.
struct Sweep {
  std::vector<mpm::Transfer> transfers;
  std::vector<mpm::Kernel> kernels;
  std::vector<std::int64_t> points_per_cell;
  std::vector<double> cells;  ///< h [m]
  std::vector<double>
      reference;  ///< finer h, with the scene's own transfer, kernel and points alone [m]
  std::vector<double> courants;  ///< Courant numbers
  std::vector<double> dts;       ///< fixed steps [s]
};

struct ChartTable {
  std::optional<ChartKind> kind;
  std::optional<std::int64_t> evaluations, seed;  ///< of a chart of fits
  Sweep sweep;                                    ///< what is not given is empty
};

/// Reads [chart]; it may be absent. Problems are reported to the file, for its throw_if_bad().
ChartTable read_chart(InputFile& file);

/// [chart] as text, with a blank line before it.
std::string chart_text(ChartKind kind);
std::string chart_text(std::int64_t evaluations, std::uint64_t seed);
std::string chart_text(const Sweep& sweep);

}  // namespace repose::app

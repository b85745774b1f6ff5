#pragma once
/// \file
/// The [chart] table of an input file: which chart, and what it varies (docs/interface.md, Charts).

#include <optional>

#include "input/input_file.hpp"
#include "input/keys.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::input {

enum class ChartKind : std::uint8_t { point, fit, mpm };
/// Their names, in the same order.
constexpr std::array<std::string_view, 3> chart_names{"point", "fit", "mpm"};

/// Flows with an exact solution, which then is the reference of a chart (exact_flow.hpp).
enum class ExactFlow : std::uint8_t { couette, inclined_layer, bagnold };
constexpr std::array<std::string_view, 3> exact_flow_names{"couette", "inclined_layer", "bagnold"};

/// A key of the scene that a sweep varies, and its values as TOML.
struct VariedKey {
  std::string key;                  ///< "step.pressure_averaging"
  std::vector<std::string> values;  ///< "0.0", "0.003"
};

/// What `repose chart mpm` varies; every combination is run.
struct Sweep {
  std::vector<VariedKey> vary;  ///< keys without a list of their own; the first values count most
  std::vector<mpm::Transfer> transfers;
  std::vector<mpm::Kernel> kernels;
  std::vector<std::int64_t> points_per_cell;
  std::vector<double> cells;  ///< h [m]
  std::vector<double>
      reference;  ///< finer h, with the scene's own transfer, kernel and points alone [m]
  std::vector<double> courants;    ///< Courant numbers
  std::vector<double> dts;         ///< fixed steps [s]
  std::optional<ExactFlow> exact;  ///< absent: the reference is extrapolated
};

struct ChartTable {
  std::optional<ChartKind> kind;
  std::optional<std::int64_t> evaluations, seed;  ///< of a chart of fits
  bool quick = false;
  Sweep sweep;  ///< what is not given is empty
};

/// The keys of [chart].
void chart_keys(Keys& keys, ChartTable& chart);

/// Reads [chart]; it may be absent. Problems are reported to the file, for its throw_if_bad().
ChartTable read_chart(InputFile& file);

/// A TOML value on one line, as --set takes it.
std::string value_text(const toml::node& value);

/// [chart] as text, with a blank line before it.
std::string chart_text(ChartKind kind, bool quick = false);
std::string chart_text(std::int64_t evaluations, std::uint64_t seed);
std::string chart_text(const Sweep& sweep);

}  // namespace repose::input

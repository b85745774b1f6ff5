#include "input/read_chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include <fmt/format.h>

#include "input/key_info.hpp"
#include "input/read_keys.hpp"
#include "input/toml_text.hpp"
#include "input/write_keys.hpp"

namespace repose::input {
namespace {

/// Keys that have a list of their own in [chart], by which runs are grouped.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> listed_keys{
    std::pair{"step.transfer", "transfers"},
    {"grid.kernel", "kernels"},
    {"grid.points_per_cell", "points_per_cell"},
    {"grid.h", "cells"},
    {"step.courant", "courants"},
    {"step.dt", "dts"}};

/// [chart.vary]: "step.pressure_averaging" = [0.0, 50.0]. Whether the scene has such a key turns
/// out when it is read.
std::vector<VariedKey> read_varied(TomlReader& chart) {
  std::vector<VariedKey> varied;
  chart.expect("vary");
  if (!chart.has("vary")) return varied;
  const toml::table* table = chart.get("vary")->as_table();
  if (table == nullptr) {
    chart.report("vary",
                 "chart.vary must be a table, as in { \"step.pressure_averaging\" = [0, 50] }");
    return varied;
  }
  chart.table("vary").expect_any();
  for (const auto& [key, node] : *table) {
    const std::string name(key.str());
    const auto listed = std::find_if(listed_keys.begin(), listed_keys.end(),
                                     [&](const auto& pair) { return pair.first == name; });
    const toml::array* list = node.as_array();
    if (listed != listed_keys.end())
      chart.report("vary",
                   fmt::format("chart.vary: {} has a list of its own, {}", name, listed->second));
    else if (list == nullptr || list->empty())
      chart.report("vary",
                   fmt::format("chart.vary: \"{}\" needs a list of at least one value", name));
    else
      for (VariedKey& one = varied.emplace_back(VariedKey{name, {}});
           const toml::node& value : *list)
        one.values.push_back(value_text(value));
  }
  return varied;
}

}  // namespace

std::string value_text(const toml::node& value) {
  std::vector<std::string> items;
  if (const toml::table* table = value.as_table()) {
    for (const auto& [key, node] : *table)
      items.push_back(fmt::format("\"{}\" = {}", key.str(), value_text(node)));
    return fmt::format("{{ {} }}", fmt::join(items, ", "));
  }
  if (const toml::array* list = value.as_array()) {
    for (const toml::node& node : *list) items.push_back(value_text(node));
    return fmt::format("[{}]", fmt::join(items, ", "));
  }
  if (const auto* number = value.as_floating_point()) return toml_number(number->get());
  std::ostringstream out;
  out << toml::toml_formatter{value, toml::format_flags::none};
  return std::move(out).str();
}

void chart_keys(Keys& keys, ChartTable& chart) {
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  Sweep& sweep = chart.sweep;
  keys.choice({"kind", "-", "which chart"}, chart_names, chart.kind);
  keys.integer({"evaluations", "-", "most trials of one algorithm"}, {1, most}, chart.evaluations);
  keys.integer({"seed", "-", "of the random algorithms"}, {0, most}, chart.seed);
  keys.boolean({"quick", "-", "few settings, in seconds"}, chart.quick);
  keys.choices({"transfers", "-", "of velocities"}, mpm::transfer_names, sweep.transfers);
  keys.choices({"kernels", "-", "splines of the grid"}, mpm::kernel_names, sweep.kernels);
  std::vector<double> counts(sweep.points_per_cell.begin(), sweep.points_per_cell.end());
  keys.number_list(
      {"points_per_cell", "-", "square numbers: 1, 4, 9, 16", Range{1.0, 100.0, false, false}},
      counts);
  sweep.points_per_cell.clear();
  for (const double count : counts) {
    if (count != std::floor(count) && keys.reader() != nullptr)
      keys.reader()->report("points_per_cell",
                            fmt::format("chart.points_per_cell: {} is no whole number", count));
    sweep.points_per_cell.push_back(std::isfinite(count) ? std::lround(count) : 0);
  }
  keys.number_list({"cells", "m", "cell sizes", positive}, sweep.cells);
  keys.number_list({"reference", "m", "finer cells for the reference", positive}, sweep.reference);
  keys.number_list({"courants", "-", "Courant numbers", mpm::courant_range}, sweep.courants);
  keys.number_list({"dts", "s", "fixed steps", positive}, sweep.dts);
  keys.choice({"exact", "-", "flow whose exact solution is the reference"}, exact_flow_names,
              sweep.exact);
  KeyInfo any;
  any.kind = ValueKind::table;
  any.open = true;
  keys.value(
      {"vary", "-", "further keys of the scene and their values"},
      [&](TomlReader& table) { sweep.vary = read_varied(table); },
      [&] {
        std::vector<std::string> items;
        for (const VariedKey& varied : sweep.vary)
          items.push_back(fmt::format("\"{}\" = [{}]", varied.key, fmt::join(varied.values, ", ")));
        return items.empty() ? "" : fmt::format("{{ {} }}", fmt::join(items, ", "));
      },
      any);
}

ChartTable read_chart(InputFile& file) {
  ChartTable chart;
  TomlReader root(file);
  root.expect("chart");
  if (!root.has("chart")) return chart;
  ReadKeys keys(root.table("chart"));
  chart_keys(keys, chart);
  return chart;
}

namespace {

std::string text_of(ChartTable chart) {
  return write_keys(
      [&](Keys& keys) { keys.table({"chart"}, [&](Keys& below) { chart_keys(below, chart); }); });
}

}  // namespace

std::string chart_text(ChartKind kind, bool quick) {
  ChartTable chart;
  chart.kind = kind;
  chart.quick = quick;
  return text_of(std::move(chart));
}

std::string chart_text(std::int64_t evaluations, std::uint64_t seed) {
  ChartTable chart;
  chart.kind = ChartKind::fit;
  chart.evaluations = evaluations;
  chart.seed = static_cast<std::int64_t>(seed);
  return text_of(std::move(chart));
}

std::string chart_text(const Sweep& sweep) {
  ChartTable chart;
  chart.kind = ChartKind::mpm;
  chart.sweep = sweep;
  return text_of(std::move(chart));
}

}  // namespace repose::input

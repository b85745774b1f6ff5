#include "input/read_chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include <fmt/format.h>

#include "input/toml_reader.hpp"

namespace repose::input {
namespace {

template <class Enum>
std::vector<Enum> as(const std::optional<std::vector<std::size_t>>& positions) {
  std::vector<Enum> values;
  if (positions)
    for (const std::size_t k : *positions) values.push_back(static_cast<Enum>(k));
  return values;
}

std::string quoted(const std::vector<std::string_view>& words) {
  return words.empty() ? "[]" : fmt::format("[\"{}\"]", fmt::join(words, "\", \""));
}

/// Keys that have a list of their own in [chart], by which runs are grouped.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> listed_keys{
    std::pair{"step.transfer", "transfers"},
    {"grid.kernel", "kernels"},
    {"grid.points_per_cell", "points_per_cell"},
    {"grid.h", "cells"},
    {"step.courant", "courants"},
    {"step.dt", "dts"}};

/// [chart.vary]: "step.sleep_speed" = [0.0, 0.003]. Whether the scene has such a key turns out when
/// it is read.
std::vector<VariedKey> read_varied(TomlReader& chart) {
  std::vector<VariedKey> varied;
  chart.expect("vary");
  if (!chart.has("vary")) return varied;
  const toml::table* table = chart.get("vary")->as_table();
  if (table == nullptr) {
    chart.report("vary", "chart.vary must be a table, as in { \"step.sleep_speed\" = [0, 0.003] }");
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
  if (const auto* number = value.as_floating_point()) {  // the fewest digits that read back
    const std::string text = fmt::format("{}", number->get());
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
  }
  std::ostringstream out;
  out << toml::toml_formatter{value, toml::format_flags::none};
  return std::move(out).str();
}

ChartTable read_chart(InputFile& file) {
  TomlReader root(file);
  root.expect("chart");
  ChartTable chart;
  if (!root.has("chart")) return chart;
  TomlReader table = root.table("chart");
  if (table.has("kind"))
    chart.kind =
        static_cast<ChartKind>(table.choice("kind", {chart_names.begin(), chart_names.end()}, 0));
  table.expect("kind");
  const auto whole = [&](std::string_view key, std::string_view doc, std::int64_t lower) {
    table.expect(key);
    return table.has(key) ? std::optional(table.integer(key, doc, lower,
                                                        std::numeric_limits<std::int64_t>::max()))
                          : std::nullopt;
  };
  chart.evaluations = whole("evaluations", "most trials of one algorithm", 1);
  chart.seed = whole("seed", "of the random algorithms", 0);
  chart.quick = table.boolean("quick", false);
  Sweep& sweep = chart.sweep;
  sweep.vary = read_varied(table);
  sweep.transfers = as<mpm::Transfer>(
      table.choices("transfers", {mpm::transfer_names.begin(), mpm::transfer_names.end()}));
  sweep.kernels = as<mpm::Kernel>(
      table.choices("kernels", {mpm::kernel_names.begin(), mpm::kernel_names.end()}));
  if (const auto list = table.number_list({"points_per_cell",
                                           "-",
                                           "a square number: 1, 4, 9, 16",
                                           Range{1.0, 100.0, false, false},
                                           {}}))
    for (const double count : *list) {
      if (count != std::floor(count))
        table.report("points_per_cell",
                     fmt::format("chart.points_per_cell: {} is no whole number", count));
      sweep.points_per_cell.push_back(std::lround(count));
    }
  sweep.cells =
      table.number_list({"cells", "m", "cell sizes", positive, {}}).value_or(std::vector<double>{});
  sweep.reference =
      table.number_list({"reference", "m", "finer cells for the reference", positive, {}})
          .value_or(std::vector<double>{});
  sweep.courants = table.number_list({"courants", "-", "Courant numbers", mpm::courant_range, {}})
                       .value_or(std::vector<double>{});
  sweep.dts =
      table.number_list({"dts", "s", "fixed steps", positive, {}}).value_or(std::vector<double>{});
  table.expect("exact");
  if (table.has("exact"))
    sweep.exact = static_cast<ExactFlow>(
        table.choice("exact", {exact_flow_names.begin(), exact_flow_names.end()}, 0));
  return chart;
}

std::string chart_text(ChartKind kind, bool quick) {
  return fmt::format("\n[chart]\nkind = \"{}\"\n{}", chart_names[static_cast<std::size_t>(kind)],
                     quick ? "quick = true\n" : "");
}

std::string chart_text(std::int64_t evaluations, std::uint64_t seed) {
  return chart_text(ChartKind::fit) +
         fmt::format("evaluations = {}\nseed = {}\n", evaluations, seed);
}

std::string chart_text(const Sweep& sweep) {
  std::vector<std::string_view> transfers, kernels;
  for (const mpm::Transfer t : sweep.transfers) transfers.push_back(mpm::name_of(t));
  for (const mpm::Kernel k : sweep.kernels) kernels.push_back(mpm::name_of(k));
  std::string text =
      chart_text(ChartKind::mpm) +
      fmt::format("transfers = {}\nkernels = {}\npoints_per_cell = [{}]\ncells = [{}]  # m\n",
                  quoted(transfers), quoted(kernels), fmt::join(sweep.points_per_cell, ", "),
                  fmt::join(sweep.cells, ", "));
  if (!sweep.reference.empty())
    text += fmt::format("reference = [{}]  # m\n", fmt::join(sweep.reference, ", "));
  if (!sweep.courants.empty())
    text += fmt::format("courants = [{}]\n", fmt::join(sweep.courants, ", "));
  if (!sweep.dts.empty()) text += fmt::format("dts = [{}]  # s\n", fmt::join(sweep.dts, ", "));
  if (sweep.exact)
    text +=
        fmt::format("exact = \"{}\"\n", exact_flow_names[static_cast<std::size_t>(*sweep.exact)]);
  if (!sweep.vary.empty()) text += "\n[chart.vary]\n";
  for (const VariedKey& varied : sweep.vary)
    text += fmt::format("\"{}\" = [{}]\n", varied.key, fmt::join(varied.values, ", "));
  return text;
}

}  // namespace repose::input

#include "app/read_chart.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "app/toml_reader.hpp"

namespace repose::app {
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

}  // namespace

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
  Sweep& sweep = chart.sweep;
  sweep.transfers = as<mpm::Transfer>(
      table.choices("transfers", {mpm::transfer_names.begin(), mpm::transfer_names.end()}));
  sweep.kernels = as<mpm::Kernel>(
      table.choices("kernels", {mpm::kernel_names.begin(), mpm::kernel_names.end()}));
  if (const auto list = table.number_list(
          {"points_per_cell", "-", "a square number: 1, 4, 9, 16", Range{1.0, 100.0}, {}}))
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
  return chart;
}

std::string chart_text(ChartKind kind) {
  return fmt::format("\n[chart]\nkind = \"{}\"\n", chart_names[static_cast<std::size_t>(kind)]);
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
  return text;
}

}  // namespace repose::app

#include "input/history_table.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "input/measured_columns.hpp"
#include "io/column_header.hpp"

namespace repose::input {
namespace {

/// "sigma_r (kPa)" or "sigma_r" → "sigma_r_Pa", "time_min" → "time_s": the name with the SI unit.
/// None for what is neither strain, stress nor time.
std::optional<std::string> si_name(const io::ColumnHeader& header) {
  const std::string& name = header.name;
  if (name == "time") return "time_s";
  if (name.starts_with("sigma_") || name == "tau") return name + "_Pa";
  if (name.starts_with("eps_") || name == "gamma") return name;
  return {};
}

/// What the column holds in the rows that have a time.
io::MeasuredColumn in_rows(const io::MeasuredColumn& column, const std::vector<int>& lines) {
  io::MeasuredColumn result = column;
  result.values.clear();
  result.file_rows.clear();
  for (std::size_t i = 0; i < column.values.size(); ++i)
    if (std::binary_search(lines.begin(), lines.end(), column.file_rows[i])) {
      result.values.push_back(column.values[i]);
      result.file_rows.push_back(column.file_rows[i]);
    }
  return result;
}

/// Values in all rows, blank ones on the straight line over time between their neighbours.
/// `time` has a value in each row. None, after a report, if the first or the last is blank.
std::optional<std::vector<double>> without_gaps(TomlReader& test, const io::MeasuredColumn& column,
                                                const std::vector<double>& time,
                                                const std::vector<int>& lines) {
  const auto at = [&](std::size_t row) {
    return std::lower_bound(column.file_rows.begin(), column.file_rows.end(), lines[row]) -
           column.file_rows.begin();
  };
  const auto value = [&](std::ptrdiff_t i) { return column.values[static_cast<std::size_t>(i)]; };
  if (column.values.empty() || column.file_rows.front() != lines.front() ||
      column.file_rows.back() != lines.back()) {
    const bool first = column.values.empty() || column.file_rows.front() != lines.front();
    test.report(
        "history",
        fmt::format("row {}, column {} ({}) is blank, and a history needs its first and its "
                    "last row; fill the cell, or leave the row out by rows",
                    first ? lines.front() : lines.back(), column.column + 1, column.header));
    return {};
  }
  std::vector<double> values(lines.size());
  std::vector<std::size_t> row_of;  // of each value
  for (std::size_t row = 0; row < lines.size(); ++row)
    if (const auto i = at(row); column.file_rows[static_cast<std::size_t>(i)] == lines[row])
      row_of.push_back(row);
  for (std::size_t row = 0; row < lines.size(); ++row) {
    const auto next = at(row);
    const std::size_t b = row_of[static_cast<std::size_t>(next)];
    if (b == row) {
      values[row] = value(next);
      continue;
    }
    const std::size_t a = row_of[static_cast<std::size_t>(next - 1)];
    const double share = (time[row] - time[a]) / (time[b] - time[a]);
    values[row] = value(next - 1) + share * (value(next) - value(next - 1));
  }
  return values;
}

}  // namespace

std::optional<point::Table> read_history_table(TomlReader& test, const std::string& file) {
  MeasuredColumns measured(test, "history", file);
  if (!measured.usable()) return {};
  std::vector<std::string> wanted;
  for (const std::string& name : measured.chosen()) wanted.push_back(name);
  if (wanted.empty())
    for (const io::ColumnHeader& header : measured.table().headers()) wanted.push_back(header.text);

  point::Table table;
  table.name = measured.table().file();
  std::vector<io::MeasuredColumn> columns;
  bool good = true;
  for (const std::string& text : wanted) {
    const auto name = si_name(io::read_header(text));
    table.columns.push_back(name.value_or(text));
    columns.emplace_back();
    if (!name) continue;  // history_path() says what is wrong with it
    auto column = measured.read(*name, "history");
    good = good && column.has_value();
    if (column) columns.back() = std::move(*column);
  }
  measured.finish();
  if (!good) return {};

  const auto time = std::find(table.columns.begin(), table.columns.end(), "time_s");
  table.values.resize(columns.size());
  if (time == table.columns.end()) return table;  // history_path() says so
  const io::MeasuredColumn& times = columns[static_cast<std::size_t>(time - table.columns.begin())];
  table.lines = times.file_rows;
  if (table.lines.empty()) {
    test.report("history", fmt::format("{}: no row has a time", table.name));
    return {};
  }
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (!columns[c].present) continue;
    auto values = without_gaps(test, in_rows(columns[c], table.lines), times.values, table.lines);
    if (!values) return {};
    table.values[c] = std::move(*values);
  }
  return table;
}

}  // namespace repose::input

#include "input/fit_table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "input/measured_columns.hpp"

namespace repose::input {
namespace {

/// The value in a row of the file; none if the cell is blank there. Rows grow.
std::optional<double> value_at(const io::MeasuredColumn& column, int file_row) {
  const auto found = std::lower_bound(column.file_rows.begin(), column.file_rows.end(), file_row);
  if (found == column.file_rows.end() || *found != file_row) return {};
  return column.values[static_cast<std::size_t>(found - column.file_rows.begin())];
}

}  // namespace

std::vector<FitTable> read_fit_tables(TomlReader& target, const TargetTable& given, bool apart) {
  MeasuredColumns measured(target, "data", given.data);
  const std::vector<std::string>& y = given.y;
  std::vector<FitTable> none(1);
  none.front().channels = y;
  std::vector<io::MeasuredColumn> columns;
  for (std::size_t i = 0; i <= y.size(); ++i) {
    const std::string& name = i == 0 ? given.x : y[i - 1];
    if (name.empty()) return none;
    if (auto column = measured.read(name, i == 0 ? "x" : "y"))
      columns.push_back(std::move(*column));
  }
  measured.finish();
  if (y.empty() || columns.size() != y.size() + 1) return none;

  /// The rows in which x and all of the channels from `first` to `last` have a value.
  std::vector<int> left_out;
  const auto rows_of = [&](std::size_t first, std::size_t last) {
    FitTable table;
    table.channels.assign(y.begin() + static_cast<std::ptrdiff_t>(first),
                          y.begin() + static_cast<std::ptrdiff_t>(last));
    table.y.resize(last - first);
    for (const std::size_t row : measured.rows()) {
      const int line = measured.table().file_row(row);
      const std::optional<double> x = value_at(columns[0], line);
      std::vector<double> values;
      for (std::size_t c = first; c < last; ++c)
        if (const auto value = value_at(columns[c + 1], line)) values.push_back(*value);
      if (!x || values.size() != last - first) {
        left_out.push_back(line);
        continue;
      }
      const double at = *x + given.x_shift;
      if ((given.from && at < *given.from) || (given.to && at > *given.to)) continue;
      table.x.push_back(at);
      for (std::size_t c = 0; c < values.size(); ++c) table.y[c].push_back(values[c]);
      table.lines.push_back(line);
    }
    return table;
  };
  std::vector<FitTable> tables{rows_of(0, y.size())};
  if (!left_out.empty() && y.size() > 1) {
    std::vector<FitTable> each;
    std::string rows;
    bool more = false;  // rows than those that have all
    for (std::size_t c = 0; c < y.size(); ++c) {
      each.push_back(rows_of(c, c + 1));
      more = more || each.back().x.size() > tables.front().x.size();
      rows += fmt::format("{}{} {}", c == 0 ? "" : ", ", y[c], each.back().x.size());
    }
    if (more && apart) {
      tables = std::move(each);
      tables.front().note = fmt::format(
          "{}: cells are blank in some columns and not in others, so each is compared over its own "
          "rows ({}), as a target of its own",
          measured.table().file(), rows);
    }
  }
  if (tables.size() == 1 && !left_out.empty()) {
    std::sort(left_out.begin(), left_out.end());
    left_out.erase(std::unique(left_out.begin(), left_out.end()), left_out.end());
    const std::size_t shown = std::min<std::size_t>(left_out.size(), 10);
    tables.front().note = fmt::format(
        "{}: {} row{} left out, a compared cell is blank: {}{}", measured.table().file(),
        left_out.size(), left_out.size() == 1 ? "" : "s",
        fmt::join(left_out.begin(), left_out.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
        shown < left_out.size() ? ", ..." : "");
  }
  for (const FitTable& table : tables)
    if (table.x.size() < 2) {
      target.report("data",
                    fmt::format("{} has {} rows with {}{} in the range that is compared; at least "
                                "two are needed",
                                measured.table().file(), table.x.size(), given.x,
                                tables.size() > 1 ? " and " + table.channels.front() : ""));
      return none;
    }
  return tables;
}

}  // namespace repose::input

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

FitTable read_fit_table(TomlReader& target, const TargetTable& given) {
  MeasuredColumns measured(target, "data", given.data);
  const std::vector<std::string>& y = given.y;
  std::vector<io::MeasuredColumn> columns;
  for (std::size_t i = 0; i <= y.size(); ++i) {
    const std::string& name = i == 0 ? given.x : y[i - 1];
    if (name.empty()) return {};
    if (auto column = measured.read(name, i == 0 ? "x" : "y"))
      columns.push_back(std::move(*column));
  }
  measured.finish();
  if (y.empty() || columns.size() != y.size() + 1) return {};

  FitTable result;
  result.y.resize(y.size());
  std::vector<int> left_out;
  for (const std::size_t row : measured.rows()) {
    const int line = measured.table().file_row(row);
    std::vector<double> values;
    for (const io::MeasuredColumn& column : columns)
      if (const auto value = value_at(column, line)) values.push_back(*value);
    if (values.size() != columns.size()) {
      left_out.push_back(line);
      continue;
    }
    const double at = values[0] + given.x_shift;
    if ((given.from && at < *given.from) || (given.to && at > *given.to)) continue;
    result.x.push_back(at);
    for (std::size_t c = 0; c < y.size(); ++c) result.y[c].push_back(values[c + 1]);
    result.lines.push_back(line);
  }
  if (!left_out.empty()) {
    const std::size_t shown = std::min<std::size_t>(left_out.size(), 10);
    result.note = fmt::format(
        "{}: {} row{} left out, a compared cell is blank: {}{}", measured.table().file(),
        left_out.size(), left_out.size() == 1 ? "" : "s",
        fmt::join(left_out.begin(), left_out.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
        shown < left_out.size() ? ", ..." : "");
  }
  if (result.x.size() < 2) {
    target.report("data", fmt::format("{} has {} rows with {} in the range that is compared; at "
                                      "least two are needed",
                                      measured.table().file(), result.x.size(), given.x));
    result = {};
  }
  return result;
}

}  // namespace repose::input

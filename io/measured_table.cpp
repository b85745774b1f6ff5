#include "io/measured_table.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/nearest_text.hpp"
#include "io/number_text.hpp"

namespace repose::io {
namespace {

/// Letter case and blanks taken away.
std::string folded(std::string_view text) {
  std::string result;
  for (const char c : text)
    if (c != ' ' && c != '\t')
      result += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

std::vector<std::string> header_texts(const RawTable& table) {
  std::vector<std::string> texts;
  for (const ColumnHeader& header : table.headers()) {
    if (!header.text.empty()) texts.push_back(header.text);
    if (header.name != header.text && !header.name.empty()) texts.push_back(header.name);
  }
  return texts;
}

/// "its columns are 1 (eps_a), 2 (q_kPa)"
std::string list_of_columns(const RawTable& table) {
  constexpr std::size_t most = 30;
  std::string text = "its columns are ";
  for (std::size_t i = 0; i < table.columns() && i < most; ++i)
    text += (i > 0 ? ", " : "") + table.column_title(i);
  return table.columns() > most ? text + ", ..." : text;
}

[[noreturn]] void no_such_column(const RawTable& table, std::string_view wanted) {
  std::string cure = did_you_mean(wanted, header_texts(table));
  cure += (cure.empty() ? "" : " ") + list_of_columns(table);
  throw TableError(table.file(), table.layout().header_row, "",
                   fmt::format("there is no column {}", shown(wanted)), cure);
}

std::size_t column_of(const RawTable& table, std::string_view wanted) {
  const auto column = find_column(table, wanted);
  if (!column) no_such_column(table, wanted);
  return *column;
}

/// The end of a header's word that may as well be part of the name: e_min, q_s.
bool is_doubtful(const ColumnHeader& header) {
  return header.unit_in_name &&
         (header.unit.size() == 1 || header.unit == "min" || header.unit == "in");
}

[[noreturn]] void refuse_unit(const RawTable& table, const ColumnSpec& spec, std::size_t column,
                              int row, const std::string& cause) {
  std::vector<std::string> names = unit_names(spec.dimension);
  throw TableError(
      table.file(), row, table.column_title(column), cause,
      fmt::format("give the unit for {}, one of {}", spec.name, fmt::join(names, ", ")));
}

/// The unit of a column, into `result`.
Unit unit_of(const RawTable& table, const ColumnSpec& spec, MeasuredColumn& result) {
  const ColumnHeader& header = table.headers()[result.column];
  const int row = header.unit_in_name || table.layout().unit_row == 0 ? table.layout().header_row
                                                                      : table.layout().unit_row;
  const bool given = !spec.unit.empty();
  result.unit = given ? spec.unit : header.unit;
  result.unit_source = given                                       ? "given"
                       : row == table.layout().unit_row && row > 0 ? fmt::format("row {}", row)
                                                                   : "header";
  if (!given && result.unit.empty()) {
    if (spec.dimension && *spec.dimension != dimension::number)
      refuse_unit(
          table, spec, result.column, table.layout().header_row,
          fmt::format("the file names no unit, and {} is {}", spec.name, name_of(*spec.dimension)));
    result.unit = "-";
    result.unit_source = "none in the file";
    return {};
  }
  const auto unit = find_unit(result.unit);
  if (!unit) {
    const std::string near = did_you_mean(result.unit, unit_names(spec.dimension));
    refuse_unit(table, spec, result.column, given ? 0 : row,
                fmt::format("{} is no unit that is known{}{}", shown(result.unit),
                            near.empty() ? "" : "; ", near));
  }
  if (!spec.dimension || unit->dimension == *spec.dimension) return *unit;
  if (!given && is_doubtful(header) && *spec.dimension == dimension::number) {
    result.unit = "-";
    result.unit_source = "none in the file";
    return {};
  }
  refuse_unit(table, spec, result.column, given ? 0 : row,
              fmt::format("the unit {}{} measures {}, and {} is {}", result.unit,
                          given ? "" : " that the file names", name_of(unit->dimension), spec.name,
                          name_of(*spec.dimension)));
}

/// Why a cell is no number, and what to do.
std::pair<std::string, std::string> complaint(std::string_view cell, const CellShape& shape,
                                              char decimal) {
  const char other = decimal == '.' ? ',' : '.';
  if (shape.kind == CellKind::not_finite)
    return {fmt::format("{} is not finite", shown(cell)),
            "leave the cell empty if nothing was measured"};
  if (shape.kind == CellKind::grouped || (shape.mark == other && shape.may_be_grouped))
    return {
        fmt::format("{} has a thousands separator (decimal mark of the file: \"{}\")", shown(cell),
                    decimal),
        fmt::format("write the number without it{}",
                    shape.kind == CellKind::grouped
                        ? ""
                        : fmt::format(", or give decimal = \"{}\" if that is what it is", other))};
  if (shape.kind == CellKind::number)
    return {fmt::format("{} has another decimal mark than the rest of the file, \"{}\"",
                        shown(cell), decimal),
            "write one of them everywhere, or give decimal"};
  std::string cure =
      "leave the cell empty if nothing was measured, or leave the row out by rows or where";
  const auto digit = cell.find_first_of("0123456789");
  if (digit != std::string_view::npos) {
    const std::size_t end = cell.find_last_of("0123456789");
    const std::string_view after = trimmed(cell.substr(end + 1));
    if (!after.empty() && find_unit(after))
      cure = "write the number alone, and the unit in the header";
    else if (after == ",")
      cure = fmt::format("finish the number{}",
                         decimal == '.' ? ", or separate cells by one mark" : "");
  }
  return {fmt::format("{} is no number", shown(cell)), cure};
}

}  // namespace

std::optional<std::size_t> find_column(const RawTable& table, std::string_view header,
                                       const std::optional<Dimension>& dimension) {
  header = trimmed(header);
  const std::string wanted = folded(header);
  if (wanted.empty()) return {};
  const auto fits = [&](const ColumnHeader& h, int round) {
    if (round % 2 == 1 && is_doubtful(h) &&
        !(dimension && find_unit(h.unit)->dimension == *dimension))
      return false;
    switch (round) {
      case 0:
        return h.text == header;
      case 1:
        return h.name == header;
      case 2:
        return folded(h.text) == wanted;
      default:
        return folded(h.name) == wanted;
    }
  };
  for (int round = 0; round < 4; ++round) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < table.columns(); ++i)
      if (fits(table.headers()[i], round)) found.push_back(i);
    if (found.size() == 1) return found.front();
    if (found.size() > 1)
      throw TableError(
          table.file(), table.layout().header_row, table.column_title(found[1]),
          fmt::format("{} columns are called {}: numbers {} and {}{}", found.size(), shown(header),
                      found[0] + 1, found[1] + 1, found.size() > 2 ? ", ..." : ""),
          fmt::format("give the column's number: from = {}", found[0] + 1));
  }
  return {};
}

std::vector<std::size_t> select_rows(const RawTable& table, const RowFilter& filter) {
  std::vector<std::size_t> rows;
  const char decimal = table.layout().decimal;
  for (std::size_t i = 0; i < table.rows(); ++i)
    if (table.file_row(i) >= filter.first && table.file_row(i) <= filter.last) rows.push_back(i);
  if (rows.empty())
    throw TableError(table.file(), 0, "",
                     fmt::format("no data in rows {} to {}", filter.first, filter.last),
                     fmt::format("the file's rows of data are {} to {}", table.file_row(0),
                                 table.file_row(table.rows() - 1)));
  for (const RowFilter::Equals& equals : filter.where) {
    const std::size_t column = column_of(table, equals.column);
    const std::string_view wanted = trimmed(equals.text);
    const auto number = [](std::string_view cell, char mark) -> std::optional<double> {
      const CellShape shape = shape_of(cell);
      if (shape.kind != CellKind::number || (shape.mark != 0 && shape.mark != mark)) return {};
      return value_of(cell, mark);
    };
    const auto wanted_number = number(wanted, '.');
    std::vector<std::size_t> passed;
    for (const std::size_t row : rows) {
      const std::string_view cell = table.cell(row, column);
      if (cell == wanted || (wanted_number && number(cell, decimal) == wanted_number))
        passed.push_back(row);
    }
    if (passed.empty()) {
      std::vector<std::string> held;
      for (const std::size_t row : rows) {
        std::string cell = shown(table.cell(row, column));
        if (held.size() < 12 && std::find(held.begin(), held.end(), cell) == held.end())
          held.push_back(std::move(cell));
      }
      throw TableError(
          table.file(), 0, table.column_title(column),
          fmt::format("no row holds {}", shown(wanted)),
          fmt::format("it holds {}{}", fmt::join(held, ", "), held.size() == 12 ? ", ..." : ""));
    }
    rows = std::move(passed);
  }
  return rows;
}

MeasuredColumn read_column(const RawTable& table, const ColumnSpec& spec, const RowFilter& filter) {
  return read_column(table, spec, select_rows(table, filter));
}

MeasuredColumn read_column(const RawTable& table, const ColumnSpec& spec,
                           const std::vector<std::size_t>& rows) {
  MeasuredColumn result;
  result.name = spec.name;
  result.sign = spec.sign;
  result.scale = spec.scale;
  result.offset = spec.offset;
  const std::string& wanted = spec.from.empty() ? spec.name : spec.from;
  if (spec.number != 0) {
    if (spec.number < 1 || static_cast<std::size_t>(spec.number) > table.columns())
      throw TableError(table.file(), table.layout().header_row, "",
                       fmt::format("there is no column number {}", spec.number),
                       list_of_columns(table));
    result.column = static_cast<std::size_t>(spec.number) - 1;
  } else {
    const auto found = find_column(table, wanted, spec.dimension);
    if (!found && spec.optional) return result;
    if (!found) no_such_column(table, wanted);
    result.column = *found;
  }
  result.present = true;
  result.header = table.headers()[result.column].text;
  const Unit unit = unit_of(table, spec, result);
  const char decimal = table.layout().decimal;
  for (const std::size_t row : rows) {
    const std::string_view cell = table.cell(row, result.column);
    const CellShape shape = shape_of(cell);
    if (shape.kind == CellKind::blank || shape.kind == CellKind::missing) {
      ++result.dropped;
      continue;
    }
    if (shape.kind != CellKind::number || (shape.mark != 0 && shape.mark != decimal)) {
      const auto [cause, cure] = complaint(cell, shape, decimal);
      throw TableError(table.file(), table.file_row(row), table.column_title(result.column), cause,
                       cure);
    }
    const auto number = value_of(cell, decimal);
    const double value =
        number ? spec.sign * spec.scale * (*number * unit.factor) + spec.offset : 0.0;
    if (!number || !std::isfinite(value))
      throw TableError(table.file(), table.file_row(row), table.column_title(result.column),
                       fmt::format("{} exceeds what a double can hold{}", shown(cell),
                                   number ? ", in SI units" : ""),
                       "leave the cell empty if nothing was measured");
    result.values.push_back(value);
    result.file_rows.push_back(table.file_row(row));
  }
  if (!result.values.empty()) {
    const auto [low, high] = std::minmax_element(result.values.begin(), result.values.end());
    result.min = *low;
    result.max = *high;
  }
  return result;
}

std::string describe(const RawTable& table) {
  const TableLayout& layout = table.layout();
  std::string text =
      fmt::format("{}: {}, separator {}, decimal mark \"{}\", ", table.file(),
                  name_of(layout.encoding), name_of(layout.separator), layout.decimal);
  text += layout.header_row == 0 ? "no header"
                                 : fmt::format("header in row {}{}", layout.header_row,
                                               layout.header_in_comment ? " (a comment)" : "");
  if (layout.unit_row > 0) text += fmt::format(", units in row {}", layout.unit_row);
  text += fmt::format(", {} row{} of data ({} to {})", table.rows(), table.rows() == 1 ? "" : "s",
                      table.file_row(0), table.file_row(table.rows() - 1));
  if (layout.comments > 0)
    text += fmt::format(", {} comment{}", layout.comments, layout.comments == 1 ? "" : "s");
  if (layout.lines_above > 0)
    text += fmt::format(", {} line{} above the header passed over", layout.lines_above,
                        layout.lines_above == 1 ? "" : "s");
  return text;
}

std::string describe(const MeasuredColumn& column) {
  if (!column.present) return fmt::format("{}: not in the file", column.name);
  std::string text = fmt::format("{}: column {}{}, unit {} ({})", column.name, column.column + 1,
                                 column.header.empty() ? "" : fmt::format(" \"{}\"", column.header),
                                 column.unit, column.unit_source);
  if (column.sign != 1.0) text += fmt::format(", sign {:g}", column.sign);
  if (column.scale != 1.0) text += fmt::format(", times {:g}", column.scale);
  if (column.offset != 0.0) text += fmt::format(", plus {:g}", column.offset);
  text +=
      fmt::format(", {} row{} used", column.values.size(), column.values.size() == 1 ? "" : "s");
  if (column.dropped > 0) text += fmt::format(", {} dropped (blank or nan)", column.dropped);
  if (!column.values.empty())
    text += fmt::format(", from {:.6g} to {:.6g} in SI", column.min, column.max);
  return text;
}

}  // namespace repose::io

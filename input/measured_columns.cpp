#include "input/measured_columns.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "input/key_info.hpp"
#include "io/atomic_file.hpp"
#include "io/column_header.hpp"

namespace repose::input {
namespace {

/// Text or a number, as a cell may hold it.
std::optional<std::string> cell_text(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return text;
  if (const auto whole = node.value_exact<std::int64_t>()) return fmt::format("{}", *whole);
  if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);
  return {};
}

/// What a quantity's unit measures: "q_Pa" a stress, "eps_a" a number.
io::Dimension dimension_of(const io::ColumnHeader& quantity) {
  const auto unit = io::find_unit(quantity.unit);
  return quantity.unit.empty() || !unit ? io::dimension::number : unit->dimension;
}

io::ColumnSpec read_column_keys(TomlReader& columns, const std::string& key) {
  io::ColumnSpec spec;
  if (const toml::node* node = columns.get(key); node->is_string()) {  // eps_a = "Axial strain"
    spec.from = *node->value<std::string>();
    return spec;
  }
  TomlReader entry = columns.table(key);
  entry.expect("from");
  if (const toml::node* from = entry.get("from"); from != nullptr && from->is_integer())
    spec.number = static_cast<int>(
        entry.integer("from", "the column's number, from 1", 1, std::numeric_limits<int>::max()));
  else
    spec.from = entry.text("from", "the column's header, or its number from 1", "");
  spec.unit = entry.text("unit", "as laboratories write it, \"%\", \"kPa\"", "");
  spec.scale = entry.number({"scale", "-", "factor besides the unit's", {}, 1.0});
  spec.offset = entry.number({"offset", "SI", "added at last, in SI units", {}, 0.0});
  spec.sign = entry.number({"sign", "-", "1 or -1", {}, 1.0});
  if (std::abs(spec.sign) != 1.0)
    entry.report("sign", fmt::format("{} = {} must be 1 or -1; a factor is scale",
                                     entry.path_of("sign"), spec.sign));
  return spec;
}

}  // namespace

void describe_table_keys(Keys& keys) {
  if (!keys.describes()) return;
  const auto nothing = [](TomlReader&) {};
  const auto no_text = [] { return std::string(); };
  KeyInfo open;
  open.kind = ValueKind::table;
  open.open = true;
  keys.value({"columns", "-",
              "of the file, by quantity: the header, or { from, unit, sign, scale, offset }, from "
              "being the header or the column's number; value = sign × scale × (cell in SI) + "
              "offset"},
             nothing, no_text, open);
  keys.value({"where", "-", "cells that a row must hold, by header, as in { LabID = \"A7\" }"},
             nothing, no_text, open);
  KeyInfo rows;
  rows.kind = ValueKind::number_list;
  rows.least = rows.most = 2;
  keys.value({"rows", "-", "first and last row of the file that count"}, nothing, no_text, rows);
  std::string separator, decimal;
  std::optional<std::int64_t> header_row;
  keys.text({"separator", "-",
             "between cells: \",\", \";\", \"tab\", \"blanks\" or \"none\"; found "
             "from the file by default"},
            separator);
  keys.text({"decimal", "-", "the decimal mark, \".\" or \",\"; found from the file by default"},
            decimal);
  keys.integer({"header_row", "-", "row of the file that names the columns, 0 for none"},
               {0, std::numeric_limits<int>::max()}, header_row);
}

MeasuredColumns::MeasuredColumns(TomlReader& reader, std::string_view key, const std::string& name)
    : reader_(&reader),
      key_(key) {
  read_columns(reader);
  read_filter(reader);
  const io::TableFormat format = read_format(reader);
  if (name.empty()) return;
  std::filesystem::path file = name;
  if (file.is_relative()) file = std::filesystem::path(reader.file().name()).parent_path() / file;
  if (!std::filesystem::exists(file)) {
    const std::string near = similar_file(file);
    throw io::IoError(file,
                      fmt::format("there is no such file, which {} names{}",
                                  to_string(reader.file().origin(reader.path_of(key))),
                                  near.empty() ? "" : fmt::format("; did you mean {}?", near)));
  }
  try {
    io::RawTable table = io::load_table(file, format);
    rows_ = io::select_rows(table, filter_);
    table_ = std::move(table);
  } catch (const io::IoError& error) {
    throw io::IoError(file, fmt::format("{}, which {} names", error.reason(),
                                        to_string(reader.file().origin(reader.path_of(key)))));
  } catch (const io::TableError& error) {
    reader.report(key, error.what());
  }
}

void MeasuredColumns::read_columns(TomlReader& reader) {
  TomlReader columns = reader.table("columns");
  for (const std::string& key : columns.keys()) {
    columns.expect(key);
    columns_[key] = read_column_keys(columns, key);
  }
}

void MeasuredColumns::read_filter(TomlReader& reader) {
  TomlReader where = reader.table("where");
  for (const std::string& column : where.keys()) {
    where.expect(column);
    const auto text = cell_text(*where.get(column));
    if (text)
      filter_.where.push_back({column, *text});
    else
      where.report(column, fmt::format("{} must be the text or the number that the cell holds; "
                                       "got {}",
                                       where.path_of(column), describe(*where.get(column))));
  }
  reader.expect("rows");
  const toml::node* rows = reader.get("rows");
  if (rows == nullptr) return;
  const toml::array* list = rows->as_array();
  const auto at = [&](std::size_t i) {
    return list != nullptr && list->size() == 2 ? (*list)[i].value_exact<std::int64_t>()
                                                : std::optional<std::int64_t>();
  };
  const auto first = at(0), last = at(1);
  constexpr std::int64_t most = std::numeric_limits<int>::max();
  if (!first || !last || *first < 1 || *last < *first || *last > most) {
    reader.report("rows", fmt::format("{} must be the first and the last row of the file, counted "
                                      "from 1 as a spreadsheet does, as in [2, 40]; got {}",
                                      reader.path_of("rows"), describe(*rows)));
    return;
  }
  filter_.first = static_cast<int>(*first);
  filter_.last = static_cast<int>(*last);
}

io::TableFormat MeasuredColumns::read_format(TomlReader& reader) {
  io::TableFormat format;
  const std::string separator = reader.text("separator", "what stands between cells", "");
  if (!separator.empty()) {
    if (const auto found = io::find_separator(separator))
      format.separator = *found;
    else
      reader.report("separator",
                    fmt::format("{} must be \",\", \";\", \"tab\", \"blanks\" or \"none\"; got "
                                "\"{}\"",
                                reader.path_of("separator"), separator));
  }
  const std::string decimal = reader.text("decimal", "the decimal mark", "");
  if (decimal == "." || decimal == ",")
    format.decimal = decimal.front();
  else if (!decimal.empty())
    reader.report("decimal", fmt::format("{} must be \".\" or \",\"; got \"{}\"",
                                         reader.path_of("decimal"), decimal));
  reader.expect("header_row");
  if (reader.has("header_row"))
    format.header_row = static_cast<int>(
        reader.integer("header_row", "row of the file that names the columns, 0 for none", 0,
                       std::numeric_limits<int>::max()));
  return format;
}

std::vector<std::string> MeasuredColumns::chosen() const {
  std::vector<std::string> names;
  for (const auto& [name, spec] : columns_) names.push_back(name);
  return names;
}

std::optional<io::MeasuredColumn> MeasuredColumns::read(const std::string& quantity,
                                                        std::string_view at) {
  const io::ColumnHeader wanted = io::read_header(quantity);
  io::ColumnSpec spec;
  const auto entry = [&](const std::string& name) {
    const auto found = columns_.find(name);
    if (found == columns_.end()) return false;
    asked_for_[name] = true;
    spec = found->second;
    at = "columns";
    return true;
  };
  asked_for_[quantity] = true;
  const bool given = entry(quantity) || entry(wanted.name);
  const bool void_ratio = !given && quantity == "v" && entry("e");
  spec.dimension = dimension_of(wanted);
  if (void_ratio) spec.offset += 1.0;  // v = 1 + e
  spec.name = quantity;
  if (!usable()) return {};
  try {
    if (spec.from.empty() && spec.number == 0) {
      const auto has = [&](const std::string& name) {
        return io::find_column(*table_, name, spec.dimension).has_value();
      };
      if (void_ratio) {
        spec.from = "e";
      } else if (!has(quantity) && has(wanted.name)) {
        spec.from = wanted.name;
      } else if (quantity == "v" && !given && !has("v") && has("e")) {
        spec.from = "e";
        spec.offset += 1.0;
      }
    }
    io::MeasuredColumn column = io::read_column(*table_, spec, rows_);
    lines_.push_back(io::describe(column));
    return column;
  } catch (const io::TableError& error) {
    reader_->report(at, error.what());
    return {};
  }
}

void MeasuredColumns::finish() {
  std::vector<std::string_view> asked;
  for (const auto& [name, yes] : asked_for_) asked.push_back(name);
  for (const auto& [name, spec] : columns_) {
    if (asked_for_.contains(name)) continue;
    const std::string near = closest(name, asked);
    const std::string key = "columns." + name;
    reader_->report(
        key, fmt::format("{}: nothing asks for this quantity{}", reader_->path_of(key),
                         near.empty() ? fmt::format("; wanted are {}", fmt::join(asked, ", "))
                                      : fmt::format("; did you mean '{}'?", near)));
  }
  if (!usable()) return;
  std::string text = io::describe(*table_);
  if (rows_.size() < table_->rows())
    text += fmt::format("\n  {} of {} rows pass rows and where", rows_.size(), table_->rows());
  for (const std::string& line : lines_) text += "\n  " + line;
  reader_->file().add_table(std::move(text));
}

}  // namespace repose::input

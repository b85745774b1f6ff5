#include "io/raw_table.hpp"

#include <algorithm>
#include <array>
#include <system_error>

#include <fmt/core.h>

#include "io/atomic_file.hpp"
#include "io/column_header.hpp"
#include "io/number_text.hpp"
#include "io/seal.hpp"
#include "io/table_layout.hpp"

namespace repose::io {
namespace {

bool is_possible(std::string_view text, Separator separator, char decimal) {
  switch (separator) {
    case Separator::comma:
      return text.find(',') != std::string_view::npos &&
             (decimal != ',' || text.find('"') != std::string_view::npos);
    case Separator::semicolon:
      return text.find(';') != std::string_view::npos;
    case Separator::tab:
      return text.find('\t') != std::string_view::npos;
    case Separator::blanks:
      return text.find_first_of(" \t") != std::string_view::npos;
    default:
      return true;
  }
}

/// Rule 2 of parse_table().
bool is_better(const Reading& a, const Reading& b) {
  if (a.fit != b.fit) return a.fit < b.fit;
  if ((a.separator == Separator::none) != (b.separator == Separator::none))
    return b.separator == Separator::none;
  const auto sure = [](const Reading& r) {  // neither mark stands in a number
    return r.fit != Fit::poor &&
           (r.separator == Separator::semicolon || r.separator == Separator::tab);
  };
  if (sure(a) != sure(b)) return sure(a);
  return a.numbers_size > b.numbers_size;
}

bool has_mark(const Reading& reading, char mark) {
  if (!reading.first_data) return false;
  for (std::size_t i = *reading.first_data; i < reading.list.records.size(); ++i)
    for (std::size_t k = 0; k < reading.list.records[i].count; ++k) {
      const CellShape shape = shape_of(reading.list.cell(reading.list.records[i], k));
      if (shape.kind == CellKind::number && shape.mark == mark) return true;
    }
  return false;
}

Reading best_reading(std::string_view text, const std::string& file, const TableFormat& format) {
  if (format.separator != Separator::detect)
    return read_as(text, format.separator, format.decimal, format.header_row);
  std::vector<Reading> readings;
  for (const Separator separator : {Separator::semicolon, Separator::tab, Separator::comma,
                                    Separator::blanks, Separator::none}) {
    if (!is_possible(text, separator, format.decimal)) continue;
    Reading reading = read_as(text, separator, format.decimal, format.header_row);
    if (reading.width < 2 && separator != Separator::none) continue;
    readings.push_back(std::move(reading));
  }
  std::size_t best = 0;
  for (std::size_t i = 1; i < readings.size(); ++i)
    if (is_better(readings[i], readings[best])) best = i;
  // "1,5" without a name above it: one number or two?
  if (readings[best].fit == Fit::no_header && format.decimal == 0) {
    const auto reads = [&](bool commas) {
      return std::any_of(readings.begin(), readings.end(), [&](const Reading& r) {
        return r.fit == Fit::no_header &&
               (commas ? r.separator == Separator::comma : has_mark(r, ','));
      });
    };
    const bool pure = std::none_of(readings.begin(), readings.end(), [](const Reading& r) {
      return r.fit == Fit::no_header && has_mark(r, '.');
    });
    const Separator chosen = readings[best].separator;
    if (reads(true) && reads(false) && pure &&
        (chosen == Separator::comma || chosen == Separator::none))
      throw TableError(file, readings[best].list.records[*readings[best].first_data].row, "",
                       "without a row of names above the numbers a comma may separate columns or "
                       "be the decimal mark",
                       "name the columns, or give separator = \",\" or decimal = \",\"");
  }
  return std::move(readings[best]);
}

[[noreturn]] void refuse_ragged(const Reading& r, const Record& record, const std::string& file) {
  std::size_t cells = record.count;
  while (cells > r.width && r.list.cell(record, cells - 1).empty()) --cells;
  std::string cause, cure;
  const int header = r.header ? r.list.records[*r.header].row : 0;
  if (header > 0)
    cause = fmt::format("{} cell{}, and the header in row {} names {} column{}", cells,
                        cells == 1 ? "" : "s", header, r.width, r.width == 1 ? "" : "s");
  else
    cause = fmt::format("{} cell{}, and the first row of data has {}", cells, cells == 1 ? "" : "s",
                        r.width);
  cause += fmt::format(" (separator: {})", name_of(r.separator));
  if (r.separator == Separator::comma && cells > r.width)
    cure =
        "if commas are decimal marks too, separate the columns by semicolons or give separator; "
        "if they stand between thousands, leave those out; a cell with commas needs quotes";
  else if (cells > r.width)
    cure = "name all columns, or put a cell that holds the separator in quotes";
  else
    cure =
        "fill the row, leaving the separator for an empty cell, or start it with # if it is no "
        "data";
  // which column is the first that is too many, or that is missing
  const std::size_t at = std::min(cells, r.width);
  std::string column = std::to_string(at + 1);
  if (at < r.names.size()) column += fmt::format(" ({})", r.names[at].substr(0, 40));
  throw TableError(file, record.row, column, cause, cure);
}

bool has_number(const Reading& r, const Record& record) {
  for (std::size_t i = 0; i < record.count; ++i)
    if (shape_of(r.list.cell(record, i)).kind == CellKind::number) return true;
  return false;
}

/// The text directly above the data does not name their columns; returns if there is none.
void refuse_header(const Reading& r, const std::string& file) {
  const Record* text = nullptr;
  for (const Record& record : r.list.records) {
    if (record.comment) continue;
    const bool number = has_number(r, record);
    const auto first = r.list.cells.begin() + static_cast<std::ptrdiff_t>(record.begin);
    if (!number && !are_units({first, first + static_cast<std::ptrdiff_t>(record.count)}))
      text = &record;
    if (!number || record.count != r.width) continue;
    if (text == nullptr) return;
    const bool commas = r.separator == Separator::comma && r.width > text->count;
    throw TableError(
        file, text->row, std::to_string(std::min(text->count, r.width) + 1),
        fmt::format("{} cell{} here, and {} in row {} below (separator: {}), so this does not name "
                    "the columns",
                    text->count, text->count == 1 ? "" : "s", r.width, record.row,
                    name_of(r.separator)),
        fmt::format("name every column{}, or give separator, decimal or header_row (0: no names)",
                    commas ? "; if commas are decimal marks, separate by semicolons" : ""));
  }
}

/// Rule 3 of parse_table().
char decimal_mark(const Reading& r, const std::vector<Record>& records, const std::string& file,
                  const std::vector<ColumnHeader>& headers) {
  struct Place {
    int row = 0;
    std::size_t column = 0;
    std::string_view cell;
  };
  Place comma, point, doubtful, doubtful_point;  // the first of each
  for (const Record& record : records)
    for (std::size_t i = 0; i < r.width; ++i) {
      const std::string_view cell = r.list.cell(record, i);
      const CellShape shape = shape_of(cell);
      if (shape.mark == 0) continue;
      Place* const place = shape.mark == ',' ? (shape.may_be_grouped ? &doubtful : &comma)
                                             : (shape.may_be_grouped ? &doubtful_point : &point);
      if (place->row == 0) *place = {record.row, i, cell};
    }
  const auto title = [&](const Place& p) {
    return fmt::format("{} ({})", p.column + 1, headers[p.column].text);
  };
  if (comma.row > 0 && point.row > 0)
    throw TableError(file, comma.row, title(comma),
                     fmt::format("both marks are in use: {} here, and {} in row {}, column {}",
                                 shown(comma.cell), shown(point.cell), point.row, title(point)),
                     "write one of them everywhere, or say which it is: decimal = \",\" or "
                     "decimal = \".\"");
  if (comma.row > 0) return ',';
  if (point.row > 0 || doubtful.row == 0) return '.';
  throw TableError(
      file, doubtful.row, title(doubtful),
      fmt::format("{} is a thousand times as much if its comma stands between thousands, and no "
                  "cell of the file tells",
                  shown(doubtful.cell)),
      doubtful_point.row > 0 ? "give decimal = \",\" or decimal = \".\""
                             : "give decimal = \",\" if it is a decimal comma, or leave it out");
}

}  // namespace

std::optional<Separator> find_separator(std::string_view text) {
  if (text == "," || text == "comma") return Separator::comma;
  if (text == ";" || text == "semicolon") return Separator::semicolon;
  if (text == "\t" || text == "\\t" || text == "tab") return Separator::tab;
  if (text == " " || text == "blank" || text == "blanks") return Separator::blanks;
  if (text == "none") return Separator::none;
  return {};
}

std::string RawTable::column_title(std::size_t column) const {
  const std::string& text = headers_[column].text;
  return text.empty() ? std::to_string(column + 1) : fmt::format("{} ({})", column + 1, text);
}

RawTable parse_table(std::string bytes, std::string file, const TableFormat& format) {
  RawTable table;
  table.file_ = std::move(file);
  const auto storage = std::make_shared<RawTable::Storage>();
  DecodedText decoded = decode_text(std::move(bytes), table.file_);
  storage->text = std::move(decoded.text);
  if (trimmed(storage->text).find_first_not_of("\r\n\t ") == std::string_view::npos)
    throw TableError(table.file_, 0, "", "the file is empty", "give a table with a row of names");
  Reading r = best_reading(storage->text, table.file_, format);

  if (r.list.open_quote_row > 0)
    throw TableError(table.file_, r.list.open_quote_row, std::to_string(r.list.open_quote_cell + 1),
                     "a quote opens here and none closes it",
                     "close it, take it away, or double it if it is a character of the text");
  if (format.header_row && *format.header_row > 0 && !r.header)
    throw TableError(table.file_, *format.header_row, "",
                     "this row has no text, so it cannot be the header",
                     "give header_row as the file's row, from 1");
  if (r.fit == Fit::none)
    throw TableError(table.file_, 0, "", "there are no rows with numbers below the header",
                     "give the rows that were measured");
  if (!r.header && !format.header_row && r.fit == Fit::poor) refuse_header(r, table.file_);

  TableLayout& layout = table.layout_;
  layout.encoding = decoded.encoding;
  layout.separator = r.separator;
  layout.header_in_comment = r.header_in_comment;
  if (r.header) layout.header_row = r.list.records[*r.header].row;
  if (r.units) layout.unit_row = r.list.records[*r.units].row;
  for (std::size_t i = 0; i < r.list.records.size(); ++i) {
    const Record& record = r.list.records[i];
    if ((r.header && i == *r.header) || (r.units && i == *r.units)) continue;
    if (record.comment) {
      ++layout.comments;
    } else if (!r.first_data || i < *r.first_data) {
      ++layout.lines_above;
    } else {
      if (!has_width(r.list, record, r.width)) refuse_ragged(r, record, table.file_);
      table.records_.push_back(record);
    }
  }
  if (table.records_.empty())
    throw TableError(table.file_, 0, "", "there are no rows below the header",
                     "give the rows that were measured");

  table.headers_.resize(r.width);
  for (std::size_t i = 0; i < r.names.size(); ++i) table.headers_[i] = read_header(r.names[i]);
  for (std::size_t i = 0; i < r.unit_texts.size(); ++i) {
    if (r.unit_texts[i].empty()) continue;
    ColumnHeader& header = table.headers_[i];
    header.unit = r.unit_texts[i];
    header.unit_in_name = false;
  }
  layout.decimal = format.decimal != 0
                       ? format.decimal
                       : decimal_mark(r, table.records_, table.file_, table.headers_);
  storage->cells = std::move(r.list);
  table.storage_ = storage;
  return table;
}

RawTable load_table(const std::filesystem::path& file, const TableFormat& format) {
  constexpr std::size_t most_bytes = 1'000'000'000;  // its cells take five times as much
  return parse_table(read_bytes(file, most_bytes), file.string(), format);
}

}  // namespace repose::io

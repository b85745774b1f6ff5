// Any bytes: a table is read or refused with a TableError, and what was read keeps its promises.
//
// The first byte chooses what a caller forces; the rest is the file.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "io/measured_table.hpp"

namespace {

using namespace repose::io;

void require(bool holds) {
  if (!holds) std::abort();
}

TableFormat format_of(unsigned char choice) {
  TableFormat format;
  format.separator = static_cast<Separator>(choice % 6);
  format.decimal = choice / 6 % 3 == 0 ? 0 : choice / 6 % 3 == 1 ? '.' : ',';
  const int header = choice / 18 % 4;
  if (header > 0) format.header_row = header - 1;
  return format;
}

void read_columns(const RawTable& table) {
  for (std::size_t i = 0; i < table.columns(); ++i) {
    const ColumnHeader& header = table.headers()[i];
    ColumnSpec spec{.name = header.text};
    if (i % 3 == 0) spec.number = static_cast<int>(i) + 1;
    if (i % 3 == 1) spec.unit = header.unit;
    if (i % 5 == 1) spec.dimension = dimension::stress;
    if (i % 5 == 2) spec.dimension = dimension::number;
    try {
      RowFilter filter;
      if (i % 2 == 1) filter.where.push_back({header.name, std::string(table.cell(0, i))});
      const MeasuredColumn column = read_column(table, spec, filter);
      require(column.values.size() == column.file_rows.size());
      require(column.values.size() + column.dropped <= table.rows());
      require(filter.where.empty() ? column.values.size() + column.dropped == table.rows() : true);
      for (const double value : column.values)
        require(std::isfinite(value) && value >= column.min && value <= column.max);
      require(!describe(column).empty());
    } catch (const TableError& error) {
      require(!error.cause().empty());
      if (error.row() > 0 && !error.column().empty()) require(!error.cure().empty());
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    const RawTable table = parse_table(std::move(bytes), "f", format_of(data[0]));
    require(table.rows() > 0 && table.columns() > 0);
    require(table.layout().decimal == '.' || table.layout().decimal == ',');
    require(table.layout().separator != Separator::detect);
    int last = table.layout().header_row;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      require(table.file_row(row) > last);
      last = table.file_row(row);
    }
    require(!describe(table).empty());
    read_columns(table);
  } catch (const TableError& error) {
    require(!error.cause().empty());
  }
  return 0;
}

#pragma once

#include <string_view>

#include "io/json.hpp"

namespace repose::io {

/// A result's table as the page wants it, column by column:
///     {"rows": 240, "shown": 240, "columns": [
///         {"name": "time_s", "values": [0.0, 0.005, "nan", null]},
///         {"name": "method", "words": ["cvode", "ida"], "of": [0, 0, 1]}]}
/// A column is numbers if every cell is one or empty (null); seven digits are kept, and what is not
/// finite stays as "nan", "inf" or "-inf". Cells may stand in quotes. A last line without its
/// newline that is too short is a row cut off by a kill and is left out. Above most_rows, evenly
/// chosen rows are kept, the first and the last among them.
/// file: for messages. Errors: IoError with the line for a row of another length than the header.
Json csv_columns(std::string_view csv, std::string_view file, std::size_t most_rows = 20000);

}  // namespace repose::io

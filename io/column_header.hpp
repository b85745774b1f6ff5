#pragma once
/// \file
/// A column's name and unit in the text of its header.

#include <string>
#include <string_view>

#include "io/raw_table.hpp"

namespace repose::io {

/// "Axial strain [%]", "q (kPa)", "q_kPa", "shear_rate_per_s", "q / kPa", "q in kPa", "q kPa" →
/// name and unit. What stands in square brackets is a unit in any case; elsewhere only what is
/// known as one is, so "q (corrected)" and "eps_a" have none. Line breaks become blanks.
ColumnHeader read_header(std::string_view text);

}  // namespace repose::io

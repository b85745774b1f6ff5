#pragma once
/// \file
/// What a report on a laboratory test quotes, as summary.json and the terminal tell it.

#include <string>

#include "io/json.hpp"
#include "pointdriver/study/laboratory_figures.hpp"

namespace repose::study {

/// The members of "laboratory" in summary.json: units in the names, angles in degrees; only what
/// the test shows.
io::Json laboratory_json(const point::LaboratoryFigures& figures);

/// The most quoted of them in a line, "S_u = 51.3 kPa at ε_a = 8.2 % (plateau), ..."; empty if
/// the test shows none.
std::string laboratory_line(const point::LaboratoryFigures& figures);

}  // namespace repose::study

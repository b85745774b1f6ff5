#pragma once

#include <string>

#include "report/plot/figure.hpp"

namespace repose::report {

/// The figure as a complete gnuplot script that writes SVG to its standard output.
/// Errors: std::logic_error as Figure::svg().
std::string figure_script(const Figure& figure);

}  // namespace repose::report

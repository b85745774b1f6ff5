#pragma once
/// \file
/// A point test: the [law], [initial], [test] and [integration] tables of `repose point`, and those
/// of them that a fit's targets hold.

#include "input/read_law.hpp"
#include "pointdriver/integrate/simulate.hpp"

namespace repose::input {

struct PointTestFile {
  LawSpec law;
  point::PointTest test;
  point::Kind kind = point::Kind::triaxial;
  std::string name;  ///< of the result folder: the file's stem
};

/// Reads and validates a point test, the start of the law included. Throws BadInput with everything
/// that is wrong; a history's table that cannot be used is bad input too.
PointTestFile read_point_test(InputFile& file);

/// p, ocr, v, density, K0, sigma.
InitialConditions read_initial_conditions(TomlReader table);

/// A [test] table: kind, drainage, goals, stages, cycles, rates, history, custom constraints. What
/// is wrong is reported; the path may then be empty.
point::Path read_path(TomlReader test, point::Kind& kind);

/// An [integration] table; every key is optional.
point::Settings read_settings(TomlReader table);

}  // namespace repose::input

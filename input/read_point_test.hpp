#pragma once
/// \file
/// A point test: the [law], [initial], [test] and [integration] tables of `repose point`, and those
/// of them that a fit's targets hold.

#include "input/key_info.hpp"
#include "input/read_law.hpp"
#include "pointdriver/integrate/simulate.hpp"

namespace repose::input {

struct PointTestFile {
  LawSpec law;
  point::PointTest test;
  point::Kind kind = point::Kind::triaxial;
  std::vector<double> secants_at;  ///< shear strains at which a secant modulus is wanted [-]
  std::string name;                ///< of the result folder: the file's stem
  std::vector<std::string> notes;  ///< what is possible but hardly meant
};

/// How a [test] table is read, beside what it says itself.
struct PathReading {
  double max_strain = point::Settings().max_strain;  ///< a key beyond it is taken for per cent
  /// Of its strains, unless it says `strain = ...`.
  point::StrainMeasure measure = point::StrainMeasure::logarithmic;
  /// Where the data turn round, and their last row: a test that says no end is driven there.
  std::vector<point::Goal> ends;
};

/// Reads and validates a point test, the start of the law included. Throws BadInput with everything
/// that is wrong; a history's table that cannot be used is bad input too.
PointTestFile read_point_test(InputFile& file);

/// Reports what would take more memory or time than a test of one point is worth: rows of output,
/// and steps that method = "implicit" is bound to take. table: "" or that of a fit's target.
void check_size(InputFile& file, const std::string& table, const LawInfo& law,
                const point::PointTest& test);

/// p or sigma_v, ocr or ocr_v with K0_nc, v or e, density, K0, sigma.
InitialConditions read_initial_conditions(TomlReader table);

/// A [test] table: kind, drainage, strain, goals, stages, cycles, rates, history, custom
/// constraints. What is wrong is reported; the path may then be empty.
point::Path read_path(TomlReader test, point::Kind& kind, const PathReading& reading = {});

/// strain = "logarithmic" or "engineering".
point::StrainMeasure read_strain_measure(TomlReader& table, point::StrainMeasure fallback);

/// Every key of a point test.
std::vector<KeyInfo> point_test_infos();

/// An [integration] table; every key is optional.
point::Settings read_settings(TomlReader table);

}  // namespace repose::input

#pragma once
/// \file
/// What a quantity of granular and soil mechanics can be at all, by its unit. A key's own range
/// says what its equation takes ("> 0"); this says where a number is a slip of the pen, so that
/// nothing downstream has to fear what 1e-308 m or 1e80 Pa does to a product, a count or a loop.

#include <string>
#include <string_view>

#include "models/parameter.hpp"

namespace repose::input {

/// Sizes of a quantity, both included. `smallest` is for one that must not be zero; where zero is
/// allowed, anything next to it is.
struct SensibleSize {
  std::string_view unit;  ///< "-" for pure numbers
  double smallest, largest;
};

/// Every unit that a key or a parameter has.
const SensibleSize* find_sensible_size(std::string_view unit);

/// Why a number that the key's own range takes is none that a quantity of this unit has:
/// "lengths … go from 1e-09 to 1e+06 m"; "" if it is one, or if nothing is known of the unit.
/// range: the key's own, which goes before where it is narrower.
std::string why_senseless(double x, std::string_view unit, const Range& range);

}  // namespace repose::input

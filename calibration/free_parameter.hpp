#pragma once
/// \file
/// A parameter that a fit may change.

#include <optional>
#include <string>

#include "models/parameter.hpp"

namespace repose::calibration {

/// What is known of a value from elsewhere: the residual (value − mean)/sd with sd in the
/// parameter's own unit, whatever its scale, or ln(value/mean)/sd if sd is relative.
struct Prior {
  double mean = 0.0;
  double sd = 1.0;
  bool relative = false;
};

/// A value kept below another is at most this share of it.
inline constexpr double below_share = 0.999;

struct FreeParameter {
  std::string name;  ///< "M", "ocr of A7"
  std::string unit = "-";
  double lower = 0.0;  ///< of the coordinate x
  double upper = 1.0;
  Scale scale = Scale::linear;
  int of = -1;                    ///< x is a ratio to this earlier parameter; −1: x is the value
  std::optional<double> start{};  ///< of the coordinate x; default: the middle of its scale
  std::optional<Prior> prior{};   ///< on the value
  int below = -1;                 ///< the value stays below that of this earlier parameter
};

}  // namespace repose::calibration

#pragma once
/// \file
/// Noise to start from.

#include <cmath>

namespace repose::mpm {

/// A number in [−1, 1] that looks random but is the same every time.
inline double scatter(double x, double y, double seed) {
  const double s = std::sin(12.9898 * x + 78.233 * y + 37.719 * seed) * 43758.5453;
  return 2.0 * (s - std::floor(s)) - 1.0;
}

}  // namespace repose::mpm

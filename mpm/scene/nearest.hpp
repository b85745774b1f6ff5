#pragma once
/// \file
/// What a signed distance says of a place.

#include <array>
#include <string>

namespace repose::mpm {

using Position = std::array<double, 3>;  ///< x, y and in space z [m]

/// Distance from the surface, negative in the rigid part, and its gradient, which points away from
/// the rigid part.
struct Nearest {
  double distance = 0.0;  ///< [m]
  Position normal{};
};

/// A file that something was read from, as the scene names it, and the fingerprint of its bytes.
struct SourceFile {
  std::string name, content;
};

}  // namespace repose::mpm

#pragma once
/// \file
/// What of a body lies on an upright line.

#include <vector>

#include "mpm/scene/scene.hpp"

namespace repose::mpm {

/// A part of an upright line, from a height to another [m]; of a shape without end, infinite.
struct Span {
  double low = 0.0, high = 0.0;
};
/// Those of a line, from below, none of which meet.
using Spans = std::vector<Span>;

/// What the line over (x, z) has in common with a shape; z counts in space only.
Spans spans_of(const Solid& solid, double x, double z);

/// What stands of a body over (x, z), rigid surfaces aside; z counts in space only.
Spans spans_over(const Scene& scene, const Body& body, double x, double z);

}  // namespace repose::mpm

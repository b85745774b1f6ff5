#pragma once
/// \file
/// Lines of equal value on a lattice of numbers, and the regions within them.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "io/geojson.hpp"

namespace repose::io {

/// Numbers at the nodes of a lattice: node (i, k) lies at (x + i dx, y + k dy) and has the number
/// values[k columns + i].
struct Lattice {
  std::size_t columns = 0, rows = 0;
  double x = 0.0, y = 0.0, dx = 1.0, dy = 1.0;
  std::span<const double> values;
};

struct LevelLine {
  Ring places;
  bool closed = false;  ///< else it begins and ends at the border, or where there is no number
};

/// The lines on which the values, linear along the lattice's edges, are `level` (marching squares;
/// where two high corners of a square face each other, its mean tells whether they hang together).
/// None passes through a square with a corner that is no number.
std::vector<LevelLine> level_lines(const Lattice& lattice, double level);

/// Where the values are at least `level` > 0, beyond the lattice being 0: outer rings run
/// counterclockwise, holes clockwise.
std::vector<Region> regions_above(const Lattice& lattice, double level);

/// Of a ring, positive if it runs counterclockwise.
double signed_area(const Ring& ring);

}  // namespace repose::io

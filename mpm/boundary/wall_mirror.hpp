#pragma once
/// \file
/// What walls that are at rest and carry no friction do to a field on the grid, as a linear map.

#include <vector>

#include "mpm/boundary/walls.hpp"
#include "mpm/grid/grid.hpp"

namespace repose::mpm {

/// The velocity fields that slip and no-slip walls admit (walls.hpp): v = E y, where y are the
/// values at the nodes that are free, and E gives ghosts their mirrored values and zero to what is
/// held.
class WallMirror {
 public:
  void connect(Grid& grid, const Walls& walls);
  /// v ← E y, y being v at the free nodes.
  void extend(NodeVector& v) const;
  /// f ← Eᵀ f: ghosts' values go to their images; 0 at ghosts and at what is held.
  void fold(NodeVector& f) const;
  /// The same for a diagonal, diag(Eᵀ d E).
  void fold_diagonal(NodeVector& d) const;

 private:
  struct Place {
    std::size_t block, node;
  };
  struct Pair {
    Place ghost, image;
    double sign_x, sign_y;  ///< ghost over image
  };
  struct Held {
    Place at;
    bool x, y;
  };
  static double* component(NodeVector& v, const Place& at, bool y) {
    return (y ? v[at.block].y : v[at.block].x).data() + at.node;
  }
  void add_wall(Grid& grid, const Wall& wall, bool normal_is_x, int line, int inward);
  void release(NodeVector& f) const;

  std::vector<Pair> pairs_;
  std::vector<Held> held_;
};

}  // namespace repose::mpm

#pragma once
/// \file
/// An edge of the box in parts: what holds at a place of it, and at its nodes.
///
/// A wall node takes the kind of the part that contains it. Openings are resolved below a cell: a
/// node on a lip is closed, and the first node of an opening, r < h from the lip, is bound to the
/// next, its master:
///   q = r²/(h (r + h)) q_master,
/// where q is what a wall sets to zero: v_n of the node on the wall, and the sum of those behind
/// and inside. The impulses that do so are those of Gauss' principle of least constraint. A profile
/// that grows linearly from the lip has the share r/(r + h); the factor r/h makes the discharge go
/// over from that of one whole number of cells to the next (docs/edges.md): without it three
/// quarters of the way are gone at r = h/2, as the master's own momentum gives way.

#include "mpm/boundary/walls.hpp"

namespace repose::mpm {

template <int dim>
class WallParts {
 public:
  /// `normal`: the axis across the wall.
  WallParts(const Wall& wall, std::size_t normal, const GridOf<dim>& grid);

  using Place = std::array<double, 2>;  ///< along the edge [m]; in the plane the second is 0
  /// The part that holds at a place; beyond the ends of the edge, what its image has.
  const Wall::Part& at(Place place) const;
  bool open_at(const std::array<double, dim>& x) const;
  /// Whether there is an opening within two cells: the velocity of one reaches as far.
  bool open_near(const std::array<double, dim>& x) const;

  struct Node {
    const Wall::Part* part;                  ///< what holds at it
    std::array<double, dim - 1> share;       ///< of the velocity of the next node; 1: its own
    std::array<int, dim - 1> towards_lip{};  ///< −1 or 1 where share < 1
    bool free() const {
      for (const double s : share)
        if (s < 1.0) return false;
      return part->kind == Wall::Kind::open;
    }
  };
  /// `index`: of the node along the edge.
  Node node(const std::array<int, dim - 1>& index) const;

 private:
  const Wall& wall_;
  double h_, hair_;
  std::array<double, 2> length_{};
  std::array<std::size_t, dim - 1> axes_{};
};

}  // namespace repose::mpm

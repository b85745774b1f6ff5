#pragma once
/// \file
/// The background grid: blocks of cells (Shape), of which only those near material exist.
///
/// Node (i, j) lies at (i h, j h), so nodes 0 and nx lie on the walls and −1, nx + 1 are ghosts; in
/// space likewise (i, j, k).
/// Points are sorted by the block of their cell. A block's points write to, and read from, a dense
/// local tile that also covers one cell of drift around the block, so that sorting can wait until a
/// point may have moved by one cell. Tiles are summed into nodes by their owners in a fixed order:
/// no atomics, and the same bits for any number of threads.

#include <array>
#include <cstdint>
#include <vector>

#include "mpm/grid/points.hpp"

namespace repose::mpm {

namespace detail {
template <std::size_t n>
constexpr int product(const std::array<int, n>& factors) {
  int all = 1;
  for (const int x : factors) all *= x;
  return all;
}
}  // namespace detail

/// A block's cells, and its tile: one cell of drift around the block and the stencils of points
/// there. That is two nodes before the block's first, and one cell and two nodes (in x three, with
/// the idle lane of the quadratic kernel) after its last. In x it begins two columns earlier, so
/// that a tile row is 4 + 8 + 4 nodes: the last four of the block before, the block's own, the
/// first four of the next. In space the blocks are smaller, for a tile of theirs to stay in the
/// cache; a plane of constant z in it is laid out as the tile of the plane.
template <int dim>
struct Shape {
  static constexpr std::size_t axes = dim;
  static constexpr std::array<int, axes> cells = [] {
    if constexpr (dim == 2)
      return std::array{8, 8};
    else
      return std::array{8, 4, 4};
  }();
  static constexpr std::array<int, axes> margin = [] {
    std::array<int, axes> nodes{};
    nodes.fill(2);
    nodes[0] = 4;
    return nodes;
  }();
  static constexpr std::array<int, axes> tile = [] {
    std::array<int, axes> nodes{};
    for (std::size_t a = 0; a < axes; ++a) nodes[a] = cells[a] + 5;
    nodes[0] = 16;
    return nodes;
  }();
  static_assert(tile[0] == margin[0] + cells[0] + 4);
  static constexpr int nodes = detail::product(cells);
  static constexpr int tile_nodes = detail::product(tile);
  static constexpr std::size_t around = dim == 2 ? 9 : 27;  ///< a block and its neighbours

  /// The k-th of the blocks around one, −1, 0 or 1 along each axis, x changing fastest.
  static constexpr std::array<int, axes> neighbour(std::size_t k) {
    std::array<int, axes> offset{};
    for (int& d : offset) {
      d = static_cast<int>(k % 3) - 1;
      k /= 3;
    }
    return offset;
  }
};

// those of the plane by name
constexpr int block_nx = Shape<2>::cells[0];
constexpr int block_ny = Shape<2>::cells[1];
constexpr int block_nodes = Shape<2>::nodes;
constexpr int tile_margin_x = Shape<2>::margin[0];
constexpr int tile_margin_y = Shape<2>::margin[1];
constexpr int tile_stride = Shape<2>::tile[0];
constexpr int tile_rows = Shape<2>::tile[1];
constexpr int tile_nodes = Shape<2>::tile_nodes;

/// What points hand to nodes in the plane. T_EXTRA, the last: elastic volume strain where pressures
/// are averaged, else now and then the square of c + |v|.
enum TileChannel : std::size_t { T_MASS, T_PX, T_PY, T_FX, T_FY, T_EXTRA, tile_channels };
/// The same in `dim` dimensions.
template <int dim>
struct Channels {
  static constexpr std::size_t mass = 0;
  static constexpr std::size_t momentum = 1;
  static constexpr std::size_t force = momentum + dim;
  static constexpr std::size_t extra = force + dim;
  static constexpr std::size_t count = extra + 1;
};
static_assert(Channels<2>::momentum == T_PX && Channels<2>::force == T_FX &&
              Channels<2>::extra == T_EXTRA && Channels<2>::count == tile_channels);

template <int dim>
using TileField = std::array<double, Shape<dim>::tile_nodes>;
template <int dim>
struct alignas(64) TileOf : std::array<TileField<dim>, Channels<dim>::count> {};
using Tile = TileOf<2>;

/// Nodes of a tile along one axis, from `begin` up to the one before `end`.
struct TileRows {
  int begin = 0, end = 0;
};
/// Of a tile, along every axis.
template <int dim>
using TilePart = std::array<TileRows, Shape<dim>::axes>;

/// The points of one block, all bodies.
template <int dim>
struct PointBlockOf {
  std::array<int, Shape<dim>::axes> at{};  ///< block coordinates
  /// The node blocks around, row by row; −1 where the points touch none of their nodes
  std::array<std::int32_t, Shape<dim>::around> node_block{};
  std::vector<SlotRange> range;  ///< per body
  /// The part of the tile with all nodes that the points can touch before they are sorted again. A
  /// thin flow fills a row or two of its blocks' cells, and the rest would be most of its cost.
  TilePart<dim> touched = whole_tile();

  static TilePart<dim> whole_tile() {
    TilePart<dim> all;
    for (std::size_t a = 0; a < all.size(); ++a) all[a] = {0, Shape<dim>::tile[a]};
    return all;
  }
  /// Whether the points touch nodes of a block beside this one, −1, 0 or 1 along each axis.
  bool touches(const std::array<int, Shape<dim>::axes>& offset) const {
    for (std::size_t a = 0; a < offset.size(); ++a) {
      const int begin = Shape<dim>::margin[a] + offset[a] * Shape<dim>::cells[a];
      if (touched[a].begin >= begin + Shape<dim>::cells[a] || touched[a].end <= begin) return false;
    }
    return true;
  }

  std::size_t points() const {
    std::size_t n = 0;
    for (const SlotRange& r : range) n += r.count;
    return n;
  }
};
using PointBlock = PointBlockOf<2>;

/// The nodes of one block; masses per metre of depth in the plane.
template <int dim>
struct alignas(64) NodeBlockOf {
  using Nodes = std::array<double, Shape<dim>::nodes>;
  Nodes mass{};  ///< [kg/m], [kg]
  /// Mass with its mirror image beyond a wall, equal to mass away from walls [kg/m], [kg]
  Nodes mirrored_mass{};
  std::array<Nodes, Shape<dim>::axes> u{};  ///< velocity before forces (from the points) [m/s]
  std::array<Nodes, Shape<dim>::axes> v{};  ///< velocity after forces, then after walls [m/s]
  /// Mass average of what the tiles' last channel carries, if it carries anything
  Nodes extra{};
  std::array<int, Shape<dim>::axes> at{};  ///< block coordinates
  /// The point blocks around; −1 where there is none that touches a node of this one
  std::array<std::int32_t, Shape<dim>::around> point_block{};
};
using NodeBlock = NodeBlockOf<2>;

/// A vector at every node of a block.
struct alignas(64) NodeField {
  std::array<double, block_nodes> x{}, y{};
};
/// One per node block of the grid, in its order.
using NodeVector = std::vector<NodeField>;

template <int dim>
class GridOf {
 public:
  using Index = std::array<int, Shape<dim>::axes>;  ///< of a node, a cell or a block

  /// `cells` of size h; one ring of blocks is kept around the box for ghosts.
  GridOf(double h, const Index& cells);
  GridOf(double h, int nx, int ny) requires(dim == 2) : GridOf(h, Index{nx, ny}) {}

  double h() const { return h_; }
  const Index& cells() const { return cells_; }
  int nx() const { return cells_[0]; }
  int ny() const { return cells_[1]; }

  static int block_of_cell(std::size_t axis, int cell) {
    return (cell + Shape<dim>::cells[axis]) / Shape<dim>::cells[axis];
  }
  /// Index of the block's first cell and node.
  static int first(std::size_t axis, int block) { return (block - 1) * Shape<dim>::cells[axis]; }
  static int block_of_cell_x(int cell) { return block_of_cell(0, cell); }
  static int block_of_cell_y(int cell) { return block_of_cell(1, cell); }
  static int first_x(int bx) { return first(0, bx); }
  static int first_y(int by) { return first(1, by); }

  /// Sorts the points of all bodies by block and, within it, by the anchor of their stencils, the
  /// node ⌊ξ + anchor_offset⌋ (stable, so the result depends on positions and the former order
  /// only), and brings the blocks to life around them. Works on the threads of the arena that it is
  /// called in.
  void sort(std::vector<PointsOf<dim>>& bodies, double anchor_offset = 0.0);

  /// Takes over point blocks as sort() left them (from a checkpoint).
  void restore(std::vector<PointBlockOf<dim>> blocks);

  /// The live node block holding a node and its place in it; null where nothing is near.
  struct NodeRef {
    NodeBlockOf<dim>* block;
    std::size_t place;
  };
  NodeRef node(const Index& index);
  NodeRef node(int i, int j) requires(dim == 2) { return node(Index{i, j}); }

  /// The block of points at block coordinates; null where there is none.
  const PointBlockOf<dim>* point_block(const Index& block) const;

  std::vector<PointBlockOf<dim>> point_blocks;
  std::vector<NodeBlockOf<dim>> node_blocks;
  std::vector<TileOf<dim>> tiles;  ///< one per point block; zero beyond what its points touch

 private:
  std::size_t table_index(const Index& block) const;
  Index block_at(std::size_t table_index) const;
  /// Place of a cell or node in its block.
  static int place_in(const Index& block, const Index& index);
  bool inside(const Index& block) const;
  void connect();

  double h_;
  Index cells_;
  Index blocks_;                           // along each axis
  std::vector<std::int32_t> point_table_;  // block → index into point_blocks, or −1
  std::vector<std::int32_t> node_table_;   // block → index into node_blocks, or −1
};
using Grid = GridOf<2>;

}  // namespace repose::mpm

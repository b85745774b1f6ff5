#pragma once
/// \file
/// The background grid: blocks of 8 × 8 cells, of which only those near material exist.
///
/// Node (i, j) lies at (i h, j h), so nodes 0 and nx lie on the walls and −1, nx + 1 are ghosts.
/// Points are sorted by the block of their cell. A block's points write to, and read from, a dense
/// local tile that also covers one cell of drift around the block, so that sorting can wait until a
/// point may have moved by one cell. Tiles are summed into nodes by their owners in a fixed order:
/// no atomics, and the same bits for any number of threads.

#include <array>
#include <cstdint>
#include <vector>

#include "mpm/points.hpp"
#include "mpm/sleep.hpp"

namespace repose::mpm {

constexpr int block_nx = 8;
constexpr int block_ny = 8;
constexpr int block_nodes = block_nx * block_ny;

/// A tile covers one cell of drift around its block and the stencils of points there: two nodes
/// before the block's first, and one cell and two nodes (in x three, with the idle lane of the
/// quadratic kernel) after its last. In x it begins two columns earlier, so that a tile row is
/// 4 + 8 + 4 nodes: the last four of the block before, the block's own, the first four of the next.
constexpr int tile_margin_x = 4;
constexpr int tile_margin_y = 2;
constexpr int tile_stride = 16;
constexpr int tile_rows = block_ny + 5;
constexpr int tile_nodes = tile_stride * tile_rows;
static_assert(tile_stride == tile_margin_x + block_nx + 4);

/// What points hand to nodes. T_EXTRA, the last: elastic volume strain where pressures are
/// averaged, else now and then the square of c + |v|.
enum TileChannel : std::size_t { T_MASS, T_PX, T_PY, T_FX, T_FY, T_EXTRA, tile_channels };
struct alignas(64) Tile : std::array<std::array<double, tile_nodes>, tile_channels> {};

/// The points of one block, all bodies.
struct PointBlock {
  int bx = 0, by = 0;                        ///< block coordinates
  std::array<std::int32_t, 9> node_block{};  ///< the 3 × 3 node blocks around, row by row
  std::vector<Range> range;                  ///< per body
  Rest rest;

  std::size_t points() const {
    std::size_t n = 0;
    for (const Range& r : range) n += r.count;
    return n;
  }
};

/// The nodes of one block.
struct alignas(64) NodeBlock {
  std::array<double, block_nodes> mass{};  ///< [kg/m]
  /// Mass with its mirror image beyond a wall, equal to mass away from walls [kg/m]
  std::array<double, block_nodes> mirrored_mass{};
  std::array<double, block_nodes> ux{}, uy{};  ///< velocity before forces (from the points) [m/s]
  std::array<double, block_nodes> vx{}, vy{};  ///< velocity after forces, then after walls [m/s]
  /// Mass average of what the tiles' last channel carries, if it carries anything
  std::array<double, block_nodes> extra{};
  /// What points awake put there; only where blocks of both kinds are around [kg/m]
  std::array<double, block_nodes> awake_mass{};
  int bx = 0, by = 0;
  bool asleep = false;   ///< no point awake is near: nothing reads it and it holds zeros
  bool borders = false;  ///< of the blocks of points around, some are awake and some asleep
  std::array<std::int32_t, 9> point_block{};  ///< the point blocks around; −1 where there is none
};

/// A vector at every node of a block.
struct alignas(64) NodeField {
  std::array<double, block_nodes> x{}, y{};
};
/// One per node block of the grid, in its order.
using NodeVector = std::vector<NodeField>;

class Grid {
 public:
  /// `nx` × `ny` cells of size h; one ring of blocks is kept around the box for ghosts.
  Grid(double h, int nx, int ny);

  double h() const { return h_; }
  int nx() const { return nx_; }
  int ny() const { return ny_; }

  int block_of_cell_x(int cell) const { return (cell + block_nx) / block_nx; }
  int block_of_cell_y(int cell) const { return (cell + block_ny) / block_ny; }
  /// Index of the block's first cell and node.
  static int first_x(int bx) { return (bx - 1) * block_nx; }
  static int first_y(int by) { return (by - 1) * block_ny; }

  /// Sorts the points of all bodies by block and cell (stable, so the result depends on positions
  /// and the former order only), and brings the blocks to life around them. A block of points keeps
  /// what it knows of its rest.
  void sort(std::vector<PointSet>& bodies);

  /// Takes over point blocks as sort() left them (from a checkpoint).
  void restore(std::vector<PointBlock> blocks);

  /// The live node block holding node (i, j) and its place in it; null where nothing is near.
  struct NodeRef {
    NodeBlock* block;
    std::size_t place;
  };
  NodeRef node(int i, int j);

  /// The block of points at block coordinates; null where there is none.
  const PointBlock* point_block(int bx, int by) const;

  std::vector<PointBlock> point_blocks;
  std::vector<NodeBlock> node_blocks;
  std::vector<Tile> tiles;  ///< one per point block

 private:
  std::size_t table_index(int bx, int by) const {
    return static_cast<std::size_t>(by) * static_cast<std::size_t>(blocks_x_) +
           static_cast<std::size_t>(bx);
  }
  void connect();

  double h_;
  int nx_, ny_;
  int blocks_x_, blocks_y_;
  std::vector<std::int32_t> point_table_;  // block → index into point_blocks, or −1
  std::vector<std::int32_t> node_table_;   // block → index into node_blocks, or −1
};

}  // namespace repose::mpm

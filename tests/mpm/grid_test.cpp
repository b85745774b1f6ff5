#include "mpm/grid/grid.hpp"

#include <set>

#include <gtest/gtest.h>

#include "models/scalar.hpp"
#include "mpm/grid/kernel.hpp"
#include "mpm/grid/tile_exchange.hpp"
#include "tests/mpm/point_cloud.hpp"

namespace repose::mpm {
namespace {

constexpr double h = 0.25;

int cell(double x) { return static_cast<int>(std::floor(x / h)); }

/// Every slot of a body in the order of its blocks: begin, count of the ranges.
void expect_sorted(const Grid& grid, const PointSet& points, std::size_t body) {
  std::set<std::int64_t> seen;
  std::size_t next = 0;
  for (const PointBlock& pb : grid.point_blocks) {
    const SlotRange& range = pb.range[body];
    EXPECT_EQ(range.begin, next) << "ranges follow each other";
    EXPECT_EQ(range.begin % pack_size, 0U) << "ranges begin with a pack";
    next = range.begin + padded(range.count);
    ASSERT_LE(next, points.slots());
    int last_key = -1;
    std::int64_t last_id = -1;
    for (std::size_t s = range.begin; s < range.begin + range.count; ++s) {
      const int i = cell(points[X][s]) - Grid::first_x(pb.at[0]);
      const int j = cell(points[Y][s]) - Grid::first_y(pb.at[1]);
      EXPECT_TRUE(i >= 0 && i < block_nx && j >= 0 && j < block_ny) << "in its block";
      const int key = j * block_nx + i;
      EXPECT_GE(key, last_key) << "sorted by cell";
      if (key == last_key) {
        EXPECT_GT(points.id[s], last_id) << "in the former order within a cell";
      }
      last_key = key;
      last_id = points.id[s];
      EXPECT_TRUE(seen.insert(points.id[s]).second) << "once only";
      EXPECT_EQ(points[SZZ][s], static_cast<double>(points.id[s])) << "fields travel together";
    }
    for (std::size_t s = range.begin + range.count; s < next; ++s) {
      EXPECT_EQ(points.id[s], -1) << "padding has no name";
      for (std::size_t f = 0; f < points.fields; ++f)
        EXPECT_EQ(points[f][s], points[f][range.begin + range.count - 1]) << "padding is a copy";
    }
  }
  EXPECT_EQ(next, points.slots());
  EXPECT_EQ(seen.size(), points.count);
  EXPECT_TRUE(seen.empty() || *seen.begin() >= 0);
}

PointSet labelled(PointSet points) {
  for (std::size_t s = 0; s < points.slots(); ++s)
    points.field[SZZ][s] = static_cast<double>(points.id[s]);
  return points;
}

TEST(GridTest, SortsSeveralBodies) {
  Grid grid(h, 40, 20);
  std::vector<PointSet> bodies{labelled(random_points(500, {0, 0}, {10, 5}, 1)),
                               labelled(random_points(37, {2, 1}, {3, 2}, 2)),
                               labelled(no_points())};
  for (int again = 0; again < 2; ++again) {  // a sorted set sorts to itself
    const std::vector<PointSet> before = bodies;
    grid.sort(bodies);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      expect_sorted(grid, bodies[b], b);
      if (again) {
        EXPECT_EQ(bodies[b].id, before[b].id);
      }
    }
  }
}

TEST(GridTest, DropsThePointsWithoutAName) {
  Grid grid(h, 40, 20);
  std::vector<PointSet> bodies{labelled(random_points(300, {0, 0}, {10, 5}, 3))};
  grid.sort(bodies);
  PointSet& points = bodies[0];
  for (std::size_t s = 0; s < points.slots(); ++s)
    if (points.id[s] >= 0 && points.id[s] % 3 == 0) {
      points.id[s] = -1;
      --points.count;
      points.field[X][s] = 1e9;  // wherever it has gone
    }
  grid.sort(bodies);
  expect_sorted(grid, points, 0);
  EXPECT_EQ(points.count, 200U);
  points.id.assign(points.slots(), -1);  // and all of them
  points.count = 0;
  grid.sort(bodies);
  EXPECT_EQ(points.slots(), 0U);
  EXPECT_TRUE(grid.point_blocks.empty() && grid.node_blocks.empty());
}

// Boxes of every width and height against the blocks of 8 × 4 cells, points in the outermost
// places.
TEST(GridTest, EveryBoxHasItsGhosts) {
  for (int nx = 1; nx <= 26; ++nx)
    for (int ny = 1; ny <= 14; ++ny) {
      Grid grid(h, nx, ny);
      std::vector<PointSet> bodies{no_points()};
      const double hair = 1e-9 * h;
      for (const double x : {0.0, hair, nx * h - hair, nx * h})
        for (const double y : {0.0, hair, ny * h - hair, ny * h}) add_point(bodies[0], x, y);
      bodies[0] = labelled(bodies[0]);
      grid.sort(bodies);
      expect_sorted(grid, bodies[0], 0);
      for (std::size_t s = 0; s < bodies[0].slots(); ++s) {
        const int i = cell(bodies[0][X][s]), j = cell(bodies[0][Y][s]);
        // all nodes that a stencil can reach within a cell of drift, the box's ghosts included
        for (int node_j = std::max(j - 2, -1); node_j <= std::min(j + 3, ny + 1); ++node_j)
          for (int node_i = std::max(i - 2, -1); node_i <= std::min(i + 3, nx + 1); ++node_i) {
            const Grid::NodeRef at = grid.node(node_i, node_j);
            ASSERT_NE(at.block, nullptr) << nx << " x " << ny << ": " << node_i << ", " << node_j;
            EXPECT_EQ(Grid::first_x(at.block->at[0]) + static_cast<int>(at.place) % block_nx,
                      node_i);
            EXPECT_EQ(Grid::first_y(at.block->at[1]) + static_cast<int>(at.place) / block_nx,
                      node_j);
          }
      }
    }
}

TEST(GridTest, NeighboursKnowEachOther) {
  Grid grid(h, 100, 50);
  std::vector<PointSet> bodies{random_points(60, {0, 0}, {25, 12.5}, 5)};
  grid.sort(bodies);
  for (std::size_t p = 0; p < grid.point_blocks.size(); ++p)
    for (std::size_t k = 0; k < 9; ++k) {
      const std::int32_t n = grid.point_blocks[p].node_block[k];
      if (n < 0) continue;
      const NodeBlock& nb = grid.node_blocks[static_cast<std::size_t>(n)];
      EXPECT_EQ(nb.at[0], grid.point_blocks[p].at[0] + static_cast<int>(k) % 3 - 1);
      EXPECT_EQ(nb.at[1], grid.point_blocks[p].at[1] + static_cast<int>(k) / 3 - 1);
      EXPECT_EQ(nb.point_block[8 - k], static_cast<std::int32_t>(p));
    }
}

TEST(GridTest, RestoreBringsBackWhatSortMade) {
  Grid grid(h, 40, 20), other(h, 40, 20);
  std::vector<PointSet> bodies{random_points(200, {0, 0}, {10, 5}, 6)};
  grid.sort(bodies);
  std::vector<PointSet> elsewhere{random_points(50, {0, 0}, {10, 5}, 7)};
  other.sort(elsewhere);
  other.restore(grid.point_blocks);
  ASSERT_EQ(other.node_blocks.size(), grid.node_blocks.size());
  EXPECT_EQ(other.tiles.size(), grid.tiles.size());
  for (std::size_t k = 0; k < grid.node_blocks.size(); ++k) {
    EXPECT_EQ(other.node_blocks[k].at[0], grid.node_blocks[k].at[0]);
    EXPECT_EQ(other.node_blocks[k].at[1], grid.node_blocks[k].at[1]);
    EXPECT_EQ(other.node_blocks[k].point_block, grid.node_blocks[k].point_block);
  }
  for (std::size_t k = 0; k < grid.point_blocks.size(); ++k)
    EXPECT_EQ(other.point_blocks[k].node_block, grid.point_blocks[k].node_block);
}

/// Points of a sheet, at least and at most so high and sloped by one cell in three, a cell of drift
/// later: what their stencils touch lies in what their block says that it touches, is alive, and
/// holds all that the tile may hold.
template <class Kernel, int dim>
void expect_touched(double low, double high, std::uint64_t seed) {
  using F = Layout<dim>;
  using S = Shape<dim>;
  constexpr int cells = 40;
  std::array<int, dim> box;
  box.fill(cells);
  GridOf<dim> grid(h, box);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0), sign(-1.0, 1.0);
  std::vector<PointsOf<dim>> bodies(1);
  PointsOf<dim>& points = bodies[0];
  points.fields = F::state;
  for (int n = 0; n < 400; ++n) {
    for (std::size_t f = 0; f < points.fields; ++f) points.field[f].push_back(0.0);
    for (std::size_t a = 0; a < dim; ++a)
      points.field[F::x + a].back() = h * (2.0 + (cells - 4.0) * share(random));
    points.field[F::x + 1].back() =
        points.field[F::x].back() / 3.0 + h * (low + (high - low) * share(random));
    points.id.push_back(n);
    ++points.count;
  }
  grid.sort(bodies, Kernel::anchor_offset);
  std::size_t rows = 0;
  for (const PointBlockOf<dim>& pb : grid.point_blocks) {
    rows += static_cast<std::size_t>(pb.touched[1].end - pb.touched[1].begin);
    for (std::size_t s = pb.range[0].begin; s < pb.range[0].begin + pb.range[0].count; ++s)
      for (int again = 0; again < 8; ++again) {
        std::array<int, dim> first;
        for (std::size_t a = 0; a < dim; ++a)
          first[a] =
              static_cast<int>(Kernel::anchor(points[F::x + a][s] / h + 0.98 * sign(random))) - 1;
        int stencil = 1;
        for (int a = 0; a < dim; ++a) stencil *= Kernel::rows;
        for (int n = 0; n < stencil; ++n) {
          std::array<int, dim> node = first;
          int rest = n;
          for (std::size_t a = 0; a < dim; ++a, rest /= Kernel::rows) {
            node[a] += rest % Kernel::rows;
            const int in_tile = node[a] - GridOf<dim>::first(a, pb.at[a]) + S::margin[a];
            ASSERT_GE(in_tile, pb.touched[a].begin);
            ASSERT_LT(in_tile, pb.touched[a].end);
          }
          const typename GridOf<dim>::NodeRef at = grid.node(node);
          ASSERT_NE(at.block, nullptr);
          ASSERT_TRUE(touched_nodes(grid, *at.block)[at.place]);
        }
      }
  }
  // a row of cells, a cell of drift and the stencil: six rows; and one in three for the slope of a
  // block that it does not cross
  if (high - low <= 1.0) {
    EXPECT_LE(static_cast<double>(rows) / static_cast<double>(grid.point_blocks.size()),
              dim == 2 ? 9.0 : 8.0)
        << "of " << S::tile[1];
  }
}

TEST(GridTest, ABlockSaysWhatItsPointsCanTouch) {
  for (const double high : {3.5, 4.0, 9.0}) {
    expect_touched<CubicKernel, 2>(3.0, high, 11);
    expect_touched<QuadraticKernel, 2>(3.0, high, 12);
    expect_touched<CubicKernel, 3>(3.0, high, 13);
    expect_touched<QuadraticKernel, 3>(3.0, high, 14);
  }
}

/// What is beyond a block's touched part is zero after a sort, whatever the tile held before.
TEST(GridTest, TilesAreZeroWhereNothingTouchesThem) {
  Grid grid(h, 40, 20);
  std::vector<PointSet> bodies{random_points(200, {1, 1}, {9, 4}, 8)};
  grid.sort(bodies);
  for (Tile& tile : grid.tiles)
    for (auto& channel : tile) channel.fill(7.0);
  bodies = {random_points(50, {1, 2}, {9, 2.2}, 9)};
  grid.sort(bodies);
  for (const Tile& tile : grid.tiles)
    for (const auto& channel : tile)
      for (const double value : channel) ASSERT_EQ(value, 0.0);
}

}  // namespace
}  // namespace repose::mpm

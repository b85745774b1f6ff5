/// What frames carry of the grid.

#include "mpm/output/grid_frame.hpp"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

/// A block of fluid that falls in the middle of a box with another number of cells on every side.
Scene falling(std::size_t dimensions) {
  Scene scene;
  scene.name = "falling";
  scene.gravity = 9.8;
  scene.h = 0.1;
  scene.points_per_cell = dimensions == 2 ? 4 : 8;
  scene.domain = {2.0, 1.0, dimensions == 2 ? 0.0 : 1.2};
  scene.end_time = 1.0;
  Body block;
  block.origin = {0.5, 0.4, dimensions == 2 ? 0.0 : 0.4};
  block.size = {0.4, 0.3, dimensions == 2 ? 0.0 : 0.2};
  block.velocity = {0.5, 0.25, dimensions == 2 ? 0.0 : 0.125};
  block.law = newtonian(1.0, 1e4, 1.0, 1000.0);
  block.initial.density = 1000.0;
  scene.bodies = {block};
  return scene;
}

class GridFrameTest : public ::testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, GridFrameTest, ::testing::Values(2, 3));

TEST_P(GridFrameTest, HoldsTheMassAndTheMomentumOfThePoints) {
  Simulation simulation(falling(GetParam()), 1);
  for (int step = 0; step < 10; ++step) simulation.step(1.0);
  GridFrame frame;
  const io::GridView view = frame.view(simulation);
  EXPECT_EQ(view.time_s, simulation.time());
  EXPECT_EQ(view.h_m, 0.1);
  const std::size_t depth = GetParam() == 2 ? 1 : 13;
  EXPECT_EQ(view.nodes, (std::array<std::size_t, 3>{21, 11, depth}));
  ASSERT_EQ(view.scalars.size(), 1U);
  ASSERT_EQ(view.vectors.size(), 1U);
  EXPECT_EQ(view.scalars[0].name, GetParam() == 2 ? "mass_kg_per_m" : "mass_kg");
  EXPECT_EQ(view.vectors[0].name, "velocity_m_per_s");
  const auto mass = view.scalars[0].values;
  const auto& velocity = view.vectors[0];
  ASSERT_EQ(mass.size(), 21 * 11 * depth);
  EXPECT_EQ(velocity.z.size(), GetParam() == 2 ? 0 : mass.size());

  const Simulation::PointFields points = simulation.point_fields();
  const double wanted = std::accumulate(points.mass.begin(), points.mass.end(), 0.0);
  const double found = std::accumulate(mass.begin(), mass.end(), 0.0);
  // Positive terms throughout. A point's weights, products of cubics of dim axes, sum to 1 within
  // some 16 roundings; a node is a sum of the points near it (fewer than n), the total one of the
  // nodes, and the points' own total has n terms: n + nodes + n + 16 roundings of 2^-53 at most.
  const double terms =
      2.0 * static_cast<double>(points.mass.size()) + static_cast<double>(mass.size()) + 16.0;
  EXPECT_NEAR(found / wanted, 1.0, terms * 0x1p-53);

  // Velocities are those after forces: the momentum that the block was thrown with along x, where
  // nothing acts from outside. 10 steps more of as many roundings.
  double momentum = 0.0;
  for (std::size_t n = 0; n < mass.size(); ++n) momentum += mass[n] * velocity.x[n];
  EXPECT_NEAR(momentum / (0.5 * wanted), 1.0, 11.0 * terms * 0x1p-53);
}

TEST_P(GridFrameTest, EveryNodeStandsAtItsPlace) {
  Simulation simulation(falling(GetParam()), 1);
  for (int step = 0; step < 3; ++step) simulation.step(1.0);
  GridFrame frame;
  const io::GridView view = frame.view(simulation);
  const auto [nx, ny, nz] = view.nodes;
  const Simulation::NodeFields fields = simulation.node_fields();
  const std::size_t axes = GetParam();
  std::size_t massive = 0;
  for (std::size_t i = 0; i < nx; ++i)
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t k = 0; k < nz; ++k) {
        const std::size_t there = (i * ny + j) * nz + k, here = i + nx * (j + ny * k);
        ASSERT_EQ(view.scalars[0].values[here], fields.mass[there]);
        ASSERT_EQ(view.vectors[0].x[here], fields.velocity[axes * there]);
        ASSERT_EQ(view.vectors[0].y[here], fields.velocity[axes * there + 1]);
        if (axes == 3) {
          ASSERT_EQ(view.vectors[0].z[here], fields.velocity[axes * there + 2]);
        }
        if (fields.mass[there] == 0.0) continue;
        ++massive;
        // a cubic kernel reaches two cells; three steps move nothing by a tenth of one
        const double x = 0.1 * static_cast<double>(i), y = 0.1 * static_cast<double>(j);
        ASSERT_TRUE(x > 0.29 && x < 1.11 && y > 0.19 && y < 0.91) << x << " " << y;
      }
  EXPECT_GT(massive, 0U);
  EXPECT_LT(massive, view.scalars[0].values.size());  // the rest of the box is zeros
}

TEST_P(GridFrameTest, IsZerosBeforeTheFirstStep) {
  const Simulation simulation(falling(GetParam()), 1);
  GridFrame frame;
  const io::GridView view = frame.view(simulation);
  ASSERT_FALSE(view.scalars[0].values.empty());
  for (const double mass : view.scalars[0].values) ASSERT_EQ(mass, 0.0);
  for (const double v : view.vectors[0].y) ASSERT_EQ(v, 0.0);
}

}  // namespace
}  // namespace repose::mpm

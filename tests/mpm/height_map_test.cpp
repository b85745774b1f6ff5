/// Ground by its heights: the surface between the nodes, and the distance from it.

#include "mpm/scene/height_map.hpp"

#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "mpm/scene/terrain.hpp"

namespace repose::mpm {
namespace {

using Heights = std::function<double(double, double)>;

HeightMap map_of(const Heights& y, double spacing, std::size_t columns, std::size_t rows,
                 std::array<double, 2> first = {0.0, 0.0}) {
  std::vector<double> heights;
  for (std::size_t k = 0; k < rows; ++k)
    for (std::size_t i = 0; i < columns; ++i)
      heights.push_back(y(first[0] + spacing * static_cast<double>(i),
                          first[1] + spacing * static_cast<double>(k)));
  return {first, spacing, columns, rows, std::move(heights)};
}

Solid ground_of(HeightMap map) {
  return {Ground{std::make_shared<const HeightMap>(std::move(map))}, false};
}

// Keys (1981): a = −1/2 reproduces polynomials up to the second degree, here of size 60 and with a
// round-off of some 20 operations.
TEST(HeightMapTest, IsExactForQuadratics) {
  const Heights y = [](double x, double z) {
    return 3.0 + 0.5 * x - 2.0 * z + 0.25 * x * x - 0.1 * x * z + 0.3 * z * z;
  };
  const HeightMap map = map_of(y, 0.7, 20, 16, {-2.0, 1.0});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> at_x(-1.3, 10.6), at_z(1.7, 10.8);
  for (int n = 0; n < 1000; ++n) {
    const double x = at_x(random), z = at_z(random);
    const HeightMap::Sample sample = map.at(x, z);
    EXPECT_NEAR(sample.height, y(x, z), 1e-12);
    EXPECT_NEAR(map.height(x, z), sample.height, 1e-13);
    EXPECT_NEAR(sample.gradient[0], 0.5 + 0.5 * x - 0.1 * z, 1e-12);
    EXPECT_NEAR(sample.gradient[1], -2.0 - 0.1 * x + 0.6 * z, 1e-12);
  }
}

TEST(HeightMapTest, GoesThroughItsNodesAndOnBeyondThem) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  std::vector<double> heights(6 * 5);
  for (double& y : heights) y = any(random);
  const HeightMap map({1.0, 2.0}, 0.5, 6, 5, heights);
  for (std::size_t k = 0; k < 5; ++k)
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(
          map.height(1.0 + 0.5 * static_cast<double>(i), 2.0 + 0.5 * static_cast<double>(k)),
          heights[6 * k + i], 1e-15);
  // straight on for a cell, and then level
  EXPECT_NEAR(map.height(0.5, 2.0), 2.0 * heights[0] - heights[1], 1e-15);
  EXPECT_EQ(map.height(-7.0, 2.0), map.height(0.5, 2.0));
  EXPECT_EQ(map.at(-7.0, 2.0).gradient[0], 0.0);
  // the bound on its slope holds everywhere
  for (int n = 0; n < 10000; ++n) {
    const auto g = map.at(4.0 * any(random), 1.5 + 3.5 * any(random)).gradient;
    EXPECT_LE(std::hypot(g[0], g[1]), map.steepest());
  }
}

TEST(HeightMapTest, OneRowOrColumnWillDo) {
  const HeightMap map({0.0, 0.0}, 1.0, 3, 1, {1.0, 2.0, 3.0});
  EXPECT_EQ(map.height(0.5, -3.0), 1.5);
  EXPECT_EQ(map.height(0.5, 12.0), 1.5);
}

// An inclined plane is the half-space.
TEST(GroundTest, APlaneIsAHalfSpace) {
  const Solid ground =
      ground_of(map_of([](double x, double z) { return 2.0 + 0.6 * x - 0.3 * z; }, 0.5, 40, 40));
  const Solid plane{HalfSpace{{0.0, 2.0, 0.0}, {-0.6, 1.0, 0.3}}, false};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> at(4.0, 15.0), above(-2.0, 2.0);
  for (int n = 0; n < 1000; ++n) {
    Position x{at(random), 0.0, at(random)};
    x[1] = 2.0 + 0.6 * x[0] - 0.3 * x[2] + above(random);
    const Nearest a = nearest(ground, x), b = nearest(plane, x);
    EXPECT_NEAR(a.distance, b.distance, 1e-12);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a.normal[i], b.normal[i], 1e-12);
    EXPECT_EQ(holds(ground, x), b.distance < 0.0);
  }
}

// A bowl of radius R: its distance is R less that from its centre. What the nodes do not tell of
// it, Keys' error of the third order, h³ y‴/16 and less at slopes up to 1 (y‴ < 10/R²), is 2e-4
// here; 4 rounds shorten what lies a distance d away by (d/R)⁸.
TEST(GroundTest, ABowlIsAHollowBall) {
  constexpr double R = 10.0, h = 0.5;
  const Solid ground =
      ground_of(map_of([](double x, double z) { return R - std::sqrt(R * R - x * x - z * z); }, h,
                       25, 25, {-6.0, -6.0}));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> at(-3.5, 3.5), above(-1.5, 1.5);
  double worst = 0.0;
  for (int n = 0; n < 2000; ++n) {
    Position x{at(random), 0.0, at(random)};
    x[1] = R - std::sqrt(R * R - x[0] * x[0] - x[2] * x[2]) + above(random);
    const double exact = R - std::hypot(x[0], x[1] - R, x[2]);
    const Nearest found = nearest(ground, x);
    worst = std::max(worst, std::abs(found.distance - exact));
    EXPECT_EQ(found.distance < 0.0, holds(ground, x));
    EXPECT_NEAR(std::hypot(found.normal[0], found.normal[1], found.normal[2]), 1.0, 1e-14);
    EXPECT_FALSE(is_beyond(ground, x, 1.001 * std::abs(found.distance) + 1e-9));
  }
  std::printf("[ measured ] a bowl of radius %g, nodes %g apart: distances off by %.2g\n", R, h,
              worst);
  EXPECT_LT(worst, h * h * h * 10.0 / (R * R) / 16.0 + std::pow(1.5 / R, 8) * 1.5);
}

io::Raster raster(std::size_t columns, std::size_t rows, double cell, double west, double south,
                  double value) {
  return {columns, rows, west, south, cell, std::vector<double>(columns * rows, value)};
}

TEST(TerrainTest, PutsTheNorthWestAtTheOrigin) {
  Terrain terrain;
  terrain.ground_map = raster(4, 3, 10.0, 500.0, 900.0, 0.0);
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      terrain.ground_map.at(row, column) =
          100.0 + static_cast<double>(column) + 10.0 * static_cast<double>(row);
  terrain.base = 90.0;
  terrain.place();
  EXPECT_NEAR(terrain.ground->height(5.0, 5.0), 10.0, 1e-13);    // the north-western cell
  EXPECT_NEAR(terrain.ground->height(35.0, 25.0), 33.0, 1e-13);  // the south-eastern one
  Terrain shifted = terrain;  // a map of depths of its own, of other cells and extent
  io::Raster depths = raster(2, 2, 5.0, 510.0, 910.0, 0.0);
  depths.at(0, 1) = 3.0;  // easting 515 to 520, northing 915 to 920
  shifted.release_map = depths;
  shifted.place();
  EXPECT_EQ(shifted.release->low(), (std::array<double, 2>{15.0, 10.0}));
  EXPECT_EQ(shifted.release->high(), (std::array<double, 2>{20.0, 15.0}));
  EXPECT_EQ(shifted.release->volume(), 75.0);
}

// Volumes over parts add up to the whole, whatever the parts; round-off of a thousand of them.
TEST(ReleaseTest, IsWholeInParts) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(0.0, 3.0);
  io::Raster depths = raster(7, 5, 3.0, 101.0, 202.0, 0.0);
  for (double& depth : depths.values) depth = std::max(0.0, any(random) - 1.0);
  depths.values[11] = std::nan("");
  const io::Region ring{
      {{101, 202}, {119, 204}, {110, 216}}, {{{108, 206}, {112, 206}, {110, 209}}}, {}};
  const io::Region small{{{118, 210}, {121, 210}, {121, 214}, {118, 214}}, {}, 0.5};
  const double exact_of_regions = 2.0 * (0.5 * (18.0 * 14.0 - 9.0 * 2.0) - 6.0) + 0.5 * 12.0;
  for (const Release& release :
       {Release(depths, 100.0, 220.0), Release({ring, small}, 2.0, 100.0, 220.0)}) {
    double sum = 0.0;
    constexpr double step = 0.83;
    for (double x = release.low()[0] - 1.0; x < release.high()[0]; x += step)
      for (double z = release.low()[1] - 1.0; z < release.high()[1]; z += step)
        sum += release.volume_over({x, z}, {x + step, z + step});
    EXPECT_NEAR(sum, release.volume(), 1e-11);
  }
  EXPECT_NEAR(Release({ring, small}, 2.0, 100.0, 220.0).volume(), exact_of_regions, 1e-11);
}

}  // namespace
}  // namespace repose::mpm

/// The instrument of docs/noise.md, on states that are known exactly.

#include "mpm/output/rest_pressure.hpp"

#include <gtest/gtest.h>

#include "tests/mpm/point_cloud.hpp"

namespace repose::mpm {
namespace {

constexpr double h = 0.1, g = 9.8, rho = 1000.0, width = 2.0, height = 1.5;
constexpr int columns = 40, rows = 30;  // 2 × 2 points per cell

/// A layer from wall to wall, at rest; p(column, row, overburden) is every point's pressure.
template <class F>
std::vector<PointSet> layer(F&& p) {
  PointSet points = no_points();
  points.rho_0 = rho;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double y = (j + 0.5) * 0.5 * h;
      add_point(points, (i + 0.5) * 0.5 * h, y, rho * 0.25 * h * h);
      for (const Field f : {SXX, SYY, SZZ})
        points.field[f].back() = -p(i, j, rho * g * (height - y));
    }
  return {points};
}

RestPressure judged(const std::vector<PointSet>& bodies) {
  return rest_pressure(bodies, h, width, g, 2.0 * h, 0.25);
}

// The weight above a point of a lattice is ρ g × depth to the last bits: ½ of its own height, all
// of the rows above, and columns whose splines add up to one, the images in the walls included.
// 1e-12: a thousand terms, and the fit's condition of about ten.
TEST(RestPressureTest, AHydrostaticLayerDoesNotDeviate) {
  const RestPressure rest = judged(layer([](int, int, double P) { return P; }));
  EXPECT_EQ(rest.points, columns * (rows - 4)) << "the upper 2h are left out";
  EXPECT_NEAR(rest.largest_overburden, rho * g * (height - 0.25 * h), 1e-12 * rho * g * height);
  EXPECT_LT(rest.pressure.total, 1e-12);
  EXPECT_LT(rest.vertical.total, 1e-12);
  EXPECT_LT(rest.pressure.noise, 1e-12);
  EXPECT_NEAR(rest.mean_ratio, 1.0, 1e-12);
  EXPECT_NEAR(rest.floor_ratio, 1.0, 1e-12);
}

TEST(RestPressureTest, AFactorIsSmooth) {
  const RestPressure rest = judged(layer([](int, int, double P) { return 0.8 * P; }));
  EXPECT_NEAR(rest.pressure.smooth, 0.2, 1e-12);
  EXPECT_NEAR(rest.pressure.total, 0.2, 1e-12);
  EXPECT_LT(rest.pressure.noise, 1e-12);
  EXPECT_NEAR(rest.floor_vertical_ratio, 0.8, 1e-12);
}

// A checkerboard of points is invisible to a spline of twice its spacing, except where the fit is
// one-sided: within 2h of the floor and the side walls, 24 % of the points. There it follows the
// pattern by at most the weight of the point itself in its fit, below a half.
TEST(RestPressureTest, ACheckerboardIsNoise) {
  const double a = 0.1;
  const RestPressure rest = judged(layer([&](int i, int j, double P) {
    return P + ((i + j) % 2 == 0 ? a : -a) * rho * g * (height - 0.25 * h);
  }));
  EXPECT_NEAR(rest.pressure_of_largest.total, a, 1e-12);
  EXPECT_NEAR(rest.pressure_of_largest.noise, a, 0.24 * 0.5 * a);
  EXPECT_LT(rest.pressure_of_largest.smooth, std::sqrt(0.24) * 0.5 * a);
}

// What stands less than a quarter as deep as the deepest column is toe, and not judged.
TEST(RestPressureTest, LeavesTheToeOut) {
  std::vector<PointSet> bodies = layer([](int, int, double P) { return P; });
  PointSet& points = bodies[0];
  for (std::size_t s = 0; s < points.count; ++s)
    if (points.field[X][s] > 0.5 * width && points.field[Y][s] > 0.2 * height) points.id[s] = -1;
  const RestPressure rest = judged(bodies);
  // columns within 2h of the step see some of the high side
  EXPECT_GE(rest.points, columns / 2 * (rows - 4));
  EXPECT_LE(rest.points, columns / 2 * (rows - 4) + 4 * rows);
}

TEST(RestPressureTest, NothingToJudgeIsNotANumber) {
  const RestPressure rest = judged({no_points()});
  EXPECT_EQ(rest.points, 0);
  EXPECT_TRUE(std::isnan(rest.pressure.total));
}

}  // namespace
}  // namespace repose::mpm

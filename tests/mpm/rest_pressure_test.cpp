/// The instrument of docs/noise.md, on states that are known exactly.

#include "mpm/output/rest_pressure.hpp"

#include <gtest/gtest.h>

namespace repose::mpm {
namespace {

constexpr double h = 0.1, g = 9.8, rho = 1000.0, width = 2.0, height = 1.5;
constexpr int columns = 40, rows = 30;  // 2 × 2 points per cell

/// A layer from wall to wall, at rest; p(column, row, overburden) is every point's pressure.
template <class F>
Simulation::Snapshot layer(F&& p) {
  Simulation::Snapshot points;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double y = (j + 0.5) * 0.5 * h;
      const double pressure = p(i, j, rho * g * (height - y));
      points.x_m.push_back((i + 0.5) * 0.5 * h);
      points.y_m.push_back(y);
      points.mass.push_back(rho * 0.25 * h * h);
      points.density.push_back(rho);
      points.pressure_Pa.push_back(pressure);
      points.syy.push_back(-pressure);
      points.body.push_back(0);
    }
  return points;
}

RestPressure judged(const Simulation::Snapshot& points) {
  return rest_pressure(points, {rho}, h, width, g, 2.0 * h, 0.25);
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
  const Simulation::Snapshot whole = layer([](int, int, double P) { return P; });
  Simulation::Snapshot step;
  for (std::size_t k = 0; k < whole.x_m.size(); ++k) {
    if (whole.x_m[k] > 0.5 * width && whole.y_m[k] > 0.2 * height) continue;
    using Column = std::vector<double> Simulation::Snapshot::*;
    for (const Column column : {&Simulation::Snapshot::x_m, &Simulation::Snapshot::y_m,
                                &Simulation::Snapshot::mass, &Simulation::Snapshot::density,
                                &Simulation::Snapshot::pressure_Pa, &Simulation::Snapshot::syy})
      (step.*column).push_back((whole.*column)[k]);
    step.body.push_back(0);
  }
  const RestPressure rest = judged(step);
  // columns within 2h of the step see some of the high side
  EXPECT_GE(rest.points, columns / 2 * (rows - 4));
  EXPECT_LE(rest.points, columns / 2 * (rows - 4) + 4 * rows);
}

TEST(RestPressureTest, NothingToJudgeIsNotANumber) {
  const RestPressure rest = judged({});
  EXPECT_EQ(rest.points, 0);
  EXPECT_TRUE(std::isnan(rest.pressure.total));
}

}  // namespace
}  // namespace repose::mpm

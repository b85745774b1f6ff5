#include "mpm/deposit.hpp"

#include <gtest/gtest.h>

#include "tests/mpm/point_cloud.hpp"

namespace repose::mpm {
namespace {

constexpr double h = 0.5;
constexpr double rho_0 = 1000.0;

std::vector<PointSet> bodies_of(const std::vector<std::array<double, 2>>& x_and_mass) {
  PointSet points = no_points();
  points.rho_0 = rho_0;
  for (const auto& [x, mass] : x_and_mass) add_point(points, x, 0.3, mass);
  return {points};
}

TEST(DepositTest, SharesAPointBetweenTheNearestColumns) {
  // 100 kg/m of 1000 kg/m³ on a column 0.5 m wide: 0.2 m, a quarter of it to the farther column
  const Deposit deposit(bodies_of({{{1.125, 100.0}}}), h, 6);
  ASSERT_EQ(deposit.depth.size(), 7U);
  const double expected[] = {0.0, 0.0, 0.15, 0.05, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < 7; ++i) EXPECT_DOUBLE_EQ(deposit.depth[i], expected[i]) << i;
}

TEST(DepositTest, EndColumnsAreHalfAsWide) {
  // a uniform layer of 0.4 m is 0.4 m deep everywhere: points at the middles of half cells
  std::vector<std::array<double, 2>> layer;
  for (int k = 0; k < 12; ++k) layer.push_back({(k + 0.5) * 0.25, 0.25 * 0.4 * rho_0});
  const Deposit deposit(bodies_of(layer), h, 6);
  for (const double depth : deposit.depth) EXPECT_NEAR(depth, 0.4, 1e-15);
  // and the trapezoidal rule over the columns gives the mass back
  EXPECT_EQ(deposit.front(0.3), 3.0) << "up to the end of the box";
}

TEST(DepositTest, EachBodyByItsOwnReferenceDensity) {
  std::vector<PointSet> bodies = bodies_of({{{1.0, 100.0}}});
  bodies.push_back(bodies_of({{{1.0, 100.0}}})[0]);
  bodies[1].rho_0 = 500.0;
  EXPECT_DOUBLE_EQ(Deposit(bodies, h, 6).depth[2], 0.2 + 0.4);
}

TEST(DepositTest, IgnoresPadding) {
  std::vector<PointSet> bodies = bodies_of({{{1.0, 100.0}}, {{2.0, 100.0}}});
  bodies[0].id[1] = -1;
  const Deposit deposit(bodies, h, 6);
  EXPECT_DOUBLE_EQ(deposit.depth[2], 0.2);
  EXPECT_EQ(deposit.depth[4], 0.0);
}

TEST(DepositTest, FrontIsWhereTheDepthLastReachesTheThreshold) {
  // depths 0.4 at x = 0.5, 0.05 at 1.0, 0.2 at 1.5, 0 beyond
  const Deposit deposit(bodies_of({{{0.5, 200.0}}, {{1.0, 25.0}}, {{1.5, 100.0}}}), h, 6);
  EXPECT_DOUBLE_EQ(deposit.front(0.1), 1.75) << "half way down from 0.2 to 0";
  EXPECT_DOUBLE_EQ(deposit.front(0.3), 0.5 + 0.5 * (0.1 / 0.35)) << "the high one is far behind";
  EXPECT_EQ(deposit.front(0.5), 0.0) << "never";
}

TEST(DepositTest, WhatHasLeftTheBoxIsSeenAtItsEdge) {
  const Deposit deposit(bodies_of({{{-0.2, 50.0}}, {{3.4, 50.0}}}), h, 6);
  EXPECT_DOUBLE_EQ(deposit.depth.front(), 0.2);
  EXPECT_DOUBLE_EQ(deposit.depth.back(), 0.2);
}

}  // namespace
}  // namespace repose::mpm

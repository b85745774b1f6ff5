#include "mpm/output/deposit.hpp"

#include <algorithm>

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
  const Deposit deposit(bodies_of({{{1.125, 100.0}}}), h, 6, false);
  ASSERT_EQ(deposit.depth.size(), 7U);
  const double expected[] = {0.0, 0.0, 0.15, 0.05, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < 7; ++i) EXPECT_DOUBLE_EQ(deposit.depth[i], expected[i]) << i;
}

TEST(DepositTest, EndColumnsAreHalfAsWide) {
  // a uniform layer of 0.4 m is 0.4 m deep everywhere: points at the middles of half cells
  std::vector<std::array<double, 2>> layer;
  for (int k = 0; k < 12; ++k) layer.push_back({(k + 0.5) * 0.25, 0.25 * 0.4 * rho_0});
  const Deposit deposit(bodies_of(layer), h, 6, false);
  for (const double depth : deposit.depth) EXPECT_NEAR(depth, 0.4, 1e-15);
  // and the trapezoidal rule over the columns gives the mass back
  EXPECT_EQ(deposit.front(0.3), 3.0) << "up to the end of the box";
}

TEST(DepositTest, EachBodyByItsOwnReferenceDensity) {
  std::vector<PointSet> bodies = bodies_of({{{1.0, 100.0}}});
  bodies.push_back(bodies_of({{{1.0, 100.0}}})[0]);
  bodies[1].rho_0 = 500.0;
  EXPECT_DOUBLE_EQ(Deposit(bodies, h, 6, false).depth[2], 0.2 + 0.4);
}

TEST(DepositTest, IgnoresPadding) {
  std::vector<PointSet> bodies = bodies_of({{{1.0, 100.0}}, {{2.0, 100.0}}});
  bodies[0].id[1] = -1;
  const Deposit deposit(bodies, h, 6, false);
  EXPECT_DOUBLE_EQ(deposit.depth[2], 0.2);
  EXPECT_EQ(deposit.depth[4], 0.0);
}

TEST(DepositTest, FrontIsWhereTheDepthLastReachesTheThreshold) {
  // depths 0.4 at x = 0.5, 0.05 at 1.0, 0.2 at 1.5, 0 beyond
  const Deposit deposit(bodies_of({{{0.5, 200.0}}, {{1.0, 25.0}}, {{1.5, 100.0}}}), h, 6, false);
  EXPECT_DOUBLE_EQ(deposit.front(0.1), 1.75) << "half way down from 0.2 to 0";
  EXPECT_DOUBLE_EQ(deposit.front(0.3), 0.5 + 0.5 * (0.1 / 0.35)) << "the high one is far behind";
  EXPECT_EQ(deposit.front(0.5), 0.0) << "never";
}

TEST(DepositTest, WhatHasLeftTheBoxIsSeenAtItsEdge) {
  const Deposit deposit(bodies_of({{{-0.2, 50.0}}, {{3.4, 50.0}}}), h, 6, false);
  EXPECT_DOUBLE_EQ(deposit.depth.front(), 0.2);
  EXPECT_DOUBLE_EQ(deposit.depth.back(), 0.2);
}

TEST(DepositTest, PeriodicEdgesAreOneColumn) {
  // the same uniform layer, one of its points not yet brought back through the left edge
  std::vector<std::array<double, 2>> layer;
  for (int k = 0; k < 12; ++k) layer.push_back({(k + 0.5) * 0.25, 0.25 * 0.4 * rho_0});
  layer[11][0] -= 3.0;
  const Deposit deposit(bodies_of(layer), h, 6, true);
  for (const double depth : deposit.depth) EXPECT_NEAR(depth, 0.4, 1e-15);
  // a point beside the edge is seen at both ends, by its share of the whole column
  const Deposit edge(bodies_of({{{2.875, 100.0}}}), h, 6, true);
  EXPECT_DOUBLE_EQ(edge.depth.front(), 0.15);
  EXPECT_DOUBLE_EQ(edge.depth.back(), 0.15);
}

constexpr double width = 3.0;

TEST(MassFrontTest, LiesBetweenPointsOfEqualMass) {
  // ten of 100 kg/m at 0.1, 0.2, … 1.0 m: 75 % is the middle of the eighth; 80 % half way on
  std::vector<std::array<double, 2>> row;
  for (int k = 10; k > 0; --k) row.push_back({0.1 * k, 100.0});
  const std::vector<PointSet> bodies = bodies_of(row);
  EXPECT_NEAR(mass_front(bodies, width, 0.75, false), 0.8, 1e-15);
  EXPECT_NEAR(mass_front(bodies, width, 0.80, false), 0.85, 1e-15);
  EXPECT_NEAR(mass_front(bodies, width, 0.99, false), 1.0, 1e-15) << "within the last point";
  EXPECT_EQ(mass_front(bodies_of({}), width, 0.99, false), 0.0);
}

TEST(MassFrontTest, IsContinuousWherePointsPassEachOther) {
  // A light point overtakes the heavy one that holds the mark: no jump, whoever is first. Moving
  // one of two points by 2e-9 moves a weighted mean of positions by no more than that.
  const auto at = [](double x) {
    return mass_front(bodies_of({{{0.2, 100.0}}, {{1.0, 300.0}}, {{x, 40.0}}, {{1.4, 60.0}}}),
                      width, 0.75, false);
  };
  EXPECT_LE(std::abs(at(1.0 + 1e-9) - at(1.0 - 1e-9)), 2e-9);
  EXPECT_GT(at(1.2), at(0.8)) << "it counts on which side the light one is";
}

TEST(MassFrontTest, DoesNotDependOnTheOrderOfThePoints) {
  std::vector<std::array<double, 2>> cloud;
  for (int k = 0; k < 100; ++k) cloud.push_back({0.03 * ((k * 37) % 100), 100.0});
  const double front = mass_front(bodies_of(cloud), width, 0.9, false);
  std::reverse(cloud.begin(), cloud.end());
  EXPECT_EQ(mass_front(bodies_of(cloud), width, 0.9, false), front);
}

TEST(MassFrontTest, CountsWhatHasLeftAtTheEdgeAndPeriodicTurnsNot) {
  const std::vector<PointSet> bodies = bodies_of({{{0.5, 100.0}}, {{3.25, 100.0}}});
  EXPECT_EQ(mass_front(bodies, width, 0.75, false), width);
  EXPECT_EQ(mass_front(bodies, width, 0.75, true), 0.5);
}

}  // namespace
}  // namespace repose::mpm

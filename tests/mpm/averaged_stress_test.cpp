/// The stress that frames and pictures show.

#include "mpm/output/averaged_stress.hpp"

#include <gtest/gtest.h>

#include "models/sym.hpp"
#include "mpm/output/rest_pressure.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

constexpr double h = 0.1;

/// A lattice of 2 (in space 2³) points per cell and direction, `cells` wide, moved off its places
/// by up to `disorder` of their distance; stress(x, y, z) of every point, isotropic but for xy.
template <class F>
Simulation::Snapshot lattice(int dim, int cells, double disorder, F&& stress) {
  Simulation::Snapshot points;
  std::uint32_t seed = 1;
  const auto any = [&] {  // a linear congruential generator (Numerical Recipes), in (−1, 1)
    seed = 1664525u * seed + 1013904223u;
    return static_cast<double>(seed) / 2147483648.0 - 1.0;
  };
  const int n = 2 * cells;
  for (int k = 0; k < (dim == 2 ? 1 : n); ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double x = (i + 0.5 + disorder * any()) * 0.5 * h;
        const double y = (j + 0.5 + disorder * any()) * 0.5 * h;
        const double z = (k + 0.5 + disorder * any()) * 0.5 * h;
        const double p = stress(x, y, dim == 2 ? 0.0 : z);
        points.x_m.push_back(x);
        points.y_m.push_back(y);
        if (dim == 3) points.z_m.push_back(z);
        points.mass.push_back(1.0 + 0.2 * any());
        for (auto* column : {&points.sxx, &points.syy, &points.szz}) column->push_back(-p);
        points.sxy.push_back(0.3 * p);
        if (dim == 3)
          for (auto* column : {&points.syz, &points.szx}) column->push_back(0.1 * p);
        points.pressure_Pa.push_back(p);
        points.mises_Pa.push_back(0.0);
        points.body.push_back(0);
      }
  return points;
}

class AveragedStressTest : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, AveragedStressTest, ::testing::Values(2, 3));

// 1e-14: sums of 64 weights, each with a rounding or two.
TEST_P(AveragedStressTest, KeepsWhatIsUniformUpToTheSurface) {
  Simulation::Snapshot points = lattice(GetParam(), 6, 0.4, [](auto...) { return 2.0; });
  average_stress(points, h);
  for (std::size_t k = 0; k < points.x_m.size(); ++k) {
    EXPECT_NEAR(points.pressure_Pa[k], 2.0, 2.0 * 1e-14);
    EXPECT_NEAR(points.sxy[k], 0.6, 1e-14);
    // √(3/2 s:s), s:s = 2 s_xy² and in space 2 (s_yz² + s_zx²) more
    const double shear2 = 0.36 + (GetParam() == 3 ? 0.08 : 0.0);
    EXPECT_NEAR(points.mises_Pa[k], std::sqrt(3.0 * shear2), 1e-13);
  }
}

// A convex combination with Σ m σ̄ = Σ m σ. 1e-12: sums of some 2000 terms of order one.
TEST_P(AveragedStressTest, KeepsTheSumAndTheBounds) {
  const auto wild = [](double x, double y, double z) {
    return 1.5 + std::sin(170.0 * x) * std::cos(230.0 * y) + 0.4 * std::sin(90.0 * z);
  };
  const Simulation::Snapshot before = lattice(GetParam(), 6, 0.4, wild);
  Simulation::Snapshot after = before;
  average_stress(after, h);
  const auto [least, most] =
      std::minmax_element(before.pressure_Pa.begin(), before.pressure_Pa.end());
  double sum_before = 0.0, sum_after = 0.0, change = 0.0;
  for (std::size_t k = 0; k < before.x_m.size(); ++k) {
    sum_before += before.mass[k] * before.pressure_Pa[k];
    sum_after += after.mass[k] * after.pressure_Pa[k];
    change += std::abs(after.pressure_Pa[k] - before.pressure_Pa[k]);
    EXPECT_GT(after.pressure_Pa[k], *least);
    EXPECT_LT(after.pressure_Pa[k], *most);
  }
  EXPECT_NEAR(sum_after / sum_before, 1.0, 1e-12);
  EXPECT_GT(change, 0.2 * static_cast<double>(before.x_m.size())) << "of deviations of a half";
}

// Equal masses on a lattice lie evenly around every node and every point: eight cells from the edge
// (four times the spline's half width) a gradient stays. 1e-13: coordinates of order one.
TEST_P(AveragedStressTest, KeepsAGradientAwayFromSurfaces) {
  const auto linear = [](double x, double y, double z) { return 3.0 + x - 2.0 * y + 0.5 * z; };
  const int cells = 18;
  Simulation::Snapshot points = lattice(GetParam(), cells, 0.0, linear);
  std::fill(points.mass.begin(), points.mass.end(), 1.0);
  const std::vector<double> exact = points.pressure_Pa;
  average_stress(points, h);
  int inside = 0;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    const auto deep = [&](double x) { return x > 8.0 * h && x < (cells - 8) * h; };
    if (!deep(points.x_m[k]) || !deep(points.y_m[k])) continue;
    if (GetParam() == 3 && !deep(points.z_m[k])) continue;
    EXPECT_NEAR(points.pressure_Pa[k], exact[k], 1e-13);
    ++inside;
  }
  EXPECT_EQ(inside, GetParam() == 2 ? 16 : 64);
}

// Points of two bodies in the same cells know nothing of each other.
TEST(AveragedStressTest, BodiesStayApart) {
  Simulation::Snapshot points = lattice(2, 6, 0.2, [](auto...) { return 1.0; });
  for (std::size_t k = 0; k < points.body.size(); k += 2) {
    points.body[k] = 1;
    for (auto* column : {&points.sxx, &points.syy, &points.szz}) (*column)[k] = -5.0;
  }
  average_stress(points, h);
  for (std::size_t k = 0; k < points.body.size(); ++k)
    EXPECT_NEAR(points.pressure_Pa[k], points.body[k] == 1 ? 5.0 : 1.0, 5e-14);
}

TEST(AveragedStressTest, APointAloneKeepsItsStressAndNoneIsNoTrouble) {
  Simulation::Snapshot alone = lattice(2, 1, 0.0, [](auto...) { return 7.0; });
  for (auto* column : {&alone.x_m, &alone.y_m, &alone.mass, &alone.sxx, &alone.syy, &alone.szz,
                       &alone.sxy, &alone.pressure_Pa, &alone.mises_Pa})
    column->resize(1);
  alone.body.resize(1);
  average_stress(alone, h);
  EXPECT_NEAR(alone.pressure_Pa[0], 7.0, 7e-14);
  Simulation::Snapshot none;
  average_stress(none, h);
  EXPECT_TRUE(none.pressure_Pa.empty());
}

}  // namespace
}  // namespace repose::mpm

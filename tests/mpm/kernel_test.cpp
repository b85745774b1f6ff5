#include "mpm/grid/kernel.hpp"

#include <array>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace repose::mpm {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

std::array<double, 4> values(const Row& row) {
  std::array<double, 4> x{};
  row.store_unaligned(x.data());
  return x;
}

/// Weights and offsets of a point in one direction, with the index of the stencil's first node.
struct Stencil {
  int base;
  std::array<double, 4> w, d;
};
template <class K>
Stencil stencil_at(double xi) {
  const double anchor = K::anchor(xi);
  const Weights at = K::of_point(xi - anchor, 0.0);
  return {static_cast<int>(anchor) - 1, values(at.w.x()), values(at.d.x())};
}

/// The B-splines written as their textbooks do, in the distance from the node.
double spline(CubicKernel, double d) {
  const double r = std::abs(d);
  if (r < 1.0) return 2.0 / 3.0 - r * r + 0.5 * r * r * r;
  return r < 2.0 ? (2.0 - r) * (2.0 - r) * (2.0 - r) / 6.0 : 0.0;
}
double spline(QuadraticKernel, double d) {
  const double r = std::abs(d);
  if (r < 0.5) return 0.75 - r * r;
  return r < 1.5 ? 0.5 * (1.5 - r) * (1.5 - r) : 0.0;
}

template <class K>
class KernelTest : public ::testing::Test {
 protected:
  /// Random positions on both sides of 0, and every place where the polynomials join.
  static std::vector<double> positions() {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> anywhere(-5.0, 200.0);
    std::vector<double> xi;
    for (int k = 0; k < 2000; ++k) xi.push_back(anywhere(random));
    for (const double joint : {-1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 7.0, 7.5, 8.0, 191.5, 192.0})
      for (const double near : {joint, std::nextafter(joint, -9e9), std::nextafter(joint, 9e9)})
        xi.push_back(near);
    return xi;
  }
};
using Kernels = ::testing::Types<CubicKernel, QuadraticKernel>;
TYPED_TEST_SUITE(KernelTest, Kernels);

TYPED_TEST(KernelTest, IsTheBSpline) {
  for (const double xi : this->positions()) {
    const auto [base, w, offset] = stencil_at<TypeParam>(xi);
    for (int k = 0; k < stencil_width; ++k) {
      const double d = base + k - xi;
      const double expected = k < TypeParam::rows ? spline(TypeParam{}, d) : 0.0;
      // four products of size <= 1 and the rounding of ξ − cell: 8 eps
      EXPECT_NEAR(w[static_cast<std::size_t>(k)], expected, 8 * eps) << "xi = " << xi;
    }
  }
}

// dw/dξ against the weights themselves: a central difference of a cubic is off by h² w'''/6 (h² at
// most, as |w'''| <= 3 < 6) and by the rounding of w over h; one slope per node and all of a
// stencil.
TYPED_TEST(KernelTest, SlopesAreTheDerivativesOfTheWeights) {
  constexpr double h = 1e-5;
  for (const double xi : this->positions()) {
    const double t = xi - TypeParam::anchor(xi);
    const auto slopes = TypeParam::slopes(t);
    const auto up = TypeParam::weights(t + h), down = TypeParam::weights(t - h);
    const auto all = values(TypeParam::slopes_of_point(t, 0.0).x());
    double sum = 0.0;
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      EXPECT_NEAR(slopes[k], (up[k] - down[k]) / (2.0 * h), h * h + 4.0 * eps / h) << "xi = " << xi;
      EXPECT_NEAR(all[k], slopes[k], 8.0 * eps) << "xi = " << xi;
      sum += slopes[k];
    }
    EXPECT_NEAR(sum, 0.0, 8.0 * eps) << "xi = " << xi;
  }
}

TYPED_TEST(KernelTest, MomentsOfOrderZeroToTwo) {
  for (const double xi : this->positions()) {
    const auto [base, w, d] = stencil_at<TypeParam>(xi);
    double unity = 0.0, first = 0.0, second = 0.0;
    for (std::size_t k = 0; k < TypeParam::rows; ++k) {
      unity += w[k];
      first += w[k] * d[k];
      second += w[k] * d[k] * d[k];
    }
    // sums of four terms of size <= |d|^n, |d| <= 2, each off by a few eps
    EXPECT_NEAR(unity, 1.0, 4 * eps) << "xi = " << xi;
    EXPECT_NEAR(first, 0.0, 8 * eps) << "xi = " << xi;
    EXPECT_NEAR(second * TypeParam::inverse_moment, 1.0, 16 * TypeParam::inverse_moment * eps)
        << "xi = " << xi;
  }
}

TYPED_TEST(KernelTest, PositiveAndTheIdleLaneIsZero) {
  for (const double xi : this->positions()) {
    const auto w = stencil_at<TypeParam>(xi).w;
    // at the end of its support a weight is a sum of terms <= 1 that cancel: ± 2 eps
    for (std::size_t k = 0; k < 4; ++k) EXPECT_GE(w[k], -2 * eps) << "xi = " << xi;
    if (TypeParam::rows == 3) {
      EXPECT_EQ(w[3], 0.0);
    }
  }
}

TYPED_TEST(KernelTest, StencilHoldsTheWholeSupport) {
  // (rows + 1)/2 nodes to either side at most: what the tile's margins are made for
  for (const double xi : this->positions()) {
    const int base = stencil_at<TypeParam>(xi).base;
    EXPECT_LE(base, xi - 0.5 * (TypeParam::rows - 2) + eps * 200);
    EXPECT_GE(base, xi - 0.5 * TypeParam::rows - eps * 200);
  }
}

// The rows of x and y, their repetition and spreading over a register that holds two of them, and
// the weights of whole packs of points are the same weights.
TYPED_TEST(KernelTest, EveryShapeHoldsTheSameWeights) {
  const auto positions = this->positions();
  for (std::size_t n = 0; n + Pack::size <= positions.size(); n += Pack::size) {
    const Pack xi = Pack::load_unaligned(positions.data() + n);
    const Pack anchor = TypeParam::anchor(xi);
    const auto packs = TypeParam::weights(Pack(xi - anchor));
    for (std::size_t lane = 0; lane < Pack::size; ++lane) {
      const Stencil x = stencil_at<TypeParam>(positions[n + lane]);
      for (std::size_t k = 0; k < 4; ++k) {
        alignas(64) double w[Pack::size];
        packs[k].store_aligned(w);
        // two polynomials of the same value, terms of size <= 1: 8 eps each
        EXPECT_NEAR(w[lane], x.w[k], 16 * eps);
      }
      const double t = positions[n] - TypeParam::anchor(positions[n]);
      const double t_lane = positions[n + lane] - TypeParam::anchor(positions[n + lane]);
      const Weights both = TypeParam::of_point(t, t_lane);
      EXPECT_EQ(values(both.w.y()), x.w);
      EXPECT_EQ(values(both.d.y()), x.d);
#if defined(__AVX512F__)
      alignas(64) double repeated[Pack::size], spread[Pack::size];
      both.w.x_repeated().store_aligned(repeated);
      both.w.template y_spread<2>().store_aligned(spread);
      for (std::size_t k = 0; k < Pack::size; ++k) {
        EXPECT_EQ(repeated[k], values(both.w.x())[k % 4]);
        EXPECT_EQ(spread[k], x.w[2 + k / 4]);
      }
#endif
    }
  }
}

/// Row r holds 10 r + 1 … 10 r + 4.
Row numbered(std::size_t r) {
  std::array<double, 4> x;
  for (std::size_t k = 0; k < 4; ++k)
    x[k] = 10.0 * static_cast<double>(r) + static_cast<double>(k) + 1.0;
  return Row::load_unaligned(x.data());
}

TEST(Rows, ChangePlacesWithTheirLanes) {
  std::array<Row, 4> rows{numbered(0), numbered(1), numbered(2), numbered(3)};
  transpose(rows);
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t lane = 0; lane < 4; ++lane)
      EXPECT_EQ(values(rows[k])[lane], values(numbered(lane))[k]) << k << " " << lane;
}

TEST(Rows, ColumnsHoldALaneOfEachPoint) {
  std::array<Row, RowPoints::size> rows;
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = numbered(k);
  const auto columns = columns_of(rows);
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<double, RowPoints::size> column;
    columns[k].store_unaligned(column.data());
    for (std::size_t point = 0; point < rows.size(); ++point)
      EXPECT_EQ(column[point], values(numbered(point))[k]) << k << " " << point;
  }
}

TEST(Rows, AreSummedEachIntoItsLane) {  // whole numbers: exact in any order
  EXPECT_EQ(values(sums_of({numbered(0), numbered(1), numbered(2), numbered(3)})),
            (std::array<double, 4>{10.0, 50.0, 90.0, 130.0}));
}

TEST(Rows, AreMultipliedAndAddedInOneRounding) {
  // (1 + ε)(1 − ε) − 1 = −ε², which is lost where the product is rounded
  const Row left({1.0 + eps, 2.0, 3.0, 1.0 + eps}), right({1.0 - eps, 5.0, 7.0, 1.0 - eps});
  const Row sum = fma(left, right, Row({-1.0, 1.0, -1.0, -1.0}));
  EXPECT_EQ(values(sum), (std::array<double, 4>{-eps * eps, 11.0, 20.0, -eps * eps}));
}

TEST(Rows, AreRoundedDown) {
  using std::floor;
  EXPECT_EQ(values(Row(floor(Row({-0.5, 0.5, -2.0, 3.999})))),
            (std::array<double, 4>{-1.0, 0.0, -2.0, 3.0}));
}

TEST(Rows, AreStoredAsTheyWereLoaded) {
  alignas(Row) const std::array<double, 4> given{1.0, 2.0, 3.0, 4.0};
  alignas(Row) std::array<double, 4> aligned{};
  alignas(Row) std::array<double, 5> shifted{};
  Row::load_aligned(given.data()).store_aligned(aligned.data());
  Row::load_unaligned(given.data()).store_unaligned(shifted.data() + 1);
  EXPECT_EQ(aligned, given);
  EXPECT_EQ(shifted, (std::array<double, 5>{0.0, 1.0, 2.0, 3.0, 4.0}));
  EXPECT_EQ(values(Row({1.0, 2.0, 3.0, 4.0})), given);
}

}  // namespace
}  // namespace repose::mpm

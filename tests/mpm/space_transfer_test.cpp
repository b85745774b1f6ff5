/// The transfers in three dimensions against their formulas, one point and one node at a time.

#include <map>
#include <random>

#include <gtest/gtest.h>

#include "mpm/step/row_sums.hpp"
#include "mpm/step/transfer.hpp"

namespace repose::mpm {
namespace {

using Vector = std::array<double, 3>;
using F = Layout<3>;
using C = Channels<3>;
using S = Shape<3>;

constexpr double h = 0.25;
/// A block in the middle of nowhere and its tile.
constexpr std::array<int, 3> first_cell{16, 8, 12};
constexpr std::array<int, 3> origin{first_cell[0] - S::margin[0], first_cell[1] - S::margin[1],
                                    first_cell[2] - S::margin[2]};

/// A kernel as its formula stands in a paper.
template <class K>
struct Formula {
  static constexpr bool cubic = K::rows == 4;
  static constexpr double moment = h * h / (cubic ? 3.0 : 4.0);
  static double weight(double d) {
    const double r = std::abs(d);
    if (cubic) {
      if (r < 1.0) return 2.0 / 3.0 - r * r + 0.5 * r * r * r;
      return r < 2.0 ? (2.0 - r) * (2.0 - r) * (2.0 - r) / 6.0 : 0.0;
    }
    if (r < 0.5) return 0.75 - r * r;
    return r < 1.5 ? 0.5 * (1.5 - r) * (1.5 - r) : 0.0;
  }
  /// dw/dx of a point at −d h from its node.
  static double slope(double d) {
    const double r = std::abs(d);
    double dw_dr = 0.0;
    if (cubic)
      dw_dr = r < 1.0 ? (1.5 * r - 2.0) * r : r < 2.0 ? -0.5 * (2.0 - r) * (2.0 - r) : 0.0;
    else
      dw_dr = r < 0.5 ? -2.0 * r : r < 1.5 ? r - 1.5 : 0.0;
    return (d > 0.0 ? -dw_dr : dw_dr) / h;
  }
  /// Calls f(node, w, x_i − x, g), g what the node's velocity brings to the gradient.
  template <class G>
  static void each_node(const Vector& x, G&& f) {
    std::array<int, 3> first{};
    for (std::size_t a = 0; a < 3; ++a) first[a] = static_cast<int>(std::floor(x[a] / h)) - 1;
    for (int k = first[2]; k < first[2] + 4; ++k)
      for (int j = first[1]; j < first[1] + 4; ++j)
        for (int i = first[0]; i < first[0] + 4; ++i) {
          const std::array<int, 3> node{i, j, k};
          Vector w{}, s{}, d{}, g{};
          for (std::size_t a = 0; a < 3; ++a) {
            d[a] = node[a] * h - x[a];
            w[a] = weight(d[a] / h);
            s[a] = slope(d[a] / h);
          }
          const double product = w[0] * w[1] * w[2];
          for (std::size_t a = 0; a < 3; ++a)
            g[a] = K::spline_gradient ? s[a] * w[(a + 1) % 3] * w[(a + 2) % 3]
                                      : product * d[a] / moment;
          f(node, product, d, g);
        }
  }
};

Vector place_of(std::size_t n) {
  const int at = static_cast<int>(n);
  return {(origin[0] + at % S::tile[0]) * h, (origin[1] + at / S::tile[0] % S::tile[1]) * h,
          (origin[2] + at / (S::tile[0] * S::tile[1])) * h};
}
std::size_t entry_of(const std::array<int, 3>& node) {
  int entry = 0;
  for (std::size_t a = 3; a-- > 0;) entry = entry * S::tile[a] + node[a] - origin[a];
  return static_cast<std::size_t>(entry);
}

/// Points in the block and up to `drift` cells around it, its outermost corners included.
PointsOf<3> points_near_block(double drift) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> share(0.0, 1.0), sign(-1.0, 1.0);
  PointsOf<3> points;
  for (std::size_t n = 0; n < 200; ++n) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double from = (first_cell[a] - drift) * h;
      const double to = (first_cell[a] + S::cells[a] + drift) * h;
      const bool corner = n < 8;
      points.field[F::x + a].push_back(corner ? ((n >> a) & 1 ? to : from)
                                              : from + share(random) * (to - from));
    }
    for (std::size_t f = F::v; f < F::rho; ++f) points.field[f].push_back(sign(random));
    points.field[F::rho].push_back(0.5 + share(random));
    points.field[F::mass].push_back(0.5 + share(random));
    points.id.push_back(static_cast<std::int64_t>(n));
    ++points.count;
  }
  for (std::size_t f = 0; f < points.fields; ++f) points.field[f].resize(padded(points.count));
  return points;
}

Vector vector_at(const PointsOf<3>& points, std::size_t first_field, std::size_t s) {
  return {points[first_field][s], points[first_field + 1][s], points[first_field + 2][s]};
}
/// Row i of the stress: xx, yy, zz, xy, yz, zx.
double stress_at(const PointsOf<3>& points, std::size_t i, std::size_t j, std::size_t s) {
  const std::size_t component = i == j ? i : i + j == 1 ? 3 : i + j == 3 ? 4 : 5;
  return points[F::stress + component][s];
}

template <class K>
class SpaceTransferTest : public ::testing::Test {
 protected:
  static std::unique_ptr<TileOf<3>> scattered(const PointsOf<3>& points) {
    auto tile = std::make_unique<TileOf<3>>();
    for (auto& channel : *tile) channel.fill(0.0);
    points_to_tile<K, true, false>(points, {0, points.count}, h, origin, nullptr, *tile);
    return tile;
  }
  static void gather(const VelocityTileOf<3>& tile, PointsOf<3>& points) {
    std::array<AlignedVector<double>, 3> moving;
    MotionOf<3> motion;
    for (std::size_t a = 0; a < 3; ++a) {
      moving[a].resize(padded(points.count));
      motion.v[a] = moving[a].data();
    }
    tile_to_points<K, Keeps::nothing, false>(tile, origin, h, {0, points.count}, Retention{},
                                             points, motion);
    for (std::size_t s = 0; s < points.count; ++s)
      for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(moving[a][s], points[F::v + a][s]);
  }
};
using Kernels = ::testing::Types<CubicKernel, QuadraticKernel, SplineGradient<CubicKernel>,
                                 SplineGradient<QuadraticKernel>>;
TYPED_TEST_SUITE(SpaceTransferTest, Kernels);

// 200 terms of order one per node, in another order: 200 eps, times the largest |L|h or V σ D⁻¹h
// of about 3/h.
constexpr double round_off = 200 * 2.2e-16 * 12;

TYPED_TEST(SpaceTransferTest, EveryTileEntryIsTheBruteForceSum) {
  const PointsOf<3> points = points_near_block(0.999);
  const auto tile = this->scattered(points);
  std::map<std::array<int, 3>, std::array<double, C::extra>> expected;
  for (std::size_t s = 0; s < points.count; ++s) {
    const double m = points[F::mass][s];
    const double V = m / points[F::rho][s];
    Formula<TypeParam>::each_node(
        vector_at(points, F::x, s),
        [&](const auto& node, double w, const Vector& d, const Vector& g) {
          auto& sums = expected[node];
          sums[C::mass] += w * m;
          for (std::size_t i = 0; i < 3; ++i) {
            const Vector L = vector_at(points, F::L + 3 * i, s);
            sums[C::momentum + i] +=
                w * m * (points[F::v + i][s] + L[0] * d[0] + L[1] * d[1] + L[2] * d[2]);
            for (std::size_t j = 0; j < 3; ++j)
              sums[C::force + i] -= V * stress_at(points, i, j, s) * g[j];
          }
        });
  }
  std::vector<bool> found(S::tile_nodes, false);
  for (const auto& [node, sums] : expected) {
    bool in_tile = true;
    for (std::size_t a = 0; a < 3; ++a)
      in_tile = in_tile && node[a] >= origin[a] && node[a] < origin[a] + S::tile[a];
    if (!in_tile) {
      EXPECT_LT(sums[C::mass], round_off) << "outside the tile";
      continue;
    }
    const std::size_t n = entry_of(node);
    found[n] = true;
    for (std::size_t c = 0; c < C::extra; ++c) EXPECT_NEAR((*tile)[c][n], sums[c], round_off);
  }
  for (std::size_t n = 0; n < found.size(); ++n)
    EXPECT_TRUE(found[n] || (*tile)[C::mass][n] == 0.0) << "out of reach";
}

TYPED_TEST(SpaceTransferTest, TheWayByRowsGivesTheSame) {
  const PointsOf<3> points = points_near_block(0.999);
  const auto tile = this->scattered(points);
  auto by_rows = std::make_unique<TileOf<3>>();
  for (auto& channel : *by_rows) channel.fill(0.0);
  add_row_sums<TypeParam, true, false>(points, {0, points.count}, h, origin, nullptr, *by_rows);
  for (std::size_t c = 0; c < C::extra; ++c)
    for (std::size_t n = 0; n < S::tile_nodes; ++n)
      EXPECT_NEAR((*by_rows)[c][n], (*tile)[c][n], round_off) << c << " " << n;
}

TYPED_TEST(SpaceTransferTest, ConservesMassMomentumAndAngularMomentum) {
  const PointsOf<3> points = points_near_block(0.9);
  const auto tile = this->scattered(points);
  const double D = Formula<TypeParam>::moment;
  double mass = 0.0, grid_mass = 0.0;
  Vector momentum{}, angular{}, grid_momentum{}, grid_angular{}, force{}, torque{};
  for (std::size_t s = 0; s < points.count; ++s) {
    const double m = points[F::mass][s];
    const Vector x = vector_at(points, F::x, s), v = vector_at(points, F::v, s);
    mass += m;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t i = (a + 1) % 3, j = (a + 2) % 3;
      momentum[a] += m * v[a];
      // m D (L_ji − L_ij): what the affine field turns
      angular[a] += m * (x[i] * v[j] - x[j] * v[i] +
                         D * (points[F::L + 3 * j + i][s] - points[F::L + 3 * i + j][s]));
    }
  }
  for (std::size_t n = 0; n < static_cast<std::size_t>(S::tile_nodes); ++n) {
    const Vector x = place_of(n);
    grid_mass += (*tile)[C::mass][n];
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t i = (a + 1) % 3, j = (a + 2) % 3;
      grid_momentum[a] += (*tile)[C::momentum + a][n];
      grid_angular[a] += x[i] * (*tile)[C::momentum + j][n] - x[j] * (*tile)[C::momentum + i][n];
      force[a] += (*tile)[C::force + a][n];
      torque[a] += x[i] * (*tile)[C::force + j][n] - x[j] * (*tile)[C::force + i][n];
    }
  }
  EXPECT_NEAR(grid_mass / mass, 1.0, 1e-12);
  for (std::size_t a = 0; a < 3; ++a) {
    // sums of 200 m |v| of order one, and |x| of up to 6 in the moments; Σ f = 0 and Σ x × f = 0 as
    // σ is symmetric
    EXPECT_NEAR(grid_momentum[a], momentum[a], round_off);
    EXPECT_NEAR(grid_angular[a], angular[a], 6 * round_off);
    EXPECT_NEAR(force[a], 0.0, round_off);
    EXPECT_NEAR(torque[a], 0.0, 6 * round_off);
  }
}

// v = a + B x at the points, with L = B, is a + B x at the nodes, and comes back as it was.
TYPED_TEST(SpaceTransferTest, ALinearFieldGoesToTheGridAndBackExactly) {
  const Vector a{0.3, -0.7, 0.2};
  const Vector B[3] = {{0.4, -1.1, 0.6}, {0.9, 0.2, -0.5}, {-0.3, 0.8, -0.6}};
  const auto field = [&](std::size_t i, const Vector& x) {
    return a[i] + B[i][0] * x[0] + B[i][1] * x[1] + B[i][2] * x[2];
  };
  PointsOf<3> points = points_near_block(0.999);
  for (std::size_t s = 0; s < points.count; ++s)
    for (std::size_t i = 0; i < 3; ++i) {
      points.set(F::v + i, s, field(i, vector_at(points, F::x, s)));
      for (std::size_t j = 0; j < 3; ++j) points.set(F::L + 3 * i + j, s, B[i][j]);
    }
  const auto tile = this->scattered(points);
  const auto velocity = std::make_unique<VelocityTileOf<3>>();
  for (std::size_t n = 0; n < static_cast<std::size_t>(S::tile_nodes); ++n) {
    const double m = (*tile)[C::mass][n];
    for (std::size_t i = 0; i < 3; ++i) {
      velocity->v[i][n] = m > 0.0 ? (*tile)[C::momentum + i][n] / m : 0.0;
      // |v| <= 10 here; a node that only sees the ends of supports is known to eps/w
      if (m < 1e-6) continue;
      EXPECT_NEAR(velocity->v[i][n], field(i, place_of(n)), 10 * 1e-9);
    }
  }
  const PointsOf<3> before = points;
  this->gather(*velocity, points);
  for (std::size_t s = 0; s < points.count; ++s) {
    // 64 terms of size |v| <= 10, each known to a few eps: 4e-13; divided by h in the gradient
    for (std::size_t f = F::v; f < F::L; ++f) EXPECT_NEAR(points[f][s], before[f][s], 4e-13);
    for (std::size_t f = F::L; f < F::stress; ++f)
      EXPECT_NEAR(points[f][s], before[f][s], 4e-13 * 4 / h);
  }
}

// G2P against its formula, for a field that is anything.
TYPED_TEST(SpaceTransferTest, GatherIsTheBruteForceSum) {
  PointsOf<3> points = points_near_block(0.999);
  const PointsOf<3> before = points;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> sign(-1.0, 1.0);
  const auto tile = std::make_unique<VelocityTileOf<3>>();
  for (auto& component : tile->v)
    for (double& v : component) v = sign(random);
  this->gather(*tile, points);
  for (std::size_t s = 0; s < points.count; ++s) {
    Vector v{};
    std::array<Vector, 3> L{};
    Formula<TypeParam>::each_node(vector_at(before, F::x, s),
                                  [&](const auto& node, double w, const Vector&, const Vector& g) {
                                    if (!(w > 0.0)) return;
                                    for (std::size_t i = 0; i < 3; ++i) {
                                      const double node_v = tile->v[i][entry_of(node)];
                                      v[i] += w * node_v;
                                      for (std::size_t j = 0; j < 3; ++j) L[i][j] += node_v * g[j];
                                    }
                                  });
    const double exact = 64 * 12 * 2.2e-16;  // 64 terms, weights known to 12 eps (kernel_test: 8)
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(points[F::v + i][s], v[i], exact);
      for (std::size_t j = 0; j < 3; ++j)
        EXPECT_NEAR(points[F::L + 3 * i + j][s], L[i][j], exact * 8 / h);
    }
  }
}

}  // namespace
}  // namespace repose::mpm

#include "mpm/step/transfer.hpp"

#include <gtest/gtest.h>

#include "mpm/grid/point_stencil.hpp"
#include "mpm/step/row_sums.hpp"
#include "tests/mpm/point_cloud.hpp"

namespace repose::mpm {
namespace {

constexpr double h = 0.25;
/// A block in the middle of nowhere and its tile.
constexpr std::array<int, 2> first_cell{16, 8};
constexpr std::array<int, 2> origin{first_cell[0] - tile_margin_x, first_cell[1] - tile_margin_y};

template <class K>
struct Named;
template <>
struct Named<CubicKernel> {
  static constexpr Kernel kernel = Kernel::cubic;
};
template <>
struct Named<QuadraticKernel> {
  static constexpr Kernel kernel = Kernel::quadratic;
};
template <class K>
struct Named<SplineGradient<K>> : Named<K> {};

template <class K>
class TransferTest : public ::testing::Test {
 protected:
  /// Points in the block and up to `drift` cells around it, its outermost corners included.
  static PointSet points_near_block(double drift) {
    const std::array<double, 2> from{(first_cell[0] - drift) * h, (first_cell[1] - drift) * h};
    const std::array<double, 2> to{(first_cell[0] + block_nx + drift) * h,
                                   (first_cell[1] + block_ny + drift) * h};
    PointSet points = random_points(200, from, to, 11);
    points.field[X][0] = points.field[X][1] = from[0];
    points.field[X][2] = points.field[X][3] = to[0];
    points.field[Y][0] = points.field[Y][2] = from[1];
    points.field[Y][1] = points.field[Y][3] = to[1];
    return points;
  }
  static Tile scattered(const PointSet& points) {
    Tile tile;
    for (auto& channel : tile) channel.fill(0.0);
    points_to_tile<K, true, false>(points, {0, points.count}, h, origin, nullptr, tile);
    return tile;
  }
  static double x_of(std::size_t n) { return (origin[0] + static_cast<int>(n) % tile_stride) * h; }
  static double y_of(std::size_t n) { return (origin[1] + static_cast<int>(n) / tile_stride) * h; }
};
/// Grid to points by APIC.
template <class K>
void gather(const VelocityTile& tile, PointSet& points) {
  AlignedVector<double> vx(padded(points.count)), vy(padded(points.count));
  tile_to_points<K, Keeps::nothing, false>(tile, origin, h, {0, points.count}, Retention{}, points,
                                           {{vx.data(), vy.data()}});
  for (std::size_t s = 0; s < points.count; ++s) {
    EXPECT_EQ(vx[s], points[VX][s]);
    EXPECT_EQ(vy[s], points[VY][s]);
  }
}

using Kernels = ::testing::Types<CubicKernel, QuadraticKernel, SplineGradient<CubicKernel>,
                                 SplineGradient<QuadraticKernel>>;
TYPED_TEST_SUITE(TransferTest, Kernels);

// 200 terms of order one per node, in another order: 200 eps, times the largest |L|h or V σ D⁻¹h
// of about 3/h.
constexpr double round_off = 200 * 2.2e-16 * 12;

TYPED_TEST(TransferTest, EveryTileEntryIsTheBruteForceSum) {
  const PointSet points = this->points_near_block(0.999);
  const Tile tile = this->scattered(points);
  reference::Grid grid(h, Named<TypeParam>::kernel, TypeParam::spline_gradient);
  for (std::size_t s = 0; s < points.count; ++s) grid.scatter(particle(points, s));
  for (std::size_t n = 0; n < tile_nodes; ++n) {
    const auto at = grid.nodes.extract({origin[0] + static_cast<int>(n) % tile_stride,
                                        origin[1] + static_cast<int>(n) / tile_stride});
    const reference::Node node = at.empty() ? reference::Node{} : at.mapped();
    EXPECT_NEAR(tile[T_MASS][n], node.m, round_off);
    EXPECT_NEAR(tile[T_PX][n], node.momentum[0], round_off);
    EXPECT_NEAR(tile[T_PY][n], node.momentum[1], round_off);
    EXPECT_NEAR(tile[T_FX][n], node.force[0], round_off);
    EXPECT_NEAR(tile[T_FY][n], node.force[1], round_off);
    if (n % tile_stride < tile_margin_x - 2 || n % tile_stride >= tile_margin_x + block_nx + 3) {
      EXPECT_EQ(tile[T_MASS][n], 0.0) << "out of reach";
    }
  }
  for (const auto& [place, node] : grid.nodes)
    EXPECT_LT(node.m, round_off) << "outside the tile: " << place.first << ", " << place.second;
}

// The way by rows is that of AVX2; here it is held against the other one wherever that is taken.
TYPED_TEST(TransferTest, TheWayByRowsGivesTheSame) {
  const PointSet points = this->points_near_block(0.999);
  const Tile tile = this->scattered(points);
  Tile by_rows;
  for (auto& channel : by_rows) channel.fill(0.0);
  add_row_sums<TypeParam, true, false>(points, {0, points.count}, h, origin, nullptr, by_rows);
  for (std::size_t c = 0; c < T_EXTRA; ++c)
    for (std::size_t n = 0; n < tile_nodes; ++n)
      EXPECT_NEAR(by_rows[c][n], tile[c][n], round_off) << c << " " << n;

  const auto pack = [&](std::size_t f, std::size_t s, int first) {
    return Pack(Pack::load_aligned(points.data(f) + s) * Pack(1.0 / h) - Pack(first));
  };
  for (std::size_t s = 0; s < points.count; s += Pack::size) {
    const std::array<Pack, 2> xi{pack(X, s, origin[0]), pack(Y, s, origin[1])};
    std::array<Moments, 2> expected, found;
    std::array<Pack, 1> value, value_found;
    const std::array fields{tile[T_PX].data(), tile[T_FY].data()};
    const std::array<const double*, 1> another{tile[T_MASS].data()};
    PointStencil<TypeParam, 2>(xi).read(fields, expected, another, value);
    RowStencil<TypeParam, 2>(xi).read(fields, found, another, value_found);
    const auto near = [](const Pack& x, const Pack& y) {
      for (std::size_t k = 0; k < Pack::size; ++k) EXPECT_NEAR(x.get(k), y.get(k), round_off);
    };
    for (std::size_t f = 0; f < 2; ++f) {
      near(found[f].value, expected[f].value);
      near(found[f].dx, expected[f].dx);
      near(found[f].dy, expected[f].dy);
    }
    near(value_found[0], value[0]);
  }
}

TYPED_TEST(TransferTest, ConservesMassMomentumAndAngularMomentum) {
  const PointSet points = this->points_near_block(0.9);
  const Tile tile = this->scattered(points);
  const double D =
      reference::Grid(h, Named<TypeParam>::kernel, TypeParam::spline_gradient).moment();
  double mass = 0, px = 0, py = 0, spin = 0;
  for (std::size_t s = 0; s < points.count; ++s) {
    const reference::Particle p = particle(points, s);
    mass += p.mass;
    px += p.mass * p.v[0];
    py += p.mass * p.v[1];
    spin += p.mass * (p.x[0] * p.v[1] - p.x[1] * p.v[0] + D * (p.L[1][0] - p.L[0][1]));
  }
  double grid_mass = 0, grid_px = 0, grid_py = 0, grid_spin = 0;
  for (std::size_t n = 0; n < tile_nodes; ++n) {
    grid_mass += tile[T_MASS][n];
    grid_px += tile[T_PX][n];
    grid_py += tile[T_PY][n];
    grid_spin += this->x_of(n) * tile[T_PY][n] - this->y_of(n) * tile[T_PX][n];
  }
  EXPECT_NEAR(grid_mass / mass, 1.0, 1e-12);
  // sums of 200 m |v| of order one, and |x| of up to 6 in the moment
  EXPECT_NEAR(grid_px, px, round_off);
  EXPECT_NEAR(grid_py, py, round_off);
  EXPECT_NEAR(grid_spin, spin, 6 * round_off);
}

// Σ f_i = 0, Σ x_i × f_i = 0 (σ symmetric), and the virial Σ f_i ⊗ x_i = −Σ V σ (Σ w d dᵀ = D).
TYPED_TEST(TransferTest, InternalForcesAreBalanced) {
  const PointSet points = this->points_near_block(0.9);
  const Tile tile = this->scattered(points);
  double fx = 0, fy = 0, torque = 0, xx = 0, yy = 0, xy = 0;
  for (std::size_t n = 0; n < tile_nodes; ++n) {
    const double x = this->x_of(n), y = this->y_of(n);
    fx += tile[T_FX][n];
    fy += tile[T_FY][n];
    torque += x * tile[T_FY][n] - y * tile[T_FX][n];
    xx += tile[T_FX][n] * x;
    yy += tile[T_FY][n] * y;
    xy += tile[T_FX][n] * y;
  }
  double virial_xx = 0, virial_yy = 0, virial_xy = 0;
  for (std::size_t s = 0; s < points.count; ++s) {
    const reference::Particle p = particle(points, s);
    virial_xx -= p.volume * p.stress[0][0];
    virial_yy -= p.volume * p.stress[1][1];
    virial_xy -= p.volume * p.stress[0][1];
  }
  EXPECT_NEAR(fx, 0.0, round_off);
  EXPECT_NEAR(fy, 0.0, round_off);
  EXPECT_NEAR(torque, 0.0, 6 * round_off);
  EXPECT_NEAR(xx, virial_xx, 6 * round_off);
  EXPECT_NEAR(yy, virial_yy, 6 * round_off);
  EXPECT_NEAR(xy, virial_xy, 6 * round_off);
}

// v = a + B x at the points, with L = B, is a + B x at the nodes, and comes back as it was.
TYPED_TEST(TransferTest, ALinearFieldGoesToTheGridAndBackExactly) {
  const double a[2] = {0.3, -0.7};
  const double B[2][2] = {{0.4, -1.1}, {0.9, 0.2}};
  PointSet points = this->points_near_block(0.999);
  for (std::size_t s = 0; s < points.count; ++s) {
    for (std::size_t i = 0; i < 2; ++i)
      points.set(VX + i, s, a[i] + B[i][0] * points[X][s] + B[i][1] * points[Y][s]);
    points.set(LXX, s, B[0][0]);
    points.set(LXY, s, B[0][1]);
    points.set(LYX, s, B[1][0]);
    points.set(LYY, s, B[1][1]);
  }
  const Tile tile = this->scattered(points);
  VelocityTile velocity;
  for (std::size_t n = 0; n < tile_nodes; ++n) {
    const double m = tile[T_MASS][n];
    velocity.v[0][n] = m > 0.0 ? tile[T_PX][n] / m : 0.0;
    velocity.v[1][n] = m > 0.0 ? tile[T_PY][n] / m : 0.0;
    // |v| <= 10 here. A node that only sees the ends of supports (weight w) has terms of size w
    // known to eps·1: relative eps/w. They are exact where they count: w > 1e-6.
    if (m < 1e-6) continue;
    const double x = this->x_of(n), y = this->y_of(n);
    EXPECT_NEAR(velocity.v[0][n], a[0] + B[0][0] * x + B[0][1] * y, 10 * 1e-9);
    EXPECT_NEAR(velocity.v[1][n], a[1] + B[1][0] * x + B[1][1] * y, 10 * 1e-9);
  }
  const PointSet before = points;
  gather<TypeParam>(velocity, points);
  for (std::size_t s = 0; s < points.count; ++s) {
    // 16 terms of size |v| <= 10, each known to a few eps: 1e-13; divided by h in the gradient
    for (const Field f : {VX, VY}) EXPECT_NEAR(points[f][s], before[f][s], 1e-13);
    for (const Field f : {LXX, LXY, LYX, LYY})
      EXPECT_NEAR(points[f][s], before[f][s], 1e-13 * 4 / h);
  }
}

// G2P against its formula, for a field that is anything.
TYPED_TEST(TransferTest, GatherIsTheBruteForceSum) {
  PointSet points = this->points_near_block(0.999);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> sign(-1.0, 1.0);
  VelocityTile tile;
  reference::Grid grid(h, Named<TypeParam>::kernel, TypeParam::spline_gradient);
  for (std::size_t n = 0; n < tile_nodes; ++n) {
    tile.v[0][n] = sign(random);
    tile.v[1][n] = sign(random);
    grid.nodes[{origin[0] + static_cast<int>(n) % tile_stride,
                origin[1] + static_cast<int>(n) / tile_stride}]
        .velocity = {tile.v[0][n], tile.v[1][n]};
  }
  gather<TypeParam>(tile, points);
  for (std::size_t s = 0; s < points.count; ++s) {
    reference::Vector v;
    reference::Matrix L;
    grid.gather({points[X][s], points[Y][s]}, v, L);
    const double exact = 16 * 8 * 2.2e-16;  // 16 terms, weights known to 8 eps (kernel_test)
    EXPECT_NEAR(points[VX][s], v[0], exact);
    EXPECT_NEAR(points[VY][s], v[1], exact);
    EXPECT_NEAR(points[LXX][s], L[0][0], exact * 8 / h);
    EXPECT_NEAR(points[LXY][s], L[0][1], exact * 8 / h);
    EXPECT_NEAR(points[LYX][s], L[1][0], exact * 8 / h);
    EXPECT_NEAR(points[LYY][s], L[1][1], exact * 8 / h);
  }
}

}  // namespace
}  // namespace repose::mpm

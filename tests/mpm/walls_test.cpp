#include "mpm/boundary/walls.hpp"

#include <functional>

#include <gtest/gtest.h>

#include "tests/mpm/point_cloud.hpp"

namespace repose::mpm {
namespace {

constexpr double h = 0.5;
constexpr int nx = 11, ny = 7;
constexpr double width = nx * h, height = ny * h;
constexpr Wall open{Wall::Kind::open};
constexpr Wall slip{Wall::Kind::slip};
constexpr Wall no_slip{Wall::Kind::no_slip};

using Motion = std::function<reference::Vector(double x, double y)>;

class WallsTest : public ::testing::TestWithParam<Kernel> {
 protected:
  /// Four points at random in every cell of the box, moving with a linear field before forces;
  /// after them with the same field times `kick`.
  void fill(const Motion& v, double kick = 1.0) {
    points_ = random_points(4 * nx * ny, {0.0, 0.0}, {1.0, 1.0}, 21);
    for (std::size_t s = 0; s < points_.count; ++s) {
      const auto cell = static_cast<int>(s / 4);
      points_.set(X, s, (cell % nx + points_[X][s]) * h);
      points_.set(Y, s, (cell / nx + points_[Y][s]) * h);
      set_motion(s, v);
    }
    std::vector<PointSet> bodies{points_};
    grid_.sort(bodies);
    reference::Grid nodes(h, GetParam());
    for (std::size_t s = 0; s < points_.count; ++s) nodes.scatter(particle(points_, s));
    for (const auto& [place, node] : nodes.nodes) {
      const Grid::NodeRef at = grid_.node(place.first, place.second);
      at.block->mass[at.place] = at.block->mirrored_mass[at.place] = node.m;
      at.block->u[0][at.place] = node.momentum[0] / node.m;
      at.block->u[1][at.place] = node.momentum[1] / node.m;
      at.block->v[0][at.place] = kick * node.momentum[0] / node.m;
      at.block->v[1][at.place] = kick * node.momentum[1] / node.m;
    }
  }
  /// A field without any order: every node for itself.
  void scramble(unsigned seed) {
    fill([](double, double) { return reference::Vector{}; });
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> sign(-1.0, 1.0);
    for (NodeBlock& nb : grid_.node_blocks)
      for (std::size_t n = 0; n < block_nodes; ++n)
        for (auto* values : {&nb.u[0], &nb.u[1], &nb.v[0], &nb.v[1]})
          (*values)[n] = nb.mass[n] > 0.0 ? sign(random) : 0.0;
  }
  reference::Vector velocity_at(double x, double y) { return motion_at(x, y).first; }
  std::pair<reference::Vector, reference::Matrix> motion_at(double x, double y) {
    reference::Grid nodes(h, GetParam());
    for (const NodeBlock& nb : grid_.node_blocks)
      for (std::size_t n = 0; n < block_nodes; ++n)
        nodes
            .nodes[{Grid::first_x(nb.at[0]) + static_cast<int>(n) % block_nx,
                    Grid::first_y(nb.at[1]) + static_cast<int>(n) / block_nx}]
            .velocity = {nb.v[0][n], nb.v[1][n]};
    std::pair<reference::Vector, reference::Matrix> found;
    nodes.gather({x, y}, found.first, found.second);
    return found;
  }
  struct Sums {
    double px = 0, py = 0, before = 0, after = 0;
  };
  Sums sums() const {
    Sums s;
    for (const NodeBlock& nb : grid_.node_blocks)
      for (std::size_t n = 0; n < block_nodes; ++n) {
        s.px += nb.mass[n] * nb.v[0][n];
        s.py += nb.mass[n] * nb.v[1][n];
        s.before += 0.5 * nb.mass[n] * (nb.u[0][n] * nb.u[0][n] + nb.u[1][n] * nb.u[1][n]);
        s.after += 0.5 * nb.mass[n] * (nb.v[0][n] * nb.v[0][n] + nb.v[1][n] * nb.v[1][n]);
      }
    return s;
  }
  std::array<double, 2> momentum_before_forces() const {
    std::array<double, 2> p{};
    for (const NodeBlock& nb : grid_.node_blocks)
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t n = 0; n < block_nodes; ++n) p[i] += nb.mass[n] * nb.u[i][n];
    return p;
  }
  std::vector<double> velocities_after_forces() const {
    std::vector<double> all;
    for (const NodeBlock& nb : grid_.node_blocks)
      for (const auto* values : {&nb.v[0], &nb.v[1]})
        all.insert(all.end(), values->begin(), values->end());
    return all;
  }
  std::vector<double> node_velocities() const {
    std::vector<double> all;
    for (const NodeBlock& nb : grid_.node_blocks)
      for (const auto* values : {&nb.u[0], &nb.u[1], &nb.v[0], &nb.v[1]})
        all.insert(all.end(), values->begin(), values->end());
    return all;
  }

  Grid grid_{h, nx, ny};
  PointSet points_;

 private:
  void set_motion(std::size_t s, const Motion& v) {
    const double x = points_[X][s], y = points_[Y][s];
    const auto at = v(x, y), right = v(x + 1.0, y), above = v(x, y + 1.0);  // linear: exact
    for (std::size_t i = 0; i < 2; ++i) {
      points_.set(VX + i, s, at[i]);
      points_.set(LXX + 2 * i, s, right[i] - at[i]);
      points_.set(LXY + 2 * i, s, above[i] - at[i]);
    }
  }
};

// What a wall mirrors: the image of a is on c and that of b on b, so that the node on the wall
// holds its mass twice, and the two beside it their sum. The mass that the points put there stays.
TEST_P(WallsTest, TheMirroredMassIsThatOfBothSides) {
  for (const Wall& wall : {slip, no_slip}) {
    fill([](double, double) { return reference::Vector{0.3, -0.2}; });
    const auto node = [&](int ix, int iy) { return grid_.node(ix, iy); };
    const auto mass = [&](int ix, int iy) { return node(ix, iy).block->mass[node(ix, iy).place]; };
    const auto mirrored = [&](int ix, int iy) {
      return node(ix, iy).block->mirrored_mass[node(ix, iy).place];
    };
    const double a = mass(5, -1), b = mass(5, 0), c = mass(5, 1), inside = mass(5, 3);
    apply_walls(grid_, {open, open, wall, open});
    EXPECT_EQ(mass(5, 0), b);
    EXPECT_DOUBLE_EQ(mirrored(5, 0), 2.0 * b);
    EXPECT_DOUBLE_EQ(mirrored(5, 1), a + c);
    EXPECT_DOUBLE_EQ(mirrored(5, -1), a + c);
    EXPECT_EQ(mirrored(5, 3), inside);
  }
}

// A node's velocity is a quotient of sums of up to 60 terms; over w > 1e-7, the lightest node of
// this lattice, that is 1e-16/1e-7. Where it is interpolated it weighs little again: 1e-13 |v|.
constexpr double exact = 1e-12;

TEST_P(WallsTest, SlipReproducesMotionAlongAndLinearMotionAcross) {
  const double c = 0.7, V = 1.3;
  const struct {
    Walls walls;
    Motion v;
  } cases[] = {{{slip, open, open, open},
                [&](double x, double) {
                  return reference::Vector{c * x, V};
                }},
               {{open, slip, open, open},
                [&](double x, double) {
                  return reference::Vector{c * (x - width), V};
                }},
               {{open, open, slip, open},
                [&](double, double y) {
                  return reference::Vector{V, c * y};
                }},
               {{open, open, open, slip},
                [&](double, double y) {
                  return reference::Vector{V, c * (y - height)};
                }},
               // all four at once: motion along one pair of walls, nothing across
               {{slip, slip, slip, slip}, [&](double, double) {
                  return reference::Vector{0.0, 0.0};
                }}};
  for (const auto& one : cases) {
    fill(one.v);
    apply_walls(grid_, one.walls);
    for (std::size_t s = 0; s < points_.count; ++s) {
      const double x = points_[X][s], y = points_[Y][s];
      const auto [v, L] = motion_at(x, y);
      const auto expected = one.v(x, y);
      EXPECT_NEAR(v[0], expected[0], exact) << x << ", " << y;
      EXPECT_NEAR(v[1], expected[1], exact) << x << ", " << y;
      EXPECT_NEAR(L[0][0], points_[LXX][s], exact * 8 / h);
      EXPECT_NEAR(L[1][1], points_[LYY][s], exact * 8 / h);
      EXPECT_NEAR(L[0][1], 0.0, exact * 8 / h);
      EXPECT_NEAR(L[1][0], 0.0, exact * 8 / h);
    }
  }
}

TEST_P(WallsTest, NoSlipReproducesLinearShear) {
  const double c = 0.7, d = -1.1;
  const struct {
    Walls walls;
    Motion v;
  } cases[] = {{{no_slip, open, open, open},
                [&](double x, double) {
                  return reference::Vector{c * x, d * x};
                }},
               {{open, no_slip, open, open},
                [&](double x, double) {
                  return reference::Vector{c * (x - width), d * (x - width)};
                }},
               {{open, open, no_slip, open},
                [&](double, double y) {
                  return reference::Vector{d * y, c * y};
                }},
               {{open, open, open, no_slip}, [&](double, double y) {
                  return reference::Vector{d * (y - height), c * (y - height)};
                }}};
  for (const auto& one : cases) {
    fill(one.v);
    apply_walls(grid_, one.walls);
    for (std::size_t s = 0; s < points_.count; ++s) {
      const auto v = velocity_at(points_[X][s], points_[Y][s]);
      const auto expected = one.v(points_[X][s], points_[Y][s]);
      EXPECT_NEAR(v[0], expected[0], exact);
      EXPECT_NEAR(v[1], expected[1], exact);
    }
  }
}

// Whatever the nodes do, nothing moves through a wall nor along one without slip, corners included.
TEST_P(WallsTest, NothingCrossesAWall) {
  for (const Wall& side : {slip, no_slip})
    for (const Wall& base : {slip, no_slip}) {
      scramble(31);
      apply_walls(grid_, {side, side, base, base});
      const double round_off = 1e-15;  // two equal terms of size one sixth
      for (int k = 0; k <= 40; ++k) {
        const double x = width * k / 40, y = height * k / 40;
        for (const double at : {0.0, width}) {
          const auto v = velocity_at(at, y);
          EXPECT_NEAR(v[0], 0.0, round_off);
          if (side.kind == Wall::Kind::no_slip) {
            EXPECT_NEAR(v[1], 0.0, round_off);
          }
        }
        for (const double at : {0.0, height}) {
          const auto v = velocity_at(x, at);
          EXPECT_NEAR(v[1], 0.0, round_off);
          if (base.kind == Wall::Kind::no_slip) {
            EXPECT_NEAR(v[0], 0.0, round_off);
          }
        }
      }
    }
}

// Mirroring is an orthogonal projection: it keeps what it has made, takes energy and never gives
// any, and reports exactly what it took.
TEST_P(WallsTest, IsAProjectionWithItsEnergyAccounted) {
  for (const Walls& walls :
       {Walls{slip, slip, no_slip, slip}, Walls{no_slip, slip, slip, no_slip}}) {
    scramble(32);
    const Sums start = sums();
    const WallEffect effect = apply_walls(grid_, walls);
    const Sums end = sums();
    EXPECT_LT(effect.kinetic_before, 0.0);
    EXPECT_LT(effect.kinetic_after, 0.0);
    // sums of 1300 nodes of energy below 1 each
    EXPECT_NEAR(effect.kinetic_before, end.before - start.before, 1e-12 * start.before);
    EXPECT_NEAR(effect.kinetic_after, end.after - start.after, 1e-12 * start.after);
    const std::vector<double> once = node_velocities();
    for (NodeBlock& nb : grid_.node_blocks) nb.mirrored_mass = nb.mass;
    const WallEffect again = apply_walls(grid_, walls);
    EXPECT_NEAR(again.kinetic_before, 0.0, 1e-14 * start.before);
    EXPECT_NEAR(again.kinetic_after, 0.0, 1e-14 * start.after);
    const std::vector<double> twice = node_velocities();
    for (std::size_t k = 0; k < once.size(); ++k) EXPECT_NEAR(twice[k], once[k], 1e-14);
  }
}

TEST_P(WallsTest, FrictionLetsGoWhatParts) {
  const Wall rough{Wall::Kind::friction, 0.5};
  fill([](double, double) { return reference::Vector{0.4, 0.3}; });  // up and along the floor
  const std::vector<double> before = node_velocities();
  const WallEffect effect = apply_walls(grid_, {open, open, rough, open});
  EXPECT_EQ(node_velocities(), before);
  EXPECT_EQ(effect.kinetic_after, 0.0);
}

TEST_P(WallsTest, FrictionSlidesAtItsLimit) {
  const double f = 0.3;
  const Wall rough{Wall::Kind::friction, f};
  const struct {
    Walls walls;
    reference::Vector v;
    bool normal_is_x;
  } cases[] = {{{open, open, rough, open}, {2.0, -0.5}, false},
               {{open, open, open, rough}, {-2.0, 0.5}, false},
               {{rough, open, open, open}, {-0.5, 2.0}, true},
               {{open, rough, open, open}, {0.5, -2.0}, true}};
  for (const auto& one : cases) {
    fill([&](double, double) { return one.v; });
    const Sums start = sums();
    const WallEffect effect = apply_walls(grid_, one.walls);
    const Sums end = sums();
    const double J_x = end.px - start.px, J_y = end.py - start.py;
    const double J_n = one.normal_is_x ? J_x : J_y;
    const double J_t = one.normal_is_x ? J_y : J_x;
    // every triple slides (f J_n < J_t: 0.3·0.5 < 2), so the sums are in proportion too
    EXPECT_NEAR(std::abs(J_t), f * std::abs(J_n), 1e-12 * std::abs(J_n));
    EXPECT_GT(std::abs(J_n), 0.1);
    EXPECT_LT(J_n * (one.normal_is_x ? one.v[0] : one.v[1]), 0.0) << "it pushes back";
    EXPECT_LT(J_t * (one.normal_is_x ? one.v[1] : one.v[0]), 0.0) << "it slows down";
    EXPECT_NEAR(effect.kinetic_after, end.after - start.after, 1e-12 * start.after);
    EXPECT_LT(effect.kinetic_after, 0.0);
  }
}

TEST_P(WallsTest, FrictionWithinItsLimitIsNoSlip) {
  const Motion v = [](double, double) { return reference::Vector{0.1, -0.5}; };
  fill(v);
  apply_walls(grid_, {open, open, {Wall::Kind::friction, 0.9}, open});
  const std::vector<double> stuck = velocities_after_forces();
  fill(v);
  apply_walls(grid_, {open, open, no_slip, open});
  EXPECT_EQ(velocities_after_forces(), stuck);
}

// Friction's impulse belongs to the step, and v − u carries all of it: u keeps its momentum.
TEST_P(WallsTest, FrictionLeavesTheMomentumBeforeForces) {
  for (const double f : {0.0, 0.3, 0.9}) {
    fill([](double x, double) { return reference::Vector{0.8 + 0.1 * x, -0.5}; });
    const std::vector<double> before = node_velocities();
    const std::array<double, 2> start = momentum_before_forces();
    const Wall rough{Wall::Kind::friction, f};
    apply_walls(grid_, {open, open, rough, open});
    EXPECT_NE(node_velocities(), before);
    const std::array<double, 2> end = momentum_before_forces();
    // 1300 nodes: the mirror and the way back round 6 times each
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_NEAR(end[i], start[i], 12.0 * 2.3e-16 * (std::abs(start[0]) + std::abs(start[1])));
  }
}

// What the walls did to the velocities before forces, done again from the record. The rough walls
// slide here and stick or part there, by the velocities after forces. The formula is the same, but
// compilers fuse products and sums in one place and not in the other: with all velocities within 1,
// which mirroring does not enlarge, 8 roundings by eps/2 each time, twice, and in the corners,
// which are mirrored in x and y, twice again.
TEST_P(WallsTest, MirrorRepeatsWhatTheWallsDid) {
  scramble(4);
  NodeVector copy(grid_.node_blocks.size());
  for (std::size_t k = 0; k < copy.size(); ++k)
    copy[k] = {grid_.node_blocks[k].u[0], grid_.node_blocks[k].u[1]};
  const Wall rough{Wall::Kind::friction, 0.5};
  std::vector<MirroredTriple> record;
  apply_walls(grid_, {rough, slip, no_slip, rough}, &record);
  mirror(record, copy);
  std::array<int, 3> slid_stuck_mixed{};
  for (const MirroredTriple& at : record)
    ++slid_stuck_mixed[at.stick == 0.0 ? 0 : at.stick == 1.0 ? 1 : 2];
  for (const int count : slid_stuck_mixed) EXPECT_GT(count, 0);
  constexpr double round_off = 16.0 * std::numeric_limits<double>::epsilon();
  for (std::size_t k = 0; k < copy.size(); ++k)
    for (std::size_t n = 0; n < block_nodes; ++n) {
      EXPECT_NEAR(copy[k].x[n], grid_.node_blocks[k].u[0][n], round_off);
      EXPECT_NEAR(copy[k].y[n], grid_.node_blocks[k].u[1][n], round_off);
    }
}

// The forces' work on what the walls leave of the motion: Δt Σ F·u, before and after.
TEST_P(WallsTest, ReportsTheWorkOfTheForces) {
  fill([](double x, double y) { return reference::Vector{0.3 + x, -0.4 + 0.2 * y}; }, 1.25);
  const auto impulse_work = [&](const std::vector<double>& u, const std::vector<double>& kick) {
    double sum = 0.0;
    std::size_t k = 0;
    for (const NodeBlock& nb : grid_.node_blocks)
      for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t n = 0; n < block_nodes; ++n, ++k)
          if (c < 2) sum += nb.mass[n] * kick[k] * u[k];
    return sum;
  };
  const std::vector<double> u = node_velocities();
  std::vector<double> kick = u;
  for (double& x : kick) x *= 0.25;  // v − u
  const double before = impulse_work(u, kick);
  const WallEffect effect = apply_walls(grid_, {slip, slip, no_slip, slip});
  const double after = impulse_work(node_velocities(), kick);
  EXPECT_NEAR(effect.impulse_work, after - before, 1e-12 * std::abs(before));
  EXPECT_LT(effect.impulse_work, 0.0);  // here the forces push along u
}

INSTANTIATE_TEST_SUITE_P(Kernels, WallsTest, ::testing::Values(Kernel::cubic, Kernel::quadratic),
                         [](const auto& kernel) {
                           return kernel.param == Kernel::cubic ? "cubic" : "quadratic";
                         });

}  // namespace
}  // namespace repose::mpm

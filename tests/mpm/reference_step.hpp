#pragma once
/// \file
/// A whole step of the method in its plainest form, to hold the solver against: no blocks, no
/// drift, no ghost conditions. A wall that mirrors is what it says: every point has an image behind
/// it, and the images are points like any other.

#include <functional>
#include <memory>
#include <numbers>

#include "models/scalar.hpp"
#include "mpm/grid/points.hpp"
#include "tests/mpm/reference_grid.hpp"
#include "tests/mpm/saved_state.hpp"

namespace repose::mpm::reference {

/// The points of a scene and their laws; starts where `simulation` stands.
class Model {
 public:
  explicit Model(const Simulation& simulation)
      : scene_(simulation.scene()),
        points_(points_of(simulation)) {
    for (const Body& body : scene_.bodies) materials_.push_back(make_material(body.law));
    const double angle = scene_.tilt_deg * std::numbers::pi / 180.0;
    gravity_ = {scene_.gravity * std::sin(angle), -scene_.gravity * std::cos(angle)};
  }
  const std::vector<PointState>& points() const { return points_; }

  void step(double dt) {
    Grid grid = empty_grid();
    for (const PointState& point : points_) scatter_with_images(grid, point);
    grid.advance(dt);
    const std::vector<Vector> extension = extended_by(grid);
    for (std::size_t k = 0; k < points_.size(); ++k) {
      PointState& point = points_[k];
      Vector u, v;
      Matrix G, L;
      grid.gather({point[X], point[Y]}, u, G, &Node::before);
      grid.gather({point[X], point[Y]}, v, L);
      const auto [keep_v, keep_A] = kept(dt);
      for (std::size_t i = 0; i < 2; ++i) {
        point.field[VX + i] = v[i] + keep_v * (point[VX + i] - u[i]) + extension[k][i];
        point.field[X + i] += dt * v[i];
        for (std::size_t j = 0; j < 2; ++j) {
          point.field[LXX + 2 * i + j] = L[i][j];
          double& A = point.affine[2 * i + j];
          A = L[i][j] + keep_A * (A - G[i][j]);
        }
      }
      update_stress(point, dt);
    }
  }

 private:
  Grid empty_grid() const {
    return Grid(scene_.h, scene_.kernel, scene_.transfer == Transfer::tpic);
  }

  /// What XPIC(m) adds to the points' velocities S v: V − (I − P)^m V − P V with P V = S S⁺V, said
  /// of the points (Hammerquist & Nairn 2017). FMPM(k) changes the velocity of the grid itself,
  ///   Σ_r (−1)^{r+1} C(k, r) (S⁺S)^{r−1} v   (Nairn & Hammerquist 2021).
  /// (The solver sums powers of I − S⁺S on the grid for both.)
  std::vector<Vector> extended_by(Grid& grid) const {
    std::vector<Vector> added(points_.size());
    if (scene_.transfer == Transfer::xpic) {
      std::vector<Vector> rest(points_.size());
      for (std::size_t k = 0; k < points_.size(); ++k) rest[k] = {points_[k][VX], points_[k][VY]};
      const std::vector<Vector> velocity = rest;
      const std::vector<Vector> pic = there_and_back(velocity);
      for (int pass = 0; pass < scene_.order; ++pass) {
        const std::vector<Vector> filtered = there_and_back(rest);
        for (std::size_t k = 0; k < rest.size(); ++k)
          for (std::size_t i = 0; i < 2; ++i) rest[k][i] -= filtered[k][i];
      }
      for (std::size_t k = 0; k < rest.size(); ++k)
        for (std::size_t i = 0; i < 2; ++i) added[k][i] = velocity[k][i] - rest[k][i] - pic[k][i];
    } else if (scene_.transfer == Transfer::fmpm) {
      Grid power = grid;  // (S⁺S)^{r−1} v
      double factor = 1.0;
      for (auto& [place, node] : grid.nodes) node.velocity = {};
      for (int r = 1; r <= scene_.order; ++r) {
        if (r > 1) power = to_grid(at_points(power));
        factor *= (r > 1 ? -1.0 : 1.0) * (scene_.order - r + 1.0) / r;
        for (auto& [place, node] : grid.nodes)
          for (std::size_t i = 0; i < 2; ++i)
            node.velocity[i] += factor * power.nodes[place].velocity[i];
      }
    }
    return added;
  }

  std::vector<Vector> at_points(Grid& grid) const {
    std::vector<Vector> velocity(points_.size());
    for (std::size_t k = 0; k < points_.size(); ++k) {
      Matrix unused;
      grid.gather({points_[k][X], points_[k][Y]}, velocity[k], unused);
    }
    return velocity;
  }
  Grid to_grid(const std::vector<Vector>& velocity) const {
    Grid grid = empty_grid();
    for (std::size_t k = 0; k < points_.size(); ++k) {
      Particle p;
      p.x = {points_[k][X], points_[k][Y]};
      p.v = velocity[k];
      p.mass = points_[k][MASS];
      scatter_with_images(grid, p);
    }
    grid.advance(0.0);
    return grid;
  }
  std::vector<Vector> there_and_back(const std::vector<Vector>& velocity) const {
    Grid grid = to_grid(velocity);
    return at_points(grid);
  }

  /// Shares of its own velocity and affine velocity that a point keeps over a step.
  std::array<double, 2> kept(double dt) const {
    const double rate = scene_.relaxation_time ? 1.0 / *scene_.relaxation_time : 0.0;
    switch (scene_.transfer) {
      case Transfer::pic:
      case Transfer::apic:
      case Transfer::tpic:
      case Transfer::xpic:
      case Transfer::fmpm:
        return {0.0, 0.0};
      case Transfer::flip:
      case Transfer::aflip:
        return {1.0, 0.0};
      case Transfer::relaxed:
        return {std::exp(-dt * rate), std::exp(-dt * rate)};
    }
    return {};
  }

  void scatter_with_images(Grid& grid, const PointState& point) const {
    Particle p;
    p.x = {point[X], point[Y]};
    p.v = {point[VX], point[VY]};
    if (scene_.transfer == Transfer::apic || scene_.transfer == Transfer::aflip ||
        scene_.transfer == Transfer::relaxed || scene_.transfer == Transfer::tpic)
      p.L = {{{point.affine[0], point.affine[1]}, {point.affine[2], point.affine[3]}}};
    p.stress = {{{point[SXX], point[SXY]}, {point[SXY], point[SYY]}}};
    p.mass = point[MASS];
    p.volume = point[MASS] / point[RHO];
    p.body_force = gravity_;
    scatter_with_images(grid, p);
  }

  void scatter_with_images(Grid& grid, const Particle& p) const {
    // itself, its images in the walls across x, and the images of those in the walls across y
    std::vector<Particle> row{p};
    add_images(row, {scene_.left, scene_.right}, 0);
    add_images(row, {scene_.floor, scene_.top}, 1);
    for (const Particle& one : row) grid.scatter(one);
  }

  void add_images(std::vector<Particle>& row, const std::array<Wall, 2>& walls,
                  std::size_t across) const {
    const std::size_t n = row.size();
    for (std::size_t side = 0; side < 2; ++side) {
      if (walls[side].kind == Wall::Kind::open) continue;
      Vector R{1.0, 1.0}, origin{};
      R[across] = -1.0;
      if (side == 1) origin[across] = scene_.domain[across];
      const Vector S = walls[side].kind == Wall::Kind::slip ? R : Vector{-1.0, -1.0};
      for (std::size_t k = 0; k < n; ++k) row.push_back(image(row[k], R, S, origin));
    }
  }

  void update_stress(PointState& point, double dt) const {
    std::array<std::array<double, pack_size>, 5> motion{};
    std::array<std::array<double, pack_size>, STATE + max_state> field{};
    // ln(I + A) = A − ½A² + O(A³), A = Δt L: its symmetric part strains, its other part turns
    const Matrix A{{{dt * point[LXX], dt * point[LXY]}, {dt * point[LYX], dt * point[LYY]}}};
    const auto logarithm = [&](std::size_t i, std::size_t j) {
      return A[i][j] - 0.5 * (A[i][0] * A[0][j] + A[i][1] * A[1][j]);
    };
    motion[0].fill(logarithm(0, 0));
    motion[1].fill(logarithm(1, 1));
    motion[3].fill(0.5 * (logarithm(0, 1) + logarithm(1, 0)));
    motion[4].fill(0.5 * (logarithm(1, 0) - logarithm(0, 1)));
    if (!materials_[point.body]->law().has_stress_memory) {  // D itself, but with that volume
      const double volume = logarithm(0, 0) + logarithm(1, 1) - A[0][0] - A[1][1];
      motion[0].fill(A[0][0] + volume / 3.0);
      motion[1].fill(A[1][1] + volume / 3.0);
      motion[2].fill(volume / 3.0);
      motion[3].fill(0.5 * (A[0][1] + A[1][0]));
      motion[4].fill(0.5 * (A[1][0] - A[0][1]));
    }
    for (std::size_t f = 0; f < field.size(); ++f) field[f].fill(point[f]);
    Batch batch;
    batch.count = 1;
    batch.dt = dt;
    for (std::size_t k = 0; k < 4; ++k) batch.strain[k] = motion[k].data();
    batch.spin = {motion[4].data()};
    batch.density = field[RHO].data();
    for (std::size_t k = 0; k < 4; ++k) batch.stress[k] = field[SXX + k].data();
    for (std::size_t k = 0; k < max_state; ++k) batch.state[k] = field[STATE + k].data();
    EXPECT_TRUE(materials_[point.body]->update(batch).ok());
    for (std::size_t f = SXX; f < field.size(); ++f) point.field[f] = field[f][0];
    // no looser than a grid can tell: 0.2 m/h²
    point.field[RHO] = std::max(point[RHO], 0.2 * point[MASS] / (scene_.h * scene_.h));
  }

  Scene scene_;
  std::vector<PointState> points_;
  std::vector<std::shared_ptr<const Material>> materials_;
  Vector gravity_{};
};

/// The largest difference of a field between two states of the same points, over its largest value.
inline double difference(const std::vector<PointState>& a, const std::vector<PointState>& b,
                         std::initializer_list<std::size_t> fields) {
  double largest = 0.0, scale = 0.0;
  EXPECT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    for (const std::size_t f : fields) {
      EXPECT_EQ(a[k].id, b[k].id);
      largest = std::max(largest, std::abs(a[k][f] - b[k][f]));
      scale = std::max(scale, std::abs(b[k][f]));
    }
  return scale > 0.0 ? largest / scale : largest;
}

}  // namespace repose::mpm::reference

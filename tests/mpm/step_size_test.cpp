/// The bound of step_size.hpp on the frequencies of the grid, against their exact values.

#include <map>
#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "mpm/grid/kernel.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

/// One scalar field on a grid of 9 × 9 nodes, h = 1: L_p = D⁻¹ Σ w v_i (x_i − x_p), potential
/// energy ½Σ m c² |L_p|², kinetic energy ½Σ m_i v_i².
template <class Kernel>
class Membrane {
 public:
  static constexpr int edge = 9, nodes = edge * edge;

  void add(double x, double y, double m, double c) {
    const double ax = Kernel::anchor(x), ay = Kernel::anchor(y);
    const auto wx = Kernel::weights(x - ax), wy = Kernel::weights(y - ay);
    Eigen::VectorXd w = Eigen::VectorXd::Zero(nodes), Lx = w, Ly = w;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const double weight = wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)];
        if (weight == 0.0) continue;
        const double node_x = ax - 1.0 + i, node_y = ay - 1.0 + j;
        const int n = static_cast<int>(node_y) * edge + static_cast<int>(node_x);
        w[n] = weight;
        Lx[n] = Kernel::inverse_moment * weight * (node_x - x);
        Ly[n] = Kernel::inverse_moment * weight * (node_y - y);
      }
    mass += m * w;
    signal += m * c * c * w;
    stiffness += m * c * c * (Lx * Lx.transpose() + Ly * Ly.transpose());
  }

  /// Largest ω², and D⁻¹ max c_i².
  std::array<double, 2> exact_and_bound() const {
    std::vector<int> live;
    for (int n = 0; n < nodes; ++n)
      if (mass[n] > 0.0) live.push_back(n);
    const auto n = static_cast<Eigen::Index>(live.size());
    Eigen::MatrixXd K(n, n);
    double most = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const int at = live[static_cast<std::size_t>(i)];
      most = std::max(most, signal[at] / mass[at]);
      for (Eigen::Index j = 0; j < n; ++j) {
        const int to = live[static_cast<std::size_t>(j)];
        K(i, j) = stiffness(at, to) / std::sqrt(mass[at] * mass[to]);
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(K, Eigen::EigenvaluesOnly);
    return {modes.eigenvalues()[n - 1], Kernel::inverse_moment * most};
  }

 private:
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(nodes), signal = mass;
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(nodes, nodes);
};

template <class Kernel>
class NodeSignal : public ::testing::Test {};
using Kernels = ::testing::Types<QuadraticKernel, CubicKernel>;
TYPED_TEST_SUITE(NodeSignal, Kernels);

TYPED_TEST(NodeSignal, BoundsEveryFrequency) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(2.0, 6.0), part(0.1, 1.0);
  for (const int points : {1, 3, 20, 80})
    for (int cloud = 0; cloud < 20; ++cloud) {
      Membrane<TypeParam> membrane;
      for (int p = 0; p < points; ++p)
        membrane.add(place(random), place(random), part(random), std::pow(part(random), 3.0));
      const auto [exact, bound] = membrane.exact_and_bound();
      EXPECT_LE(exact, bound * (1.0 + 1e-12)) << points << " points";
      // one point alone reaches it: Σ w d = 0 and Σ w d² = D make both steps equalities
      if (points == 1) {
        EXPECT_NEAR(exact, bound, 1e-12 * bound);
      }
    }
}

TYPED_TEST(NodeSignal, OneStiffPointAmongSoftOnesIsHeldByItsNeighbours) {
  Membrane<TypeParam> membrane;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      membrane.add(2.25 + 0.5 * i, 2.25 + 0.5 * j, 0.25, i == 4 && j == 4 ? 3.0 : 1.0);
  const auto [exact, bound] = membrane.exact_and_bound();
  EXPECT_LE(exact, bound);
  EXPECT_LT(bound, 0.4 * 9.0 * TypeParam::inverse_moment);  // 9 = the square of its own signal
}

// The solver's own: a softer and a stiffer grain bed side by side take the stiffer one's step; one
// stiff point does not set it.
TEST(NodeShare, FollowsTheScene) {
  Scene scene = column_collapse(cam_clay(), 0.0125);
  scene.courant = 0.4;
  Simulation simulation(scene);
  run_until(simulation, 0.25);
  // c of the fastest point by MCC-4, c² = (1 + 4G/3K) p/(κρ), as of the last step
  const Simulation::Snapshot shot = simulation.snapshot();
  double fastest = 0.0;
  const double G_over_K = 3.0 * (1.0 - 0.6) / (2.0 * 1.3);
  for (std::size_t k = 0; k < shot.x_m.size(); ++k)
    fastest = std::max(fastest,
                       std::sqrt((1.0 + 4.0 / 3.0 * G_over_K) * std::max(0.0, shot.pressure_Pa[k]) /
                                 (0.0010 * shot.density[k])));
  const double of_points = 0.4 * 0.0125 / fastest;
  EXPECT_GT(simulation.next_dt(), 1.2 * of_points);  // 1.9 at the paper's h
  EXPECT_LT(simulation.next_dt(), 4.0 * of_points);
}

// The share itself, from the points as they lie: the largest c_i² = Σ w c_p²/Σ w of any node (the
// masses are alike) over the largest c_p². A step earlier the toe's pressures differ by some per
// cent.
TEST(NodeShare, IsTheRootOfTheLargestNodeOverTheLargestPoint) {
  Scene scene = column_collapse(cam_clay(), 0.0125);
  scene.courant = 0.4;
  Simulation simulation(scene);
  run_until(simulation, 0.25);
  const Simulation::Snapshot shot = simulation.snapshot();
  const double stiff = (1.0 + 4.0 / 3.0 * 3.0 * (1.0 - 0.6) / (2.0 * 1.3)) / 0.0010;
  std::map<std::pair<int, int>, std::pair<double, double>> nodes;
  double fastest = 0.0, most = 0.0;
  for (std::size_t k = 0; k < shot.x_m.size(); ++k) {
    const double c2 = stiff * std::max(0.0, shot.pressure_Pa[k]) / shot.density[k];
    fastest = std::max(fastest, c2);
    const double x = shot.x_m[k] / scene.h, y = shot.y_m[k] / scene.h;
    const double ax = CubicKernel::anchor(x), ay = CubicKernel::anchor(y);
    const auto wx = CubicKernel::weights(x - ax), wy = CubicKernel::weights(y - ay);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const double w = wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)];
        // what is behind the floor or the left wall is mirrored
        const int ix = std::abs(static_cast<int>(ax) - 1 + i);
        const int iy = std::abs(static_cast<int>(ay) - 1 + j);
        auto& node = nodes[{ix, iy}];
        node.first += w * c2;
        node.second += w;
      }
  }
  for (const auto& [place, node] : nodes)
    if (node.second > 0.0) most = std::max(most, node.first / node.second);
  const double expected = 0.4 * scene.h / std::sqrt(most);
  EXPECT_LT(most, 0.7 * fastest);  // so that a root makes a difference
  EXPECT_NEAR(simulation.next_dt(), expected, 0.1 * expected);
}

// Diffusion by the grid's own Laplacian is stable up to Δt = ρh²/4η in the plane; 0.9 of it is
// taken.
TEST(StepSize, OfAViscousFluidIsNineTenthsOfTheLimitOfDiffusion) {
  const double eta = 500.0, rho = 1300.0;
  Scene scene = column_collapse(newtonian(eta, 26e3, 7.0, rho), 0.0125);
  Simulation simulation(scene);
  simulation.step(1.0);
  EXPECT_NEAR(simulation.next_dt(), 0.9 * rho * scene.h * scene.h / (4.0 * eta),
              0.01 * simulation.next_dt());
}

}  // namespace
}  // namespace repose::mpm

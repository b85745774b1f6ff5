/// The solver against the plain method of reference_step.hpp, step by step.

#include "tests/mpm/reference_step.hpp"

#include <gtest/gtest.h>

#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

constexpr double h = 0.05;

/// Bodies thrown into the corners of a small box and at each other: every stencil meets a wall
/// sooner or later. 23 × 13 cells, so that the far walls cut through blocks.
Scene melee(Kernel kernel, const Wall& sides, const Wall& base, const LawSpec& law) {
  Scene scene = empty_box(23 * h, 13 * h, h);
  scene.kernel = kernel;
  scene.gravity = 9.8;
  scene.tilt_deg = 20.0;
  scene.left = scene.right = sides;
  scene.floor = scene.top = base;
  scene.courant = 0.6;
  const std::array<double, 3> velocities[] = {{-3, -2}, {3, -3}, {2, 3}, {-2, 3}, {4, 1}};
  const std::array<double, 2> places[] = {{1, 1}, {17, 1}, {17, 7}, {1, 7}, {9, 4}};
  for (std::size_t b = 0; b < 5; ++b) {
    Body body = block(places[b][0] * h, places[b][1] * h, 5 * h, 5 * h, law);
    body.velocity = velocities[b];
    body.spin = 6.0 - 3.0 * static_cast<double>(b);
    if (law.name != "modified_cam_clay") body.initial.p = 500.0 * static_cast<double>(b);
    scene.bodies.push_back(body);
  }
  return scene;
}

/// The affine velocities of all points, which the comparison of fields does not see.
double affine_difference(const std::vector<PointState>& a, const std::vector<PointState>& b) {
  double largest = 0.0, scale = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t j = 0; j < affine_fields; ++j) {
      largest = std::max(largest, std::abs(a[k].affine[j] - b[k].affine[j]));
      scale = std::max(scale, std::abs(b[k].affine[j]));
    }
  return largest / scale;
}

/// Runs both and compares all they have.
void expect_same(const Scene& scene, int steps) {
  Simulation simulation(scene, 2);
  reference::Model model(simulation);
  for (int k = 0; k < steps; ++k) {
    const double before = simulation.time();
    simulation.step(HUGE_VAL);
    model.step(simulation.time() - before);
  }
  EXPECT_GT(simulation.counters().sorts, 10) << "the run was long enough to sort";
  // round-off: sums of up to 50 terms in another order, every step, in units of the largest value
  const double tolerance = steps * 100 * 2.2e-16;
  const auto found = points_of(simulation);
  EXPECT_LT(reference::difference(found, model.points(), {X, Y}), tolerance);
  EXPECT_LT(reference::difference(found, model.points(), {VX, VY}), tolerance);
  EXPECT_LT(reference::difference(found, model.points(), {LXX, LXY, LYX, LYY}), tolerance);
  EXPECT_LT(affine_difference(found, model.points()), tolerance);
  EXPECT_LT(reference::difference(found, model.points(), {RHO}), tolerance);
  EXPECT_LT(reference::difference(found, model.points(), {SXX, SYY, SZZ, SXY}), tolerance);
}

class ReferenceStepTest : public ::testing::TestWithParam<Kernel> {};

TEST_P(ReferenceStepTest, NewtonianBetweenSlipWalls) {
  expect_same(
      melee(GetParam(), {Wall::Kind::slip}, {Wall::Kind::slip}, newtonian(0.5, 2e4, 2, 1000)), 200);
}

TEST_P(ReferenceStepTest, GrainsBetweenNoSlipWalls) {
  expect_same(melee(GetParam(), {Wall::Kind::no_slip}, {Wall::Kind::no_slip}, mu_i(2e4)), 200);
}

TEST_P(ReferenceStepTest, ClayOnNoSlipBetweenSlip) {
  LawSpec clay = cam_clay();  // softer than the paper's, so that 200 steps are a long time
  clay.values["lambda"] = 0.2;
  clay.values["kappa"] = 0.05;
  clay.values["Gamma"] = 2.5;
  expect_same(melee(GetParam(), {Wall::Kind::slip}, {Wall::Kind::no_slip}, clay), 200);
}

TEST_P(ReferenceStepTest, EveryTransfer) {
  for (const Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::aflip, Transfer::relaxed,
                                  Transfer::tpic, Transfer::xpic, Transfer::fmpm}) {
    SCOPED_TRACE(transfer_names[static_cast<std::size_t>(transfer)]);
    Scene scene = melee(GetParam(), {Wall::Kind::slip}, {Wall::Kind::no_slip}, mu_i(2e4));
    scene.transfer = transfer;
    if (transfer == Transfer::relaxed) scene.relaxation_time = 2e-3;  // about two steps
    scene.order = 3;                                                  // of xpic and fmpm
    expect_same(scene, 100);
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, ReferenceStepTest,
                         ::testing::Values(Kernel::cubic, Kernel::quadratic),
                         [](const auto& kernel) {
                           return kernel.param == Kernel::cubic ? "cubic" : "quadratic";
                         });

}  // namespace
}  // namespace repose::mpm

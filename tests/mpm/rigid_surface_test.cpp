/// Bodies on rigid surfaces that lie across the grid.

#include <gtest/gtest.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double g = 10.0;

struct Turned {
  double angle;  ///< of the plane against the grid [°]
  double friction;
  double h;
  Transfer transfer = Transfer::relaxed;
};
void PrintTo(const Turned& t, std::ostream* out) {
  *out << t.angle << " deg, friction " << t.friction << ", h " << t.h << ", "
       << name_of(t.transfer);
}

/// A stiff block on a plane of 45° against gravity, the two turned together against the grid.
class BlockOnPlaneTest : public testing::TestWithParam<Turned> {
 protected:
  static constexpr double length = 1.2, height = 0.4;

  Scene scene(double slope) const {
    const Turned& t = GetParam();
    const double a = -t.angle * degree, way = 10.5 + length;
    const std::array<double, 2> along{std::cos(a), std::sin(a)}, up{-std::sin(a), std::cos(a)};
    // 1.5 m of room to the edges, all around the way
    const std::array<double, 2> start{1.5, 1.5 - std::min(0.0, along[1]) * way};
    const auto whole = [&](double x) { return std::ceil(x / t.h) * t.h; };
    Scene scene = empty_box(whole(start[0] + way * along[0] + 1.5), whole(start[1] + 1.5), t.h);
    scene.transfer = t.transfer;
    scene.gravity = g;
    scene.tilt_deg = slope - t.angle;
    Surface plane;
    plane.solid.shape = HalfSpace{{start[0], start[1], 0.0}, {up[0], up[1], 0.0}};
    plane.contact = Surface::Contact::friction;
    plane.friction = t.friction;
    scene.surfaces = {plane};
    Body body = block(0.0, 0.0, 1.0, 1.0, unyielding());
    Polygon corners;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {length, 0.0}, {length, height}, {0.0, height}})
      corners.corners.push_back(
          {start[0] + x * along[0] + y * up[0], start[1] + x * along[1] + y * up[1]});
    set_polygon(body, corners);
    scene.bodies = {body};
    return scene;
  }
  /// Of the mass, along the plane.
  static double place(const Simulation& simulation) {
    const double a = -GetParam().angle * degree;
    double x = 0.0, mass = 0.0;
    for (const PointState& p : points_of(simulation)) {
      x += p[MASS] * (p[X] * std::cos(a) + p[Y] * std::sin(a));
      mass += p[MASS];
    }
    return x / mass;
  }
};

TEST_P(BlockOnPlaneTest, SlidesAgainstItsFriction) {
  Simulation simulation(scene(45.0), 1);
  const double start = place(simulation);
  const double mass = simulation.diagnostics().mass_kg_per_m;
  EXPECT_NEAR(mass, 1300.0 * length * height, 1e-12 * mass);
  const double t = 1.999;
  run_until(simulation, t);
  const double way = place(simulation) - start;
  const double exact = 0.5 * g * std::sqrt(0.5) * (1.0 - GetParam().friction) * t * t;
  const SeriesRow row = simulation.diagnostics();
  const double fall = mass * g * std::sqrt(0.5) * way;
  std::printf(
      "[ measured ] %s: way %.4f m, exact %.4f, %.2f %%; residual/fall %.2g; friction work %.4f\n",
      testing::PrintToString(GetParam()).c_str(), way, exact, 100.0 * (way / exact - 1.0),
      row.energy_residual_J_per_m / fall, row.wall_loss_J_per_m / (fall * GetParam().friction));
  EXPECT_NEAR(way, exact, 0.01 * exact);
}

std::vector<Turned> planes() {
  std::vector<Turned> all;
  for (const double h : {0.1, 0.05})
    for (const double friction : {0.3, 0.5})
      for (const double angle : {0.0, 17.0, 45.0, 80.0}) all.push_back({angle, friction, h});
  for (const Transfer transfer : {Transfer::apic, Transfer::flip, Transfer::tpic})
    all.push_back({17.0, 0.5, 0.1, transfer});
  return all;
}
INSTANTIATE_TEST_SUITE_P(Angles, BlockOnPlaneTest, testing::ValuesIn(planes()));

}  // namespace
}  // namespace repose::mpm

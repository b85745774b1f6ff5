/// step.pressure_averaging: what it keeps, what it takes away, and what it must not do.

#include "mpm/step/pressure_averaging.hpp"

#include <gtest/gtest.h>

#include "models/scalar.hpp"
#include "mpm/output/rest_pressure.hpp"
#include "mpm/step/transfer.hpp"
#include "tests/mpm/point_cloud.hpp"
#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

// --- through the grid ---

constexpr double h = 0.25;
constexpr std::array<int, 2> origin{16 - tile_margin_x, 8 - tile_margin_y};

/// Points all over a block, no two alike.
PointSet cloud() { return random_points(200, {4.0, 2.0}, {6.0, 3.0}, 11); }

/// ē of every point.
template <class K>
AlignedVector<double> means(PointSet points, const AlignedVector<double>& elastic) {
  const SlotRange all{0, points.count};
  Tile tile;
  for (auto& channel : tile) channel.fill(0.0);
  points_to_tile<K, true, true>(points, all, h, origin, elastic.data(), tile);
  VelocityTile nodes{};
  for (std::size_t n = 0; n < tile_nodes; ++n)
    if (tile[T_MASS][n] > 0.0) nodes.elastic[n] = tile[T_EXTRA][n] / tile[T_MASS][n];
  AlignedVector<double> vx(points.count), vy(points.count), mean(points.count);
  tile_to_points<K, Keeps::nothing, true>(nodes, origin, h, all, Retention{}, points,
                                          {{vx.data(), vy.data()}, mean.data()});
  return mean;
}

template <class K>
class AveragingTransferTest : public ::testing::Test {};
using Kernels = ::testing::Types<CubicKernel, QuadraticKernel>;
TYPED_TEST_SUITE(AveragingTransferTest, Kernels);

// 1e-12: sums of 200 terms of order one. A mean has no new extremes.
TYPED_TEST(AveragingTransferTest, KeepsTheSumAndTheBounds) {
  const PointSet points = cloud();
  AlignedVector<double> e(points.count);
  for (std::size_t s = 0; s < points.count; ++s) e[s] = points[SXX][s];  // any numbers in (−1, 1)
  const AlignedVector<double> mean = means<TypeParam>(points, e);
  double before = 0.0, after = 0.0, change = 0.0;
  const auto [least, most] = std::minmax_element(e.begin(), e.end());
  for (std::size_t s = 0; s < points.count; ++s) {
    before += points[MASS][s] * e[s];
    after += points[MASS][s] * mean[s];
    change += std::abs(mean[s] - e[s]);
    EXPECT_GT(mean[s], *least);
    EXPECT_LT(mean[s], *most);
  }
  EXPECT_NEAR(after, before, 1e-12);
  EXPECT_GT(change, 0.25 * static_cast<double>(points.count)) << "of a mean |e| of a half";
}

TYPED_TEST(AveragingTransferTest, KeepsWhatIsUniform) {
  const PointSet points = cloud();
  const AlignedVector<double> e(points.count, -0.7);
  for (const double mean : means<TypeParam>(points, e)) EXPECT_NEAR(mean, -0.7, 1e-14);
}

// --- at the point ---

struct Case {
  const char* name;
  LawSpec law;
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
const Case every_law[] = {{"newtonian", newtonian(1.0, 26000.0, 7.0, 1300.0)},
                          {"cohesive", newtonian(1.0, 26000.0, 7.0, 1300.0, true)},
                          {"mu_i", mu_i()},
                          {"mu_i_regularised", mu_i(254800.0, "regularised")},
                          {"cam_clay", cam_clay()},
                          {"cam_clay_v", cam_clay("v-ln_p")},
                          {"critical_state", critical_state()}};

/// One point under an isotropic pressure, with room for a pack.
struct OnePoint {
  using Pad = std::array<double, pack_size>;
  std::shared_ptr<const Material> material;
  std::array<Pad, 4> stress{}, state{}, strain{};
  Pad density{}, work{}, averaging{}, before{};

  OnePoint(const LawSpec& law, double p) : material(make_material(law)) {
    InitialConditions given;
    given.p = p;
    if (law.name == "modified_cam_clay") given.ocr = 2.0;
    const InitialPoint at = material->initial(given);
    for (int k = 0; k < 4; ++k) stress[static_cast<std::size_t>(k)].fill(at.stress[k]);
    for (std::size_t k = 0; k < at.state.size(); ++k) state[k].fill(at.state[k]);
    density.fill(at.density);
  }
  double pressure() const { return -(stress[0][0] + stress[1][0] + stress[2][0]) / 3.0; }

  /// e, from p_contact or 0.
  double elastic() {
    Pad e{};
    material->elastic_volume_strain(view(), e.data());
    return e[0];
  }

  /// Simple shear by gamma in one step, among neighbours at `mean`.
  void shear(double gamma, double rate, double mean) {
    for (Pad& pad : strain) pad.fill(0.0);
    strain[3].fill(0.5 * gamma);
    averaging.fill(mean);
    Batch batch = view();
    add_averaging_strain(*material, batch, rate, averaging.data(), before.data(),
                         {strain[0].data(), strain[1].data(), strain[2].data(), strain[3].data()});
    ASSERT_TRUE(material->update(batch).ok());
    take_back_averaging_work(batch, averaging.data(), before.data());
  }

 private:
  Batch view() {
    Batch batch;
    batch.count = 1;
    batch.dt = 1e-4;
    for (std::size_t k = 0; k < 4; ++k) {
      batch.strain[k] = strain[k].data();
      batch.stress[k] = stress[k].data();
      batch.state[k] = state[k].data();
    }
    batch.density = density.data();
    batch.work = work.data();
    return batch;
  }
};

class AveragingPointTest : public ::testing::TestWithParam<Case> {
 protected:
  /// e under 1500 Pa at the density of a point.
  static double neighbour(const OnePoint& point) {
    OnePoint other(GetParam().law, 1500.0);
    other.density = point.density;
    return other.elastic();
  }
};

// The strain is the law's own: where nothing of the difference is left, the point is at its
// neighbours' pressure, here below its own (elastic in Cam-Clay, whose ocr is 2). No law feels a
// shear of gamma = 1e-9, and c gamma = 100. 2e-10: round-off of density, 2e-16, times K/p <= 1000,
// times a thousand for the exponentials. On v - ln p lines e = -(κ/v) ln(p/p_sep), and v changes by
// κ ln(4/3) = 3e-4 on the way: 1e-2 for that times ln(p/p_sep) = 12.
TEST_P(AveragingPointTest, ReachesThePressureOfItsNeighbours) {
  OnePoint point(GetParam().law, 2000.0);
  const double rho = point.density[0];
  const double mean = neighbour(point);
  point.shear(1e-9, 1e11, mean);
  const bool first_order = GetParam().name == std::string("cam_clay_v");
  EXPECT_NEAR(point.pressure() / 1500.0, 1.0, first_order ? 1e-2 : 2e-10);
  EXPECT_LT(point.density[0], rho);
}

// e − ē decays as e^{−cγ}, in one step or in many. 1e-9 of the difference of some 1e-3: round-off
// of e from a pressure, 2e-16 K/p, and the shear of 1e-7 itself in Cam-Clay's pressure, of its
// second order.
TEST_P(AveragingPointTest, DecaysPerUnitOfStrainNotPerStep) {
  const double gamma = 1e-7, rate = 1e7;
  const double mean = neighbour(OnePoint(GetParam().law, 2000.0));
  std::vector<double> pressure;
  for (const int steps : {1, 2, 16}) {
    OnePoint point(GetParam().law, 2000.0);
    const double start = point.elastic();
    for (int k = 0; k < steps; ++k) point.shear(gamma / steps, rate, mean);
    const double left = (point.elastic() - mean) / (start - mean);
    const bool first_order = GetParam().name == std::string("cam_clay_v");
    EXPECT_NEAR(left, std::exp(-1.0), first_order ? 2e-2 : 1e-9) << steps;
    pressure.push_back(point.pressure());
  }
  EXPECT_NEAR(pressure[1] / pressure[0], 1.0, 1e-2);
  EXPECT_NEAR(pressure[2] / pressure[0], 1.0, 1e-2);
}

TEST_P(AveragingPointTest, DoesNothingWithoutShear) {
  OnePoint point(GetParam().law, 2000.0);
  point.shear(0.0, 1e9, 0.0);
  EXPECT_EQ(point.averaging[0], 0.0);
  EXPECT_NEAR(point.pressure(), 2000.0, 1e-9);
}

// What the averaging strain does on its own is no work of the motion.
TEST_P(AveragingPointTest, DoesNoWork) {
  OnePoint point(GetParam().law, 2000.0);
  point.shear(1e-9, 1e11, neighbour(point));
  const double of_shear =
      1e-9 * 2000.0;  // τγ with τ < p; the averaging strain alone: 0.6 to 8 J/m³
  EXPECT_NEAR(point.work[0], 0.0, of_shear);
}

INSTANTIATE_TEST_SUITE_P(Laws, AveragingPointTest, ::testing::ValuesIn(every_law),
                         [](const auto& one) { return std::string(one.param.name); });

// --- in a simulation ---

Scene collapse(double averaging) {
  Scene scene = column_collapse(mpm::mu_i());
  scene.transfer = Transfer::relaxed;
  scene.pressure_averaging = averaging;
  return scene;
}

// The target of at most 5 % of noise is meant relative to the largest pressure here: half of the
// points lie under a fifth of it, and the friction's own part (the deviator) is not averaged.
// Without, it is five times the target.
TEST(PressureAveragingTest, QuietensACollapsedHeapAndLeavesItsShape) {
  double noise[2]{}, height[2]{}, middle[2]{};
  for (const bool averages : {false, true}) {
    Simulation simulation(collapse(averages ? 100.0 : 0.0), 1);
    run_until(simulation, 1.2);
    noise[averages] = simulation.rest_pressure(Stress::points).pressure_of_largest.noise;
    height[averages] = simulation.diagnostics().height_m;
    std::vector<double> x = simulation.snapshot().x_m;
    std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
    middle[averages] = x[x.size() / 2];
  }
  EXPECT_GT(noise[0], 0.2);
  EXPECT_LT(noise[1], 0.05);
  // shape: within 1 %, the change that is asked of a step four times smaller
  EXPECT_NEAR(height[1] / height[0], 1.0, 0.01);
  EXPECT_NEAR(middle[1] / middle[0], 1.0, 0.01);
}

// A column that has settled under its weight bears it to less than 1 %, averaging or not.
TEST(PressureAveragingTest, ASelfWeightColumnKeepsItsPressure) {
  Scene scene = empty_box(0.08, 0.6, 0.02);
  scene.gravity = 9.8;
  scene.floor = {Wall::Kind::no_slip};
  scene.bodies = {block(0.0, 0.0, 0.08, 0.4, newtonian(800.0, 254800.0, 1.0, 1300.0))};
  scene.pressure_averaging = 100.0;
  Simulation simulation(scene, 1);
  run_until(simulation, 1.2);
  const RestPressure rest = simulation.rest_pressure(Stress::points);
  EXPECT_GT(rest.points, 200);
  EXPECT_LT(rest.pressure.total, 0.01);
}

TEST(PressureAveragingTest, SameBitsForAnyNumberOfThreadsAndAfterRestart) {
  Simulation one(collapse(100.0), 1);
  Simulation two(collapse(100.0), 2);
  run_steps(one, 300);
  run_steps(two, 150);
  const ScratchFile file;
  two.save(file.path());
  Simulation resumed(collapse(100.0), 2);
  resumed.load(file.path());
  run_steps(resumed, 150);
  EXPECT_TRUE(saved_state(one) == saved_state(resumed));
}

TEST(PressureAveragingTest, MustNotBeNegative) {
  Scene scene = collapse(-1.0);
  try {
    validate(scene);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "step.pressure_averaging");
    EXPECT_STREQ(error.what(), "pressure_averaging = -1 is out of range: must be >= 0");
  }
}

}  // namespace
}  // namespace repose::mpm

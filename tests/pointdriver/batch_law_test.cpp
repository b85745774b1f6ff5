/// A law that is known by its batches alone: what the Material around it does, its tangent, and its
/// point driver, against closed forms of isotropic elasticity.

#include "models/batch_law.hpp"

#include <gtest/gtest.h>

#include "models/registry.hpp"
#include "models/tangent.hpp"
#include "pointdriver/integrate/gradient.hpp"
#include "pointdriver/integrate/material_driver.hpp"

namespace repose {
namespace {

constexpr std::array<ParamInfo, 3> parameters{
    {{"K", "K", "Pa", "bulk modulus", Need::required, 0.0, positive},
     {"G", "G", "Pa", "shear modulus", Need::required, 0.0, positive},
     {"rho_0", "rho_0", "kg/m3", "density", Need::defaulted, 1500.0, positive}}};
constexpr std::array<StateField, 1> state{{{"volume", "", "-", "volume strain so far"}}};
constexpr LawInfo info{"batch_elastic", "", "", "isotropic, hypoelastic", parameters, state, true};

/// dσ = 2G dε + (K − 2G/3) tr(dε) I
class Elastic final : public BatchLaw {
 public:
  explicit Elastic(std::vector<double> theta) : BatchLaw(info, std::move(theta)) {}
  InitialPoint initial(const InitialConditions& given) const override {
    return {initial_stress(given, 0.0), {0.0}, theta()[2]};
  }
  double density_at(double, double) const override { return theta()[2]; }

 private:
  void advance(const PointArrays& p) const override {
    for (std::size_t i = 0; i < p.count; ++i) {
      const double volume = p.strain[i] + p.strain[p.count + i] + p.strain[2 * p.count + i];
      for (std::size_t k = 0; k < p.components; ++k)
        p.stress[k * p.count + i] += 2.0 * theta()[1] * p.strain[k * p.count + i] +
                                     (k < 3 ? (theta()[0] - 2.0 * theta()[1] / 3.0) * volume : 0.0);
      p.state[i] += volume;
    }
  }
  void wave_modulus(const PointArrays& p, double* rho_c2) const override {
    std::fill_n(rho_c2, p.count, theta()[0] + 4.0 * theta()[1] / 3.0);
  }
  void step_viscosity(const PointArrays& p, double* eta) const override {
    std::fill_n(eta, p.count, 0.0);
  }
  void energy(const PointArrays& p, double* stored) const override {
    std::fill_n(stored, p.count, 0.0);
  }
};

const LawInfo& registered() {
  static const bool once = [] {
    OutsideLaw law;
    law.info = &info;
    law.complete = [](std::vector<double>&) {};
    law.make = [](std::vector<double> theta) {
      return std::make_unique<Elastic>(std::move(theta));
    };
    law.point = point::material_driver(info, law.complete, law.make);
    register_law({law});
    return true;
  }();
  EXPECT_TRUE(once);
  return info;
}

constexpr double K = 1e6, G = 6e5;
const LawSpec spec{"batch_elastic", {}, {{"K", K}, {"G", G}}};

/// 20 points, the last 12 entries padding; point i strained i times as far.
struct Points {
  static constexpr std::size_t count = 20, room = padded(count);
  std::array<std::array<double, room>, 4> stress{}, strain{};
  std::array<double, room> volume{}, density{}, spin{}, work{}, modulus{};
  Batch batch;

  Points() {
    batch.count = count;
    batch.dt = 1.0;
    density.fill(1500.0);
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t i = 0; i < room; ++i) {
        const double n = static_cast<double>(std::min(i, count - 1));
        stress[k][i] = k < 3 ? -1e3 : 100.0;
        strain[k][i] = 1e-4 * n * (k == 3 ? 0.5 : 1.0);
        spin[i] = 0.01 * n;
      }
      batch.stress[k] = stress[k].data();
      batch.strain[k] = strain[k].data();
    }
    batch.state[0] = volume.data();
    batch.density = density.data();
    batch.work = work.data();
    batch.modulus = modulus.data();
  }
};

TEST(BatchLaw, StrainsRotatesAndCountsWork) {
  registered();
  const std::unique_ptr<Material> material = make_material(spec);
  Points points;
  points.batch.spin[0] = points.spin.data();
  ASSERT_TRUE(material->update(points.batch).ok());
  for (std::size_t i = 0; i < Points::room; ++i) {
    const double n = static_cast<double>(std::min(i, Points::count - 1)), e = 1e-4 * n;
    // Cayley's rotation by ω turns the deviator by 4 atan(ω/2) (Hughes & Winget 1980)
    const double turn = 4.0 * std::atan(0.5 * 0.01 * n);
    // a few roundings of 1e3 Pa
    EXPECT_NEAR(points.stress[0][i], -1e3 - 100.0 * std::sin(turn) + 3.0 * K * e, 1e-11);
    EXPECT_NEAR(points.stress[3][i], 100.0 * std::cos(turn) + G * e, 1e-11);
    EXPECT_NEAR(points.density[i], 1500.0 * std::exp(-3.0 * e), 1e-12 * 1500.0);
    EXPECT_NEAR(points.volume[i], 3.0 * e, 1e-18);
    EXPECT_EQ(points.modulus[i], K + 4.0 * G / 3.0);
  }
}

TEST(BatchLaw, PutsAPointBackThatCannotBeAdvanced) {
  registered();
  const std::unique_ptr<Material> material = make_material(spec);
  Points points;
  points.strain[2][7] = std::nan("");
  const UpdateReport report = material->update(points.batch);
  EXPECT_EQ(report.failed, 7U);
  EXPECT_EQ(points.stress[0][7], -1e3);
  EXPECT_EQ(points.density[7], 1500.0);
  EXPECT_EQ(points.volume[7], 0.0);
  EXPECT_EQ(points.work[7], 0.0);
  EXPECT_NE(points.stress[0][8], -1e3);
}

TEST(Tangent, ByDifferencesIsThatOfALinearLaw) {
  registered();
  const std::unique_ptr<Material> material = make_material(spec);
  Points points;
  std::vector<double> tangent(Points::count * 16);
  ASSERT_TRUE(consistent_tangent(*material, points.batch, tangent.data()).ok());
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = 0; b < 4; ++b) {
      const double exact = (a == b ? 2.0 * G : 0.0) + (a < 3 && b < 3 ? K - 2.0 * G / 3.0 : 0.0);
      // round-off of stresses of up to 1e4 Pa over 2e-7: 1e-5 Pa
      EXPECT_NEAR(tangent[19 * 16 + 4 * a + b], exact, 1e-4);
    }
}

point::PointTest drained() {
  point::Stage stage;
  stage.goal = point::Goal{point::Quantity::eps_a, 0.01};
  stage.points = 5;
  point::PointTest test;
  test.path = point::path_of({stage});
  test.initial.p = 1e4;
  return test;
}

TEST(MaterialDriver, MeetsAMixedControl) {
  const LawInfo& law = registered();
  const std::vector<double> theta = checked_parameters(spec);
  point::Curve curve;
  ASSERT_EQ(point::simulate(law, theta, drained(), curve).status, point::Status::completed);
  std::vector<double> q, eps_a;
  point::read_column(law, theta, drained(), curve, point::Quantity::q, q);
  point::read_column(law, theta, drained(), curve, point::Quantity::eps_a, eps_a);
  ASSERT_EQ(q.size(), 6U);
  const double E = 9.0 * K * G / (3.0 * K + G);
  // the control is met to 1e-12 of the stress, at the end 2.5e4 Pa
  for (std::size_t i = 0; i < q.size(); ++i) EXPECT_NEAR(q[i], E * eps_a[i], 1e-11 * 2.5e4);
}

TEST(MaterialDriver, CarriesDerivatives) {
  const LawInfo& law = registered();
  const std::vector<double> theta = checked_parameters(spec);
  std::vector<point::GradientColumn> columns;
  const std::array<int, 2> which{0, 1};
  const std::array quantities{point::Quantity::q};
  ASSERT_EQ(point::simulate_columns_with_gradient(law, theta, which, drained(), quantities, columns)
                .status,
            point::Status::completed);
  const double bottom = (3.0 * K + G) * (3.0 * K + G);
  const double* const last = &columns[0].derivatives[2 * 5];
  // central differences over 1e-5 of the parameter: 1e-10 of the derivative, and 1e-12 of 2.5e4 Pa
  // over 2e-5 of it, 1e-7
  EXPECT_NEAR(last[0] / (0.01 * 9.0 * G * G / bottom), 1.0, 1e-6);
  EXPECT_NEAR(last[1] / (0.01 * 27.0 * K * K / bottom), 1.0, 1e-7);
}

TEST(BatchLaw, RefusesWhatItCannotSay) {
  registered();
  const std::unique_ptr<Material> material = make_material(spec);
  Points points;
  std::array<double, Points::room> out{};
  EXPECT_THROW(material->elastic_volume_strain(points.batch, out.data()), InputError);
  EXPECT_THROW(material->viscosity(points.batch, out.data(), out.data()), InputError);
}

}  // namespace
}  // namespace repose

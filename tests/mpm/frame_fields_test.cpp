/// What frames carry of the points beside position, velocity, density and stress.

#include "mpm/output/frame_fields.hpp"

#include <filesystem>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/mpm/scenes.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::mpm {
namespace {

std::vector<double> scalar(const io::FrameView& frame, std::string_view name) {
  for (const auto& field : frame.scalars)
    if (field.name == name) return {field.values.begin(), field.values.end()};
  return {};
}

/// Two blocks that fly without gravity through a large box.
Scene flying(std::size_t dimensions) {
  Scene scene;
  scene.name = "flying";
  scene.gravity = 0.0;
  scene.transfer = Transfer::apic;
  scene.h = 0.1;
  scene.points_per_cell = dimensions == 2 ? 4 : 8;
  scene.domain = {2.0, 1.0, dimensions == 2 ? 0.0 : 1.0};
  scene.end_time = 1.0;
  scene.shear_strain = true;
  const double deep = dimensions == 2 ? 0.0 : 0.4, z = dimensions == 2 ? 0.0 : 0.3;
  Body grains;
  grains.origin = {0.2, 0.3, z};
  grains.size = {0.4, 0.4, deep};
  grains.velocity = {0.5, 0.1, 0.0};
  grains.law = cam_clay();
  grains.initial.p = 1.0;
  grains.initial.ocr = 1.0;
  Body fluid = grains;
  fluid.origin[0] = 1.2;
  fluid.law = newtonian(1.0, 1e3, 1.0, 1000.0);
  fluid.initial = {};
  fluid.initial.density = 1000.0;
  scene.bodies = {grains, fluid};
  return scene;
}

class FrameFieldsTest : public ::testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, FrameFieldsTest, ::testing::Values(2, 3));

TEST_P(FrameFieldsTest, APointsNumberAndWayStayItsOwn) {
  Scene scene = flying(GetParam());
  scene.right.kind = Wall::Kind::open;
  scene.bodies[1].velocity = {3.0, 0.1, 0.0};  // its first points leave
  Simulation simulation(scene, 1);
  FrameFields fields(simulation);
  const std::vector<double> x = simulation.snapshot().x_m;
  while (simulation.time() < 0.2) simulation.step(0.2);
  const Simulation::Snapshot shot = simulation.snapshot();
  const io::FrameView frame = fields.view(shot, simulation.time());
  ASSERT_LT(shot.id.size(), x.size()) << "none has left";
  ASSERT_EQ(frame.vectors.back().name, "displacement_m");
  ASSERT_EQ(frame.integers.back().name, "point");
  for (std::size_t k = 0; k < shot.id.size(); ++k) {
    const auto id = static_cast<std::size_t>(frame.integers.back().values[k]);
    EXPECT_EQ(shot.x_m[k] - x[id], frame.vectors.back().x[k]);
    if (shot.body[k] == 0) {  // which nothing stops: 0.2 s with 0.5 and 0.1 m/s
      // the pressure of 1 Pa that it starts with throws its surface off at 2p/(ρc), ρ = 1300 kg/m³,
      // K = p/κ = 1000 Pa: 1.8e-3 m/s
      EXPECT_NEAR(frame.vectors.back().x[k], 0.1, 0.2 * 1.8e-3);
      EXPECT_NEAR(frame.vectors.back().y[k], 0.02, 0.2 * 1.8e-3);
    }
  }
}

TEST_P(FrameFieldsTest, WhatALawDoesNotHaveIsNoNumber) {
  Scene scene = flying(GetParam());
  Simulation simulation(scene, 1);
  FrameFields fields(simulation);
  const Simulation::Snapshot shot = simulation.snapshot();
  const io::FrameView frame = fields.view(shot, 0.0);
  const auto p_c = scalar(frame, "p_c_Pa"), v = scalar(frame, "specific_volume");
  ASSERT_EQ(p_c.size(), shot.id.size());
  ASSERT_EQ(v.size(), shot.id.size());
  EXPECT_TRUE(scalar(frame, "inertial_number").empty()) << "neither law has grains of a size";
  for (std::size_t k = 0; k < shot.id.size(); ++k) {
    if (shot.body[k] == 0) {
      EXPECT_DOUBLE_EQ(p_c[k], 1.0);  // ocr p
      EXPECT_DOUBLE_EQ(v[k], 2000.0 / shot.density[k]);
    } else {
      EXPECT_TRUE(std::isnan(p_c[k]) && std::isnan(v[k]));
    }
  }
  scene.bodies.pop_back();
  scene.bodies[0].law = mu_i();
  scene.bodies[0].initial = {};
  scene.bodies[0].initial.p = 100.0;
  scene.bodies[0].spin = 0.0;
  Simulation grains(scene, 1);
  FrameFields of_grains(grains);
  for (int step = 0; step < 5; ++step) grains.step(1.0);
  const Simulation::Snapshot moved = grains.snapshot();
  const io::FrameView after = of_grains.view(moved, grains.time());
  const auto I = scalar(after, "inertial_number"), strain = scalar(after, "volume_strain");
  const double rho_start = 1300.0 * (1.0 + 100.0 / 254800.0);  // p = K(ρ/ρ_0 − 1)
  ASSERT_EQ(I.size(), moved.id.size());
  for (std::size_t k = 0; k < I.size(); ++k) {
    const double p = moved.pressure_Pa[k];
    if (p > 0.0)
      EXPECT_NEAR(I[k], moved.shear_rate[k] * 0.0053 * std::sqrt(2000.0 / p), 1e-12 * I[k]);
    else
      EXPECT_TRUE(std::isnan(I[k]));
    // two logarithms' round-off
    EXPECT_NEAR(strain[k], std::log(moved.density[k] / rho_start), 1e-15);
  }
}

/// A fluid's strain of a step is Δt sym L of the very gradient that a snapshot shows, so the sum
/// over steps is known: to the round-off of n additions.
TEST_P(FrameFieldsTest, ShearStrainAddsUpTheRatesOfTheSteps) {
  Scene scene = flying(GetParam());
  scene.gravity = 9.8;
  scene.bodies.erase(scene.bodies.begin());
  scene.bodies[0].origin[1] = 0.0;
  for (const Storage storage : {Storage::double_precision, Storage::single_precision}) {
    scene.storage = storage;
    Simulation simulation(scene, 2);
    std::vector<double> sum(simulation.snapshot().id.size(), 0.0);
    constexpr int steps = 40;
    for (int step = 0; step < steps; ++step) {
      const double before = simulation.time();
      simulation.step(1.0);
      const std::vector<double> rate = simulation.snapshot().shear_rate;
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += (simulation.time() - before) * rate[k];
    }
    const std::vector<double> strain = simulation.snapshot().shear_strain;
    ASSERT_EQ(strain.size(), sum.size());
    const double most = *std::max_element(sum.begin(), sum.end());
    ASSERT_GT(most, 0.01);
    // in single precision gradient and sum are rounded to 24 bits each step
    const double unit = storage == Storage::double_precision ? 0x1p-52 : 0x1p-23;
    for (std::size_t k = 0; k < sum.size(); ++k)
      EXPECT_NEAR(strain[k], sum[k], 4.0 * steps * unit * most);
  }
}

/// Simple shear: A² = 0, so log(I + A) = A and every step adds γ̇Δt. Points that no wave from the
/// surface has reached have strained by γ̇t, and not in volume.
TEST(FrameFields, ShearStrainOfSimpleShearIsTheShear) {
  Scene scene = flying(2);
  scene.bodies.pop_back();
  scene.bodies[0].origin = {0.1, 0.1, 0.0};
  scene.bodies[0].size = {1.8, 0.8, 0.0};
  scene.bodies[0].law = {"neo_hookean", {}, {{"E", 1e3}, {"nu", 0.3}, {"rho_0", 1000.0}}};
  scene.bodies[0].initial = {};
  scene.bodies[0].velocity = {};
  const double rate = 0.5, t = 0.05;
  Prescribed shear;
  shear.start = [&](double, double y) {
    return PointMotion{{rate * y, 0.0}, {0.0, rate, 0.0, 0.0}};
  };
  Simulation simulation(scene, shear, 1);
  FrameFields fields(simulation);
  while (simulation.time() < t) simulation.step(t);
  const Simulation::Snapshot shot = simulation.snapshot();
  const auto strain = scalar(fields.view(shot, t), "volume_strain");
  // c = √(E(1 − ν)/((1 + ν)(1 − 2ν)ρ)) = 1.16 m/s: 0.06 m and two cells from the surface
  std::size_t inside = 0;
  for (std::size_t k = 0; k < shot.id.size(); ++k) {
    if (std::abs(shot.x_m[k] - 1.0) > 0.6 || std::abs(shot.y_m[k] - 0.5) > 0.14) continue;
    ++inside;
    EXPECT_NEAR(shot.shear_strain[k], rate * t, 1e-3 * rate * t) << shot.y_m[k];
    EXPECT_NEAR(strain[k], 0.0, 1e-3 * rate * t);
  }
  EXPECT_GT(inside, 100U);
}

TEST_P(FrameFieldsTest, ShearStrainSurvivesACheckpointToTheLastBit) {
  const ScratchFolder scratch;
  Scene scene = flying(GetParam());
  scene.gravity = 9.8;
  Simulation whole(scene, 2);
  for (int step = 0; step < 5; ++step) whole.step(1.0);
  whole.save(scratch.path() / "checkpoint.h5");
  for (int step = 0; step < 5; ++step) whole.step(1.0);
  Simulation resumed(scene, 1);
  resumed.load(scratch.path() / "checkpoint.h5");
  for (int step = 0; step < 5; ++step) resumed.step(1.0);
  EXPECT_EQ(whole.snapshot().shear_strain, resumed.snapshot().shear_strain);
}

}  // namespace
}  // namespace repose::mpm

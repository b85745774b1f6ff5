/// \file
/// What every law must fulfil at a point, whatever its physics: rest, objectivity, scalar types and
/// dimensions that agree, bad and extreme input, dissipation.

#include <Eigen/Dense>

#include "models/objective.hpp"
#include "tests/models/dissipation.hpp"
#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

template <class L>
class LawContract : public ::testing::Test {};
TYPED_TEST_SUITE(LawContract, LawTypes, LawName);

template <class L>
bool all_finite(const LawPoint<L>& point) {
  for (int k = 0; k < 6; ++k)
    if (!std::isfinite(point.stress[k])) return false;
  for (const double x : point.state)
    if (!std::isfinite(x)) return false;
  return true;
}

const Sym<double, 6> no_strain = Sym<double, 6>::isotropic(0.0);

/// What lifts parameters to another scalar type reads them off Params<double>.
TYPED_TEST(LawContract, ParamsAreTheParametersInTableOrder) {
  using L = TypeParam;
  using Params = typename L::template Params<double>;
  constexpr std::size_t count = L::parameters.size();
  static_assert(sizeof(Params) == count * sizeof(double));
  std::array<double, count> theta;
  for (std::size_t i = 0; i < count; ++i) theta[i] = 0.1 + 0.01 * static_cast<double>(i);
  const Params P = Params::from(std::span<const double>(theta));
  EXPECT_EQ((std::bit_cast<std::array<double, count>>(P)), theta);
}

TYPED_TEST(LawContract, InitialStateStaysAtRestToTheLastBit) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(1);
    for (int sample = 0; sample < 100; ++sample) {
      InitialConditions given;
      given.p = example.pressure * random.decade(-1.0, 1.0);
      const InitialPoint start = L::initial(P, given);
      LawPoint<L> point{start.stress, {}, start.density};
      for (std::size_t k = 0; k < start.state.size(); ++k) point.state[k] = start.state[k];
      const LawPoint<L> before = point;
      for (int step = 0; step < 3; ++step)
        ASSERT_FALSE(point.step(P, no_strain, example.time)) << example.label;
      EXPECT_TRUE(same_bits(point, before)) << example.label << " p = " << *given.p;
    }
  }
}

TYPED_TEST(LawContract, ShearedStateDoesNotCreepAtRest) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(2);
    for (int sample = 0; sample < 100; ++sample) {
      LawPoint<L> point = random_point<L>(example, P, random);
      for (int step = 0; step < 5; ++step)  // viscous stress dies away
        ASSERT_FALSE(point.step(P, no_strain, 1e6 * example.time));
      const LawPoint<L> settled = point;
      for (int step = 0; step < 1000; ++step)
        ASSERT_FALSE(point.step(P, no_strain, example.time)) << example.label;
      // Cam-Clay leaves a resting point alone. A pressure taken from ρ and a deviator taken from σ
      // are put together again in every step: 4 roundings, which must not add up over the steps.
      const double tolerance = std::string(L::name) == "modified_cam_clay"
                                   ? 0.0
                                   : 4.0 * epsilon * largest(settled.stress);
      for (int k = 0; k < 6; ++k)
        EXPECT_NEAR(point.stress[k], settled.stress[k], tolerance) << example.label;
      EXPECT_EQ(point.state, settled.state);
    }
  }
}

Eigen::Matrix3d matrix(const Sym<double, 6>& a) {
  Eigen::Matrix3d m;
  m << a[0], a[3], a[5], a[3], a[1], a[4], a[5], a[4], a[2];
  return m;
}

Sym<double, 6> rotated(const Sym<double, 6>& a, const Eigen::Matrix3d& Q) {
  const Eigen::Matrix3d m = Q * matrix(a) * Q.transpose();
  Sym<double, 6> r;
  r.c = {m(0, 0),
         m(1, 1),
         m(2, 2),
         0.5 * (m(0, 1) + m(1, 0)),
         0.5 * (m(1, 2) + m(2, 1)),
         0.5 * (m(2, 0) + m(0, 2))};
  return r;
}

TYPED_TEST(LawContract, RotatedInputGivesRotatedResult) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(3);
    for (int sample = 0; sample < 300; ++sample) {
      const LawPoint<L> start = random_point<L>(example, P, random);
      const Sym<double, 6> strain = random.tensor(example.strain * random.decade(-2.0, 0.0));
      const bool in_plane = sample % 2 == 0;
      const Eigen::Vector3d axis =
          in_plane ? Eigen::Vector3d::UnitZ()
                   : Eigen::Vector3d(random(-1, 1), random(-1, 1), random(-1, 1)).normalized();
      const Eigen::Matrix3d Q = Eigen::AngleAxisd(random(-3.0, 3.0), axis).toRotationMatrix();
      LawPoint<L> plain = start;
      LawPoint<L> turned{rotated(start.stress, Q), start.state, start.density};
      ASSERT_FALSE(plain.step(P, strain, example.time));
      ASSERT_FALSE(turned.step(P, rotated(strain, Q), example.time));
      const Sym<double, 6> expected = rotated(plain.stress, Q);
      // turning input and result costs ~30 roundings each, magnified at most by the tangent
      const double tolerance = 100.0 * epsilon * stress_scale(P, start, plain, strain);
      for (int k = 0; k < 6; ++k)
        EXPECT_NEAR(turned.stress[k], expected[k], tolerance) << example.label;
      const double relative = 100.0 * epsilon * (1.0 + largest(strain) / example.strain * 20.0);
      for (std::size_t k = 0; k < L::state.size(); ++k)
        EXPECT_NEAR(turned.state[k], plain.state[k], relative * std::abs(plain.state[k]));
    }
  }
}

TYPED_TEST(LawContract, PlaneStrainAndThreeDimensionsAgree) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(4);
    for (int sample = 0; sample < 300; ++sample) {
      const LawPoint<L> start = random_point<L>(example, P, random, true);
      const Sym<double, 6> strain = random.tensor(example.strain * random.decade(-2.0, 0.0), true);
      LawPoint<L> solid = start;
      LawPoint<L> plane = start;
      ASSERT_FALSE(solid.step(P, strain, example.time));
      ASSERT_FALSE(plane.step(P, LawPoint<L>::template truncated<4>(strain), example.time));
      // the same operations; the compiler may fuse multiply and add differently (few roundings)
      const double tolerance = 16.0 * epsilon * stress_scale(P, start, solid, strain);
      for (int k = 0; k < 6; ++k)
        EXPECT_NEAR(plane.stress[k], solid.stress[k], tolerance) << example.label;
      for (std::size_t k = 0; k < L::state.size(); ++k)
        EXPECT_NEAR(plane.state[k], solid.state[k], 1e3 * epsilon * std::abs(solid.state[k]));
      EXPECT_EQ(plane.stress[4], 0.0);
      EXPECT_EQ(solid.stress[4], 0.0);
    }
  }
}

template <class T>
double lane(const T& x, std::size_t i) {
  std::array<double, T::size> lanes;
  x.store_unaligned(lanes.data());
  return lanes[i];
}

/// The law in T, a register or two of points, against the law in double.
template <class L, class T>
void expect_agreement_with_scalar() {
  constexpr std::size_t n = T::size;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    const std::vector<double> theta = checked_parameters(example.spec);
    std::vector<T> wide;
    for (const double x : theta) wide.emplace_back(x);
    const auto P_wide = L::template Params<T>::from(std::span<const T>(wide));
    Random random(5);
    for (int sample = 0; sample < 200; ++sample) {
      std::vector<LawPoint<L>> start;
      std::vector<Sym<double, 6>> strain;
      for (std::size_t i = 0; i < n; ++i) {
        start.push_back(random_point<L>(example, P, random));
        strain.push_back(random.tensor(example.strain * random.decade(-2.0, 0.5)));
      }
      Increment<T, 6> inc;
      Sym<T, 6> stress;
      typename L::template State<T> state{};
      const auto gather = [&](auto&& of) {
        std::array<double, n> lanes;
        for (std::size_t i = 0; i < n; ++i) lanes[i] = of(i);
        return T::load_unaligned(lanes.data());
      };
      for (int k = 0; k < 6; ++k) {
        inc.strain[k] = gather([&](std::size_t i) { return strain[i][k]; });
        stress[k] = gather([&](std::size_t i) { return start[i].stress[k]; });
      }
      for (std::size_t k = 0; k < L::state.size(); ++k)
        state[k] = gather([&](std::size_t i) { return start[i].state[k]; });
      inc.density =
          gather([&](std::size_t i) { return start[i].density * std::exp(-trace(strain[i])); });
      inc.dt = T(example.time);
      ASSERT_FALSE(any(L::update(P_wide, inc, stress, state)));
      for (std::size_t i = 0; i < n; ++i) {
        LawPoint<L> one = start[i];
        ASSERT_FALSE(one.step(P, strain[i], example.time));
        // log and exp of the two libraries differ by 2 ε, magnified at most by the tangent;
        // Cam-Clay's root is known to 4 ε of w, and y = Lw to that times |L| < 20
        const double units = L::state.size() > 0 ? 200.0 : 16.0;
        const double tolerance = units * epsilon * stress_scale(P, start[i], one, strain[i]);
        for (int k = 0; k < 6; ++k)
          EXPECT_NEAR(lane(stress[k], i), one.stress[k], tolerance) << example.label;
        for (std::size_t k = 0; k < L::state.size(); ++k)
          EXPECT_NEAR(lane(state[k], i), one.state[k], 1e-12 * std::abs(one.state[k]));
      }
    }
  }
}
TYPED_TEST(LawContract, ScalarAndPackAgree) {
  expect_agreement_with_scalar<TypeParam, Pack>();
  expect_agreement_with_scalar<TypeParam, Twin>();
}

TYPED_TEST(LawContract, BadInputFailsOrGivesNumbersAndNeverLeavesNaN) {
  using L = TypeParam;
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(6);
    for (int sample = 0; sample < 20; ++sample) {
      const LawPoint<L> good = random_point<L>(example, P, random);
      const Sym<double, 6> strain = random.tensor(example.strain);
      const std::size_t slots = 6 + 2 + 6 + L::state.size();
      for (std::size_t slot = 0; slot < slots; ++slot) {
        for (const double bad : {nan, infinity, -infinity, 0.0, -1.0}) {
          LawPoint<L> point = good;
          Increment<double, 6> inc{strain, example.time, good.density * std::exp(-trace(strain))};
          if (slot < 6) {
            inc.strain.c[slot] = bad;
          } else if (slot == 6) {
            inc.dt = bad;
          } else if (slot == 7) {
            inc.density = bad;
          } else if (slot < 14) {
            point.stress.c[slot - 8] = bad;
          } else {
            point.state[slot - 14] = bad;
          }
          const LawPoint<L> before = point;
          const bool failed = L::update(P, inc, point.stress, point.state);
          const auto where = [&] {
            return example.label + ", slot " + std::to_string(slot) + " = " + std::to_string(bad);
          };
          if (failed) {
            EXPECT_TRUE(same_bits(point, before)) << where() << ": a failed point was changed";
          } else {
            EXPECT_TRUE(all_finite(point)) << where() << ": passed, but left no numbers";
          }
          // a strain or a density that is no number can never pass as a step
          if (slot < 8 && slot != 6 && !std::isfinite(bad)) {
            EXPECT_TRUE(failed) << where();
          }
        }
      }
    }
  }
}

TYPED_TEST(LawContract, TinyAndHugeIncrements) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(7);
    int passed = 0;
    for (const double size : {1e-300, 1e-200, 1e-100, 1e-30, 1e-16, 1e-8, 1e-4, 1e-2, 0.1, 1.0,
                              10.0, 1e2, 1e10, 1e100, 1e300}) {
      for (int sample = 0; sample < 100; ++sample) {
        LawPoint<L> point = random_point<L>(example, P, random);
        const LawPoint<L> before = point;
        Sym<double, 6> strain = random.tensor(size);
        if (sample % 4 == 1) strain = Sym<double, 6>::isotropic(random(-size, size));
        if (sample % 4 == 2) strain = deviator(strain);
        const bool failed = point.step(P, strain, example.time * random.decade(-3.0, 3.0));
        if (failed) {
          EXPECT_TRUE(same_bits(point, before)) << example.label << " size " << size;
          EXPECT_GT(size, 0.5) << example.label << ": an ordinary step failed";
          continue;
        }
        ++passed;
        EXPECT_TRUE(all_finite(point)) << example.label << " size " << size;
        const double p = pressure(point.stress);
        if (!carries_tension<L>) {
          // the trace of a deviator is zero to 4 roundings of its components
          EXPECT_GE(p, -4.0 * epsilon * largest(point.stress)) << example.label << " size " << size;
        }
        if constexpr (L::name == "modified_cam_clay") {
          EXPECT_GT(point.state[0], 0.0) << example.label;
        }
        // a step too small to be seen changes nothing beyond its own size
        if (size < 1e-20 && L::has_stress_memory && L::state.size() > 0 && rests<L>(P, before)) {
          for (int k = 0; k < 6; ++k)
            EXPECT_NEAR(point.stress[k], before.stress[k],
                        200.0 * epsilon * largest(before.stress));
        }
      }
    }
    EXPECT_GT(passed, 800);
  }
}

TYPED_TEST(LawContract, DissipationIsNotNegative) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(8);
    int dissipating = 0;
    int steps = 0;
    for (int path = 0; path < 100; ++path) {
      LawPoint<L> point = random_point<L>(example, P, random);
      const Sym<double, 6> direction = random.tensor(example.strain);
      for (int step = 0; step < 50; ++step) {
        const LawPoint<L> before = point;
        const double size = random.decade(-3.0, -0.5);
        const Sym<double, 6> strain =
            size * (random.tensor(example.strain) + (step % 20 < 10 ? 1.0 : -1.0) * direction);
        ASSERT_FALSE(point.step(P, strain, example.time));
        if (point.apart() || before.apart()) break;
        const Dissipated d = dissipated<L>(P, before, point, strain);
        // energies are differences of terms of the size of a modulus (ρ-driven pressure) or a
        // stress, per unit of mass
        const double scale = stress_scale(P, before, point, strain) / point.density;
        EXPECT_GE(d.energy, -d.slack - 64.0 * epsilon * scale) << example.label;
        ++steps;
        if (d.energy > 1e-3 * largest(point.stress) * largest(strain) / point.density)
          ++dissipating;
      }
    }
    // and the test has teeth only if much of the path does dissipate
    if (yields<L>) {
      EXPECT_GT(dissipating, steps / 4) << example.label;
    }
    EXPECT_GT(steps, 1000);
  }
}

}  // namespace
}  // namespace repose

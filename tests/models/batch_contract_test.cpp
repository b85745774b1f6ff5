/// \file
/// What every law must fulfil as a Material, in plane strain and in three dimensions: points in
/// batches, lane by lane on their own; rotation; failed points left as they were.

#include <cstring>

#include <Eigen/Dense>

#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

/// A law with N tensor components.
template <class L, int N>
struct Case {
  using Law = L;
  static constexpr int components = N;
};
template <class>
struct CasesOf;
template <class... L>
struct CasesOf<std::tuple<L...>> {
  using Types = ::testing::Types<Case<L, 4>..., Case<L, 6>...>;
};
struct CaseName {
  template <class C>
  static std::string GetName(int k) {  // NOLINT: the name GoogleTest asks for
    return LawName::GetName<typename C::Law>(k) + (C::components == 4 ? "_plane" : "_space");
  }
};

template <class C>
class BatchContract : public ::testing::Test {};
TYPED_TEST_SUITE(BatchContract, CasesOf<AllLaws>::Types, CaseName);

/// Structure-of-arrays points with outputs, and a margin behind them that nobody may touch.
template <class C>
struct Columns {
  using L = typename C::Law;
  using Batch = BatchOf<C::components>;
  static constexpr std::size_t components = Batch::components;
  static constexpr std::size_t margin = 8;
  static constexpr double canary = -77.0;
  std::size_t count;
  std::array<std::vector<double>, components> strain, stress;
  std::array<std::vector<double>, L::state.size()> state;
  std::array<std::vector<double>, 3> spin;
  std::vector<double> density, modulus, viscosity, work;

  template <class F>
  void each_input(F&& f) {
    for (auto& column : strain) f(column);
    for (auto& column : stress) f(column);
    for (auto& column : state) f(column);
    for (auto& column : spin) f(column);
    f(density);
  }
  explicit Columns(std::size_t n) : count(n) {
    const auto fill = [&](std::vector<double>& column) {
      column.assign(padded(n) + margin, canary);
    };
    each_input(fill);
    for (auto* column : {&modulus, &viscosity, &work}) fill(*column);
  }
  void set(std::size_t i, const LawPoint<L>& point, const Sym<double, 6>& e,
           const std::array<double, 3>& angles) {
    for (std::size_t k = 0; k < components; ++k) {
      strain[k][i] = e.c[k];
      stress[k][i] = point.stress.c[k];
    }
    for (std::size_t k = 0; k < state.size(); ++k) state[k][i] = point.state[k];
    for (std::size_t k = 0; k < 3; ++k) spin[k][i] = angles[k];
    density[i] = point.density;
  }
  /// The slots between count and padded(count) take copies of the last point.
  void pad() {
    each_input([&](std::vector<double>& column) {
      std::fill_n(column.begin() + static_cast<std::ptrdiff_t>(count), padded(count) - count,
                  column[count - 1]);
    });
  }
  Batch batch(double dt) {
    Batch b;
    b.count = count;
    b.dt = dt;
    for (std::size_t k = 0; k < components; ++k) {
      b.strain[k] = strain[k].data();
      b.stress[k] = stress[k].data();
    }
    for (std::size_t k = 0; k < state.size(); ++k) b.state[k] = state[k].data();
    if constexpr (C::components == 4)
      b.spin = {spin[2].data()};
    else
      b.spin = {spin[0].data(), spin[1].data(), spin[2].data()};
    b.density = density.data();
    b.modulus = modulus.data();
    b.viscosity = viscosity.data();
    b.work = work.data();
    return b;
  }
  LawPoint<L> point(std::size_t i) const {
    LawPoint<L> r{Sym<double, 6>::isotropic(0.0), {}, density[i]};
    for (std::size_t k = 0; k < components; ++k) r.stress.c[k] = stress[k][i];
    for (std::size_t k = 0; k < L::state.size(); ++k) r.state[k] = state[k][i];
    return r;
  }
  /// Everything update() writes for point i.
  std::vector<double> written(std::size_t i) const {
    std::vector<double> all{density[i], modulus[i], viscosity[i], work[i]};
    for (const auto& column : stress) all.push_back(column[i]);
    for (std::size_t k = 0; k < L::state.size(); ++k) all.push_back(state[k][i]);
    return all;
  }
};

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// A point, its increment and its spin, wild enough to take every branch: elastic, plastic, torn,
/// apart, rejoining.
template <class C>
struct Task {
  using L = typename C::Law;
  static constexpr bool plane = C::components == 4;
  LawPoint<L> point;
  Sym<double, 6> strain;
  std::array<double, 3> spin;  // plane strain: about z, the last

  static Task random(const LawExample& example, const typename L::template Params<double>& P,
                     Random& random) {
    Task task{random_point<L>(example, P, random, plane),
              random.tensor(example.strain * random.decade(-3.0, 1.0), plane),
              {random(-0.1, 0.1), random(-0.1, 0.1), random(-0.1, 0.1)}};
    if (random(0.0, 1.0) < 0.2) {
      // part it: dilate until the stress is gone, and offer it compression
      const double step = random(0.05, 0.5);
      task.point.step(P, Sym<double, 6>::isotropic(step), example.time);
      task.strain = task.strain - Sym<double, 6>::isotropic(step * random(0.0, 2.0));
    }
    return task;
  }
};

TYPED_TEST(BatchContract, LanesDoNotKnowTheirNeighbours) {
  using L = typename TypeParam::Law;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    const auto material = make_material(example.spec);
    Random random(21);
    int apart = 0;
    for (int sample = 0; sample < 100; ++sample) {
      std::vector<Task<TypeParam>> tasks;
      for (std::size_t i = 0; i < pack_size; ++i)
        tasks.push_back(Task<TypeParam>::random(example, P, random));
      for (const Task<TypeParam>& task : tasks) apart += task.point.apart() ? 1 : 0;
      Columns<TypeParam> together(pack_size);
      for (std::size_t i = 0; i < pack_size; ++i)
        together.set(i, tasks[i].point, tasks[i].strain, tasks[i].spin);
      ASSERT_TRUE(material->update(together.batch(example.time)).ok()) << example.label;
      for (std::size_t i = 0; i < pack_size; ++i) {
        // alone in every lane, and with its neighbours in another order
        Columns<TypeParam> alone(pack_size), shuffled(pack_size);
        for (std::size_t k = 0; k < pack_size; ++k) {
          const Task<TypeParam>& other = tasks[(k + i) % pack_size];
          alone.set(k, tasks[i].point, tasks[i].strain, tasks[i].spin);
          shuffled.set(k, other.point, other.strain, other.spin);
        }
        ASSERT_TRUE(material->update(alone.batch(example.time)).ok());
        ASSERT_TRUE(material->update(shuffled.batch(example.time)).ok());
        for (std::size_t k = 0; k < pack_size; ++k)
          ASSERT_TRUE(same_bits(alone.written(k), together.written(i))) << example.label;
        ASSERT_TRUE(same_bits(shuffled.written(0), together.written(i))) << example.label;
      }
    }
    if (L::state.size() > 0) {
      EXPECT_GT(apart, 5) << example.label << ": no point was apart";
    }
  }
}

TYPED_TEST(BatchContract, AnyCountAndNothingBehindThePadding) {
  using L = typename TypeParam::Law;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    const auto material = make_material(example.spec);
    Random random(22);
    constexpr std::size_t most = 3 * pack_size + 1;
    std::vector<Task<TypeParam>> tasks;
    for (std::size_t i = 0; i < most; ++i)
      tasks.push_back(Task<TypeParam>::random(example, P, random));
    Columns<TypeParam> all(most);
    for (std::size_t i = 0; i < most; ++i)
      all.set(i, tasks[i].point, tasks[i].strain, tasks[i].spin);
    all.pad();
    ASSERT_TRUE(material->update(all.batch(example.time)).ok());
    for (std::size_t n = 1; n <= most; ++n) {
      Columns<TypeParam> some(n);
      for (std::size_t i = 0; i < n; ++i)
        some.set(i, tasks[i].point, tasks[i].strain, tasks[i].spin);
      some.pad();
      EXPECT_TRUE(material->update(some.batch(example.time)).ok()) << example.label << " " << n;
      for (std::size_t i = 0; i < n; ++i)
        EXPECT_TRUE(same_bits(some.written(i), all.written(i))) << example.label << " " << n;
      for (std::size_t i = padded(n); i < padded(n) + Columns<TypeParam>::margin; ++i)
        for (const double x : some.written(i))
          EXPECT_EQ(x, Columns<TypeParam>::canary) << example.label << ": wrote behind the padding";
    }
    Columns<TypeParam> none(1);
    none.count = 0;
    EXPECT_TRUE(material->update(none.batch(example.time)).ok());
    EXPECT_EQ(none.density[0], Columns<TypeParam>::canary);
  }
}

TYPED_TEST(BatchContract, AFailedPointIsReportedAndLeftAsItWas) {
  using L = typename TypeParam::Law;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  constexpr std::size_t n = 2 * pack_size + 3;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    const auto material = make_material(example.spec);
    Random random(23);
    std::vector<Task<TypeParam>> tasks;
    for (std::size_t i = 0; i < n; ++i)
      tasks.push_back(Task<TypeParam>::random(example, P, random));
    const auto filled = [&] {
      Columns<TypeParam> columns(n);
      for (std::size_t i = 0; i < n; ++i)
        columns.set(i, tasks[i].point, tasks[i].strain, tasks[i].spin);
      columns.pad();
      return columns;
    };
    Columns<TypeParam> good = filled();
    ASSERT_TRUE(material->update(good.batch(example.time)).ok());

    for (const double bad : {nan, infinity, -infinity, 800.0, -800.0}) {
      for (const std::size_t where : {std::size_t{0}, pack_size + 2, n - 1}) {
        for (int what = 0; what < 3; ++what) {
          Columns<TypeParam> columns = filled();
          // a strain; a strain of the last component; the density. ±800: e^800 is beyond all
          // numbers
          if (what < 2) columns.strain[what == 0 ? 0 : 1][where] = bad;
          if (what == 2) columns.density[where] = std::abs(bad) == 800.0 ? -bad * bad : bad;
          const LawPoint<L> before = columns.point(where);
          const UpdateReport report = material->update(columns.batch(example.time));
          EXPECT_FALSE(report.ok());
          EXPECT_EQ(report.failed, where) << example.label << " bad = " << bad;
          const LawPoint<L> after = columns.point(where);
          EXPECT_TRUE(same_bits(after, before)) << example.label;
          EXPECT_EQ(columns.work[where], 0.0);
          if (what < 2) {
            EXPECT_TRUE(std::isfinite(columns.modulus[where]) &&
                        std::isfinite(columns.viscosity[where]));
          }
          for (std::size_t i = 0; i < n; ++i)
            EXPECT_TRUE(i == where || same_bits(columns.written(i), good.written(i)));
        }
      }
    }
    // what lies in the padding is nobody's failure
    Columns<TypeParam> padding = filled();
    for (std::size_t i = n; i < padded(n); ++i) padding.strain[0][i] = nan;
    EXPECT_TRUE(material->update(padding.batch(example.time)).ok());
    // a duration that is none fails everywhere; a duration of zero is one
    for (const double dt : {nan, -1.0, -infinity}) {
      Columns<TypeParam> columns = filled();
      EXPECT_EQ(material->update(columns.batch(dt)).failed, 0u) << example.label;
      for (std::size_t i = 0; i < n; ++i)
        EXPECT_EQ(columns.density[i], tasks[i].point.density) << example.label;
    }
    Columns<TypeParam> still = filled();
    EXPECT_TRUE(material->update(still.batch(0.0)).ok()) << example.label;
    for (std::size_t i = 0; i < n; ++i)
      for (const double x : still.written(i)) EXPECT_TRUE(std::isfinite(x)) << example.label;
  }
}

TYPED_TEST(BatchContract, OutputsAreThoseOfTheLaw) {
  using L = typename TypeParam::Law;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    const auto material = make_material(example.spec);
    Random random(24);
    Columns<TypeParam> columns(pack_size);
    std::vector<Task<TypeParam>> tasks;
    for (std::size_t i = 0; i < pack_size; ++i) {
      tasks.push_back(Task<TypeParam>::random(example, P, random));
      tasks[i].spin = {};
      columns.set(i, tasks[i].point, tasks[i].strain, {});
    }
    const auto batch = columns.batch(example.time);
    ASSERT_TRUE(material->update(batch).ok());
    std::array<double, pack_size> energy{}, modulus{};
    material->stored_energy(batch, energy.data());
    material->modulus(batch, modulus.data());
    for (std::size_t i = 0; i < pack_size; ++i) {
      const Task<TypeParam>& task = tasks[i];
      const LawPoint<L> after = columns.point(i);
      const auto sigma = LawPoint<L>::template truncated<TypeParam::components>(after.stress);
      const auto strain = LawPoint<L>::template truncated<TypeParam::components>(task.strain);
      const auto near = [&](double x, double expected, double scale) {
        EXPECT_NEAR(x, expected, 32.0 * epsilon * (std::abs(expected) + scale)) << example.label;
      };
      near(after.density, task.point.density * std::exp(-trace(task.strain)), 0.0);
      const double M = L::modulus(P, sigma, after.state, after.density);
      near(columns.modulus[i], M, 0.0);
      EXPECT_EQ(modulus[i], columns.modulus[i]);
      near(columns.viscosity[i],
           L::viscosity(P, sigma, after.density, (1.0 / example.time) * strain), 0.0);
      const Sym<double, TypeParam::components> mean_stress =
          0.5 * (LawPoint<L>::template truncated<TypeParam::components>(task.point.stress) + sigma);
      near(columns.work[i], contract(mean_stress, strain),
           largest(after.stress) * largest(task.strain));
      // a stored energy is a difference of terms of the size of the modulus (ρ-driven pressure)
      near(energy[i], L::stored_energy(P, sigma, after.state, after.density), M);
    }
  }
}

Eigen::Matrix3d matrix(const Sym<double, 6>& a) {
  Eigen::Matrix3d m;
  m << a[0], a[3], a[5], a[3], a[1], a[4], a[5], a[4], a[2];
  return m;
}

TYPED_TEST(BatchContract, FullTurnKeepsTheInvariants) {
  using L = typename TypeParam::Law;
  constexpr bool plane = TypeParam::components == 4;
  const double turn = 2.0 * std::acos(-1.0);
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    const auto material = make_material(example.spec);
    for (const int steps : {100, 1000}) {
      Random random(25);
      Columns<TypeParam> columns(pack_size);
      std::vector<LawPoint<L>> start;
      std::vector<Eigen::Vector3d> axes;
      for (std::size_t i = 0; i < pack_size; ++i) {
        LawPoint<L> point = random_point<L>(example, P, random, plane);
        for (int settle = 0; settle < 5; ++settle)  // no viscous stress left to die away
          ASSERT_FALSE(point.step(P, Sym<double, 6>::isotropic(0.0), 1e6 * example.time));
        start.push_back(point);
        axes.push_back(
            plane ? Eigen::Vector3d::UnitZ()
                  : Eigen::Vector3d(random(-1, 1), random(-1, 1), random(-1, 1)).normalized());
        const Eigen::Vector3d angle = turn / steps * axes.back();
        columns.set(i, point, Sym<double, 6>::isotropic(0.0), {angle[0], angle[1], angle[2]});
      }
      for (int step = 0; step < steps; ++step)
        ASSERT_TRUE(material->update(columns.batch(example.time)).ok());
      for (std::size_t i = 0; i < pack_size; ++i) {
        const Sym<double, 6> before = start[i].stress;
        const Sym<double, 6> after = columns.point(i).stress;
        // a step's rotation matrix is orthogonal to 8 ε at most and the update rounds 4 times (in
        // space 12: two products of matrices with sums of three)
        const double tolerance = (plane ? 16.0 : 24.0) * epsilon * steps * largest(before);
        EXPECT_NEAR(pressure(after), pressure(before), tolerance) << example.label;
        EXPECT_NEAR(mises(after), mises(before), 2.0 * tolerance) << example.label;
        for (std::size_t k = 0; k < L::state.size(); ++k)
          EXPECT_EQ(columns.point(i).state[k], start[i].state[k]) << example.label;
        EXPECT_EQ(columns.density[i], start[i].density);
        if (!L::has_stress_memory) continue;
        // Cayley's rotation turns by 2 atan(θ/2) in a step: short of a full turn by this angle
        const double angle = steps * 2.0 * std::atan(0.5 * turn / steps);
        const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, axes[i]).toRotationMatrix();
        const Eigen::Matrix3d expected = R * matrix(before) * R.transpose();
        EXPECT_LT((matrix(after) - expected).cwiseAbs().maxCoeff(), 4.0 * tolerance)
            << example.label;
      }
    }
  }
}

// A plane rotation and strain in space is what plane strain does.
template <class L>
class PlaneInSpace : public ::testing::Test {};
TYPED_TEST_SUITE(PlaneInSpace, LawTypes, LawName);
TYPED_TEST(PlaneInSpace, IsPlaneStrain) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    const auto material = make_material(example.spec);
    Random random(26);
    for (int sample = 0; sample < 50; ++sample) {
      Columns<Case<L, 4>> plane(pack_size);
      Columns<Case<L, 6>> space(pack_size);
      std::vector<Task<Case<L, 4>>> tasks;
      for (std::size_t i = 0; i < pack_size; ++i) {
        tasks.push_back(Task<Case<L, 4>>::random(example, P, random));
        tasks[i].spin[0] = tasks[i].spin[1] = 0.0;
        plane.set(i, tasks[i].point, tasks[i].strain, tasks[i].spin);
        space.set(i, tasks[i].point, tasks[i].strain, tasks[i].spin);
      }
      ASSERT_TRUE(material->update(plane.batch(example.time)).ok());
      ASSERT_TRUE(material->update(space.batch(example.time)).ok());
      for (std::size_t i = 0; i < pack_size; ++i) {
        const LawPoint<L> p = plane.point(i), s = space.point(i);
        // the two rotations round differently, 8 ε each, which the tangent magnifies at most as it
        // does the stress itself
        const double tolerance =
            64.0 * epsilon * stress_scale(P, tasks[i].point, p, tasks[i].strain);
        for (int k = 0; k < 6; ++k)
          EXPECT_NEAR(s.stress[k], p.stress[k], tolerance) << example.label << " " << k;
        EXPECT_EQ(s.density, p.density);
      }
    }
  }
}

}  // namespace
}  // namespace repose

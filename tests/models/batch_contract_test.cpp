/// \file
/// What every law must fulfil as a Material, in plane strain and in three dimensions: points in
/// batches, lane by lane on their own; failed points left as they were. batch_rotation_test.cpp has
/// rotations.

#include "tests/models/batch_columns.hpp"

namespace repose {
namespace {

template <class C>
class BatchContract : public ::testing::Test {};
TYPED_TEST_SUITE(BatchContract, CasesOf<AllLaws>::Types, CaseName);

TYPED_TEST(BatchContract, LanesDoNotKnowTheirNeighbours) {
  using L = typename TypeParam::Law;
  int apart = 0;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    const auto material = make_material(example.spec);
    Random random(21);
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
  }
  if (L::state.size() > 0) {
    EXPECT_GT(apart, 15) << "no point was apart";
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
          for (const auto* spent : {&columns.work, &columns.plastic, &columns.viscous,
                                    &columns.hypoelastic, &columns.separation})
            EXPECT_EQ((*spent)[where], 0.0);
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
    // (no flow has the time to bound the stress of a rate-dependent law: it may leave all numbers)
    EXPECT_TRUE(material->update(still.batch(0.0)).ok() || requires { L::rate_dependent; })
        << example.label;
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
      // the share of a cone adds 16: cos 3θ, a determinant, is known to 20 ε, of which g has a
      // third; the root of its cubic, terms of up to 27 over a slope of 15, to 8
      const bool on_cone = example.spec.values.contains("shape");
      const double units = on_cone ? 48.0 : 32.0;
      const auto near = [&](double x, double expected, double scale) {
        EXPECT_NEAR(x, expected, units * epsilon * (std::abs(expected) + scale)) << example.label;
      };
      near(after.density, task.point.density * std::exp(-trace(task.strain)), 0.0);
      const double M = L::modulus(P, sigma, after.state, after.density);
      near(columns.modulus[i], M, 0.0);
      EXPECT_EQ(modulus[i], columns.modulus[i]);
      // a viscosity μ p/γ̇ takes p from the density, K(ρ/ρ_0 − 1): an ε of ρ is εK of p
      const double eta = L::viscosity(P, sigma, after.density, (1.0 / example.time) * strain);
      const double p = pressure(after.stress);
      // and where a cone asks for the direction of D′, an ε of D turns that
      const double deviation = largest(deviator(task.strain));
      const double turned =
          deviation > 0.0 ? eta * largest(task.strain) / deviation : eta / epsilon;
      near(columns.viscosity[i], eta, (p > 0.0 ? eta * M / p : 0.0) + (on_cone ? turned : 0.0));
      const Sym<double, TypeParam::components> mean_stress =
          0.5 * (LawPoint<L>::template truncated<TypeParam::components>(task.point.stress) + sigma);
      near(columns.work[i], contract(mean_stress, strain),
           largest(after.stress) * largest(task.strain));
      // what a point on its own spends, of stresses that are differences of moduli times strains
      StepWork<double> spent;
      auto sigma_now = LawPoint<L>::template truncated<TypeParam::components>(task.point.stress);
      auto state_now = task.point.state;
      L::update(P, Increment<double, TypeParam::components>{strain, example.time, after.density},
                sigma_now, state_now, &spent);
      const double of_work =
          32.0 * stress_scale<L>(P, task.point, after, task.strain) * largest(task.strain);
      near(columns.plastic[i], spent.plastic, of_work);
      near(columns.viscous[i], spent.viscous, of_work);
      near(columns.hypoelastic[i], spent.hypoelastic, of_work);
      near(columns.separation[i], spent.separation, of_work);
      // a stored energy is a difference of terms of the size of the modulus (ρ-driven pressure)
      near(energy[i], L::stored_energy(P, sigma, after.state, after.density), M);
    }
  }
}

}  // namespace
}  // namespace repose

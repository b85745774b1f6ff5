/// \file
/// A step of the UMAT is a step of the law: stress, state, density and energies; how a point
/// starts; and that neither threads nor the number of materials matter.

#include <atomic>
#include <thread>

#include "tests/umat/out/call_umat.hpp"

namespace repose::umat {
namespace {

template <class L>
class UmatStep : public ::testing::Test {};
TYPED_TEST_SUITE(UmatStep, LawTypes, LawName);

TYPED_TEST(UmatStep, IsTheLawsUpdate) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>())
    for (const int nshr : {3, 1}) {
      const auto P = parameters_of<L>(example);
      Random random(31);
      for (int sample = 0; sample < 200; ++sample) {
        const LawPoint<L> start = random_point<L>(example, P, random, nshr == 1);
        const Sym<double, 6> strain =
            random.tensor(example.strain * random.decade(-2.0, 0.0), nshr == 1);
        Host host = host_of<L>(example, start, nshr);
        ASSERT_TRUE(host.step(host_strain(strain, host.components()), example.time));
        LawPoint<L> end = start;
        ASSERT_FALSE(end.step(P, strain, example.time));
        // the same update from other objects: what round-off makes of a step (stress_scale;
        // Cam-Clay's root is known to 20 ε, its derivative by less than 5)
        const double units = L::state.size() > 0 ? 100.0 : 8.0;
        const double noise = units * epsilon * stress_scale(P, start, end, strain);
        for (std::size_t i = 0; i < host.components(); ++i)
          EXPECT_NEAR(host.stress[i], end.stress[component(i)], noise)
              << example.label << ": component " << i;
        // e^x of two implementations, each to 2 ε
        EXPECT_NEAR(host.statev[0], end.density, 4.0 * epsilon * end.density) << example.label;
        for (std::size_t k = 0; k < L::state.size(); ++k)
          EXPECT_NEAR(host.statev[1 + k], end.state[k], 100.0 * epsilon * std::abs(end.state[k]))
              << example.label << ": state " << k;
      }
    }
}

TYPED_TEST(UmatStep, StartsFromItsStress) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    const LawInfo& law = find_law(example.spec);
    InitialConditions given;
    given.p = example.pressure;
    Host host(material_name(law), props_of(example.spec), 1 + law.state.size());
    if (L::state.size() > 0) {
      given.ocr = 1.7;
      host.props.push_back(1.7);
    }
    const InitialPoint expected = L::initial(P, given);
    for (std::size_t i = 0; i < 3; ++i) host.stress[i] = -example.pressure;
    ASSERT_TRUE(host.step(std::vector<double>(6, 0.0), example.time));
    // the point rests: what it had is what it has
    EXPECT_DOUBLE_EQ(host.statev[0], expected.density) << example.label;
    for (std::size_t k = 0; k < L::state.size(); ++k)
      EXPECT_DOUBLE_EQ(host.statev[1 + k], expected.state[k]) << example.label;
    // p of a law that has it from ρ is known to the ε of K ρ/ρ_0
    const double noise =
        4.0 * epsilon * (example.pressure + L::modulus(P, expected.stress, {}, expected.density));
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(host.stress[i], i < 3 ? -example.pressure : 0.0, noise) << example.label;
    // once more, from the state that it now has
    Host again = host;
    ASSERT_TRUE(again.step(std::vector<double>(6, 0.0), example.time));
    EXPECT_EQ(again.statev, host.statev) << example.label;
  }
}

/// What follows from the state is behind it where there is room, and only there.
TYPED_TEST(UmatStep, LeavesDerivedVariablesBehindTheState) {
  using L = TypeParam;
  constexpr std::size_t states = 1 + L::state.size();
  constexpr std::size_t derived = derived_fields<L>().size();
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(32);
    const LawPoint<L> start = random_point<L>(example, P, random);
    Host host = host_of<L>(example, start, 3);
    host.statev.resize(states + derived + 1, -77.0);
    const Sym<double, 6> strain = random.tensor(0.1 * example.strain);
    ASSERT_TRUE(host.step(host_strain(strain, 6), example.time));
    EXPECT_EQ(host.statev.back(), -77.0) << example.label;
    if constexpr (derived > 0) {
      typename L::template State<double> state{};
      Sym<double, 6> stress;
      for (std::size_t i = 0; i < 6; ++i) stress[component(i)] = host.stress[i];
      for (std::size_t k = 0; k < L::state.size(); ++k) state[k] = host.statev[1 + k];
      const auto values = L::derive(P, stress, state);
      // of the same stress by another compilation: q known to ε makes I known to about
      // ε M/(M_∞ − M) (I_M + I), and ln p_c to j of that, both factors < 200
      for (std::size_t k = 0; k < derived; ++k)
        EXPECT_NEAR(host.statev[states + k], values[k],
                    4e4 * epsilon * (std::abs(values[k]) + P.I_M))
            << example.label << ": " << L::derived[k].name;
    }
  }
}

TYPED_TEST(UmatStep, ThatCannotBeDoneChangesNothing) {
  using L = TypeParam;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(33);
    const LawPoint<L> start = random_point<L>(example, P, random);
    Host host = host_of<L>(example, start, 3);
    host.sse = 1.0;
    host.spd = 2.0;
    host.scd = 3.0;
    std::fill(host.ddsdde.begin(), host.ddsdde.end(), 4.0);
    const std::vector<double> strain =
        host_strain(random.tensor(0.1 * example.strain), host.components());
    const auto refuses = [&](Host attempt, const std::vector<double>& dstran, double dtime,
                             const char* what) {
      const Host before = attempt;
      EXPECT_FALSE(attempt.step(dstran, dtime)) << example.label << ": " << what;
      EXPECT_EQ(attempt.pnewdt, 0.5) << example.label << ": " << what;
      EXPECT_TRUE(same_bits(attempt, before)) << example.label << ": " << what;
    };
    std::vector<double> bad = strain;
    bad[3] = nan;
    refuses(host, bad, example.time, "a strain that is no number");
    bad[3] = 1e300;
    refuses(host, bad, example.time, "a strain beyond all numbers");
    refuses(host, strain, nan, "a time that is no number");
    refuses(host, strain, -example.time, "a step back in time");
    Host ill = host;
    ill.stress[1] = nan;
    refuses(ill, strain, example.time, "a stress that is no number");
    ASSERT_TRUE(host.step(strain, example.time)) << example.label;
  }
}

/// All forms, each with some strength of its own: more materials than a thread keeps.
std::vector<Host> many_hosts(int variants) {
  std::vector<Host> hosts;
  for (const LawInfo& law : library_laws())
    for (const LawExample& example : examples_of(law))
      for (int variant = 0; variant < variants; ++variant) {
        Host host(material_name(law) + "__" + std::to_string(variant), props_of(example.spec),
                  1 + law.state.size());
        host.props[0] *= 1.0 - 1e-3 * variant;
        for (std::size_t i = 0; i < 3; ++i) host.stress[i] = -example.pressure;
        hosts.push_back(host);
      }
  return hosts;
}

/// A few steps of all, in turn.
void drive(std::vector<Host>& hosts) {
  for (int step = 0; step < 3; ++step)
    for (std::size_t i = 0; i < hosts.size(); ++i) {
      const double e = 1e-5 * static_cast<double>(1 + i % 7);
      EXPECT_TRUE(hosts[i].step({e, -2.0 * e, 0.5 * e, e, 0.0, -e}, 1e-4)) << hosts[i].name;
    }
}

TEST(UmatThreads, DoNotMatterNorDoesTheNumberOfMaterials) {
  const std::vector<Host> start = many_hosts(4);
  ASSERT_GT(start.size(), 64U);  // of one thread's cache
  std::vector<Host> alone;       // each with nothing before it but itself
  for (const Host& host : start) {
    std::vector<Host> one{host};
    // the place in the row decides the strain
    const double e = 1e-5 * static_cast<double>(1 + alone.size() % 7);
    for (int step = 0; step < 3; ++step)
      ASSERT_TRUE(one[0].step({e, -2.0 * e, 0.5 * e, e, 0.0, -e}, 1e-4)) << host.name;
    alone.push_back(one[0]);
  }
  constexpr std::size_t threads = 4;
  std::vector<std::vector<Host>> results(threads, start);
  std::vector<std::thread> running;
  for (std::vector<Host>& hosts : results) running.emplace_back([&hosts] { drive(hosts); });
  for (std::thread& thread : running) thread.join();
  for (const std::vector<Host>& hosts : results)
    for (std::size_t i = 0; i < hosts.size(); ++i)
      EXPECT_TRUE(same_bits(hosts[i], alone[i])) << hosts[i].name;
}

}  // namespace
}  // namespace repose::umat

/// \file
/// Random updates of every law, as many as REPOSE_STORM says of each: along paths from the
/// admissible into the absurd (strains from 1e-8 to some hundred per cent, durations over eight
/// decades), a pack of points at a time and each of them alone. After every update numbers are
/// finite, the yield condition holds to 1e-8, p_c > 0, nothing is dissipated below zero, and pack
/// and scalar agree; a point that fails is as it was before.

#include <cstdio>
#include <cstdlib>

#include "tests/models/dissipation.hpp"

namespace repose {
namespace {

template <class L>
class Storm : public ::testing::Test {};
TYPED_TEST_SUITE(Storm, LawTypes, LawName);

long updates_wanted() {
  const char* const asked = std::getenv("REPOSE_STORM");
  return asked != nullptr ? std::atol(asked) : 20'000;
}

template <class L>
bool is_finite(const LawPoint<L>& point) {
  bool finite = std::isfinite(point.density);
  for (int k = 0; k < 6; ++k) finite = finite && std::isfinite(point.stress[k]);
  for (const double x : point.state) finite = finite && std::isfinite(x);
  return finite;
}

/// A point for a message.
template <class L>
std::string told(const LawPoint<L>& point) {
  char text[160];
  std::snprintf(text, sizeof text, "p %.17g q %.17g density %.17g state %.17g",
                pressure(point.stress), mises(point.stress), point.density,
                L::state.size() > 0 ? point.state.front() : 0.0);
  return text;
}

/// What a law's stress may not exceed, as a share of the stresses it is a difference of; <= 0
/// inside.
template <class L>
double beyond_yield(const typename L::template Params<double>& P, const LawPoint<L>& point) {
  if (point.apart()) return largest(point.stress) == 0.0 ? 0.0 : 1.0;
  const double p = pressure(point.stress);
  if constexpr (L::name == "mu_i" && L::has_stress_memory) {
    // between the friction at rest and its limit the stress is that of the flow: the limit binds
    const double tau = shear_norm(deviator(point.stress));
    const double g = mu_i::share(P, deviator(point.stress));
    return p + tau > 0.0 ? (tau - std::max(P.mu_0, P.mu_d) * g * p) / (p + tau) : 0.0;
  } else if constexpr (L::name == "critical_state_mu_i") {
    // some I carries the stress; where the volume does not depend on it, no more than M_∞ does
    if (std::isfinite(L::inertial_number(P, point.stress, point.state))) return 0.0;
    if (P.volume_rate() > 0.0) return 1.0;
    const double slope = P.M_inf / P.M * P.slope(deviator(point.stress));
    const double surface = square(mises(point.stress) / slope);
    const double p_c = std::exp(point.state[0]);
    return (surface - p * (p_c - p)) / (surface + p * (p_c + p));
  } else if constexpr (L::state.size() > 0) {
    const double F = L::yield(P, point.stress, point.state, point.density, Sym<double, 6>{});
    return F / (std::abs(p) + mises(point.stress) + point.state[0]);
  } else {
    return 0.0;
  }
}

/// How far the worst of the checks came to its limit, for the table.
struct Worst {
  double yield = 0.0, dissipation = 0.0, pack = 0.0;
  long updates = 0, failed = 0;
};

/// The state of a pack of points in the law's own scalar.
template <class L, class T>
struct Packed {
  Increment<T, 6> inc;
  Sym<T, 6> stress;
  typename L::template State<T> state{};
};

template <class T>
double lane(const T& x, std::size_t i) {
  std::array<double, T::size> lanes;
  x.store_unaligned(lanes.data());
  return lanes[i];
}

template <class L>
void storm(const LawExample& example, long updates, unsigned seed, Worst& worst) {
  constexpr std::size_t n = Pack::size;
  const auto P = parameters_of<L>(example);
  const std::vector<double> theta = checked_parameters(example.spec);
  std::vector<Pack> wide;
  for (const double x : theta) wide.emplace_back(x);
  const auto P_wide = L::template Params<Pack>::from(std::span<const Pack>(wide));
  Random random(seed);
  std::vector<LawPoint<L>> points(n), next(n);
  std::vector<Sym<double, 6>> strain(n);
  std::vector<double> begun(n, 0.0);  // density
  std::vector<int> left(n, 0);        // steps of the path of each lane
  for (long done = 0; done < updates; done += static_cast<long>(n)) {
    for (std::size_t i = 0; i < n; ++i) {
      if (left[i]-- <= 0) {
        points[i] = random_point<L>(example, P, random);
        left[i] = 200;
        begun[i] = points[i].density;
      }
      // one in eight steps is absurd
      const bool absurd = random(0.0, 8.0) < 1.0;
      const double size = example.strain * random.decade(-6.0, absurd ? 2.5 : 0.5);
      strain[i] = random.tensor(size);
      const double kind = random(0.0, 6.0);
      if (kind < 1.0) strain[i] = Sym<double, 6>::isotropic(random(-size, size));
      if (kind >= 1.0 && kind < 2.0) strain[i] = deviator(strain[i]);
    }
    const double duration = example.time * random.decade(-4.0, 4.0);
    Packed<L, Pack> pack;
    const auto gather = [&](auto&& of) {
      std::array<double, n> lanes;
      for (std::size_t i = 0; i < n; ++i) lanes[i] = of(i);
      return Pack::load_unaligned(lanes.data());
    };
    for (int k = 0; k < 6; ++k) {
      pack.inc.strain[k] = gather([&](std::size_t i) { return strain[i][k]; });
      pack.stress[k] = gather([&](std::size_t i) { return points[i].stress[k]; });
    }
    for (std::size_t k = 0; k < L::state.size(); ++k)
      pack.state[k] = gather([&](std::size_t i) { return points[i].state[k]; });
    pack.inc.density =
        gather([&](std::size_t i) { return points[i].density * std::exp(-trace(strain[i])); });
    pack.inc.dt = Pack(duration);
    const auto mask = L::update(P_wide, pack.inc, pack.stress, pack.state);
    std::array<bool, n> pack_failed{};
    mask.store_unaligned(pack_failed.data());
    for (std::size_t i = 0; i < n; ++i) {
      const LawPoint<L> before = points[i];
      LawPoint<L> after = before;
      const bool failed = after.step(P, strain[i], duration);
      ++worst.updates;
      // where the two differ in what they call beyond all numbers, neither has left any
      if (failed) {
        ++worst.failed;
        ASSERT_TRUE(same_bits(after, before)) << example.label;
        ASSERT_GT(largest(strain[i]), 0.5 * example.strain) << example.label;
        left[i] = 0;
        continue;
      }
      ASSERT_TRUE(is_finite(after)) << example.label;
      if constexpr (L::name == "modified_cam_clay") {
        ASSERT_GT(after.state[0], 0.0) << example.label;
      }
      // a pressure that follows from density knows its zero to ε of the modulus only
      const double modulus = L::modulus(P, after.stress, after.state, after.density);
      const double known = largest(after.stress) + largest(before.stress);
      const bool above_round_off = known > 1e4 * epsilon * modulus * (1.0 + largest(strain[i]));
      if (above_round_off) {
        const double beyond = beyond_yield<L>(P, after);
        ASSERT_LE(beyond, 1e-8) << example.label << " strain " << largest(strain[i]);
        worst.yield = std::max(worst.yield, beyond);
      }
      // pack against scalar, as ScalarAndPackAgree allows
      ASSERT_EQ(pack_failed[i], failed) << example.label;
      const double units = L::state.size() > 0 ? 200.0 : 16.0;
      double tolerance = units * epsilon * stress_scale(P, before, after, strain[i]);
      // e^{Δε} b e^{Δε}: a rounding of b where it is small grows with where the step stretches most
      if constexpr (L::name == "neo_hookean") tolerance *= std::exp(2.0 * largest(strain[i]));
      const bool both_bear = L::state.size() < 2 ||
                             (after.apart() == (lane(pack.state[L::state.size() - 1], i) > 0.0));
      if (both_bear)
        for (int k = 0; k < 6; ++k) {
          const double difference = std::abs(lane(pack.stress[k], i) - after.stress[k]);
          ASSERT_LE(difference, tolerance) << example.label << " strain " << largest(strain[i]);
          if (tolerance > 0.0) worst.pack = std::max(worst.pack, difference / tolerance);
        }
      // the bookkeeping of energies is that of the world that a law is for
      const bool worldly = pressure(after.stress) < 1e3 * example.pressure &&
                           after.density < 3.0 * begun[i] && after.density > begun[i] / 3.0 &&
                           largest(strain[i]) <= 3.0 * example.strain;
      if (!after.apart() && !before.apart() && worldly) {
        const Dissipated d = dissipated<L>(P, before, after, strain[i]);
        // some twenty roundings of terms up to this size: 64 ε hold over thousands of steps
        // (law_contract_test), 512 ε over ten million
        const double round_off =
            512.0 * epsilon * stress_scale(P, before, after, strain[i]) / after.density;
        ASSERT_GE(d.energy, -d.slack - round_off)
            << example.label << " strain " << largest(strain[i]) << ", volume " << trace(strain[i])
            << "; " << told(before) << " to " << told(after);
        if (d.energy < 0.0)
          worst.dissipation = std::max(worst.dissipation, -d.energy / (d.slack + round_off));
      }
      // a path that has wandered off the world begins again
      const bool lost = after.apart() || !(pressure(after.stress) > 1e-3 * example.pressure) ||
                        !(pressure(after.stress) < 1e6 * example.pressure) ||
                        !(after.density > 0.1 * before.density);
      if (lost) left[i] = std::min(left[i], 3);
      points[i] = after;
    }
  }
}

TYPED_TEST(Storm, EveryUpdateIsSound) {
  using L = TypeParam;
  const auto examples = examples_of<L>();
  Worst worst;
  unsigned seed = 20261129;
  for (const LawExample& example : examples) {
    storm<L>(example, updates_wanted() / static_cast<long>(examples.size()) + 1, seed++, worst);
    if (this->HasFatalFailure()) return;
  }
  std::printf(
      "[ measured ] %s %s: %ld updates, %ld refused; yield exceeded by at most %.1e, pack against "
      "scalar %.2f and dissipation %.2f of what round-off explains\n",
      std::string(L::name).c_str(), std::string(L::option).c_str(), worst.updates, worst.failed,
      worst.yield, worst.pack, worst.dissipation);
}

}  // namespace
}  // namespace repose

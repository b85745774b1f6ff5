/// \file
/// Dual numbers through update(): the consistent tangent and the sensitivity of a path to the
/// parameters, against central differences; and update() against the integral of rate(), which is a
/// second derivation of each law.

#include "models/dual.hpp"
#include "tests/models/central_difference.hpp"
#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

template <class L>
class LawDerivative : public ::testing::Test {};
TYPED_TEST_SUITE(LawDerivative, LawTypes, LawName);

TYPED_TEST(LawDerivative, ConsistentTangent) {
  using L = TypeParam;
  constexpr int n = 7;  // six strains and the duration
  using D = Dual<n>;
  for (const LawExample& example : examples_of<L>()) {
    const std::vector<double> theta = checked_parameters(example.spec);
    const auto P = L::template Params<double>::from(theta);
    const std::vector<D> constant(theta.begin(), theta.end());
    const auto P_dual = L::template Params<D>::from(std::span<const D>(constant));
    Random random(11);
    Comparison compare;
    for (int sample = 0; sample < 200; ++sample) {
      const LawPoint<L> start = random_point<L>(example, P, random);
      const Sym<double, 6> strain = random.tensor(example.strain * random.decade(-2.0, 0.0));
      Increment<D, 6> inc;
      Sym<D, 6> stress;
      typename L::template State<D> state{};
      for (int k = 0; k < 6; ++k) {
        inc.strain[k] = D(strain[k], k);
        stress[k] = D(start.stress[k]);
      }
      for (std::size_t k = 0; k < L::state.size(); ++k) state[k] = D(start.state[k]);
      inc.dt = D(example.time, 6);
      inc.density = D(start.density) * exp(-trace(inc.strain));
      ASSERT_FALSE(L::update(P_dual, inc, stress, state));

      const auto stepped = [&](int direction, double h) {
        LawPoint<L> point = start;
        Sym<double, 6> e = strain;
        if (direction < 6) e[direction] += h;
        EXPECT_FALSE(point.step(P, e, example.time + (direction == 6 ? h : 0.0)));
        return point;
      };
      const LawPoint<L> end = stepped(0, 0.0);
      // Cam-Clay's root is known to about 20 ε of w, y = Lw to that times |L| < 5
      const double units = L::state.size() > 0 ? 100.0 : 8.0;
      const double noise = units * epsilon * stress_scale(P, start, end, strain);
      for (int j = 0; j < n; ++j) {
        // small against the curvature (strains of example.strain), large against round-off
        const double h = 2e-5 * (j < 6 ? example.strain : example.time);
        const LawPoint<L> plus = stepped(j, h), minus = stepped(j, -h);
        const LawPoint<L> half_plus = stepped(j, 0.5 * h), half_minus = stepped(j, -0.5 * h);
        const double stress_size = largest(end.stress) / (j < 6 ? example.strain : example.time);
        for (int k = 0; k < 6; ++k)
          compare(stress[k].v[j], plus.stress[k], minus.stress[k], half_plus.stress[k],
                  half_minus.stress[k], h, noise, 10.0 * stress_size,
                  example.label + ": stress " + std::to_string(k) + " by " + std::to_string(j));
        for (std::size_t k = 0; k < L::state.size(); ++k)
          compare(state[k].v[j], plus.state[k], minus.state[k], half_plus.state[k],
                  half_minus.state[k], h, 100.0 * epsilon * end.state[k], 10.0 * stress_size,
                  example.label + ": state by " + std::to_string(j));
      }
    }
    EXPECT_GT(compare.sharp, compare.all / 2) << example.label;
  }
}

TYPED_TEST(LawDerivative, SensitivityToEveryParameterAlongAPath) {
  using L = TypeParam;
  constexpr int n = static_cast<int>(L::parameters.size());
  using D = Dual<n>;
  for (const LawExample& example : examples_of<L>()) {
    const std::vector<double> theta = checked_parameters(example.spec);
    const auto P = L::template Params<double>::from(theta);
    std::vector<D> seeded;
    for (int j = 0; j < n; ++j) seeded.emplace_back(theta[static_cast<std::size_t>(j)], j);
    const auto P_dual = L::template Params<D>::from(std::span<const D>(seeded));
    Random random(12);
    Comparison compare;
    for (int path = 0; path < 10; ++path) {
      InitialConditions given;
      given.p = example.pressure;
      if (L::state.size() > 0) given.ocr = 1.5;
      const InitialPoint at_rest = L::initial(P, given);
      LawPoint<L> start{at_rest.stress, {}, at_rest.density};
      for (std::size_t k = 0; k < at_rest.state.size(); ++k) start.state[k] = at_rest.state[k];
      // elastic first, then well into yield, then back
      std::vector<Sym<double, 6>> strains;
      const Sym<double, 6> direction = random.tensor(0.2 * example.strain);
      for (int step = 0; step < 20; ++step)
        strains.push_back((step < 15 ? 1.0 : -0.3) * direction +
                          random.tensor(0.02 * example.strain));

      Sym<D, 6> stress;
      typename L::template State<D> state{};
      for (int k = 0; k < 6; ++k) stress[k] = D(start.stress[k]);
      for (std::size_t k = 0; k < L::state.size(); ++k) state[k] = D(start.state[k]);
      double density = start.density;
      double scale = 0.0;
      int plastic = 0;
      for (const Sym<double, 6>& strain : strains) {
        density *= std::exp(-trace(strain));
        Increment<D, 6> inc;
        for (int k = 0; k < 6; ++k) inc.strain[k] = D(strain[k]);
        inc.dt = D(example.time);
        inc.density = D(density);
        const auto before = state;
        ASSERT_FALSE(L::update(P_dual, inc, stress, state));
        if constexpr (L::state.size() > 0) plastic += state[0].a != before[0].a ? 1 : 0;
        for (int k = 0; k < 6; ++k) scale = std::max(scale, std::abs(stress[k].a));
      }
      if constexpr (L::state.size() > 0) {
        EXPECT_GT(plastic, 2) << example.label;
        // (flow goes on while the stress is beyond yield, also on the way back)
        const int most = requires { L::rate_dependent; }
        ? 20 : 19;
        EXPECT_LE(plastic, most) << example.label;
      }

      for (int j = 0; j < n; ++j) {
        const double at = theta[static_cast<std::size_t>(j)];
        // absent, or p_shift = 0, which has one side only (the shifted example has both)
        if (std::isnan(at) || at == 0.0) continue;
        const auto run = [&](double h) {
          std::vector<double> moved = theta;
          moved[static_cast<std::size_t>(j)] += h;
          const auto P_moved = L::template Params<double>::from(moved);
          LawPoint<L> point = start;
          for (const Sym<double, 6>& strain : strains)
            EXPECT_FALSE(point.step(P_moved, strain, example.time));
          return point;
        };
        const double h = 1e-5 * at;
        const LawPoint<L> plus = run(h), minus = run(-h);
        const LawPoint<L> half_plus = run(0.5 * h), half_minus = run(-0.5 * h);
        // noise of one step, added up over 20
        const double modulus = L::modulus(P, start.stress, start.state, start.density);
        const double units = L::state.size() > 0 ? 1000.0 : 100.0;
        const double noise =
            units * epsilon * (scale + (L::state.size() == 0 ? modulus : modulus * example.strain));
        for (int k = 0; k < 6; ++k)
          compare(stress[k].v[j], plus.stress[k], minus.stress[k], half_plus.stress[k],
                  half_minus.stress[k], h, noise, 10.0 * scale / at,
                  example.label + ": stress by " +
                      std::string(L::parameters[static_cast<std::size_t>(j)].name));
        for (std::size_t k = 0; k < L::state.size(); ++k)
          compare(state[k].v[j], plus.state[k], minus.state[k], half_plus.state[k],
                  half_minus.state[k], h, noise, 10.0 * scale / at,
                  example.label + ": state by " +
                      std::string(L::parameters[static_cast<std::size_t>(j)].name));
      }
    }
    EXPECT_GT(compare.sharp, compare.all / 2) << example.label;
  }
}

/// rate() along a constant D, integrated by the classical fourth-order Runge-Kutta method, the
/// elastic branch until yield() is met (located by bisection), the plastic one from there.
template <class L>
LawPoint<L> integrated(const typename L::template Params<double>& P, LawPoint<L> at,
                       const Sym<double, 6>& D, double duration, int steps) {
  constexpr std::size_t m = 6 + L::state.size();
  using Vector = std::array<double, m>;
  const auto pack = [](const LawPoint<L>& point) {
    Vector y{};
    for (std::size_t k = 0; k < 6; ++k) y[k] = point.stress.c[k];
    for (std::size_t k = 6; k < m; ++k) y[k] = point.state[k - 6];
    return y;
  };
  const auto unpack = [&](const Vector& y, double density) {
    LawPoint<L> point = at;
    for (std::size_t k = 0; k < 6; ++k) point.stress.c[k] = y[k];
    for (std::size_t k = 6; k < m; ++k) point.state[k - 6] = y[k];
    point.density = density;
    return point;
  };
  Branch branch = Branch::elastic;
  const double rho_0 = at.density;
  const auto slope = [&](double t, const Vector& y) {
    const LawPoint<L> point = unpack(y, rho_0 * std::exp(-trace(D) * t));
    LawPoint<L> rate = point;
    rate.state = {};
    L::rate(P, point.stress, point.state, point.density, D, branch, rate.stress, rate.state);
    return pack(rate);
  };
  const auto runge_kutta = [&](double t, const Vector& y, double h) {
    const auto moved = [&](const Vector& k, double f) {
      Vector r = y;
      for (std::size_t i = 0; i < m; ++i) r[i] += f * k[i];
      return r;
    };
    const Vector k1 = slope(t, y);
    const Vector k2 = slope(t + 0.5 * h, moved(k1, 0.5 * h));
    const Vector k3 = slope(t + 0.5 * h, moved(k2, 0.5 * h));
    const Vector k4 = slope(t + h, moved(k3, h));
    Vector r = y;
    for (std::size_t i = 0; i < m; ++i)
      r[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    return r;
  };
  const auto yield_of = [&](double t, const Vector& y) {
    const LawPoint<L> point = unpack(y, rho_0 * std::exp(-trace(D) * t));
    return L::yield(P, point.stress, point.state, point.density, D);
  };
  Vector y = pack(at);
  double t = 0.0;
  const double h = duration / steps;
  for (int step = 0; step < steps; ++step) {
    double part = h;
    if (branch == Branch::elastic && yield_of(t + h, runge_kutta(t, y, h)) > 0.0) {
      double low = 0.0, high = h;
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (low + high);
        (yield_of(t + middle, runge_kutta(t, y, middle)) > 0.0 ? high : low) = middle;
      }
      y = runge_kutta(t, y, low);
      t += low;
      part = h - low;
      branch = Branch::plastic;
    }
    y = runge_kutta(t, y, part);
    t += part;
  }
  return unpack(y, rho_0 * std::exp(-trace(D) * t));
}

TYPED_TEST(LawDerivative, UpdateConvergesToTheIntegralOfRate) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(13);
    int first_order = 0;
    for (int path = 0; path < 12; ++path) {
      InitialConditions given;
      given.p = example.pressure;
      if (L::state.size() > 0) given.ocr = path % 3 == 0 ? 4.0 : 1.6;  // dry and wet side
      if (L::has_stress_memory) given.K0 = 0.7;  // not along the strain to come
      const InitialPoint at_rest = L::initial(P, given);
      LawPoint<L> start{at_rest.stress, {}, at_rest.density};
      for (std::size_t k = 0; k < at_rest.state.size(); ++k) start.state[k] = at_rest.state[k];
      // mostly shear, some volume change; into yield, but not so far that a steady state is reached
      // which every step size finds; 20 steps of the example's duration
      const double size = (L::state.size() > 0 ? 1.0 : 0.3) * example.strain;
      Sym<double, 6> strain = deviator(random.tensor(1.0));
      strain =
          (size / largest(strain)) * strain + Sym<double, 6>::isotropic(random(-0.1, 0.1) * size);
      const double duration = 20.0 * example.time;
      const Sym<double, 6> D = (1.0 / duration) * strain;
      const LawPoint<L> exact = integrated<L>(P, start, D, duration, 8000);

      std::array<double, 3> error{};
      for (std::size_t level = 0; level < 3; ++level) {
        const int steps = 200 << level;
        LawPoint<L> point = start;
        for (int step = 0; step < steps; ++step)
          ASSERT_FALSE(point.step(P, (1.0 / steps) * strain, duration / steps));
        for (int k = 0; k < 6; ++k) {
          // a law without memory has a viscous stress that no rate describes: its pressure counts
          const double difference = L::has_stress_memory
                                        ? point.stress[k] - exact.stress[k]
                                        : pressure(point.stress) - pressure(exact.stress);
          error[level] = std::max(error[level], std::abs(difference) / largest(exact.stress));
        }
        for (std::size_t k = 0; k < L::state.size(); ++k)
          error[level] = std::max(
              error[level], std::abs(point.state[k] - exact.state[k]) / std::abs(exact.state[0]));
      }
      // Either the update is exact along this path (elastic, or p of ρ), up to the Runge-Kutta
      // error (8000⁻⁴, and round-off of 8000 steps), or halving the step halves the error: the
      // second-order term at 200 steps is below 10 % of the first.
      if (error[0] < 1e-9) continue;
      ++first_order;
      for (std::size_t level = 0; level < 2; ++level) {
        const double ratio = error[level] / error[level + 1];
        EXPECT_GT(ratio, 1.8) << example.label << " path " << path << " error " << error[level];
        EXPECT_LT(ratio, 2.2) << example.label << " path " << path << " error " << error[level];
      }
      EXPECT_LT(error[2], 0.02) << example.label << " path " << path;
    }
    if (yields<L> && L::has_stress_memory) {
      EXPECT_GT(first_order, 6) << example.label << ": hardly any path yielded";
    }
  }
}

}  // namespace
}  // namespace repose

/// \file
/// The critical-state μ(I) law (physics.md, CSM): its return against the equations it solves, its
/// limits, the state relation, and the corners where such laws fail.

#include <algorithm>

#include "models/shear_response.hpp"
#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

using Law = CriticalStateMuI;
using Clay = Law::Clay;
using Params = Law::Params<double>;
using Point = LawPoint<Law>;

Params grains(double I_v) {
  std::map<std::string, double> values{{"M", 0.6614},  {"lambda", 0.0186},     {"kappa", 0.001},
                                       {"nu", 0.3},    {"Gamma", 1.0 / 0.648}, {"p_ref", 1.0},
                                       {"d", 0.0053},  {"rho_p", 2000.0},      {"M_inf", 0.9904},
                                       {"I_M", 0.1611}};
  if (I_v > 0.0) values["I_v"] = I_v;
  return Params::from(checked_parameters({"critical_state_mu_i", {}, values}));
}
Params kaolin() { return parameters_of<Law>(examples_of<Law>().back()); }

Point at_rest(const Params& P, double p, double ocr) {
  InitialConditions given;
  given.p = p;
  given.ocr = ocr;
  const InitialPoint start = Law::initial(P, given);
  return {start.stress, {start.state[0], start.state[1]}, start.density};
}

Sym<double, 6> shear(double gamma) {
  Sym<double, 6> e;
  e[3] = 0.5 * gamma;
  return e;
}

/// v of CSM-2 for p, p_s (at I) and I.
double volume(const Params& P, double p, double p_s, double I) {
  const double dilation = std::isnan(P.I_v) ? 0.0 : I / P.I_v;
  return P.Gamma * std::pow(P.p_ref / p_s, P.lambda) * std::pow(p_s / p, P.kappa) *
         std::exp(dilation);
}

// Every equation of CSM-1 to CSM-3 at the end of a step of any size and duration, from the stresses
// before and after alone. What is known of a difference q_tr − q is ε of q, so a step that hardly
// flows is measured as well as that allows.
TEST(CriticalStateMuI, AReturnSatisfiesItsEquationsOverEighteenDecadesOfTime) {
  struct Set {
    Params P;
    double p, strain, dt;
  };
  for (const Set& set : {Set{grains(0.5), 1e3, 1e-3, 1e-4}, Set{grains(0.0), 1e3, 1e-3, 1e-4},
                         Set{kaolin(), 1e5, 2e-2, 1e3}}) {
    const Params& P = set.P;
    Random random(40);
    int plastic = 0, flowing = 0;
    std::vector<int> evaluations;
    for (int k = 0; k < 100'000; ++k) {
      const double p = set.p * random.decade(-3.0, 2.0);
      const double p_c = 2.0 * p * random.decade(-2.0, 2.0);
      Sym<double, 6> s = deviator(random.tensor(1.0));
      s = (random(0.0, 1.5) * P.M * p / mises(s)) * s;
      const Sym<double, 6> strain = random.tensor(set.strain * random.decade(-5.0, 1.0));
      const double dt = set.dt * random.decade(-9.0, 9.0);
      Point point{s - Sym<double, 6>::isotropic(p), {std::log(p_c), 0.0}, 0.5 * P.rho_p};
      const Point before = point;
      const Increment<double, 6> inc{strain, dt, point.density * std::exp(-trace(strain))};
      int count = 0;
      ASSERT_FALSE(Law::update(P, inc, point.stress, point.state,
                               static_cast<StepWork<double>*>(nullptr), &count))
          << k;
      if (count == 0 || point.apart()) continue;
      ++plastic;
      evaluations.push_back(count);
      const double x_trial = -trace(strain) / P.kappa;
      if (x_trial > 30.0) continue;  // Ḡ is another there
      const double G = P.shear_ratio() * p / P.kappa * expm1_over(x_trial);
      const double q_trial = mises(s + (2.0 * G) * deviator(strain));
      const double q = mises(point.stress), p_end = pressure(point.stress);
      const double flow_q = (q_trial - q) / (3.0 * G);
      const double flow_v = P.kappa * (x_trial - std::log(p_end / p));
      const double known = epsilon * (p + p_end + q_trial) / (q_trial - q);
      const double I = flow_q * P.d * std::sqrt(P.rho_p / p_end) / dt;
      const double j = P.volume_rate();
      // of ln p_s and of the sums below, from 10 roundings in q and 4 in p_c
      const double tolerance = 1e-12 + 10.0 * known * (2.0 + j * I);
      if (!(tolerance < 1e-6)) continue;
      ++flowing;
      const double p_s = 0.5 * std::exp(point.state[0] + j * I);
      const double surface = square(q / (P.M * Law::friction_growth(P, I)));
      EXPECT_NEAR(surface, p_end * (2.0 * p_s - p_end),
                  tolerance * (surface + p_end * (2.0 * p_s + p_end)))
          << k;
      // Δε_v^p q = M²(p − p_s)Δε_q^p; Δε_v^p is known to ε of the strains
      EXPECT_NEAR(flow_v * q, square(P.M) * (p_end - p_s) * flow_q,
                  tolerance * square(P.M) * (p_end + p_s) * flow_q +
                      8.0 * epsilon * q * P.kappa * (std::abs(x_trial) + 1.0))
          << k;
      // (λ − κ) d ln p_c0 = dε_v^p
      EXPECT_NEAR((P.lambda - P.kappa) * (point.state[0] - before.state[0]), flow_v,
                  8.0 * epsilon *
                      (P.kappa * (std::abs(x_trial) + 10.0 + (q + p_end) / p_end) +
                       (P.lambda - P.kappa) * std::abs(point.state[0])))
          << k;
    }
    EXPECT_GT(plastic, 40'000);
    EXPECT_GT(flowing, 20'000);
    std::sort(evaluations.begin(), evaluations.end());
    EXPECT_LE(evaluations[evaluations.size() / 2], 9);
    EXPECT_LE(evaluations[evaluations.size() * 97 / 100], 16);
  }
}

// inertial_number() turns the stress of a return into the I of its flow.
TEST(CriticalStateMuI, StressAndVolumeSayTheInertialNumber) {
  for (const double I_v : {0.0, 0.5}) {
    const Params P = grains(I_v);
    Point point = at_rest(P, 1e3, 1.2);
    const double rate = 20.0, dt = 1e-5;
    double I = 0.0;
    for (int k = 0; k < 400; ++k) {
      const double G = P.shear_ratio() * pressure(point.stress) / P.kappa;
      const double q_trial = mises(point.stress + (2.0 * G) * shear(rate * dt));
      ASSERT_FALSE(point.step(P, shear(rate * dt), dt));
      I = (q_trial - mises(point.stress)) / (3.0 * G * dt) * P.d *
          std::sqrt(P.rho_p / pressure(point.stress));
      const double found = Law::inertial_number(P, point.stress, point.state);
      // q_tr − q is 0.1 of q, and at small I the surface hardly tells: ε of q over its slope
      EXPECT_NEAR(found, I, 1e-11 * (1.0 + I)) << k;
    }
    EXPECT_GT(I, 0.01);
  }
  EXPECT_EQ(Law::inertial_number(grains(0.5), Sym<double, 6>{}, {4.6, 1300.0}), 0.0);
  // without I_v no I carries more than M_∞ does: said as ∞, with the p_c of any I
  Sym<double, 6> beyond = Sym<double, 6>::isotropic(-1e3);
  beyond[3] = 1e3;
  const auto [p_c, I] = Law::derive(grains(0.0), beyond, {std::log(2e3), 0.0});
  EXPECT_TRUE(std::isinf(I));
  EXPECT_NEAR(p_c, 2e3, 1e-12 * 2e3);
}

// CSM-5: whatever it started from, shear at constant volume ends at q = M M_I(I) p and
// v = Γ (p_ref/p)^λ e^{I/I_v}.
TEST(CriticalStateMuI, SteadyShearIsMuOfIAndPhiOfI) {
  for (const double I_v : {0.3, 1.0, 0.0}) {
    const Params P = grains(I_v);
    for (const double ocr : {1.0, 1.5, 4.0}) {
      for (const double rate : {1e-3, 1.0, 30.0}) {
        Point point = at_rest(P, 1e3, ocr);
        const double v = P.rho_p / point.density;
        const double step = 1e-4;
        Sym<double, 6> before;
        for (int k = 0; k < 60'000; ++k) {
          before = point.stress;
          ASSERT_FALSE(point.step(P, shear(step), step / rate));
        }
        const double p = pressure(point.stress);
        ASSERT_NEAR(p, pressure(before), 1e-12 * p) << "not steady";
        const double I = rate / std::sqrt(3.0) * P.d * std::sqrt(P.rho_p / p);
        EXPECT_NEAR(mises(point.stress), P.M * Law::friction_growth(P, I) * p, 1e-10 * p);
        EXPECT_NEAR(volume(P, p, p, I), v, 1e-11 * v) << "rate " << rate << " ocr " << ocr;
        // and the law says so itself
        EXPECT_NEAR(Law::steady_shear_stress(P, p, rate), point.stress[3], 1e-10 * p);
        EXPECT_NEAR(Law::inertial_number(P, point.stress, point.state), I, 1e-9 * (1e-3 + I));
        EXPECT_NEAR(Law::derive(P, point.stress, point.state)[0], 2.0 * p, 1e-9 * p);
      }
    }
  }
}

// CSM-2 holds at every instant of any history: v, p, p_s and I of the point.
TEST(CriticalStateMuI, TheStateRelationHoldsAlongAnyPath) {
  for (const LawExample& example : examples_of<Law>()) {
    const Params P = parameters_of<Law>(example);
    Random random(41);
    int rows = 0;
    for (int path = 0; path < 40; ++path) {
      Point point = at_rest(P, example.pressure, random(1.0, 3.0));
      for (int k = 0; k < 500; ++k) {
        const Sym<double, 6> strain =
            random.tensor(example.strain * random.decade(-2.0, 0.0)) + 0.1 * shear(example.strain);
        ASSERT_FALSE(point.step(P, strain, example.time * random.decade(-2.0, 2.0)));
        if (point.apart()) break;
        const double p = pressure(point.stress);
        const auto [p_c, I] = Law::derive(P, point.stress, point.state);
        if (!std::isfinite(I)) continue;
        // every step rounds ln v, ln p and ln p_c a few times; I is known to what e^{jI} is
        const double known = 20.0 * epsilon * (k + 10.0) * (1.0 + P.volume_rate() * I * P.lambda);
        EXPECT_NEAR(volume(P, p, 0.5 * p_c, I) * point.density / P.rho_p, 1.0, known) << k;
        ++rows;
      }
    }
    EXPECT_GT(rows, 2000) << example.label;
  }
}

// CSM-5, Δt → ∞: a step is one of Cam-Clay with the same frozen Ḡ, whose return is here solved by
// bisection of its one equation; Δt → 0: nothing flows.
TEST(CriticalStateMuI, SlowStepsAreCamClayAndFastOnesElastic) {
  const Params P = grains(0.5);
  Random random(42);
  int plastic = 0;
  for (int k = 0; k < 2000; ++k) {
    const Point start = at_rest(P, 1e3 * random.decade(-1.0, 2.0), random(1.0, 8.0));
    const Sym<double, 6> strain = random.tensor(1e-3 * random.decade(-2.0, 0.5));
    Point slow = start, fast = start;
    ASSERT_FALSE(slow.step(P, strain, 1e15));
    ASSERT_FALSE(fast.step(P, strain, 1e-40));
    const double p_n = pressure(start.stress), p_cn = std::exp(start.state[0]);
    const double x = -trace(strain) / P.kappa;
    const double G = P.shear_ratio() * p_n / P.kappa * expm1_over(x);
    const Sym<double, 6> s_trial = (2.0 * G) * deviator(strain);
    const double p_trial = p_n * std::exp(x), q_trial = mises(s_trial);
    EXPECT_NEAR(pressure(fast.stress), p_trial, 1e-12 * p_trial);
    EXPECT_NEAR(mises(fast.stress), q_trial, 1e-12 * (q_trial + p_trial));
    EXPECT_EQ(fast.state[0], start.state[0]);
    if (square(q_trial / P.M) <= p_trial * (p_cn - p_trial)) continue;
    ++plastic;
    // the volume w between the trial state and critical state: F = 0
    const double r = P.kappa / (P.lambda - P.kappa);
    const auto q_of = [&](double w, double& F) {
      const double p = p_trial * std::exp(-w), p_c = p_cn * std::exp(r * w);
      // κw q/M² = (p − p_c/2)(q_tr − q)/3G
      const double a = (p - 0.5 * p_c) / (3.0 * G), b = P.kappa * w / square(P.M);
      const double q = w == 0.0 ? q_trial : a * q_trial / (a + b);
      F = square(q / P.M) - p * (p_c - p);
      return q;
    };
    double inside = std::log(2.0 * p_trial / p_cn) / (1.0 + r), outside = 0.0, F = 0.0;
    for (int n = 0; n < 200; ++n) {
      const double w = 0.5 * (inside + outside);
      q_of(w, F);
      (F > 0.0 ? outside : inside) = w;
    }
    const double q = q_of(outside, F);
    EXPECT_NEAR(pressure(slow.stress), p_trial * std::exp(-outside), 1e-11 * p_n);
    EXPECT_NEAR(mises(slow.stress), q, 1e-10 * (p_n + q_trial)) << k;
  }
  EXPECT_GT(plastic, 500);
}

// CSM-8: where p = p_s nothing changes the volume, and flow on q alone is a closed quadratic.
TEST(CriticalStateMuI, AtCriticalStateTheReturnIsAQuadratic) {
  const Params P = grains(0.0);
  const double root_3 = std::sqrt(3.0);
  Random random(43);
  for (int k = 0; k < 500; ++k) {
    const double p = random.decade(1.0, 5.0), dt = random.decade(-7.0, 0.0);
    Point point{Sym<double, 6>::isotropic(-p), {std::log(2.0 * p), 0.0}, 1300.0};
    point.stress[3] = random(0.0, 1.0) * P.M * p / root_3;
    const double gamma = random.decade(-4.0, -1.0);
    const double G = P.shear_ratio() * p / P.kappa;
    const double tau_trial = point.stress[3] + G * gamma;
    ASSERT_FALSE(point.step(P, shear(gamma), dt));
    const double mu_0 = P.M / root_3, Delta_mu = (P.M_inf - P.M) / root_3;
    const double S = tau_trial - mu_0 * p;
    if (S <= 0.0) continue;
    const double A = G * dt, Q = root_3 * P.I_M / P.d * std::sqrt(p / P.rho_p);
    const double b = Delta_mu * p + A * Q - S;
    const double root = std::sqrt(b * b + 4.0 * A * S * Q);
    const double rate = b > 0.0 ? 2.0 * S * Q / (b + root) : (root - b) / (2.0 * A);
    EXPECT_NEAR(pressure(point.stress), p, 1e-13 * p);
    EXPECT_NEAR(point.stress[3], tau_trial - A * rate, 1e-12 * tau_trial) << k;
  }
}

// CSM-8: a split return changes p from 844 to 762 Pa in 100 steps of 1e-15 s without strain. Here
// nothing has the time to flow: Δp/p is at most the flow, 1e-13 s of it.
TEST(CriticalStateMuI, NoTimeNoFlow) {
  const Params P = grains(0.5);
  Point point = at_rest(P, 1e3, 1.0);
  ASSERT_FALSE(point.step(P, shear(3e-3), 1e-12));
  const Point before = point;
  ASSERT_GT(mises(before.stress), 1.2 * P.M * pressure(before.stress));
  for (int k = 0; k < 100; ++k) ASSERT_FALSE(point.step(P, Sym<double, 6>{}, 1e-15));
  EXPECT_NEAR(pressure(point.stress), pressure(before.stress), 1e-8 * pressure(before.stress));
  EXPECT_NEAR(mises(point.stress), mises(before.stress), 1e-8 * mises(before.stress));
}

// CSM-9: flow that is stopped at constant volume ends on the normal compression line at its v, with
// p = p_ref (N/v)^{1/λ} and no shear stress, in 1e-4 s. A step that is longer lags: it ends, for
// good, at yield with some shear stress left, the more the longer it is.
TEST(CriticalStateMuI, ASuddenStopEndsOnTheCompressionLine) {
  const Params P = grains(0.5);
  double error_before = 1e-6;
  for (const double dt : {1e-7, 1e-5, 1e-3, 1.0}) {
    Point point = at_rest(P, 1e3, 1.5);
    for (int k = 0; k < 40'000; ++k) ASSERT_FALSE(point.step(P, shear(1e-4), 1e-5));
    ASSERT_GT(Law::inertial_number(P, point.stress, point.state), 0.01);
    const double v = P.rho_p / point.density;
    const double p_line = P.p_ref * std::pow(P.N / v, 1.0 / P.lambda);
    ASSERT_LT(p_line, 0.5 * pressure(point.stress));
    double last = mises(point.stress);
    for (int k = 0; k < 4000; ++k) {
      ASSERT_FALSE(point.step(P, Sym<double, 6>{}, dt));
      ASSERT_LE(mises(point.stress), last * (1.0 + 1e-14));
      last = mises(point.stress);
    }
    const double error = 1.0 - pressure(point.stress) / p_line;
    EXPECT_GT(error, -1e-9) << dt;  // 4e4 steps round v and p_c; p on the line is v^{−1/λ}
    EXPECT_LE(error, dt < 1e-4 ? 100.0 * error_before : 0.02) << dt;
    error_before = error;
    EXPECT_LE(Law::yield(P, point.stress, point.state, point.density, {}), 1e-9 * p_line);
    const Point arrested = point;
    ASSERT_FALSE(point.step(P, Sym<double, 6>{}, 1e3));
    EXPECT_NEAR(pressure(point.stress), pressure(arrested.stress), 1e-9 * p_line);
  }
}

// Loose material parts where its line ends, and a sheared one bears again by its rate alone.
TEST(CriticalStateMuI, PartsAtLowPressureAndShearCarriesItAgain) {
  const Params P = grains(0.5);
  Point point = at_rest(P, 10.0, 1.0);
  // dilated by 20 %: no static pressure is left
  for (int k = 0; k < 200; ++k)
    ASSERT_FALSE(point.step(P, Sym<double, 6>::isotropic(1e-3 / 3.0), 1e-4));
  ASSERT_TRUE(point.apart());
  EXPECT_EQ(largest(point.stress), 0.0);
  const Point loose = point;
  // compression alone meets nothing before ρ_sep
  ASSERT_FALSE(point.step(P, Sym<double, 6>::isotropic(-0.05 / 3.0), 1e-4));
  EXPECT_TRUE(point.apart());
  EXPECT_EQ(point.state[1], loose.state[1]) << "the way back is remembered";
  // slow shear: nothing; fast shear: the pressure of steady flow at this volume
  point = loose;
  for (int k = 0; k < 1000; ++k) ASSERT_FALSE(point.step(P, shear(1e-4), 1e-1));
  EXPECT_TRUE(point.apart());
  point = loose;
  const double rate = 10.0;
  for (int k = 0; k < 50'000; ++k) ASSERT_FALSE(point.step(P, shear(1e-4), 1e-4 / rate));
  ASSERT_FALSE(point.apart());
  const double p = pressure(point.stress);
  const double I = rate / std::sqrt(3.0) * P.d * std::sqrt(P.rho_p / p);
  EXPECT_GT(p, 1.0);
  EXPECT_NEAR(volume(P, p, p, I) * point.density / P.rho_p, 1.0, 1e-9);
  // and where the shear stops, it parts again; the way back ends on the compression line at p_sep
  for (int k = 0; k < 100; ++k) ASSERT_FALSE(point.step(P, Sym<double, 6>{}, 1e-3));
  EXPECT_TRUE(point.apart());
  const double v_line = P.N * std::pow(P.p_ref / P.p_sep, P.lambda);
  EXPECT_NEAR(point.state[1] * v_line / P.rho_p, 1.0, 1e-9);
  // compressed back to ρ_sep and beyond, it is on the compression line
  const double back = std::log(point.state[1] / point.density);
  ASSERT_FALSE(point.step(P, Sym<double, 6>::isotropic(-(back + 0.02) / 3.0), 1.0));
  ASSERT_FALSE(point.apart());
  const double v = P.rho_p / point.density;
  EXPECT_NEAR(pressure(point.stress), P.p_ref * std::pow(P.N / v, 1.0 / P.lambda),
              1e-9 * pressure(point.stress));
}

// CSM-7: with κ/(λ−κ) > 0.7 a dry step may have several roots: that of the smallest t is taken.
// Against a search along t.
TEST(CriticalStateMuI, OfSeveralRootsTheFirstIsTaken) {
  Random random(44);
  int several = 0;
  for (int k = 0; k < 4000; ++k) {
    const double eta = random.decade(-1.0, 1.5), c = random.decade(-8.0, 4.0);
    const double ell = random(-1.0, 5.0), r = random(0.7, 5.0);
    const CriticalStateReturn<double> eq{eta,
                                         ell,
                                         r,
                                         k % 2 == 0 ? 0.0 : 20.0 * random.decade(0.0, 3.0),
                                         c,
                                         random.decade(-1.0, 1.0),
                                         0.5,
                                         random.decade(-3.0, 0.0),
                                         0.0,
                                         c,
                                         1.0 / (1.0 + r)};
    if (std::log(0.5 * (1.0 + eta * eta)) <= eq.ell) continue;
    bool active = true;
    const auto end = flow_end(eq, active);
    ASSERT_FALSE(active) << k;
    int crossings = 0;
    bool beyond = true;
    for (int n = 0; n < 200; ++n) {
      const double t = end.t * std::pow(10.0, -5.0 + 7.0 * n / 200.0);
      if (t > 600.0) break;
      const bool now = eq.at(t, volume_at(eq, t)).Psi > 0.0;
      if (now != beyond) ++crossings;
      ASSERT_TRUE(now || t > 0.95 * end.t) << k << ": a root before the one taken";
      beyond = now;
    }
    if (crossings > 1) ++several;
  }
  EXPECT_GT(several, 0) << "the search met no such step";
}

// Steady friction is μ(I)'s with μ_0 = M/√3, μ_d = M_∞/√3, I_0 = √3 I_M, for the criterion of
// ill-posed waves too (CSM-11).
TEST(CriticalStateMuI, AnswersShearAsMuOfI) {
  const double root_3 = std::sqrt(3.0);
  const LawSpec grains_in_flow = examples_of<Law>().front().spec;
  const auto value = [&](const char* name) { return grains_in_flow.values.at(name); };
  const auto mu_i = make_material({"mu_i",
                                   {},
                                   {{"mu_0", value("M") / root_3},
                                    {"mu_d", value("M_inf") / root_3},
                                    {"I_0", value("I_M") * root_3},
                                    {"d", value("d")},
                                    {"rho_p", value("rho_p")},
                                    {"rho_0", 1300.0},
                                    {"K", 2e5}}});
  const auto material = make_material(grains_in_flow);
  for (const double rate : {0.1, 3.0, 100.0}) {
    const auto a = shear_response(*material, 1e3, rate), b = shear_response(*mu_i, 1e3, rate);
    ASSERT_TRUE(a && b);
    EXPECT_NEAR(a->tau, b->tau, 1e-13 * b->tau);
    EXPECT_NEAR(a->chi, b->chi, 1e-13);
    EXPECT_NEAR(ill_posedness(*a), ill_posedness(*b), 1e-13);
  }
}

std::string refusal(const std::map<std::string, double>& changes, const InitialConditions& given) {
  LawSpec spec = examples_of<Law>().front().spec;
  for (const auto& [name, x] : changes) spec.values[name] = x;
  try {
    make_material(spec)->initial(given);
  } catch (const InputError& error) {
    return error.key() + ": " + error.what();
  }
  return "";
}

TEST(CriticalStateMuI, StartsFromAnyTwoOfPressureRatioAndVolume) {
  const Params P = grains(0.5);
  InitialConditions given;
  given.p = 1e3;
  given.ocr = 1.7;
  const InitialPoint by_ocr = Law::initial(P, given);
  const double v = P.rho_p / by_ocr.density;
  EXPECT_NEAR(volume(P, 1e3, 850.0, 0.0), v, 4.0 * epsilon * v);
  given.ocr.reset();
  given.v = v;
  const InitialPoint by_v = Law::initial(P, given);
  EXPECT_NEAR(by_v.state[0], by_ocr.state[0], 1e-11);
  // v alone: on the compression line
  given.p.reset();
  const InitialPoint on_line = Law::initial(P, given);
  EXPECT_NEAR(pressure(on_line.stress), P.p_ref * std::pow(P.N / v, 1.0 / P.lambda), 1e-9 * 1e3);
  // all three, and they do not agree
  given.p = 1e3;
  given.ocr = 1.75;
  EXPECT_NE(refusal({}, given).find("any two of them give the third"), std::string::npos);
  EXPECT_EQ(refusal({{"M_inf", 0.6}}, {}),
            "M_inf: M_inf must be >= M: friction grows with the inertial number");
  EXPECT_EQ(refusal({}, {}), "p: critical_state_mu_i needs an initial p, sigma, v or density");
}

}  // namespace
}  // namespace repose

/// \file
/// Modified Cam-Clay against its exact solutions (physics.md, "Exact solutions"), and what the
/// return map costs.

#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

template <class L>
class CamClayExact : public ::testing::Test {
 protected:
  /// All examples without p_shift, for which the exact solutions are not written.
  static std::vector<LawExample> examples() {
    std::vector<LawExample> all;
    for (const LawExample& example : examples_of<L>())
      if (!example.spec.values.contains("p_shift")) all.push_back(example);
    return all;
  }
  static LawPoint<L> start(const typename L::template Params<double>& P, double p, double ocr) {
    InitialConditions given;
    given.p = p;
    given.ocr = ocr;
    const InitialPoint at = L::initial(P, given);
    return {at.stress, {at.state[0], 0.0}, at.density};
  }
  /// Axial (x) compression by strain_a without change of volume.
  static Sym<double, 6> isochoric(double strain_a) {
    Sym<double, 6> strain = Sym<double, 6>::isotropic(0.5 * strain_a);
    strain[0] = -strain_a;
    return strain;
  }
  static double q_triaxial(const Sym<double, 6>& stress) { return stress[1] - stress[0]; }
};
using Forms =
    ::testing::Types<ModifiedCamClay<Compression::ln_v_ln_p>, ModifiedCamClay<Compression::v_ln_p>>;
TYPED_TEST_SUITE(CamClayExact, Forms, LawName);

/// Undrained triaxial compression in closed form; κ, λ divided by v for the v – ln p law.
struct Undrained {
  double M, kappa, Lambda, alpha, p_0, R;

  double eta_yield() const { return M * std::sqrt(R - 1.0); }
  double p(double eta) const {
    if (eta == eta_yield()) return p_0;
    const double at_yield = M * M + eta_yield() * eta_yield();
    return p_0 * std::pow(at_yield / (M * M + eta * eta), Lambda);
  }
  /// ε_q at which the stress ratio η is reached, beyond yield.
  double strain(double eta) const {
    const double e = eta_yield();
    const auto F2 = [&](double x) {
      return (std::log(std::abs((M + x) / (M - x))) - 2.0 * std::atan(x / M)) / M;
    };
    return kappa * e / (3.0 * alpha) + kappa * Lambda * (F2(eta) - F2(e)) +
           kappa / (3.0 * alpha) *
               ((1.0 - 2.0 * Lambda) * (eta - e) +
                2.0 * Lambda * M * (std::atan(eta / M) - std::atan(e / M)));
  }
};

TYPED_TEST(CamClayExact, UndrainedTriaxialAtFirstOrderOnBothSides) {
  using L = TypeParam;
  for (const LawExample& example : this->examples()) {
    const auto P = parameters_of<L>(example);
    for (const double R : {1.0, 1.4, 1.9, 3.0, 8.0}) {
      const LawPoint<L> at_rest = this->start(P, example.pressure, R);
      const double v = P.rho_p / at_rest.density;
      const Undrained exact{
          P.M, L::kappa_star(P, v), 1.0 - P.kappa / P.lambda, P.shear_ratio(), example.pressure, R};
      // three quarters of the way from yield to critical state
      const double eta = 0.25 * exact.eta_yield() + 0.75 * P.M;
      const double strain = exact.strain(eta);
      std::array<double, 3> error{};
      for (std::size_t level = 0; level < 3; ++level) {
        const int steps = 400 << level;
        LawPoint<L> point = at_rest;
        for (int step = 0; step < steps; ++step)
          ASSERT_FALSE(point.step(P, this->isochoric(strain / steps), 1.0));
        const double p = pressure(point.stress);
        error[level] = std::abs(p / exact.p(eta) - 1.0) +
                       std::abs(this->q_triaxial(point.stress) / p / eta - 1.0);
      }
      // first order: halves with the step (the next term is 1/400 of it, times a few; where the
      // step that meets the surface happens to begin moves the result by a second-order amount)
      for (std::size_t level = 0; level < 2; ++level) {
        EXPECT_NEAR(error[level] / error[level + 1], 2.0, 0.15) << example.label << " R = " << R;
      }
      EXPECT_LT(error[2], 3e-3) << example.label << " R = " << R;
    }
  }
}

TYPED_TEST(CamClayExact, CriticalStateOfUndrainedShearIsExact) {
  using L = TypeParam;
  for (const LawExample& example : this->examples()) {
    const auto P = parameters_of<L>(example);
    for (const double R : {1.0, 1.9, 2.0, 3.0, 8.0}) {
      LawPoint<L> point = this->start(P, example.pressure, R);
      const double kappa = L::kappa_star(P, P.rho_p / point.density);
      for (int step = 0; step < 3000; ++step)
        ASSERT_FALSE(point.step(P, this->isochoric(0.1 * kappa), 1.0));
      // κ ln(p/p_0) + (λ−κ) ln(p_c/p_c0) = 0 with p_c = 2p: p = p_0 (R/2)^Λ whatever the steps;
      // 3000 steps round ln p and ln p_c a few times each
      const double p = example.pressure * std::pow(0.5 * R, 1.0 - P.kappa / P.lambda);
      EXPECT_NEAR(pressure(point.stress), p, 3000.0 * 4.0 * epsilon * p) << example.label << R;
      EXPECT_NEAR(this->q_triaxial(point.stress), P.M * p, 1e-9 * p) << example.label << R;
    }
  }
}

TYPED_TEST(CamClayExact, OneDimensionalCompressionInAnyNumberOfSteps) {
  using L = TypeParam;
  for (const LawExample& example : this->examples()) {
    const auto P = parameters_of<L>(example);
    const double Lambda = 1.0 - P.kappa / P.lambda;
    const auto balance = [&](double eta) {
      return (1.0 + P.nu) * (1.0 - Lambda) * eta / (3.0 * (1.0 - 2.0 * P.nu)) +
             3.0 * Lambda * eta / (P.M * P.M - eta * eta) - 1.0;
    };
    double low = 0.0, high = P.M;
    for (int k = 0; k < 200; ++k) {
      const double middle = 0.5 * (low + high);
      (balance(middle) < 0.0 ? low : high) = middle;
    }
    const double eta = low;
    const bool on_cone = !cone::is_circle(P.shape);

    LawPoint<L> at_rest = this->start(P, example.pressure, 1.0);
    const double p_0 = example.pressure;
    // on the K0 line: q = ηp, σ_a = p + 2q/3, σ_r = p − q/3
    at_rest.stress = Sym<double, 6>::isotropic(-p_0 * (1.0 - eta / 3.0));
    at_rest.stress[0] = -p_0 * (1.0 + 2.0 / 3.0 * eta);
    at_rest.state[0] = p_0 * (1.0 + square(eta / P.M));
    // K0 = (3 − η)/(3 + 2η)
    EXPECT_NEAR(at_rest.stress[1] / at_rest.stress[0], (3.0 - eta) / (3.0 + 2.0 * eta),
                4.0 * epsilon);
    // to p = 1.5 p_0 along the compression line: λ ln 1.5 of ln v, or of v
    const double drop = P.lambda * std::log(1.5);
    const double v_0 = P.rho_p / at_rest.density;
    const double strain = L::option == "v-ln_p" ? -std::log1p(-drop / v_0) : drop;
    // With q/p constant both strain increments are proportional to Δ ln p in every step, so that
    // the implicit step is exact. The strain is known to ε, ln p to that over κ, per step. On a
    // cone G is that of the predictor, and the step is of first order like any other: half as long,
    // half as far off.
    Sym<double, 6> axial = Sym<double, 6>::isotropic(0.0);
    double off_before = 0.0;
    for (const int steps : on_cone ? std::array{100, 200, 400} : std::array{1, 10, 300}) {
      LawPoint<L> point = at_rest;
      axial[0] = -strain / steps;
      for (int step = 0; step < steps; ++step) ASSERT_FALSE(point.step(P, axial, 1.0));
      const double tolerance = 16.0 * epsilon * (steps + 2.0 * strain / P.kappa);
      if (on_cone) {
        const double off = std::abs(mises(point.stress) / pressure(point.stress) / eta - 1.0);
        EXPECT_LT(off, 1e-2) << example.label << steps;
        if (off_before > 0.0) {
          EXPECT_NEAR(off_before / off, 2.0, 0.2) << example.label << steps;
        }
        off_before = off;
        continue;
      }
      EXPECT_NEAR(pressure(point.stress) / (1.5 * p_0), 1.0, tolerance) << example.label << steps;
      EXPECT_NEAR(mises(point.stress) / pressure(point.stress) / eta, 1.0, 4.0 * tolerance)
          << example.label << steps;
    }
    // and it attracts: from an isotropic start, q/p is there once p has grown by a few powers of e
    LawPoint<L> point = this->start(P, example.pressure, 1.0);
    const double first = std::abs(mises(point.stress) / pressure(point.stress) - eta);
    axial[0] = -0.01 * strain;
    for (int step = 0; step < 700; ++step) ASSERT_FALSE(point.step(P, axial, 1.0));
    const double last = std::abs(mises(point.stress) / pressure(point.stress) - eta);
    EXPECT_LT(last, 1e-3 * first) << example.label;
  }
}

/// The equation of a random step from the yield surface, built from its definition (physics.md,
/// "The return map"); none if the step is elastic or tears the point.
template <class L>
std::optional<CamClayReturn<double>> random_return(const typename L::template Params<double>& P,
                                                   double kappa, double size, Random& random) {
  const double x = random(0.001, 0.999);
  const double p = 1000.0, p_c = p / x;
  Sym<double, 6> s = deviator(random.tensor(1.0));
  s = (P.M * p * std::sqrt((1.0 - x) / x) / mises(s)) * s;
  const Sym<double, 6> e = deviator(random.tensor(size));
  const double strain_v = random(-size, size);
  const double G = P.shear_ratio() * p / kappa;
  const double a = P.kappa / P.lambda;
  const double unit = 1.0 / square(P.M * p);
  const double ln_ratio = std::log(p_c / (2.0 * p));
  const CamClayReturn<double> equation{a,
                                       strain_v / kappa - ln_ratio,
                                       ln_ratio,
                                       3.0 * P.shear_ratio() * (1.0 - a) / square(P.M),
                                       1.5 * contract(s, s) * unit,
                                       6.0 * G * contract(s, e) * unit,
                                       6.0 * G * G * contract(e, e) * unit,
                                       0.0};
  const auto trial = equation.at(1.0);
  if (!(trial.H > 1e-14 * trial.scale)) return {};
  if (equation.L < 0.0 && std::log(0.5 * p_c / P.p_sep) + a * equation.L < 0.0) return {};
  return equation;
}

/// An equation that counts how often it is asked.
struct Counted {
  using Point = CamClayReturn<double>::Point;
  CamClayReturn<double> equation;
  mutable int evaluations = 0;
  Point at(double w) const {
    ++evaluations;
    return equation.at(w);
  }
  Point moved(const Point& from, double move) const { return equation.moved(from, move); }
};

TYPED_TEST(CamClayExact, TheRootIsFoundInFewEvaluations) {
  using L = TypeParam;
  for (const LawExample& example : this->examples()) {
    const auto P = parameters_of<L>(example);
    Random random(41);
    int most = 0, most_of_small = 0;
    long sum = 0, sum_of_small = 0, all = 0, small = 0;
    for (int sample = 0; sample < 100000; ++sample) {
      // in κ* of a specific volume of 1.6
      const double kappa = L::kappa_star(P, 1.6);
      const double size = random.decade(-8.0, 0.0) * 50.0 * kappa;
      const auto equation = random_return<L>(P, kappa, size, random);
      if (!equation) continue;
      const Counted counted{*equation};
      const auto trial = counted.equation.at(1.0);
      bool active = true;
      const auto root = bracketed_root(counted, trial, counted.equation.bracket_end(), active);
      EXPECT_FALSE(active);
      // a root to the round-off of its terms, y = Lw to 4|L|ε
      const auto there = counted.equation.at(root.w);
      EXPECT_LT(std::abs(there.H),
                epsilon * there.scale * (32.0 + 16.0 * std::abs(counted.equation.L)));
      // The last step is a Taylor series of less than 1e-9: what it carries is what the equation
      // says, to the round-off of x and y, which are sums of terms of the size of L.
      const double sums = std::abs(counted.equation.L) + std::abs(counted.equation.ln_ratio);
      for (const auto part : {&CamClayReturn<double>::Point::g, &CamClayReturn<double>::Point::h,
                              &CamClayReturn<double>::Point::f, &CamClayReturn<double>::Point::D})
        EXPECT_NEAR(root.*part, there.*part,
                    epsilon * (32.0 + 16.0 * sums) * std::abs(there.*part));
      EXPECT_GT(root.w, 0.0);
      EXPECT_LE(root.w, counted.equation.bracket_end());
      ++all;
      sum += counted.evaluations;
      most = std::max(most, counted.evaluations);
      if (size < 0.1 * kappa) {
        ++small;
        sum_of_small += counted.evaluations;
        most_of_small = std::max(most_of_small, counted.evaluations);
      }
    }
    ASSERT_GT(small, 10000);
    std::printf("%s: evaluations in the mean %.2f, at most %d; strains below 0.1 kappa: %.2f, %d\n",
                example.label.c_str(), static_cast<double>(sum) / static_cast<double>(all), most,
                static_cast<double>(sum_of_small) / static_cast<double>(small), most_of_small);
    // Bounds around what was measured (mean 4, at most 19; small steps 2.2, at most 7), so
    // that a worse method is noticed; bisection alone would take 53.
    EXPECT_LT(most, 40) << example.label;
    EXPECT_LE(most_of_small, 8) << example.label;
    EXPECT_LT(static_cast<double>(sum_of_small), 3.0 * static_cast<double>(small)) << example.label;
  }
}

TYPED_TEST(CamClayExact, TheRootIsTheOnlyOne) {
  using L = TypeParam;
  for (const LawExample& example : this->examples()) {
    const auto P = parameters_of<L>(example);
    Random random(42);
    int scanned = 0;
    for (int sample = 0; sample < 4000; ++sample) {
      const double kappa = L::kappa_star(P, 1.6);
      const auto equation =
          random_return<L>(P, kappa, random.decade(-4.0, 0.0) * 50.0 * kappa, random);
      if (!equation) continue;
      // H < 0 at the lower end, >= 0 at the upper, and one change between on a grid of 400
      const double end = equation->bracket_end();
      EXPECT_LT(equation->at(1e-12 * end).H, 0.0) << example.label;
      EXPECT_GE(equation->at(end).H, -8.0 * epsilon * equation->at(end).scale) << example.label;
      int changes = 0;
      bool before = false;
      for (int k = 1; k < 400; ++k) {
        const bool now = equation->at(end * k / 400.0).H > 0.0;
        if (now != before) ++changes;
        before = now;
      }
      EXPECT_LE(changes, 1) << example.label << " L = " << equation->L;
      ++scanned;
    }
    EXPECT_GT(scanned, 1000);
  }
}

}  // namespace
}  // namespace repose

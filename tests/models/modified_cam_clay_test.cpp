/// \file
/// Modified Cam-Clay: the yield condition after every step, the lines, contact, initial states, the
/// solver's work.

#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

template <Compression compression>
using CamClay = ModifiedCamClay<compression>;
using LnLn = CamClay<Compression::ln_v_ln_p>;
using Classical = CamClay<Compression::v_ln_p>;

template <class L>
class CamClayUnit : public ::testing::Test {
 protected:
  using Values = typename L::template Params<double>;
  using State = typename L::template State<double>;

  static Values parameters(const std::map<std::string, double>& changes = {}) {
    LawExample example = examples_of<L>()[0];
    for (const auto& [name, x] : changes) example.spec.values[name] = x;
    return parameters_of<L>(example);
  }
  static LawPoint<L> isotropic(const Values& par, double p, double ocr) {
    InitialConditions given;
    given.p = p;
    given.ocr = ocr;
    return point_of(L::initial(par, given));
  }
  static LawPoint<L> point_of(const InitialPoint& start) {
    return {start.stress, {start.state[0], start.state[1]}, start.density};
  }
  /// Compression by a volumetric strain (compression positive).
  static Sym<double, 6> volumetric(double strain_v) {
    return Sym<double, 6>::isotropic(-strain_v / 3.0);
  }
  /// κ and λ of ln p, times v or times 1: the difference of ln v or v (MCC-5) that belongs to them.
  static double volume(const Values& par, double density) {
    const double v = par.rho_p / density;
    return L::option == "v-ln_p" ? v : std::log(v);
  }
  /// MCC-5 says that ln v (or v) + κ ln p + (λ−κ) ln p_c never changes.
  static double invariant(const Values& par, const LawPoint<L>& at) {
    return volume(par, at.density) + par.kappa * std::log(pressure(at.stress) + par.p_shift) +
           (par.lambda - par.kappa) * std::log(at.state[0]);
  }
};
using Forms = ::testing::Types<LnLn, Classical>;
TYPED_TEST_SUITE(CamClayUnit, Forms, LawName);

/// |F| in units of ε(q²/M² + pp_c), F = q²/M² − p(p_c − p)                                  MCC-1
template <class L>
double yield_residual(const typename L::template Params<double>& P, const LawPoint<L>& at) {
  const double p = pressure(at.stress) + P.p_shift;
  const double q2_M2 = square(mises(at.stress) / P.slope(deviator(at.stress)));
  const double p_c = at.state[0];
  return (q2_M2 - p * (p_c - p)) / (q2_M2 + p * p_c) / epsilon;
}

TYPED_TEST(CamClayUnit, YieldConditionHoldsAfterEveryPlasticStep) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(31);
    std::array<int, 3> side{};  // wet, dry, critical
    int apart = 0;
    for (int sample = 0; sample < 40000; ++sample) {
      // a state on the yield surface: from the isotropic tip to far on the dry side, and critical
      const double x = sample % 10 == 1 ? 0.5 : random(0.01, 1.0);
      LawPoint<L> point;
      const double p_c = example.pressure * random.decade(-1.0, 2.0);
      const double p = x * p_c;
      const Sym<double, 6> direction = deviator(random.tensor(1.0));
      point.stress =
          (P.slope(direction) * p_c * std::sqrt(x * (1.0 - x)) / mises(direction)) * direction -
          Sym<double, 6>::isotropic(p - P.p_shift);
      point.state = {p_c, 0.0};
      point.density = L::density_at(P, 1e3, 1.0);
      Sym<double, 6> strain = random.tensor(random.decade(-9.0, -0.5));
      if (sample % 5 == 1) strain = deviator(strain);  // no volume change: L → 0 from critical
      if (sample % 5 == 2) strain = random.decade(-8.0, -1.0) * direction;  // outwards
      if (sample % 20 == 3) strain = strain + Sym<double, 6>::isotropic(random(0.0, 0.5));
      const LawPoint<L> before = point;
      ASSERT_FALSE(point.step(P, strain, 1.0)) << example.label;
      if (point.apart()) {
        ++apart;
        continue;
      }
      const double residual = yield_residual<L>(P, point);
      // The root w is known to 4 ε or H to 4 ε of its terms: y = Lw to 4|L|ε, and F like y. Then
      // p and s are put together and taken apart again: 8 roundings of the largest stress.
      const double strain_v = -trace(strain);
      const double kappa = L::kappa_star(P, P.rho_p / before.density);
      const double L_wide = std::abs(strain_v) / kappa + std::abs(std::log(2.0 * x)) + 1.0;
      const double sums = 8.0 * largest(point.stress) / (pressure(point.stress) + P.p_shift);
      const double tolerance = 24.0 + 8.0 * L_wide + 4.0 * sums * std::max(1.0, 1.0 / P.M);
      if (point.state[0] != before.state[0]) {
        EXPECT_LT(std::abs(residual), tolerance) << example.label << " x = " << x;
        const double y = 2.0 * (pressure(point.stress) + P.p_shift) / point.state[0];
        ++side[std::abs(y - 1.0) < 1e-6 ? 2u : (y > 1.0 ? 0u : 1u)];
      } else {
        EXPECT_LT(residual, tolerance) << example.label << ": elastic, but outside";
      }
    }
    for (const int n : side) EXPECT_GT(n, 100) << example.label;
    EXPECT_GT(apart, 10) << example.label;
  }
}

TYPED_TEST(CamClayUnit, SwellingLineIsExactInOneStep) {
  using L = TypeParam;
  for (const double p_shift : {0.0, 500.0}) {
    const auto P = this->parameters({{"p_shift", p_shift}});
    for (const double ratio : {0.999, 0.5, 1e-2, 1e-5}) {
      for (const int steps : {1, 10, 1000}) {
        LawPoint<L> point = this->isotropic(P, 1e5, 2.0);
        const double p_c = point.state[0];
        const double end = ratio * (1e5 + p_shift) - p_shift;
        if (end < 1.0) continue;
        // ln v (or v) grows by κ ln(p_0/p)                                                 MCC-5
        const double growth = -P.kappa * std::log(ratio);
        const double v_0 = P.rho_p / point.density;
        const double v = L::option == "v-ln_p" ? v_0 + growth : v_0 * std::exp(growth);
        for (int step = 0; step < steps; ++step)
          ASSERT_FALSE(point.step(P, this->volumetric(-std::log(v / v_0) / steps), 1.0));
        // A strain of size growth is known to ε v/… : x = ln(p/p_0) to 4 ε(1/κ + |x|) of the first
        // step's kind, and once more for every step that is rounded
        const double relative = 8.0 * epsilon *
                                (std::log(v / v_0) / P.kappa * v + 1.0 / P.kappa * 0.1 + 4.0) *
                                (1.0 + std::sqrt(steps));
        EXPECT_NEAR(pressure(point.stress) + p_shift, end + p_shift, relative * (end + p_shift))
            << "ratio " << ratio << " steps " << steps;
        EXPECT_EQ(point.state[0], p_c);
        EXPECT_EQ(mises(point.stress), 0.0);
        EXPECT_NEAR(P.rho_p / point.density, v, 1e-12 * v);
      }
    }
  }
}

TYPED_TEST(CamClayUnit, CompressionLineIsExactInOneStep) {
  using L = TypeParam;
  for (const double p_shift : {0.0, 500.0}) {
    const auto P = this->parameters({{"p_shift", p_shift}});
    for (const double ocr : {1.0, 3.0}) {
      for (const double factor : {1.001, 2.0, 50.0}) {
        for (const int steps : {1, 7, 500}) {
          LawPoint<L> point = this->isotropic(P, 1e4, ocr);
          const double p_c = point.state[0];
          const double end = factor * p_c;  // p + p_shift, on the compression line
          // κ up to p_c, then λ                                                            MCC-5
          const double drop =
              P.kappa * std::log(p_c / (1e4 + p_shift)) + P.lambda * std::log(factor);
          const double v_0 = P.rho_p / point.density;
          const double v = L::option == "v-ln_p" ? v_0 - drop : v_0 * std::exp(-drop);
          // with OCR > 1 part of the first steps is elastic: the line is met only by its end
          for (int step = 0; step < steps; ++step)
            ASSERT_FALSE(point.step(P, this->volumetric(std::log(v_0 / v) / steps), 1.0));
          const double relative = 16.0 * epsilon * (1.0 / P.kappa + 10.0 * std::log(factor * ocr)) *
                                  (1.0 + std::sqrt(steps));
          EXPECT_NEAR(point.state[0], end, relative * end) << ocr << " " << factor << " " << steps;
          EXPECT_NEAR(pressure(point.stress) + p_shift, end, relative * end);
          EXPECT_NEAR(P.rho_p / point.density, v, 1e-12 * v);
        }
      }
    }
  }
}

TYPED_TEST(CamClayUnit, UndrainedShearIsElasticInsideTheSurface) {
  using L = TypeParam;
  const auto P = this->parameters();
  LawPoint<L> point = this->isotropic(P, 1e4, 3.0);
  const LawPoint<L> start = point;
  const double v = P.rho_p / point.density;
  // G = 3(1−2ν)/(2(1+ν)) p/κ*                                                              MCC-4
  const double G =
      1.5 * (1.0 - 2.0 * P.nu) / (1.0 + P.nu) * 1e4 / P.kappa * (L::option == "v-ln_p" ? v : 1.0);
  Sym<double, 6> strain = Sym<double, 6>::isotropic(0.0);
  strain[3] = 0.1 * P.M * 1e4 / G;  // γ = 2ε_xy
  ASSERT_FALSE(point.step(P, strain, 1.0));
  EXPECT_NEAR(point.stress[3], 2.0 * G * strain[3], 8.0 * epsilon * point.stress[3]);
  EXPECT_EQ(pressure(point.stress), pressure(start.stress));
  EXPECT_EQ(point.state, start.state);
  ASSERT_FALSE(point.step(P, -1.0 * strain, 1.0));
  EXPECT_NEAR(point.stress[3], 0.0, 8.0 * epsilon * 2.0 * G * strain[3]);
}

TYPED_TEST(CamClayUnit, VolumeIsAFunctionOfPressuresThroughAnyHistory) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(32);
    int rejoined = 0;
    for (int path = 0; path < 200; ++path) {
      LawPoint<L> point = random_point<L>(example, P, random);
      const double start = this->invariant(P, point);
      for (int step = 0; step < 100; ++step) {
        const bool was_apart = point.apart();
        Sym<double, 6> strain = random.tensor(example.strain * random.decade(-3.0, 0.0));
        // swell until contact is lost, compress until it is found again, on and on
        const double swell = (step / 10 % 2 == 0 ? 1.0 : -1.0) * random(0.0, 2.0) * example.strain;
        strain = strain + Sym<double, 6>::isotropic(swell);
        // (too dense or too loose for the numbers to mean anything)
        if (point.density > 0.98 * P.rho_p || point.density < 0.05 * P.rho_p) break;
        ASSERT_FALSE(point.step(P, strain, 1.0)) << example.label;
        if (point.apart()) continue;
        rejoined += was_apart ? 1 : 0;
        // 100 steps, each of which rounds p, p_c and ρ a few times
        EXPECT_NEAR(this->invariant(P, point), start, 100.0 * 64.0 * epsilon)
            << example.label << " step " << step << (was_apart ? ": rejoined" : "");
      }
    }
    EXPECT_GT(rejoined, 10) << example.label;
  }
}

TYPED_TEST(CamClayUnit, ContactIsLostAndFoundAtTheSameDensity) {
  using L = TypeParam;
  for (const double p_shift : {0.0, 50.0}) {
    const auto P = this->parameters({{"p_shift", p_shift}});
    const LawPoint<L> start = this->isotropic(P, 1e3, 2.0);
    const double v_0 = P.rho_p / start.density;
    const double rise = P.kappa * std::log((1e3 + p_shift) / (P.p_sep + p_shift));
    const double v_sep = L::option == "v-ln_p" ? v_0 + rise : v_0 * std::exp(rise);
    for (const int out : {1, 3, 100}) {
      for (const int back : {1, 5, 37}) {
        LawPoint<L> point = start;
        const double far = std::log(v_sep / v_0) + 0.05;
        for (int step = 0; step < out; ++step)
          ASSERT_FALSE(point.step(P, this->volumetric(-far / out), 1.0));
        EXPECT_TRUE(point.apart());
        for (int k = 0; k < 6; ++k) EXPECT_EQ(point.stress[k], 0.0);
        EXPECT_EQ(point.state[0], start.state[0]);
        EXPECT_NEAR(point.state[1], P.rho_p / v_sep, 1e-12 * P.rho_p / v_sep);
        // a separated point moves freely, whatever its shear
        Sym<double, 6> shear = Sym<double, 6>::isotropic(0.0);
        shear[3] = 0.3;
        ASSERT_FALSE(point.step(P, shear, 1.0));
        for (int k = 0; k < 6; ++k) EXPECT_EQ(point.stress[k], 0.0);

        // back to just before contact, to contact (p = p_sep), and to the start
        LawPoint<L> near = point;
        const double to_contact = std::log(point.state[1] / point.density);
        ASSERT_FALSE(near.step(P, this->volumetric(to_contact * (1.0 - 1e-9)), 1.0));
        EXPECT_TRUE(near.apart());
        near.density = near.state[1];
        ASSERT_FALSE(near.step(P, this->volumetric(0.0), 1.0));
        EXPECT_FALSE(near.apart());
        EXPECT_NEAR(pressure(near.stress), P.p_sep, 4.0 * epsilon * (P.p_sep + p_shift));

        for (int step = 0; step < back; ++step)
          ASSERT_FALSE(point.step(P, this->volumetric(far / back), 1.0));
        EXPECT_FALSE(point.apart());
        // ρ after out + back steps is known to an ε each, and ln p to that over κ
        const double relative = 8.0 * epsilon * (out + back) / P.kappa;
        EXPECT_NEAR(pressure(point.stress), 1e3, relative * (1e3 + p_shift)) << out << " " << back;
        EXPECT_NEAR(mises(point.stress), 0.0, relative * 1e3);
        EXPECT_EQ(point.state[0], start.state[0]);
        EXPECT_EQ(point.state[1], 0.0);
      }
    }
  }
}

TYPED_TEST(CamClayUnit, ShiftedLawIsFiniteAtZeroPressure) {
  using L = TypeParam;
  const double p_shift = 200.0;
  const auto P = this->parameters({{"p_shift", p_shift}});
  LawPoint<L> point = this->isotropic(P, 1.0, 10.0);
  const double v = P.rho_p / point.density;
  const double kappa = L::kappa_star(P, v);
  // K = (p + p_shift)/κ*, P-wave modulus K + 4G/3                                    MCC-4, MCC-7
  const double K = (1.0 + p_shift) / kappa;
  const double G = 1.5 * (1.0 - 2.0 * P.nu) / (1.0 + P.nu) * K;
  EXPECT_NEAR(L::modulus(P, point.stress, point.state, point.density), K + 4.0 / 3.0 * G,
              8.0 * epsilon * (K + G));
  const double strain = 1e-3 * kappa;
  ASSERT_FALSE(point.step(P, this->volumetric(strain), 1.0));
  // Δp = K Δε_v to first order, and half its square; v changes κ* by ε_v
  EXPECT_NEAR(pressure(point.stress) - 1.0, K * strain * (1.0 + 0.5e-3), K * strain * 2e-3 * 0.5);
  // the yield surface is shifted as a whole: at p = 0 the point carries q = M√(p_s(p_c − p_s))
  EXPECT_EQ(point.state[0], 10.0 * (1.0 + p_shift));
}

TYPED_TEST(CamClayUnit, StoredEnergyIsTheWorkOfUnloading) {
  using L = TypeParam;
  for (const double p_shift : {0.0, 500.0}) {
    const auto P = this->parameters({{"p_shift", p_shift}});
    LawPoint<L> point = this->isotropic(P, 2e4, 1.5);
    const double energy =
        L::stored_energy(P, point.stress, point.state, point.density) / point.density;
    // ∫ p d(1/ρ) down to p_sep by the trapezoidal rule in n steps: relative error Δx²/12, x = ln p
    const int n = 20000;
    const double v_0 = P.rho_p / point.density;
    const double rise = P.kappa * std::log((2e4 + p_shift) / (P.p_sep + p_shift)) * (1.0 - 1e-9);
    const double strain = L::option == "v-ln_p" ? std::log1p(rise / v_0) : rise;
    double work = 0.0;
    for (int step = 0; step < n; ++step) {
      const LawPoint<L> before = point;
      ASSERT_FALSE(point.step(P, this->volumetric(-strain / n), 1.0));
      work += 0.5 * (pressure(before.stress) + pressure(point.stress)) *
              (1.0 / point.density - 1.0 / before.density);
    }
    const double rest =
        L::stored_energy(P, point.stress, point.state, point.density) / point.density;
    const double dx = std::log((2e4 + p_shift) / (P.p_sep + p_shift)) / n;
    EXPECT_NEAR(energy - rest, work, work * (dx * dx / 6.0 + 1e-9)) << p_shift;
  }
}

TEST(CamClayInitial, ColumnOfThePublishedScene) {
  // CSL through φ = 0.648 at 1 Pa, φ = 0.65, OCR 1. N = Γ 2^{λ−κ}, p = (N/v)^{1/λ} Pa:
  // ln p = [ln(0.65/0.648) + 0.0176 ln 2]/0.0186 = 0.165670 + 0.655881 = 0.821551, p = 2.2740 Pa
  const auto P = parameters_of<LnLn>(examples_of<LnLn>()[0]);
  InitialConditions given;
  given.density = 0.65 * 2000.0;
  const InitialPoint start = LnLn::initial(P, given);
  const double p = std::exp((std::log(0.65 / 0.648) + 0.0176 * std::log(2.0)) / 0.0186);
  EXPECT_NEAR(p, 2.2740, 5e-5);
  EXPECT_NEAR(pressure(start.stress), p, 1e-12 * p);  // 1/λ magnifies the rounding of v
  EXPECT_NEAR(start.state[0], p, 1e-12 * p);
  EXPECT_EQ(start.density, 1300.0);
  // and back: the density under that pressure
  EXPECT_NEAR(LnLn::density_at(P, p, 1.0), 1300.0, 1e-11);
}

TEST(CamClayInitial, ClassicalClay) {
  // N = Γ + (λ−κ) ln 2 = 2.759 + 0.099·0.693147 = 2.8276216 at 1 kPa;
  // at p = 100 kPa, OCR 2: v = N − λ ln 200 + κ ln 2 = 2.8276216 − 0.8530291 + 0.0429751
  const auto P = parameters_of<Classical>(examples_of<Classical>()[0]);
  InitialConditions given;
  given.p = 1e5;
  given.ocr = 2.0;
  const InitialPoint start = Classical::initial(P, given);
  EXPECT_NEAR(2650.0 / start.density, 2.0175676, 1e-7);
  EXPECT_EQ(start.state[0], 2e5);
  // the same state from (v, p), and from (v, OCR)
  InitialConditions by_volume;
  by_volume.v = 2650.0 / start.density;
  by_volume.p = 1e5;
  EXPECT_NEAR(Classical::initial(P, by_volume).state[0], 2e5, 2e5 * 1e-13);
  InitialConditions by_ocr;
  by_ocr.v = 2650.0 / start.density;
  by_ocr.ocr = 2.0;
  EXPECT_NEAR(pressure(Classical::initial(P, by_ocr).stress), 1e5, 1e5 * 1e-13);
}

TEST(CamClayInitial, ShearedStatesLieOnOrInTheYieldSurface) {
  const auto P = parameters_of<Classical>(examples_of<Classical>()[0]);
  InitialConditions given;
  given.p = 1e5;
  given.K0 = 0.6;
  const InitialPoint start = Classical::initial(P, given);
  // σ_v = 3p/(1 + 2K0), q = (1 − K0)σ_v, p_c = p + q²/(M²p)
  const double vertical = 3e5 / 2.2;
  const double q = 0.4 * vertical;
  EXPECT_NEAR(start.stress[1], -vertical, 1e-10);
  EXPECT_NEAR(start.stress[0], -0.6 * vertical, 1e-10);
  EXPECT_NEAR(start.stress[2], -0.6 * vertical, 1e-10);
  EXPECT_NEAR(start.state[0], 1e5 + q * q / (0.888 * 0.888 * 1e5), 1e-9);
}

// ocr_v = σ_v,max/σ_v: p_c is that of the yield surface through the stress under σ_v,max.
TEST(CamClayInitial, VerticalOverconsolidation) {
  const auto P = parameters_of<Classical>(examples_of<Classical>()[0]);
  InitialConditions given;
  given.sigma_v = 1e5;
  given.K0 = 0.8;
  given.ocr_v = 3.0;
  const InitialPoint same = Classical::initial(P, given);
  EXPECT_NEAR(same.stress[1], -1e5, 1e-9);
  EXPECT_NEAR(pressure(same.stress), 1e5 * 2.6 / 3.0, 1e-9);
  const auto p_c = [](double vertical, double K0) {
    const double p = vertical * (1.0 + 2.0 * K0) / 3.0, q = vertical * (1.0 - K0);
    return p + q * q / (0.888 * 0.888 * p);
  };
  EXPECT_NEAR(same.state[0], p_c(3e5, 0.8), 1e-9 * same.state[0]);
  given.K0_nc = 0.6;
  EXPECT_NEAR(Classical::initial(P, given).state[0], p_c(3e5, 0.6), 1e-9 * same.state[0]);
  // from v alone: the pressure at which the line says this v
  InitialConditions by_volume = given;
  by_volume.sigma_v.reset();
  by_volume.v = 2650.0 / Classical::initial(P, given).density;
  EXPECT_NEAR(Classical::initial(P, by_volume).stress[1], -1e5, 1e-7);
}

TEST(CamClayInitial, AVolumeThatTheLineContradictsIsRefused) {
  const auto P = parameters_of<Classical>(examples_of<Classical>()[0]);
  InitialConditions given;
  given.p = 1e5;
  given.ocr = 2.0;  // v = 2.0175676 on the line
  given.v = 2.02;   // 0.1 %: as measured
  EXPECT_NEAR(2650.0 / Classical::initial(P, given).density, 2.02, 1e-12);
  given.v = 2.2;
  try {
    Classical::initial(P, given);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "v");
    EXPECT_STREQ(
        error.what(),
        "the initial state contradicts itself: v is 2.2, and at p = 1e+05 Pa with p_c = "
        "2e+05 Pa the compression line (Gamma or N) says 2.0176; leave out v, ocr or p, or "
        "Gamma and N");
  }
}

TEST(CamClayInitial, Refusals) {
  const auto P = parameters_of<Classical>(examples_of<Classical>()[0]);
  const auto refused = [&](const InitialConditions& given) {
    try {
      Classical::initial(P, given);
    } catch (const InputError& error) {
      return error.key() + ": " + error.what();
    }
    return std::string("accepted");
  };
  InitialConditions given;
  EXPECT_EQ(refused(given), "p: modified_cam_clay needs an initial p, sigma, v or density");
  given.p = 1e5;
  given.ocr = 0.9;
  EXPECT_EQ(refused(given), "ocr: ocr = p_c/p must be >= 1");
  given.ocr = 1.0;
  given.K0 = 0.5;  // σ_v = 150 kPa, q = 75 kPa, p_c >= p + q²/(M²p)
  EXPECT_EQ(
      refused(given),
      "ocr: the initial stress lies outside the yield surface: p_c = 100000.000000 Pa, and "
      "this stress needs p_c >= 171334.002922 Pa; ocr is p_c/p, of mean stresses: the ratio of "
      "vertical stresses sigma_v,max/sigma_v is ocr_v");
  given = {};
  given.p = 1e-3;
  EXPECT_EQ(refused(given),
            "p: the initial p must be > p_sep, and compression is positive: below it the point "
            "carries no stress");
  given.p = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refused(given), "p: p must be a finite pressure in Pa");
  given = {};
  given.v = 0.9;
  EXPECT_EQ(refused(given), "v: the specific volume v = rho_p/density must be > 1");
  given.v = 2.0;
  given.density = 1300.0;
  EXPECT_EQ(refused(given), "v: give either v or density: v = rho_p/density");
  given = {};
  given.p = 1e12;
  EXPECT_EQ(refused(given),
            "Gamma: the compression line gives a specific volume <= 1 (no voids) at the initial "
            "pressure");
}

}  // namespace
}  // namespace repose

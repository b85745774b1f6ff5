/// \file
/// Where the work of a step goes (StepWork, law.hpp; physics.md, "Where the work goes"): for every
/// law, stress work is what is stored and what is spent; and each part against a closed form of its
/// own, because a sum says nothing of its parts.

#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

/// Energies of a path, per mass [J/kg].
struct Energies {
  double work = 0.0, stored = 0.0, plastic = 0.0, viscous = 0.0, hypoelastic = 0.0,
         separation = 0.0;
  double missing() const { return work - stored - plastic - viscous - hypoelastic - separation; }
};

/// A point that keeps account of its steps.
template <class L>
struct Account {
  typename L::template Params<double> P;
  LawPoint<L> point;
  Energies sum;
  StepWork<double> last;  ///< per mean volume
  bool parted = false;

  double stored_per_mass() const {
    return L::stored_energy(P, point.stress, point.state, point.density) / point.density;
  }
  void step(const Sym<double, 6>& strain, double dt) {
    const Sym<double, 6> before = point.stress;
    const double stored = stored_per_mass();
    const Increment<double, 6> inc{strain, dt, point.density * std::exp(-trace(strain))};
    last = {};
    ASSERT_FALSE(L::update(P, inc, point.stress, point.state, &last));
    point.density = inc.density;
    const double mean_volume = std::exp(-0.5 * trace(strain)) / inc.density;
    sum.work += mean_volume * 0.5 * contract(before + point.stress, strain);
    sum.stored += stored_per_mass() - stored;
    sum.plastic += mean_volume * last.plastic;
    sum.viscous += mean_volume * last.viscous;
    sum.hypoelastic += mean_volume * last.hypoelastic;
    sum.separation += mean_volume * last.separation;
    parted = parted || point.apart() || (!carries_tension<L> && !(pressure(point.stress) > 0.0));
  }
  void steps(int n, const Sym<double, 6>& strain, double dt) {
    for (int k = 0; k < n; ++k) step((1.0 / n) * strain, dt / n);
  }
};

template <class L>
Account<L> at_rest(const LawSpec& spec, const InitialConditions& given) {
  const auto P = L::template Params<double>::from(checked_parameters(spec));
  const InitialPoint start = L::initial(P, given);
  Account<L> account{P, {start.stress, {}, start.density}, {}, {}};
  for (std::size_t k = 0; k < start.state.size(); ++k) account.point.state[k] = start.state[k];
  return account;
}
template <class L>
Account<L> at_rest(const LawSpec& spec, double p, double ocr = 0.0) {
  InitialConditions given;
  given.p = p;
  if (ocr > 0.0) given.ocr = ocr;
  return at_rest<L>(spec, given);
}

Sym<double, 6> shear(double gamma) {
  Sym<double, 6> e;
  e[3] = 0.5 * gamma;
  return e;
}

template <class L>
class StepWorkOf : public ::testing::Test {};
TYPED_TEST_SUITE(StepWorkOf, LawTypes, LawName);

// What is missing is the error of the mean of two stresses, of second order in the step: with half
// the steps a quarter of it. (Where a path begins to yield within a step, that one errs by its
// square.)
TYPED_TEST(StepWorkOf, WorkIsStoredOrSpent) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(31);
    double coarse = 0.0, fine = 0.0, work = 0.0;
    int paths = 0;
    for (int k = 0; k < 60; ++k) {
      const LawPoint<L> start = random_point<L>(example, P, random);
      // there and back: loading, unloading, reversal
      const Sym<double, 6> strain = random.tensor(example.strain);
      const auto missing = [&](int n, bool& parted) {
        Account<L> account{P, start, {}, {}};
        account.steps(n, strain, 40 * example.time);
        account.steps(n, -1.5 * strain, 40 * example.time);
        parted = account.parted;
        work += std::abs(account.sum.work);
        return std::abs(account.sum.missing());
      };
      bool parted_coarse = false, parted_fine = false;
      const double a = missing(200, parted_coarse), b = missing(400, parted_fine);
      if (parted_coarse || parted_fine) continue;
      coarse += a;
      fine += b;
      ++paths;
    }
    ASSERT_GT(paths, 10) << example.label;
    EXPECT_LT(fine, coarse / 3.0 + 1e-13 * work) << example.label;
    EXPECT_LT(fine, 1e-3 * work) << example.label;
  }
}

// ηγ̇² per volume and second
TEST(StepWork, OfAFluid) {
  using L = Newtonian<Tension::cut_off>;
  const double eta = 3.0, rate = 7.0, dt = 1e-3;
  auto account = at_rest<L>(
      {"newtonian", {}, {{"eta", eta}, {"K", 2e4}, {"alpha", 7.0}, {"rho_0", 1e3}}}, 50.0);
  account.step(shear(rate * dt), dt);
  EXPECT_NEAR(account.last.viscous, 0.5 * eta * rate * rate * dt, 1e-15 * eta * rate * rate)
      << "it starts from rest";
  account.step(shear(rate * dt), dt);
  EXPECT_NEAR(account.last.viscous, eta * rate * rate * dt, 1e-15 * eta * rate * rate);
  EXPECT_EQ(account.last.plastic, 0.0);
  EXPECT_EQ(account.last.hypoelastic, 0.0);
}

const LawSpec grains{"mu_i",
                     {},
                     {{"mu_0", 0.38},
                      {"mu_d", 0.57},
                      {"I_0", 0.28},
                      {"d", 0.005},
                      {"rho_p", 2000.0},
                      {"rho_0", 1300.0},
                      {"K", 25e4}}};
constexpr double p_grains = 1e3;
/// μ(I)p
double flow_stress(double rate) {
  const double I = rate * 0.005 * std::sqrt(2000.0 / p_grains);
  return (0.38 + (0.57 - 0.38) * I / (0.28 + I)) * p_grains;
}

// μ(I)pγ̇: of a viscosity, viscous; 1e-8: (r/γ̇)² of the regularisation
TEST(StepWork, OfGrainsThatAreAViscosity) {
  LawSpec spec = grains;
  spec.options["form"] = "regularised";
  auto account = at_rest<MuIRegularised>(spec, p_grains);
  const double rate = 10.0, dt = 1e-4;
  account.steps(2, shear(2.0 * rate * dt), 2.0 * dt);
  const double expected = flow_stress(rate) * rate * dt;
  EXPECT_NEAR(account.last.viscous, expected, 1e-8 * expected);
  EXPECT_EQ(account.last.plastic, 0.0);
}

// of a return, plastic. τ tends to μ(I)p over a strain of p/G = 1e-3.
TEST(StepWork, OfGrainsThatYield) {
  auto account = at_rest<MuIElastoviscoplastic>(grains, p_grains);
  const double rate = 10.0, dt = 1e-4, G = 1e6;
  const double mu_0_strain = 0.38 * p_grains / G;
  account.step(shear(0.9 * mu_0_strain), dt);
  EXPECT_EQ(account.last.plastic, 0.0);
  account.steps(400, shear(400 * rate * dt), 400 * dt);
  const double expected = flow_stress(rate) * rate * dt;
  EXPECT_NEAR(account.last.plastic, expected, 1e-9 * expected);
  EXPECT_EQ(account.last.viscous, 0.0);
  // Turned round, the mean of the two stresses is zero while the strain is 2τ/G and a flow of γ̇Δt:
  // nothing is lost over a step that ends at the opposite stress.
  const double tau = flow_stress(rate);
  account.step(shear(-2.0 * tau / G - rate * dt), dt);
  EXPECT_NEAR(account.last.plastic, 0.0, 1e-9 * expected);
}

// Where pressure goes, so does the shear stress that it held: τ²/2G slips away, and what the mean
// stress does over the step's own shear.
TEST(StepWork, OfGrainsThatPart) {
  const double tau = 300.0, G = 1e6, gamma = 1e-5;
  InitialConditions given;
  given.sigma = {p_grains, p_grains, p_grains, -tau, 0.0, 0.0};  // compression positive
  auto account = at_rest<MuIElastoviscoplastic>(grains, given);
  Sym<double, 6> strain = shear(gamma);
  for (int k = 0; k < 3; ++k) strain[k] = 0.01;
  account.step(strain, 1e-4);
  EXPECT_EQ(largest(account.point.stress), 0.0);
  const double expected = tau * tau / (2.0 * G) + 0.5 * tau * gamma;
  EXPECT_NEAR(account.last.plastic, expected, 1e-13 * expected);
}

LawSpec clay(const char* compression) {
  return {"modified_cam_clay",
          {{"compression", compression}},
          {{"M", 0.9},
           {"lambda", 0.16},
           {"kappa", 0.06},
           {"nu", 0.3},
           {"rho_p", 2650.0},
           {"Gamma", 2.76}}};
}
constexpr double kappa = 0.06, lambda = 0.16, grains_of_clay = 2650.0;
const double alpha = 1.5 * (1.0 - 2.0 * 0.3) / (1.0 + 0.3);

// Isotropic compression on the line from p_0 to 2p_0. v – ln p: dv = −λ d ln p, of which κ is
// elastic, and p dv/ρ_p: λ − κ and κ times Δp/ρ_p. ln v – ln p: ρ = ρ_0 (p/p_0)^λ, and
// ∫(λ − κ)dp/ρ = (λ − κ)p_0/(ρ_0(1 − λ))[2^{1−λ} − 1]; the plastic change of volume carries
// ψ = κp/(1 − κ) along. The mean of two pressures errs by (Δ ln p)²/12 = 4e-8.
TEST(StepWork, OfClayUnderPressure) {
  const double p = 1e5;
  const int n = 1000;
  const auto compressed = [&]<class L>(Account<L> account, double strain) {
    account.steps(n, Sym<double, 6>::isotropic(-strain / 3.0), 1.0);
    return account;
  };
  {
    auto account = at_rest<ModifiedCamClay<Compression::v_ln_p>>(clay("v-ln_p"), p, 1.0);
    const double v = grains_of_clay / account.point.density;
    account = compressed(account, -std::log1p(-lambda * std::log(2.0) / v));
    ASSERT_NEAR(pressure(account.point.stress), 2.0 * p, 1e-9 * p);
    const double per_mass = p / grains_of_clay;
    EXPECT_NEAR(account.sum.plastic, (lambda - kappa) * per_mass, 1e-7 * per_mass);
    EXPECT_NEAR(account.sum.stored, kappa * per_mass, 1e-12 * per_mass);
    EXPECT_EQ(account.sum.viscous, 0.0);
    EXPECT_NEAR(account.sum.hypoelastic, 0.0, 1e-12 * per_mass);
  }
  {
    auto account = at_rest<ModifiedCamClay<Compression::ln_v_ln_p>>(clay("ln_v-ln_p"), p, 1.0);
    const double per_mass =
        p / account.point.density * (std::pow(2.0, 1.0 - lambda) - 1.0) / (1.0 - lambda);
    account = compressed(account, lambda * std::log(2.0));
    ASSERT_NEAR(pressure(account.point.stress), 2.0 * p, 1e-9 * p);
    EXPECT_NEAR(account.sum.plastic, (lambda - kappa) * per_mass, 1e-7 * per_mass);
    EXPECT_NEAR(account.sum.hypoelastic, kappa / (1.0 - kappa) * (lambda - kappa) * per_mass,
                1e-7 * per_mass);
    EXPECT_EQ(account.sum.viscous, 0.0);
  }
}

// At critical state all work is plastic: Mp/√3 per shear strain.
TEST(StepWork, OfClayAtCriticalState) {
  auto account = at_rest<ModifiedCamClay<Compression::v_ln_p>>(clay("v-ln_p"), 1e5, 2.0);
  account.steps(2000, shear(2.0), 1.0);
  const double tau = 0.9 * pressure(account.point.stress) / std::sqrt(3.0);
  const double expected = tau * 1e-3;
  EXPECT_NEAR(account.last.plastic, expected, 1e-9 * expected);
  EXPECT_NEAR(account.last.hypoelastic, 0.0, 1e-9 * expected);
}

// An elastic cycle: pressed from p_1 to p_2, sheared to q, unloaded to p_1 with q kept, sheared
// back. G follows p, so that what shearing back returns, q²/6G_1, exceeds what it took: ∫q²/6G d ln
// p = (κq²/6α)(1/p_2 − 1/p_1) per volume of grains is made of nothing. Stored energy is as before;
// the steps' own volumes (their mean logarithmic and geometric) differ by (Δε_v)² = 1e-8.
TEST(StepWork, OfClayInAnElasticCycle) {
  auto account = at_rest<ModifiedCamClay<Compression::v_ln_p>>(clay("v-ln_p"), 1e5, 20.0);
  const double p_1 = 1e5, p_2 = 2e5;
  const double v_1 = grains_of_clay / account.point.density;
  const double strain_v = -std::log1p(-kappa * std::log(2.0) / v_1);
  const Sym<double, 6> press = Sym<double, 6>::isotropic(-strain_v / 3.0);
  account.steps(200, press, 1.0);
  ASSERT_NEAR(pressure(account.point.stress), p_2, 1e-9 * p_2);
  const double gamma = 5e-3;
  account.steps(200, shear(gamma), 1.0);
  const double q = mises(account.point.stress);
  account.steps(200, -1.0 * press, 1.0);
  ASSERT_NEAR(mises(account.point.stress), q, 1e-12 * q);
  const double v_2 = v_1 - kappa * std::log(p_2 / p_1);
  account.steps(200, shear(-gamma * p_2 * v_2 / (p_1 * v_1)), 1.0);  // G = αpv/κ
  ASSERT_NEAR(mises(account.point.stress), 0.0, 1e-9 * q);
  const double made = kappa * q * q / (6.0 * alpha) * (1.0 / p_2 - 1.0 / p_1) / grains_of_clay;
  EXPECT_NEAR(account.sum.hypoelastic, made, 1e-6 * std::abs(made));
  EXPECT_NEAR(account.sum.work, made, 1e-4 * std::abs(made));
  EXPECT_EQ(account.sum.plastic, 0.0);
}

// A step that opens a gap in a fluid of p = K(ρ/ρ_0 − 1): from p_n = Kx over a volume strain of 4x,
// of which ln(1 + x) is contact. The mean pressure over all of it, ½p_n 4x, is the motion's; ½p_n
// of the gap comes from nowhere. Back again it is lost. What the contact returns, ½p_n ln(1 + x),
// is the stored energy K(r ln r − r + 1)/r to third order: x of it.
TEST(StepWork, OfAGap) {
  const double K = 2e4, x = 1e-3;
  auto account = at_rest<Newtonian<Tension::cut_off>>(
      {"newtonian", {}, {{"eta", 0.0}, {"K", K}, {"alpha", 1.0}, {"rho_0", 1e3}}}, K * x);
  const double stored = account.stored_per_mass() * 1e3;
  const double gap = 4.0 * x - std::log1p(x), made = 0.5 * K * x * gap;
  account.step(Sym<double, 6>::isotropic(4.0 * x / 3.0), 1.0);
  EXPECT_EQ(pressure(account.point.stress), 0.0);
  EXPECT_NEAR(account.last.separation, -made, x * x * made) << "(3x)²/12: of the logarithm";
  EXPECT_NEAR(account.sum.missing() * 1e3, 0.0, 2.0 * x * stored + 4.0 * x * made);
  account.step(Sym<double, 6>::isotropic(-4.0 * x / 3.0), 1.0);
  EXPECT_NEAR(account.last.separation, made, x * x * made);
  EXPECT_NEAR(account.sum.separation, 0.0, 1e-9 * made);
}

// Clay that parts within a step and touches again within the next. Pulled by ten swelling strains
// it drops nearly nothing, κp_sep: what it had stored is in the work, as far as the mean of p_n and
// 0 is that of an exponential. Here against quarter steps, in which that error is a sixteenth:
// nothing is missing but the error, and to see it more clearly there is no shear and no yield.
TEST(StepWork, OfClayThatPartsAndTouches) {
  using L = ModifiedCamClay<Compression::v_ln_p>;
  const auto missing = [](int n) {
    auto account = at_rest<L>(clay("v-ln_p"), 1.0, 20.0);  // p_sep = 0.01 Pa
    const double v = grains_of_clay / account.point.density;
    // down the swelling line to p = 0.04 Pa, in small steps; over the edge in n; and back
    const double fall = kappa * std::log(25.0) / v, edge = kappa * std::log(16.0) / v;
    account.steps(400, Sym<double, 6>::isotropic(fall / 3.0), 1.0);
    account.steps(n, Sym<double, 6>::isotropic(edge / 3.0), 1.0);
    EXPECT_TRUE(account.point.apart());
    account.steps(n, Sym<double, 6>::isotropic(-edge / 3.0), 1.0);
    EXPECT_FALSE(account.point.apart());
    account.steps(400, Sym<double, 6>::isotropic(-fall / 3.0), 1.0);
    EXPECT_NEAR(pressure(account.point.stress), 1.0, 1e-9);
    EXPECT_NEAR(account.sum.stored, 0.0, 1e-9 * kappa / grains_of_clay);
    EXPECT_EQ(account.sum.plastic, 0.0);
    return std::abs(account.sum.missing()) / (kappa * 0.04 / grains_of_clay);
  };
  // x = ln 16/n: the mean of two pressures errs by x²/12 of κΔp
  EXPECT_LT(missing(8), 2.0 * std::pow(std::log(16.0) / 8.0, 2) / 12.0);
  EXPECT_LT(missing(32), 2.0 * std::pow(std::log(16.0) / 32.0, 2) / 12.0);
}

TEST(StepWork, OfASolidIsAllStored) {
  auto account =
      at_rest<NeoHookean>({"neo_hookean", {}, {{"E", 1e6}, {"nu", 0.3}, {"rho_0", 1000.0}}}, 1e3);
  account.steps(100, shear(0.3), 1.0);
  EXPECT_EQ(account.sum.plastic + account.sum.viscous + account.sum.hypoelastic, 0.0);
  EXPECT_NEAR(account.sum.stored, account.sum.work, 1e-4 * account.sum.work);
}

}  // namespace
}  // namespace repose

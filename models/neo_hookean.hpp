#pragma once
/// \file
/// Compressible neo-Hookean elasticity (physics.md, NH): σ = (λ ln J/J) I + (μ/J)(b − I), b = FFᵀ,
/// from the energy λ/2 ln²J + μ/2 (tr b − 3 − 2 ln J) per reference volume (Simo & Pister 1984).
///
/// No state: J = ρ_0/ρ, and b follows from σ and J. Over a step of constant D the deformation is
/// b ← e^{Δε} b e^{Δε}, taken exactly (the rotation of the step is done outside), so that a path of
/// straight steps has no error of its own. A step of more than 2 in a component of Δε is refused.

#include "models/law.hpp"
#include "models/scalar.hpp"

namespace repose {

struct NeoHookean {
  static constexpr std::string_view name = "neo_hookean";
  static constexpr std::string_view option_key = "";
  static constexpr std::string_view option = "";
  static constexpr std::string_view doc =
      "compressible hyperelastic solid, for verification: it has exact large-deformation solutions";
  static constexpr bool has_stress_memory = true;
  static constexpr bool iterates = false;

  static constexpr std::array<ParamInfo, 3> parameters{{
      {"E", "E", "Pa", "Young's modulus at small strain", Need::required, 0.0, positive,
       Scale::log},
      {"nu", "ν", "-", "Poisson's ratio at small strain", Need::required, 0.0,
       Range{0.0, 0.5, false, true}, Scale::linear},
      {"rho_0", "ρ_0", "kg/m³", "density of the unstrained solid", Need::required, 0.0, positive,
       Scale::log},
  }};
  static constexpr std::array<StateField, 0> state{};

  template <class T>
  struct Params {
    T E, nu, rho_0;
    static Params from(std::span<const T> t) { return {t[0], t[1], t[2]}; }
    /// Lamé's
    T mu() const { return T(0.5) * E / (T(1.0) + nu); }
    T lambda() const { return E / (T(1.0) + nu) * nu / (T(1.0) - T(2.0) * nu); }
  };
  template <class T>
  using State = std::array<T, 0>;

  static void complete(std::vector<double>&) {}

  /// σ₁ = e^{−tr Δε} σ₀ + (1/J₁)[λ tr Δε I + μ(b₁ − b₀)], which leaves a resting point alone to the
  /// last bit; b₁ − b₀ = Eb₀ + b₀E + Eb₀E, E = e^{Δε} − I. All work is stored.
  template <class T, int N>
  static Mask<T> update(const Params<T>& P, const Increment<T, N>& inc, Sym<T, N>& stress,
                        State<T>&, StepWork<T>* = nullptr) {
    const T tr = trace(inc.strain);
    const T J = P.rho_0 / inc.density;
    const T J_before = J * exp_pair(T(-tr)).whole;
    const Sym<T, N> b = left_cauchy_green(P, stress, J_before);
    const Sym<T, N> E = exponential_less_one(inc.strain);
    const T inv_J = T(1.0) / J;
    const Sym<T, N> next =
        exp_pair(T(-tr)).whole * stress +
        inv_J * (Sym<T, N>::isotropic(P.lambda() * tr) + P.mu() * stretched(b, E));
    auto failed = negated(finite(T(contract(next, next))) && inc.density > T(0.0));
    for (int i = 0; i < N; ++i) failed = failed || negated(square(inc.strain[i]) <= T(4.0));
    for (int i = 0; i < N; ++i) stress[i] = select(failed, stress[i], next[i]);
    return failed;
  }

  /// dσ/dt = −tr(D) σ + (1/J)[λ tr(D) I + μ(Db + bD)], without the turning of the stress.
  template <class T, int N>
  static void rate(const Params<T>& P, const Sym<T, N>& stress, const State<T>&, const T& density,
                   const Sym<T, N>& D, Branch, Sym<T, N>& stress_rate, State<T>&) {
    const T J = P.rho_0 / density;
    const Matrix<T> Db = times(full(D), full(left_cauchy_green(P, stress, J)));
    const T tr = trace(D);
    stress_rate = T(-tr) * stress + T(T(1.0) / J) * (Sym<T, N>::isotropic(P.lambda() * tr) +
                                                     T(T(2.0) * P.mu()) * symmetric<N>(Db));
  }

  /// The stored energy is a potential.
  template <class T, int N>
  static T hypoelastic_power(const Params<T>&, const Sym<T, N>&, const State<T>&, const T&,
                             const Sym<T, N>&, const Sym<T, N>&) {
    return T(0.0);
  }

  template <class T, int N>
  static T yield(const Params<T>&, const Sym<T, N>&, const State<T>&, const T&, const Sym<T, N>&) {
    return T(-std::numeric_limits<double>::infinity());
  }

  /// Of a longitudinal wave along n: Jρc² = λ(1 − ln J) + μ(1 + n·bn) = λ(1 − 2 ln J) + 2μ + J
  /// n·σn, with the largest n·σn bounded by the mean stress + √(2/3)|s|.
  template <class T, int N>
  static T modulus(const Params<T>& P, const Sym<T, N>& stress, const State<T>&, const T& density) {
    const T J = P.rho_0 / density;
    const T most = mean(stress) + T(2.0 / std::sqrt(3.0)) * shear_norm(deviator(stress));
    // μ + μ: of two products the compiler might fuse either with the sum
    const T M = (P.lambda() * (T(1.0) - T(2.0) * ln(J)) + (P.mu() + P.mu())) / J + most;
    const T shear =
        P.mu() / J;  // far enough stretched, it yields along n: no wave, but still stiff
    return select(M > shear, M, shear);
  }

  template <class T, int N>
  static T viscosity(const Params<T>&, const Sym<T, N>&, const T&, const Sym<T, N>&) {
    return T(0.0);
  }

  /// The energy per reference volume over J, with μ(tr b − 3) = J tr σ − 3λ ln J.
  template <class T, int N>
  static T stored_energy(const Params<T>& P, const Sym<T, N>& stress, const State<T>&,
                         const T& density) {
    const T J = P.rho_0 / density;
    const T ln_J = ln(J);
    const T W = T(0.5) * P.lambda() * ln_J * ln_J +
                T(0.5) * (J * trace(stress) - T(3.0) * P.lambda() * ln_J) - P.mu() * ln_J;
    return W / J;
  }

  /// ln J: all of its volume strain is elastic.
  template <class T, int N>
  static T elastic_volume_strain(const Params<T>& P, const Sym<T, N>&, const State<T>&,
                                 const T& density) {
    return ln(T(P.rho_0 / density));
  }

  static double density_at(const Params<double>& P, double p, double /*ocr*/) {
    return P.rho_0 * std::exp(-log_volume(P, Sym<double, 6>::isotropic(-p)));
  }

  /// Any stress (p and K0, or sigma) sets ρ, or a density sets an isotropic stress.
  static InitialPoint initial(const Params<double>& P, const InitialConditions& given) {
    reject_unused(name, given, false, false);
    InitialPoint point;
    if (given.density) {
      if (states_stress(given) || given.K0)
        throw InputError("density",
                         "give either density or a stress for neo_hookean: one follows from the "
                         "other");
      point.density = *given.density;
      const double J = P.rho_0 / point.density;
      point.stress = Sym<double, 6>::isotropic(
          (P.lambda() * std::log(J) + P.mu() * (std::cbrt(J * J) - 1.0)) / J);
      return point;
    }
    point.stress = initial_stress(given, 0.0);
    const double ln_J = log_volume(P, point.stress);
    if (std::isnan(ln_J))
      throw InputError(stress_key(given),
                       "no elastic deformation of neo_hookean bears this stress; it must be small "
                       "against E");
    point.density = P.rho_0 * std::exp(-ln_J);
    return point;
  }

 private:
  template <class T>
  using Matrix = std::array<std::array<T, 3>, 3>;

  template <class T, int N>
  static Matrix<T> full(const Sym<T, N>& a) {
    Matrix<T> m;
    for (std::size_t i = 0; i < 3; ++i) m[i][i] = a.c[i];
    m[0][1] = m[1][0] = a[3];
    m[1][2] = m[2][1] = N == 6 ? a.c[N - 2] : T(0.0);
    m[2][0] = m[0][2] = N == 6 ? a.c[N - 1] : T(0.0);
    return m;
  }
  template <class T>
  static Matrix<T> times(const Matrix<T>& a, const Matrix<T>& b) {
    Matrix<T> m;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        m[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    return m;
  }
  template <int N, class T>
  static Sym<T, N> symmetric(const Matrix<T>& m) {
    Sym<T, N> r;
    for (std::size_t i = 0; i < 3; ++i) r.c[i] = m[i][i];
    r[3] = T(0.5) * (m[0][1] + m[1][0]);
    if constexpr (N == 6) {
      r[4] = T(0.5) * (m[1][2] + m[2][1]);
      r[5] = T(0.5) * (m[2][0] + m[0][2]);
    }
    return r;
  }

  /// b = I + (Jσ − λ ln J I)/μ
  template <class T, int N>
  static Sym<T, N> left_cauchy_green(const Params<T>& P, const Sym<T, N>& stress, const T& J) {
    const T inv_mu = T(1.0) / P.mu();
    return T(J * inv_mu) * stress + Sym<T, N>::isotropic(T(1.0) - P.lambda() * inv_mu * ln(J));
  }

  /// (I + E) b (I + E) − b
  template <class T, int N>
  static Sym<T, N> stretched(const Sym<T, N>& b, const Sym<T, N>& E) {
    const Matrix<T> Eb = times(full(E), full(b));
    return T(2.0) * symmetric<N>(Eb) + symmetric<N>(times(Eb, full(E)));
  }

  /// ab where the two commute.
  template <class T, int N>
  static Sym<T, N> commuting_product(const Sym<T, N>& a, const Sym<T, N>& b) {
    Sym<T, N> r;
    r[0] = a[0] * b[0] + a[3] * b[3];
    r[1] = a[3] * b[3] + a[1] * b[1];
    r[2] = a[2] * b[2];
    r[3] = a[0] * b[3] + a[3] * b[1];
    if constexpr (N == 6) {
      r[0] = r[0] + a[5] * b[5];
      r[1] = r[1] + a[4] * b[4];
      r[2] = r[2] + a[4] * b[4] + a[5] * b[5];
      r[3] = r[3] + a[5] * b[4];
      r[4] = a[3] * b[5] + a[1] * b[4] + a[4] * b[2];
      r[5] = a[5] * b[0] + a[4] * b[3] + a[2] * b[5];
    }
    return r;
  }

  /// e^A − I: the Taylor series of A/8 to its 15th power, squared thrice as (I + E)² − I = 2E + E².
  /// For components of at most 2, |A/8| <= 3/4 and the next term is 0.75¹⁶/16! = 5e-16 of the sum.
  template <class T, int N>
  static Sym<T, N> exponential_less_one(const Sym<T, N>& A) {
    const Sym<T, N> eighth = T(0.125) * A;
    const Sym<T, N> I = Sym<T, N>::isotropic(T(1.0));
    Sym<T, N> sum = I;
    for (int k = 15; k >= 2; --k) sum = I + T(1.0 / k) * commuting_product(eighth, sum);
    Sym<T, N> E = commuting_product(eighth, sum);
    for (int k = 0; k < 3; ++k) E = T(2.0) * E + commuting_product(E, E);
    return E;
  }

  /// ln J of a stress: det b(σ, J) = J², by Newton's method from J = 1. NaN where that leads
  /// nowhere.
  static double log_volume(const Params<double>& P, const Sym<double, 6>& stress) {
    // f = ln det b − 2 ln J, df/d ln J = tr(b⁻¹ (Jσ − λI))/μ − 2
    double ln_J = 0.0;
    for (int k = 0; k < 50; ++k) {
      const double J = std::exp(ln_J);
      const Sym<double, 6> b = left_cauchy_green(P, stress, J);
      const double yz = b[1] * b[2] - b[4] * b[4];
      const double zx = b[0] * b[2] - b[5] * b[5];
      const double xy = b[0] * b[1] - b[3] * b[3];
      const double det =
          b[0] * yz - b[3] * (b[3] * b[2] - b[4] * b[5]) + b[5] * (b[3] * b[4] - b[1] * b[5]);
      if (!(b[0] > 0.0 && xy > 0.0 && det > 0.0)) break;  // not positive definite
      Sym<double, 6> adjugate;
      adjugate.c = {yz,
                    zx,
                    xy,
                    b[4] * b[5] - b[3] * b[2],
                    b[3] * b[5] - b[0] * b[4],
                    b[3] * b[4] - b[1] * b[5]};
      const Sym<double, 6> change = J * stress - Sym<double, 6>::isotropic(P.lambda());
      const double slope = contract(adjugate, change) / (det * P.mu()) - 2.0;
      const double step = (std::log(det) - 2.0 * ln_J) / slope;
      ln_J -= step;
      if (std::abs(step) < 1e-14) return ln_J;  // quadratic: the next would be round-off
    }
    return std::numeric_limits<double>::quiet_NaN();
  }
};

static_assert(ConstitutiveLaw<NeoHookean>);

}  // namespace repose

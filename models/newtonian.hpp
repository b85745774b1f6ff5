#pragma once
/// \file
/// Weakly compressible Newtonian fluid (physics.md, NEW): σ = −pI + 2ηD′, p = K[(ρ/ρ0)^α − 1].

#include "models/contact.hpp"
#include "models/law.hpp"
#include "models/scalar.hpp"

namespace repose {

enum class Tension : std::uint8_t { cut_off, carried };

template <Tension tension>
struct Newtonian {
  static constexpr std::string_view name = "newtonian";
  static constexpr std::string_view option_key = "tension_cutoff";
  static constexpr std::string_view option = tension == Tension::cut_off ? "true" : "false";
  static constexpr std::string_view doc =
      tension == Tension::cut_off
          ? "weakly compressible viscous fluid with a free surface (p >= 0)"
          : "weakly compressible viscous fluid that carries negative pressure";
  static constexpr bool has_stress_memory = false;
  static constexpr bool iterates = false;

  static constexpr std::array<ParamInfo, 4> parameters{{
      {"eta", "η", "Pa s", "shear viscosity", Need::required, 0.0, not_negative, Scale::log},
      {"K", "K", "Pa", "pressure scale; the bulk modulus is αK", Need::required, 0.0, positive,
       Scale::log},
      {"alpha", "α", "-", "exponent of the equation of state (water: 7)", Need::defaulted, 7.0,
       Range{1.0, 20.0, false, false}, Scale::linear},
      {"rho_0", "ρ_0", "kg/m³", "density at p = 0", Need::required, 0.0, positive, Scale::log},
  }};
  static constexpr std::array<StateField, 0> state{};

  template <class T>
  struct Params {
    T eta, K, alpha, rho_0;
    static Params from(std::span<const T> t) { return {t[0], t[1], t[2], t[3]}; }
  };
  template <class T>
  using State = std::array<T, 0>;

  static void complete(std::vector<double>&) {}

  /// p = K[(ρ/ρ0)^α − 1]
  template <class T>
  static T equation_of_state(const Params<T>& P, const T& density) {
    const T p = P.K * exp_pair(T(P.alpha * ln(T(density / P.rho_0)))).minus_one;
    return tension == Tension::cut_off ? floor_at(p, 0.0) : p;
  }

  template <class T, int N>
  static Mask<T> update(const Params<T>& P, const Increment<T, N>& inc, Sym<T, N>& stress,
                        State<T>&, StepWork<T>* spent = nullptr) {
    const T p = equation_of_state(P, inc.density);
    // σ = −pI + 2ηD′ with D = Δε/Δt; a step of no duration has no viscous stress, a NaN stays one
    const T inv_dt = select(inc.dt > T(0.0), T(T(1.0) / inc.dt), T(T(0.0) * inc.dt));
    const Sym<T, N> viscous = (T(2.0) * P.eta * inv_dt) * deviator(inc.strain);
    const Sym<T, N> next = viscous - Sym<T, N>::isotropic(p);
    const auto failed = negated(finite(T(contract(next, next))) && inc.density > T(0.0));
    if (spent != nullptr) {
      // all of the deviator is viscous: ½(s_n + s_{n+1}):Δe
      spent->viscous = T(0.5) * contract(deviator(stress) + viscous, inc.strain);
      if (tension == Tension::cut_off) spent->separation = work_over_gap(P.rho_0, stress, p, inc);
    }
    for (int i = 0; i < N; ++i) stress[i] = select(failed, stress[i], next[i]);
    return failed;
  }

  /// dp/dt = −(dp/dlnρ) tr D; the viscous part follows D at once, so its rate is that of D (0
  /// here).
  template <class T, int N>
  static void rate(const Params<T>& P, const Sym<T, N>&, const State<T>&, const T& density,
                   const Sym<T, N>& D, Branch, Sym<T, N>& stress_rate, State<T>&) {
    stress_rate = Sym<T, N>::isotropic(bulk_modulus(P, density) * trace(D));
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

  /// dp/dlnρ = αK(ρ/ρ0)^α, 0 where tension is cut off
  template <class T>
  static T bulk_modulus(const Params<T>& P, const T& density) {
    const T K = P.alpha * P.K * exp_pair(T(P.alpha * ln(T(density / P.rho_0)))).whole;
    return tension == Tension::cut_off ? select(density < P.rho_0, T(0.0), K) : K;
  }

  template <class T, int N>
  static T modulus(const Params<T>& P, const Sym<T, N>&, const State<T>&, const T& density) {
    // apart from its neighbours a point keeps the wave speed it will have on contact, c(ρ0)
    const auto apart = density < P.rho_0;
    const T M = bulk_modulus(P, select(apart, P.rho_0, density));
    return select(apart, T(M * density / P.rho_0), M);
  }

  template <class T, int N>
  static T viscosity(const Params<T>& P, const Sym<T, N>&, const T&, const Sym<T, N>&) {
    return P.eta;
  }

  /// ρ ∫ p/ρ² dρ from ρ0 = K{[r^α − r]/(α − 1) − r + 1}, r = ρ/ρ0 (α = 1: K[r ln r − r + 1])
  template <class T, int N>
  static T stored_energy(const Params<T>& P, const Sym<T, N>&, const State<T>&, const T& density) {
    const T r = density / P.rho_0;
    const T ln_r = ln(r);
    // (r^α − r)/(α − 1) = r ln r · (e^{(α−1) ln r} − 1)/((α−1) ln r), regular at α = 1
    const T W = P.K * (r * ln_r * expm1_over(T((P.alpha - T(1.0)) * ln_r)) - r + T(1.0));
    return tension == Tension::cut_off ? select(density < P.rho_0, T(0.0), W) : W;
  }

  /// ln(ρ0/ρ) with p = K[(ρ/ρ0)^α − 1]; 0 where tension is cut off
  template <class T, int N>
  static T elastic_volume_strain(const Params<T>& P, const Sym<T, N>& stress, const State<T>&,
                                 const T&) {
    return -ln(T(T(1.0) + pressure(stress) / P.K)) / P.alpha;
  }

  static double density_at(const Params<double>& P, double p, double /*ocr*/) {
    return P.rho_0 * std::exp(std::log1p(p / P.K) / P.alpha);
  }

  /// p (or sigma: its mean; a fluid at rest carries no deviator) sets ρ, or density sets p.
  static InitialPoint initial(const Params<double>& P, const InitialConditions& given) {
    reject_unused(name, given, false, false);
    if (given.K0 && *given.K0 != 1.0)
      throw InputError("K0", "a fluid at rest has K0 = 1, not another value");
    InitialPoint point;
    if (given.density) {
      if (states_stress(given))
        throw InputError("density",
                         "give either density or p for newtonian: one follows from the other");
      point.density = *given.density;
      point.stress = Sym<double, 6>::isotropic(-equation_of_state(P, point.density));
      return point;
    }
    const Sym<double, 6> stress = initial_stress(given, 0.0);
    if (mises(stress) > 1e-12 * std::abs(pressure(stress)))
      throw InputError("sigma", "a fluid at rest carries no shear stress: sigma must be isotropic");
    const double p = pressure(stress);
    if (p <= -P.K || (tension == Tension::cut_off && p < 0.0))
      throw InputError(stress_key(given),
                       "p must be >= 0 for newtonian with tension_cutoff, > -K without");
    point.density = density_at(P, p, 1.0);
    // the pressure of that density, so that the point is at rest to the last bit
    point.stress = Sym<double, 6>::isotropic(-equation_of_state(P, point.density));
    return point;
  }
};

static_assert(ConstitutiveLaw<Newtonian<Tension::cut_off>>);
static_assert(ConstitutiveLaw<Newtonian<Tension::carried>>);

}  // namespace repose

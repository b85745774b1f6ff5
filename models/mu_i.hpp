#pragma once
/// \file
/// Weakly compressible μ(I) rheology (physics.md, MUI), in two forms of the same flow curve:
///   MuIElastoviscoplastic  exact arrest, no regularisation (after Dunatunga & Kamrin 2015)
///   MuIRegularised         a viscosity, finite at rest through r (the published formulation)
/// mu_i_barker_gray.hpp has a third form, with another curve.
/// I = γ̇ d √(ρ_p/p), μ(I) = μ_0 + (μ_d − μ_0)/(I_0/I + 1), γ̇ = √(2D′:D′), τ = μ(I)p.

#include "models/cone.hpp"
#include "models/contact.hpp"
#include "models/law.hpp"
#include "models/scalar.hpp"

namespace repose {

/// What the two forms share: the pressure and the flow curve.
namespace mu_i {

inline constexpr ParamInfo mu_0{
    "mu_0", "μ_0",    "-",           "friction coefficient at rest",    Need::required,
    0.0,    positive, Scale::linear, {"phi_0", cone::friction_of_angle}};
inline constexpr ParamInfo mu_d{"mu_d",
                                "μ_d",
                                "-",
                                "friction coefficient at high inertial number",
                                Need::required,
                                0.0,
                                positive,
                                Scale::linear,
                                {"phi_d", cone::friction_of_angle}};
inline constexpr ParamInfo I_0{
    "I_0",          "I_0", "-",      "inertial number half way between μ_0 and μ_d",
    Need::required, 0.0,   positive, Scale::log};
inline constexpr ParamInfo d{"d", "d",      "m",       "grain diameter", Need::required,
                             0.0, positive, Scale::log};
inline constexpr ParamInfo rho_p{"rho_p",        "ρ_p", "kg/m³",  "density of the grains",
                                 Need::required, 0.0,   positive, Scale::log};
inline constexpr ParamInfo rho_0{"rho_0",        "ρ_0", "kg/m³",  "bulk density at p = 0",
                                 Need::required, 0.0,   positive, Scale::log};
inline constexpr ParamInfo K{"K", "K",      "Pa",      "bulk modulus", Need::required,
                             0.0, positive, Scale::log};

template <class P, class T>
T pressure_of(const P& par, const T& density) {
  return floor_at(T(par.K / par.rho_0 * (density - par.rho_0)), 0.0);  // MUI-1, no tension
}

/// q/p of friction at rest in triaxial compression
template <class P>
auto slope(const P& par) {
  using T = std::decay_t<decltype(par.mu_0)>;
  return T(T(std::sqrt(3.0)) * par.mu_0);
}

/// g of a direction of shear, what it has of the friction in triaxial compression         CONE-1
template <class P, class T, int N>
T share(const P& par, const Sym<T, N>& s) {
  return cone::share(par.shape, slope(par), s);
}
/// The same in simple shear.
template <class P>
auto shear_share(const P& par) {
  return cone::shear_share(par.shape, slope(par));
}

/// MUI-2, written so that I = 0 needs no special case.
template <class P, class T>
T friction(const P& par, const T& I) {
  return par.mu_0 + (par.mu_d - par.mu_0) * I / (par.I_0 + I);
}

/// I of MUI-2.
template <class P, class T>
T inertial_number(const P& par, const T& p, const T& gamma_dot) {
  using std::sqrt;
  return gamma_dot * par.d * sqrt(T(par.rho_p / p));
}

/// ρ ∫ p/ρ² dρ from ρ0 = K(r ln r − r + 1), r = ρ/ρ0
template <class P, class T>
T compression_energy(const P& par, const T& density) {
  const T r = density / par.rho_0;
  return select(r < T(1.0), T(0.0), T(par.K * (r * ln(r) - r + T(1.0))));
}

/// −∫dp/K with K = K_0 + p of MUI-1 (K_0: at p = 0): ln(ρ0/ρ) in contact, 0 for a loose point.
template <class P, class T>
T elastic_volume_strain(const P& par, const T& p) {
  return -ln(T(T(1.0) + p / par.K));
}

template <class P>
double density_at(const P& par, double p) {
  return par.rho_0 * (1.0 + p / par.K);
}

inline void check(double mu_0_value, double mu_d_value, double shape) {
  cone::check(shape, mu_0_value);
  if (mu_d_value < mu_0_value)
    throw InputError("mu_d", "mu_d must be >= mu_0: friction grows with the inertial number");
}

/// The density of a rest state and its stress; the caller checks the deviator.
template <class P>
InitialPoint rest_state(const P& par, const InitialConditions& given) {
  reject_unused("mu_i", given, false, false);
  InitialPoint point;
  if (given.density) {
    if (states_stress(given))
      throw InputError("density", "give either density or p for mu_i: one follows from the other");
    InitialConditions derived = given;
    derived.p = pressure_of(par, *given.density);
    derived.density.reset();
    point.stress = initial_stress(derived, 0.0);
    point.density = *given.density;
    return point;
  }
  point.stress = initial_stress(given, 0.0);
  const double p = pressure(point.stress);
  if (p < 0.0) throw InputError(stress_key(given), "p must be >= 0 Pa: grains carry no tension");
  point.density = density_at(par, p);
  // the pressure is a function of density: take the rounding of ρ into the stress, so that the
  // point is at rest to the last bit
  point.stress =
      deviator(point.stress) - Sym<double, 6>::isotropic(pressure_of(par, point.density));
  return point;
}

}  // namespace mu_i

struct MuIElastoviscoplastic {
  static constexpr std::string_view name = "mu_i";
  static constexpr std::string_view option_key = "form";
  static constexpr std::string_view option = "elastoviscoplastic";
  static constexpr std::string_view doc =
      "weakly compressible mu(I), elastic below yield: exact arrest, no regularisation";
  static constexpr bool has_stress_memory = true;
  static constexpr bool iterates = false;

  static constexpr std::array<ParamInfo, 9> parameters{
      {mu_i::mu_0,
       mu_i::mu_d,
       mu_i::I_0,
       mu_i::d,
       mu_i::rho_p,
       mu_i::rho_0,
       mu_i::K,
       {"G", "G", "Pa",
        "numerical shear modulus (default 4K, from where on results stop depending on it)",
        Need::optional, 0.0, positive, Scale::log},
       cone::shape}};
  static constexpr std::array<StateField, 0> state{};

  template <class T>
  struct Params {
    T mu_0, mu_d, I_0, d, rho_p, rho_0, K, G, shape;
    static Params from(std::span<const T> t) {
      return {t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7], t[8]};
    }
  };
  template <class T>
  using State = std::array<T, 0>;

  static void complete(std::vector<double>& t) {
    mu_i::check(t[0], t[1], t[8]);
    if (std::isnan(t[7])) t[7] = 4.0 * t[6];
  }

  template <class T, int N>
  static Mask<T> update(const Params<T>& P, const Increment<T, N>& inc, Sym<T, N>& stress,
                        State<T>&, StepWork<T>* spent = nullptr) {
    using std::sqrt;
    const T p = mu_i::pressure_of(P, inc.density);
    const Sym<T, N> s_n = deviator(stress);
    const Sym<T, N> s_trial = s_n + (T(2.0) * P.G) * deviator(inc.strain);
    const T tau_trial = shear_norm(s_trial);
    // MUI-4: (τ_tr − τ)(S_2 − τ) = α(τ − S_0), its smaller root without cancellation;
    // B² − 4H = (τ_tr − S_2 + α)² + 4α(S_2 − S_0)
    T S_0 = P.mu_0 * p;
    T S_2 = P.mu_d * p;
    if (!cone::is_circle(P.shape)) {  // s keeps the direction of the trial state
      const T g = mu_i::share(P, s_trial);
      S_0 = S_0 * g;
      S_2 = S_2 * g;
    }
    const T alpha = P.G * inc.dt * (P.I_0 / P.d) * root(T(p * (T(1.0) / P.rho_p)));
    const T B = S_2 + tau_trial + alpha;
    const T H = S_2 * tau_trial + S_0 * alpha;
    const T two_H_over_tau =
        B + root(T(square(T(tau_trial - S_2 + alpha)) + T(4.0) * alpha * (S_2 - S_0)));
    const auto elastic = tau_trial <= S_0;
    // τ/τ_tr = 2H/((B + √…) τ_tr)
    const T ratio = select(elastic, T(1.0),
                           T(T(2.0) * H / select(elastic, T(1.0), T(two_H_over_tau * tau_trial))));
    const Sym<T, N> next = ratio * s_trial - Sym<T, N>::isotropic(p);
    const auto failed = negated(finite(T(contract(next, next))) && inc.density > T(0.0));
    if (spent != nullptr) {
      // Δe^p = (γ̇_pΔt/2τ_tr) s_tr with Gγ̇_pΔt = τ_tr − τ, along the return; s_{n+1} = (τ/τ_tr) s_tr
      const T quarter = T(0.25) / P.G;
      const T turned = contract(s_n, s_trial);
      spent->plastic = quarter * (T(1.0) - ratio) * (turned + ratio * (T(2.0) * square(tau_trial)));
      // |s|²/4G is energy per volume, and the volume changes: ψ_s dε_v, though nothing works. For
      // the mean of |s|² over the step s_n:s_{n+1}.
      spent->hypoelastic = -quarter * ratio * turned * trace(inc.strain);
      spent->separation = work_over_gap(P.rho_0, stress, p, inc);
    }
    for (int i = 0; i < N; ++i) stress[i] = select(failed, stress[i], next[i]);
    return failed;
  }

  /// dp/dt = −K(ρ/ρ0) tr D;  ds/dt = 2G(D′ − γ̇_p s/(2τ)) with τ = μ(I(γ̇_p))p turned round:
  /// γ̇_p = (I_0/d)√(p/ρ_p)(τ − S_0)/(S_2 − τ). Where μ_d = μ_0 the law does not depend on the rate,
  /// and consistency with τ = μ_0 g p gives γ̇_p = s:D′/τ − μ_0(gṗ + pġ)/G, where g is that of
  /// CONE-1.
  template <class T, int N>
  static void rate(const Params<T>& P, const Sym<T, N>& stress, const State<T>&, const T& density,
                   const Sym<T, N>& D, Branch branch, Sym<T, N>& stress_rate, State<T>&) {
    const T p = mu_i::pressure_of(P, density);
    const T K_now = select(density < P.rho_0, T(0.0), T(P.K * density / P.rho_0));
    const Sym<T, N> s = deviator(stress);
    const Sym<T, N> elastic = (T(2.0) * P.G) * deviator(D);
    stress_rate = elastic + Sym<T, N>::isotropic(K_now * trace(D));
    if (branch == Branch::elastic) return;
    const T tau = shear_norm(s);
    const auto sheared = tau > T(0.0);  // without shear stress nothing flows, also at p = 0
    const T divisor = select(sheared, tau, T(1.0));
    const auto rate_dependent = P.mu_d > P.mu_0;
    const T g = mu_i::share(P, s);
    const T room = select(rate_dependent, T(P.mu_d * g * p - tau), T(1.0));
    const T viscous = (P.I_0 / P.d) * root(T(p / P.rho_p)) * (tau - P.mu_0 * g * p) / room;
    T plastic = contract(s, deviator(D)) / divisor + P.mu_0 * g * K_now * trace(D) / P.G;
    if (!cone::is_circle(P.shape))
      plastic =
          plastic - P.mu_0 * g * p / P.G * cone::share_rate(P.shape, mu_i::slope(P), s, elastic);
    const T gamma_dot_p = select(rate_dependent, viscous, plastic);
    stress_rate = stress_rate - select(sheared, T(P.G * gamma_dot_p / divisor), T(0.0)) * s;
  }

  /// τ²/2G is energy per volume, and the volume changes: ψ_s dε_v, though nothing works.
  template <class T, int N>
  static T hypoelastic_power(const Params<T>& P, const Sym<T, N>& stress, const State<T>&, const T&,
                             const Sym<T, N>& D, const Sym<T, N>&) {
    const Sym<T, N> s = deviator(stress);
    return contract(s, s) / (T(-4.0) * P.G) * trace(D);
  }

  /// τ of steady shear under p > 0: what it flows at, however it got there              MUI-5
  template <class T>
  static T steady_shear_stress(const Params<T>& P, const T& p, const T& gamma_dot) {
    return mu_i::friction(P, mu_i::inertial_number(P, p, gamma_dot)) * mu_i::shear_share(P) * p;
  }

  /// τ − μ_0 p
  template <class T, int N>
  static T yield(const Params<T>& P, const Sym<T, N>& stress, const State<T>&, const T&,
                 const Sym<T, N>&) {
    const Sym<T, N> s = deviator(stress);
    return shear_norm(s) - P.mu_0 * mu_i::share(P, s) * pressure(stress);
  }

  template <class T, int N>
  static T modulus(const Params<T>& P, const Sym<T, N>&, const State<T>&, const T& density) {
    // apart from its neighbours a point keeps the wave speed it will have on contact, c(ρ0)
    const T r = density * (T(1.0) / P.rho_0);
    const T shear = T(4.0 / 3.0) * P.G;
    return P.K * r + select(r < T(1.0), T(shear * r), shear);
  }

  /// The stress is capped by μ_d p whatever the step: no viscous limit.
  template <class T, int N>
  static T viscosity(const Params<T>&, const Sym<T, N>&, const T&, const Sym<T, N>&) {
    return T(0.0);
  }

  template <class T, int N>
  static T stored_energy(const Params<T>& P, const Sym<T, N>& stress, const State<T>&,
                         const T& density) {
    const Sym<T, N> s = deviator(stress);
    return mu_i::compression_energy(P, density) + contract(s, s) / (T(4.0) * P.G);
  }

  template <class T, int N>
  static T elastic_volume_strain(const Params<T>& P, const Sym<T, N>& stress, const State<T>&,
                                 const T&) {
    return mu_i::elastic_volume_strain(P, pressure(stress));
  }

  static double density_at(const Params<double>& P, double p, double /*ocr*/) {
    return mu_i::density_at(P, p);
  }

  /// p, sigma or density (and K0 with p or density); the deviator must lie within the yield
  /// surface.
  static InitialPoint initial(const Params<double>& P, const InitialConditions& given) {
    const InitialPoint point = mu_i::rest_state(P, given);
    const Sym<double, 6> s = deviator(point.stress);
    const double limit = P.mu_0 * mu_i::share(P, s) * pressure(point.stress);
    if (shear_norm(s) > limit * (1.0 + 1e-12))
      throw InputError(
          given.sigma ? "sigma" : "K0",
          "the initial stress is beyond yield: tau/p must be <= mu_0 at rest" +
              std::string(cone::is_circle(P.shape) ? "" : ", in its direction of shear"));
    return point;
  }

 private:
  /// √x whose derivative at 0 is taken as 0 (a Dual would otherwise become NaN at p = 0).
  template <class T>
  static T root(const T& x) {
    using std::sqrt;
    if constexpr (ScalarTraits<T>::is_dual) {
      if (value(x) == 0.0) return T(0.0);
    }
    return sqrt(x);
  }
};

namespace mu_i {

inline constexpr ParamInfo r{"r",  "r",      "1/s",     "regularising shear rate", Need::defaulted,
                             1e-4, positive, Scale::log};

/// What the forms share whose shear stress is a viscosity's, s = 2ηD′: all but η(p, γ̇) itself,
/// which is Law::effective_viscosity() in triaxial compression; elsewhere it is less by the share
/// of D′.
template <class Law>
struct Viscous {
  template <class T>
  using State = std::array<T, 0>;
  static constexpr bool has_stress_memory = false;
  static constexpr bool iterates = false;
  static constexpr std::array<StateField, 0> state{};

  /// τ of steady shear under p > 0.
  template <class Par, class T>
  static T steady_shear_stress(const Par& P, const T& p, const T& gamma_dot) {
    return Law::effective_viscosity(P, p, gamma_dot) * mu_i::shear_share(P) * gamma_dot;
  }

  template <class Par, class T, int N>
  static Mask<T> update(const Par& P, const Increment<T, N>& inc, Sym<T, N>& stress, State<T>&,
                        StepWork<T>* spent = nullptr) {
    const T p = mu_i::pressure_of(P, inc.density);
    // a step of no duration has no viscous stress; a NaN stays one
    const T inv_dt = select(inc.dt > T(0.0), T(T(1.0) / inc.dt), T(T(0.0) * inc.dt));
    const Sym<T, N> D_dev = inv_dt * deviator(inc.strain);
    const T eta =
        Law::effective_viscosity(P, p, T(T(2.0) * shear_norm(D_dev))) * mu_i::share(P, D_dev);
    const Sym<T, N> viscous = (T(2.0) * eta) * D_dev;
    const Sym<T, N> next = viscous - Sym<T, N>::isotropic(p);
    const auto failed = negated(finite(T(contract(next, next))) && inc.density > T(0.0));
    if (spent != nullptr) {
      // all of the deviator is viscous: ½(s_n + s_{n+1}):Δe
      spent->viscous = T(0.5) * contract(deviator(stress) + viscous, inc.strain);
      spent->separation = work_over_gap(P.rho_0, stress, p, inc);
    }
    for (int i = 0; i < N; ++i) stress[i] = select(failed, stress[i], next[i]);
    return failed;
  }

  /// Only the pressure has a rate; the viscous stress follows D at once.
  template <class Par, class T, int N>
  static void rate(const Par& P, const Sym<T, N>&, const State<T>&, const T& density,
                   const Sym<T, N>& D, Branch, Sym<T, N>& stress_rate, State<T>&) {
    const T K_now = select(density < P.rho_0, T(0.0), T(P.K * density / P.rho_0));
    stress_rate = Sym<T, N>::isotropic(K_now * trace(D));
  }

  /// The stored energy is a potential.
  template <class Par, class T, int N>
  static T hypoelastic_power(const Par&, const Sym<T, N>&, const State<T>&, const T&,
                             const Sym<T, N>&, const Sym<T, N>&) {
    return T(0.0);
  }

  template <class Par, class T, int N>
  static T yield(const Par&, const Sym<T, N>&, const State<T>&, const T&, const Sym<T, N>&) {
    return T(-std::numeric_limits<double>::infinity());
  }

  template <class Par, class T, int N>
  static T modulus(const Par& P, const Sym<T, N>&, const State<T>&, const T& density) {
    return P.K * density / P.rho_0;
  }

  template <class Par, class T, int N>
  static T viscosity(const Par& P, const Sym<T, N>&, const T& density, const Sym<T, N>& D) {
    const Sym<T, N> D_dev = deviator(D);
    return Law::effective_viscosity(P, mu_i::pressure_of(P, density),
                                    T(T(2.0) * shear_norm(D_dev))) *
           mu_i::share(P, D_dev);
  }

  template <class Par, class T, int N>
  static T stored_energy(const Par& P, const Sym<T, N>&, const State<T>&, const T& density) {
    return mu_i::compression_energy(P, density);
  }

  template <class Par, class T, int N>
  static T elastic_volume_strain(const Par& P, const Sym<T, N>& stress, const State<T>&, const T&) {
    return mu_i::elastic_volume_strain(P, pressure(stress));
  }

  template <class Par>
  static double density_at(const Par& P, double p, double /*ocr*/) {
    return mu_i::density_at(P, p);
  }

  template <class Par>
  static InitialPoint initial(const Par& P, const InitialConditions& given) {
    const InitialPoint point = mu_i::rest_state(P, given);
    if (mises(point.stress) > 1e-12 * pressure(point.stress))
      throw InputError(given.sigma ? "sigma" : "K0",
                       "the " + std::string(Law::option) +
                           " form carries no shear stress at rest: the initial stress must "
                           "be isotropic (form = \"elastoviscoplastic\" takes any)");
    return point;
  }
};

}  // namespace mu_i

struct MuIRegularised : mu_i::Viscous<MuIRegularised> {
  static constexpr std::string_view name = "mu_i";
  static constexpr std::string_view option_key = "form";
  static constexpr std::string_view option = "regularised";
  static constexpr std::string_view doc =
      "weakly compressible mu(I) as a viscosity made finite by r: creeps, needs tiny steps";

  static constexpr std::array<ParamInfo, 9> parameters{{mu_i::mu_0, mu_i::mu_d, mu_i::I_0, mu_i::d,
                                                        mu_i::rho_p, mu_i::rho_0, mu_i::K, mu_i::r,
                                                        cone::shape}};

  template <class T>
  struct Params {
    T mu_0, mu_d, I_0, d, rho_p, rho_0, K, r, shape;
    static Params from(std::span<const T> t) {
      return {t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7], t[8]};
    }
  };

  static void complete(std::vector<double>& t) { mu_i::check(t[0], t[1], t[8]); }

  /// MUI-3: η = μ_0 p/√(γ̇² + r²) + (μ_d − μ_0) p d/(I_0 √(p/ρ_p) + d γ̇)
  template <class T>
  static T effective_viscosity(const Params<T>& P, const T& p, const T& gamma_dot) {
    using std::sqrt;
    const T loaded = select(p > T(0.0), p, T(1.0));  // p = 0: η = 0, without 0/0 at γ̇ = 0
    const T eta =
        P.mu_0 * loaded / sqrt(T(gamma_dot * gamma_dot + P.r * P.r)) +
        (P.mu_d - P.mu_0) * loaded * P.d / (P.I_0 * sqrt(T(loaded / P.rho_p)) + P.d * gamma_dot);
    return select(p > T(0.0), eta, T(T(0.0) * p));
  }
};

static_assert(ConstitutiveLaw<MuIElastoviscoplastic>);
static_assert(ConstitutiveLaw<MuIRegularised>);

}  // namespace repose

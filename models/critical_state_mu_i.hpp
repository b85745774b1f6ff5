#pragma once
/// \file
/// Critical-state μ(I) (physics.md, CSM): one law for slow, solid-like and fast, fluid-like flow.
/// At rest modified Cam-Clay on ln v – ln p lines; in steady flow μ(I) and φ(I):
///     q = M M_I(I) p,   v = Γ (p_ref/p)^λ e^{I/I_v},   M_I = 1 + (M_∞/M − 1) I/(I_M + I)
/// with the plastic inertial number I = ε̇_q^p d √(ρ_p/p), ε̇_q^p = γ̇^p/√3.
///
/// Rate effects on q: Blatny, Gray & Gaume (2024); on q and on v: Lubbe, Cheng, Luding & Magnanimo
/// (2026). The second without I_v is the first.
///
/// I is no state of its own: stress and volume determine it (inertial_number()), so that the law is
/// one of Perzyna's kind, a rate of flow as a function of the stress beyond yield at rest.

#include "models/modified_cam_clay.hpp"

namespace repose {

struct CriticalStateMuI {
  static constexpr std::string_view name = "critical_state_mu_i";
  static constexpr std::string_view option_key = "";
  static constexpr std::string_view option = "";
  static constexpr std::string_view doc =
      "critical-state mu(I): Cam-Clay (ln v - ln p) at rest, mu(I) and phi(I) in flow";
  static constexpr bool has_stress_memory = true;
  static constexpr bool rate_dependent = true;
  static constexpr bool iterates = true;

  /// The law at rest.
  using Clay = ModifiedCamClay<Compression::ln_v_ln_p>;

  static constexpr std::array<ParamInfo, 14> parameters{{
      Clay::parameters[0],  // M
      Clay::parameters[1],  // lambda
      Clay::parameters[2],  // kappa
      Clay::parameters[3],  // nu
      Clay::parameters[4],  // Gamma
      Clay::parameters[5],  // N
      Clay::parameters[6],  // p_ref
      Clay::parameters[7],  // rho_p
      Clay::parameters[8],  // p_sep
      {"M_inf",
       "M_∞",
       "-",
       "slope q/p of steady flow at a high inertial number (>= M)",
       Need::required,
       0.0,
       positive,
       Scale::linear,
       {"phi_inf", cone::slope_of_angle}},
      {"I_M", "I_M", "-",
       "inertial number (of the triaxial strain rate) half way between M and M_inf", Need::required,
       0.0, positive, Scale::log},
      {"I_v", "I_v", "-",
       "inertial number at which steady flow has dilated by a factor e (absent: rate does not "
       "change the volume)",
       Need::optional, 0.0, positive, Scale::log},
      {"d", "d", "m", "grain diameter", Need::required, 0.0, positive, Scale::log},
      cone::shape,
  }};
  static constexpr std::array<StateField, 2> state{{
      {"ln_p_c_rest", "ln p_c0", "-",
       "ln of the preconsolidation pressure [Pa] that is left when the flow stops, 2p_s with I = 0 "
       "(fast flow brings p_c0 itself below all numbers)"},
      Clay::state[1],  // rho_sep
  }};
  /// What follows from the state, for output.
  static constexpr std::array<StateField, 2> derived{{
      {"p_c", "p_c", "Pa", "preconsolidation pressure 2p_s at the present inertial number"},
      {"I", "I", "-", "plastic inertial number, of the triaxial strain rate"},
  }};

  template <class T>
  struct Params {
    T M, lambda, kappa, nu, Gamma, N, p_ref, rho_p, p_sep, M_inf, I_M, I_v, d, shape;
    static Params from(std::span<const T> t) {
      return {t[0], t[1], t[2], t[3],  t[4],  t[5],  t[6],
              t[7], t[8], t[9], t[10], t[11], t[12], t[13]};
    }
    T shear_ratio() const { return clay().shear_ratio(); }
    /// M in the direction of a deviator; M_∞ shares its shape                            CONE-1
    template <int n>
    T slope(const Sym<T, n>& s) const {
      return M * cone::share(shape, M, s);
    }
    /// 1/(I_v(λ − κ)): what I adds to ln p_s; 0 where rate does not change the volume.
    T volume_rate() const {
      const auto given = I_v == I_v;
      return select(given, T(T(1.0) / (select(given, I_v, T(1.0)) * (lambda - kappa))), T(0.0));
    }
    /// M_∞ = M and no I_v: the law at rest, whatever the rate.
    bool rate_independent() const {
      return value(M_inf) == value(M) && !(value(volume_rate()) > 0.0);
    }
    Clay::Params<T> clay() const {
      return {M, lambda, kappa, nu, Gamma, N, p_ref, rho_p, p_sep, T(0.0), shape};
    }
  };
  template <class T>
  using State = std::array<T, 2>;
  static constexpr std::size_t i_ln_p_c = 0;
  static constexpr std::size_t i_rho_sep = 1;

  /// κ < λ, M ≤ M_∞; Γ ↔ N.
  static void complete(std::vector<double>& t);

  /// `evaluations`, if given, is raised by the number of evaluations that its return takes.
  template <class T, int N>
  static Mask<T> update(const Params<T>& P, const Increment<T, N>& inc, Sym<T, N>& stress,
                        State<T>& state_now, StepWork<T>* spent = nullptr,
                        int* evaluations = nullptr);

  /// Elastic: MCC-4. Plastic: the flow of CSM-3 at the I of CSM-4, with the hardening of CSM-2.
  /// NaN beyond what any I can carry.
  template <class T, int N>
  static void rate(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at,
                   const T& density, const Sym<T, N>& D, Branch branch, Sym<T, N>& stress_rate,
                   State<T>& state_rate);

  template <class T, int N>
  static T hypoelastic_power(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at,
                             const T& density, const Sym<T, N>& D, const Sym<T, N>& stress_rate) {
    return Clay::hypoelastic_power(P.clay(), stress, bearing(stress, at), density, D, stress_rate);
  }

  /// F/p_c of the law at rest: where > 0, it flows.
  template <class T, int N>
  static T yield(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at, const T& density,
                 const Sym<T, N>& D) {
    return Clay::yield(P.clay(), stress, at_rest(stress, at), density, D);
  }

  /// M_I, how friction grows with the rate                                               CSM-1
  template <class T>
  static T friction_growth(const Params<T>& P, const T& I) {
    return T(1.0) + (P.M_inf / P.M - T(1.0)) * I / (P.I_M + I);
  }

  /// The I at which the stress lies on its surface (CSM-4); 0 within the surface at rest and
  /// without stress, ∞ beyond what any I can carry.
  template <class T, int N>
  static T inertial_number(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at) {
    const T I = flow_number(P, stress, at);
    return value(I) > 0.0 ? I : T(0.0);
  }

  /// The same, but < 0 within the surface at rest, where it is continued by its tangent: a solver
  /// of slow flow needs a derivative that holds over more than the breadth of I itself. 0 for
  /// parameters without any rate effect (rate_independent()).
  template <class T, int N>
  static T flow_number(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at);

  /// A point that is held at `denser` times its density: p_c0 is what CSM-2 gives for it under the
  /// same p. Without it dilation that is not let happen would count as the way back.
  template <class T>
  static void hold_volume(const Params<T>& P, const T& denser, State<T>& at) {
    const T held = at[i_ln_p_c] + ln(denser) / (P.lambda - P.kappa);
    at[i_ln_p_c] = select(at[i_rho_sep] > T(0.0), at[i_ln_p_c], held);
  }

  /// The derived variables: 2p_s = p_c0 e^{jI} and I.                                    CSM-2
  template <class T, int N>
  static std::array<T, 2> derive(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at) {
    const T I = inertial_number(P, stress, at);
    const T j = P.volume_rate();
    // (without I_v the volume knows no rate, be I as large as it will)
    const T dilation = value(j) > 0.0 ? T(j * I) : T(0.0);
    return {exp_pair(T(at[i_ln_p_c] + dilation)).whole, I};
  }

  /// τ of steady shear under p > 0: M M_I p/√3, M that of simple shear, at I = γ̇d√(ρ_p/p)/√3 CSM-5
  template <class T>
  static T steady_shear_stress(const Params<T>& P, const T& p, const T& gamma_dot) {
    using std::sqrt;
    const T root_3(std::sqrt(3.0));
    const T I = gamma_dot / root_3 * P.d * sqrt(T(P.rho_p / p));
    return P.M * cone::shear_share(P.shape, P.M) * friction_growth(P, I) * p / root_3;
  }

  template <class T, int N>
  static T modulus(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at,
                   const T& density) {
    return Clay::modulus(P.clay(), stress, bearing(stress, at), density);
  }

  /// The flow is part of the update, whatever the step: no viscous limit.
  template <class T, int N>
  static T viscosity(const Params<T>&, const Sym<T, N>&, const T&, const Sym<T, N>&) {
    return T(0.0);
  }

  template <class T, int N>
  static T stored_energy(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at,
                         const T& density) {
    return Clay::stored_energy(P.clay(), stress, bearing(stress, at), density);
  }

  template <class T, int N>
  static T elastic_volume_strain(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at,
                                 const T& density) {
    return Clay::elastic_volume_strain(P.clay(), stress, bearing(stress, at), density);
  }

  /// The state as the law at rest has it, for what does not ask for p_c. Whatever carries a
  /// pressure bears: a solver of differential equations may leave round-off in ρ_sep.
  template <class T, int N>
  static Clay::State<T> bearing(const Sym<T, N>& stress, const State<T>& at) {
    return {T(1.0), select(pressure(stress) > T(0.0), T(0.0), at[i_rho_sep])};
  }
  /// The same with p_c.
  template <class T, int N>
  static Clay::State<T> at_rest(const Sym<T, N>& stress, const State<T>& at) {
    return {exp_pair(at[i_ln_p_c]).whole, bearing(stress, at)[Clay::i_rho_sep]};
  }

  /// At rest under p with p_c = ocr p, on the law's own lines; needs Γ or N.
  static double density_at(const Params<double>& P, double p, double ocr);

  /// As modified Cam-Clay, at rest; where Γ or N is known, the density is the one that CSM-2 gives
  /// for p and p_c, and a v that says otherwise is refused.
  static InitialPoint initial(const Params<double>& P, const InitialConditions& given);
};

}  // namespace repose

#include "models/critical_state_mu_i_return.hpp"

namespace repose {
static_assert(ConstitutiveLaw<CriticalStateMuI>);
}  // namespace repose

#pragma once
/// \file
/// Modified Cam-Clay (physics.md, MCC): yield F = q²/M² − p(p_c − p), associated flow, volumetric
/// hardening, pressure-dependent elasticity integrated exactly; both compression lines.
///
/// Roscoe & Burland (1968); Butterfield (1979) for the ln v – ln p lines; Borja & Lee (1990) for
/// the implicit return, which here is reduced to one bounded unknown that always has a root.
///
/// Written in the shifted pressure p̃ = p + p_shift throughout (p_shift = 0: the classical law;
/// p_shift > 0: a finite stiffness p_shift/κ at p = 0).

#include "models/cone.hpp"
#include "models/law.hpp"
#include "models/scalar.hpp"

namespace repose {

/// The pair of axes in which the compression, swelling and critical-state lines are straight.
enum class Compression : std::uint8_t { ln_v_ln_p, v_ln_p };

template <Compression compression>
struct ModifiedCamClay {
  static constexpr std::string_view name = "modified_cam_clay";
  static constexpr std::string_view option_key = "compression";
  static constexpr std::string_view option =
      compression == Compression::ln_v_ln_p ? "ln_v-ln_p" : "v-ln_p";
  static constexpr std::string_view doc =
      compression == Compression::ln_v_ln_p
          ? "modified Cam-Clay with lines straight in ln v - ln p"
          : "modified Cam-Clay with lines straight in v - ln p (laboratory lambda and kappa)";
  static constexpr bool has_stress_memory = true;
  static constexpr bool iterates = true;

  static constexpr std::array<ParamInfo, 11> parameters{{
      {"M",
       "M",
       "-",
       "slope q/p of the critical state line",
       Need::required,
       0.0,
       Range{0.0, 3.0, true, true},
       Scale::linear,
       {"phi", cone::slope_of_angle}},
      {"lambda", "λ", "-", "slope of the compression line", Need::required, 0.0, positive,
       Scale::log},
      {"kappa", "κ", "-", "slope of the swelling lines", Need::required, 0.0, positive, Scale::log},
      {"nu", "ν", "-", "Poisson's ratio", Need::required, 0.0, Range{0.0, 0.5, false, true},
       Scale::linear},
      {"Gamma", "Γ", "-", "specific volume on the critical state line at p_ref (or give N)",
       Need::optional, 0.0, Range{1.0}, Scale::linear},
      {"N", "N", "-", "specific volume on the isotropic compression line at p_ref (or give Gamma)",
       Need::optional, 0.0, Range{1.0}, Scale::linear},
      {"p_ref", "p_ref", "Pa", "pressure at which Gamma and N are read", Need::defaulted, 1e3,
       positive, Scale::log},
      {"rho_p", "ρ_p", "kg/m³", "density of the grains, ρ = ρ_p/v", Need::defaulted, 2650.0,
       positive, Scale::log},
      {"p_sep", "p_sep", "Pa", "below this pressure a point counts as separated (no stress)",
       Need::defaulted, 1e-2, positive, Scale::log},
      {"p_shift", "p_s", "Pa", "shift p -> p + p_s of the whole law: a finite stiffness at p = 0",
       Need::defaulted, 0.0, not_negative, Scale::linear},
      cone::shape,
  }};
  static constexpr std::array<StateField, 2> state{{
      {"p_c", "p_c", "Pa", "preconsolidation pressure (of p + p_shift)"},
      {"rho_sep", "ρ_sep", "kg/m³",
       "density at which the point parted and will touch again; 0 while in contact"},
  }};

  template <class T>
  struct Params {
    T M, lambda, kappa, nu, Gamma, N, p_ref, rho_p, p_sep, p_shift, shape;
    static Params from(std::span<const T> t) {
      return {t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7], t[8], t[9], t[10]};
    }
    /// M in the direction of a deviator                                                 CONE-1
    template <int n>
    T slope(const Sym<T, n>& s) const {
      return M * cone::share(shape, M, s);
    }
    /// G/K = 3(1 − 2ν)/(2(1 + ν))                                                    MCC-4
    T shear_ratio() const { return T(1.5) * (T(1.0) - T(2.0) * nu) / (T(1.0) + nu); }
  };
  template <class T>
  using State = std::array<T, 2>;
  static constexpr std::size_t i_p_c = 0;
  static constexpr std::size_t i_rho_sep = 1;

  /// Γ ↔ N: N = Γ 2^{λ−κ} (ln v – ln p) or Γ + (λ−κ) ln 2 (v – ln p)                    MCC-5
  static void complete(std::vector<double>& t);

  /// `evaluations`, if given, is raised by the number of evaluations that its return takes.
  template <class T, int N>
  static Mask<T> update(const Params<T>& P, const Increment<T, N>& inc, Sym<T, N>& stress,
                        State<T>& state_now, StepWork<T>* spent = nullptr,
                        int* evaluations = nullptr);

  /// Elastic: MCC-4; plastic: consistency of MCC-1 with MCC-2 and MCC-3.
  template <class T, int N>
  static void rate(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at,
                   const T& density, const Sym<T, N>& D, Branch branch, Sym<T, N>& stress_rate,
                   State<T>& state_rate);

  /// ψ_s d ln p̃ with ψ_s = q²/6G, for G ∝ p̃ (and, on v – ln p lines, ∝ v); on ln v – ln p lines
  /// also ψ_s dε_v + ψ_v dε_v^p, a plastic change of volume carrying the energy ψ_v per volume
  /// along. Derived in physics.md, "Where the work goes".
  template <class T, int N>
  static T hypoelastic_power(const Params<T>& P, const Sym<T, N>& stress, const State<T>&,
                             const T& density, const Sym<T, N>& D, const Sym<T, N>& stress_rate) {
    const T p = pressure(stress) + P.p_shift;
    const T kappa = kappa_star(P, specific_volume(P, density));
    const Sym<T, N> s = deviator(stress);
    const T shear_energy = contract(s, s) * kappa / (T(4.0) * P.shear_ratio() * p);
    const T ln_p_rate = pressure(stress_rate) / p;
    if (compression == Compression::v_ln_p) return shear_energy * ln_p_rate;
    const T plastic_v = -trace(D) - kappa * ln_p_rate;
    return shear_energy * (ln_p_rate - trace(D)) + compression_energy(P, p, kappa) * plastic_v;
  }

  /// F/p_c, in Pa so that it compares with a stress (MCC-1); the boundary is the same.
  template <class T, int N>
  static T yield(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at, const T&,
                 const Sym<T, N>&) {
    const T p = pressure(stress) + P.p_shift;
    const Sym<T, N> s = deviator(stress);
    const T q = T(std::sqrt(3.0)) * shear_norm(s);
    return square(T(q / P.slope(s))) / at[i_p_c] - p * (T(1.0) - p / at[i_p_c]);
  }

  template <class T, int N>
  static T modulus(const Params<T>& P, const Sym<T, N>& stress, const State<T>&, const T& density) {
    // a separated point is as stiff as at p_sep, so the step is ready for its return
    const T p = pressure(stress) + P.p_shift;
    const T bearing = select(p < contact_pressure(P), contact_pressure(P), p);
    return bearing / kappa_star(P, specific_volume(P, density)) *
           (T(1.0) + T(4.0 / 3.0) * P.shear_ratio());
  }

  template <class T, int N>
  static T viscosity(const Params<T>&, const Sym<T, N>&, const T&, const Sym<T, N>&) {
    return T(0.0);
  }

  /// The work that elastic unloading to p = 0 returns, ρ ∫(p/ρ) dε_v^e with p̃ = p + p_s, plus
  /// q²/(6G):
  ///   ln v – ln p:  [κp̃ − p_s(r − 1 + κ)]/(1 − κ), r = (p̃/p_s)^κ   (p_s = 0: κp/(1 − κ))
  ///   v – ln p:     κ*[p̃ − p_s − p_s ln(p̃/p_s)]                     (p_s = 0: κ*p)
  /// With G ∝ p̃ the law is hypoelastic: no potential exists, a closed elastic cycle in shear and
  /// pressure does not return exactly this energy, and the difference counts as dissipation.
  template <class T, int N>
  static T stored_energy(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at,
                         const T& density) {
    const auto apart = at[i_rho_sep] > T(0.0);
    const T kappa = kappa_star(P, specific_volume(P, density));
    const T bearing = select(apart, T(1.0), T(pressure(stress) + P.p_shift));
    const T G = P.shear_ratio() * bearing / kappa;
    const Sym<T, N> s = deviator(stress);
    return select(apart, T(0.0),
                  T(compression_energy(P, bearing, kappa) + contract(s, s) / (T(4.0) * G)));
  }

  /// Its first part, at p̃ with κ*.
  template <class T>
  static T compression_energy(const Params<T>& P, const T& bearing, const T& kappa) {
    const T one(1.0);
    const T ln_p = ln(T(bearing / select(P.p_shift > T(0.0), P.p_shift, one)));
    // r − 1 + κ = κ(1 + ln(p̃/p_s)(e^{κ ln(p̃/p_s)} − 1)/(κ ln(p̃/p_s)))
    return compression == Compression::ln_v_ln_p
               ? kappa * (bearing - P.p_shift * (one + ln_p * expm1_over(T(kappa * ln_p)))) /
                     (one - kappa)
               : kappa * (bearing - P.p_shift * (one + ln_p));
  }

  /// −κ* ln(p̃/p̃_contact), MCC-4, from where contact is made; 0 for a point that is separated.
  template <class T, int N>
  static T elastic_volume_strain(const Params<T>& P, const Sym<T, N>& stress, const State<T>& at,
                                 const T& density) {
    const T contact = contact_pressure(P);
    const T p = pressure(stress) + P.p_shift;
    const T bearing = select(at[i_rho_sep] > T(0.0) || p < contact, contact, p);
    return -kappa_star(P, specific_volume(P, density)) * ln(T(bearing / contact));
  }

  /// At rest under p with p_c = ocr p, on the law's own lines; needs Γ or N.
  static double density_at(const Params<double>& P, double p, double ocr);

  /// From sigma, or p or sigma_v (with K0), with ocr = p_c/p or ocr_v (p_c of the yield surface
  /// through ocr_v times the vertical stress, under K0_nc or else K0; default: through the stress
  /// itself), and v or density or the compression line; or from v or density on the compression
  /// line alone. A v that the line contradicts by more than 0.5 % is refused, with both figures.
  /// `law` is the name in messages.
  static InitialPoint initial(const Params<double>& P, const InitialConditions& given,
                              std::string_view law = name);

  template <class T>
  static T specific_volume(const Params<T>& P, const T& density) {
    return P.rho_p / density;
  }

  /// κ of d ln p = dε_v/κ*: κ on ln v – ln p lines, κ/v on v – ln p lines.
  template <class T>
  static T kappa_star(const Params<T>& P, const T& v) {
    return compression == Compression::ln_v_ln_p ? P.kappa : T(P.kappa / v);
  }

  /// p̃ at which contact is lost and made again                                       MCC-7
  template <class T>
  static T contact_pressure(const Params<T>& P) {
    return P.p_sep + P.p_shift;
  }
};

}  // namespace repose

#include "models/modified_cam_clay_return.hpp"

namespace repose {
static_assert(ConstitutiveLaw<ModifiedCamClay<Compression::ln_v_ln_p>>);
static_assert(ConstitutiveLaw<ModifiedCamClay<Compression::v_ln_p>>);
}  // namespace repose

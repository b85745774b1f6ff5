#pragma once
/// \file
/// A contrast, not a law to use: modified Cam-Clay with the linearised stress update that published
/// Material Point codes have, to show where it fails (physics.md, MCC-7). It is in no registry.
///     p = p_n/(1 − Δε_v^e/κ),   p_c = p_cn/(1 − Δε_v^p/(λ − κ)),   G = αp_n/κ
/// are backward Euler on dp = (p/κ) dε_v^e and dp_c = p_c dε_v^p/(λ − κ): singular where the volume
/// strain of one step is κ, of the wrong sign beyond. The return is Newton's method from the trial
/// state without safeguards.
///
/// A point whose new state is undefined (no finite positive p and p_c, or no convergence) is lost:
/// it carries no stress from then on, which is how such a run goes on at all. No other point has
/// zero stress, since contact is never given up.

#include "models/modified_cam_clay.hpp"

namespace repose {

struct LinearisedCamClay : ModifiedCamClay<Compression::ln_v_ln_p> {
  using Exact = ModifiedCamClay<Compression::ln_v_ln_p>;
  static constexpr std::string_view doc = "contrast: modified Cam-Clay with the linearised update";
  static constexpr double lost_density = 1e30;  ///< ρ_sep of a lost point: it never touches again

  static bool lost(const State<double>& at) { return at[i_rho_sep] >= lost_density; }

  /// Says nothing of its work: nobody runs it but to compare stresses.
  template <class T, int N>
  static Mask<T> update(const Params<T>& P, const Increment<T, N>& inc, Sym<T, N>& stress,
                        State<T>& at, StepWork<T>* = nullptr, int* evaluations = nullptr) {
    const T zero(0.0), one(1.0);
    const auto was_lost = at[i_rho_sep] > zero;
    const T p_n = select(was_lost, one, T(pressure(stress) + P.p_shift));
    const T p_cn = select(was_lost, one, at[i_p_c]);
    const T strain_v = -trace(inc.strain);
    const T G = P.shear_ratio() * p_n / P.kappa;
    const Sym<T, N> s_trial = deviator(stress) + (T(2.0) * G) * deviator(inc.strain);
    const T q2_M2 = T(1.5) * contract(s_trial, s_trial) / square(P.M);  // (q_tr/M)²
    const T hardening = P.lambda - P.kappa;

    // Unknowns z = Δε_v^p and Δλ:  z − Δλ(2p − p_c) = 0,  F = (q_tr/MD)² − p(p_c − p) = 0 with
    // D = 1 + 6GΔλ/M²
    T z = zero, multiplier = zero;
    T p = p_n / (one - strain_v / P.kappa);
    T p_c = p_cn;
    T D = one;
    const T F_trial = q2_M2 - p * (p_c - p);
    const auto plastic = negated(was_lost) && F_trial > T(1e-12) * p_n * p_cn;
    auto active = plastic;
    const T slope_D = T(6.0) * G / square(P.M);
    for (int step = 0; step < 50 && any(active); ++step) {
      if (evaluations != nullptr) ++*evaluations;
      const T volume = z - multiplier * (T(2.0) * p - p_c);
      const T F = q2_M2 / square(D) - p * (p_c - p);
      const auto done = volume * volume <= T(1e-24) * square(P.kappa) &&
                        F * F <= T(1e-20) * square(T(p_n * p_cn));
      active = active && negated(done);
      if (!any(active)) break;
      const T p_z = -p * p / (p_n * P.kappa);          // dp/dz
      const T p_c_z = p_c * p_c / (p_cn * hardening);  // dp_c/dz
      const T volume_z = one - multiplier * (T(2.0) * p_z - p_c_z);
      const T volume_l = p_c - T(2.0) * p;
      const T F_z = (T(2.0) * p - p_c) * p_z - p * p_c_z;
      const T F_l = T(-2.0) * q2_M2 * slope_D / (D * D * D);
      const T det = volume_z * F_l - volume_l * F_z;
      z = select(active, T(z - (volume * F_l - volume_l * F) / det), z);
      multiplier = select(active, T(multiplier - (volume_z * F - F_z * volume) / det), multiplier);
      p = p_n / (one - (strain_v - z) / P.kappa);
      p_c = p_cn / (one - z / hardening);
      D = one + slope_D * multiplier;
    }
    const auto defined = negated(was_lost || active) && finite(p) && finite(p_c) && finite(D) &&
                         p > zero && p_c > zero;
    const Sym<T, N> next = (one / D) * s_trial - Sym<T, N>::isotropic(p - P.p_shift);
    for (int i = 0; i < N; ++i) stress[i] = select(defined, next[i], zero);
    at[i_p_c] = select(defined, p_c, at[i_p_c]);
    at[i_rho_sep] = select(defined, zero, T(lost_density));
    return negated(inc.density > zero);
  }
};

static_assert(ConstitutiveLaw<LinearisedCamClay>);

}  // namespace repose

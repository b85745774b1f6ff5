#pragma once
/// \file
/// Weakly compressible μ(I) with the flow curve of Barker & Gray (2017), as a viscosity: the
/// incompressible equations are well-posed with it from I = 0 to a large I (physics.md, MUI-8).
///     μ = √(α/ln(A/I))                                  I <= I_1
///     μ = (μ_0 I_0 + μ_d I + μ_∞ I²)/(I_0 + I)          I > I_1
/// I_1 is where the curve of MUI-2 becomes well-posed, and A makes μ continuous there. μ → 0 for
/// I → 0, slowly: no slope is at rest, it creeps.

#include "models/ill_posedness.hpp"
#include "models/mu_i.hpp"

namespace repose {

struct MuIBarkerGray : mu_i::Viscous<MuIBarkerGray> {
  static constexpr std::string_view name = "mu_i";
  static constexpr std::string_view option_key = "form";
  static constexpr std::string_view option = "barker_gray";
  static constexpr std::string_view doc =
      "weakly compressible mu(I) with the well-posed flow curve of Barker & Gray (2017): creeps";

  static constexpr std::array<ParamInfo, 12> parameters{
      {mu_i::mu_0,
       mu_i::mu_d,
       mu_i::I_0,
       mu_i::d,
       mu_i::rho_p,
       mu_i::rho_0,
       mu_i::K,
       mu_i::r,
       {"alpha", "α", "-", "of the curve below I_1; well-posed for alpha < 2", Need::defaulted, 1.9,
        positive, Scale::linear},
       {"mu_inf", "μ_∞", "-", "slope of mu(I) at a high inertial number", Need::defaulted, 0.05,
        not_negative, Scale::linear},
       {"I_1", "I_1", "-",
        "inertial number at which the low branch ends (default: where mu(I) becomes well-posed)",
        Need::optional, 0.0, positive, Scale::log},
       cone::shape}};

  template <class T>
  struct Params {
    T mu_0, mu_d, I_0, d, rho_p, rho_0, K, r, alpha, mu_inf, I_1, shape;
    static Params from(std::span<const T> t) {
      return {t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7], t[8], t[9], t[10], t[11]};
    }
  };

  static void complete(std::vector<double>& t) {
    mu_i::check(t[0], t[1], t[11]);
    if (!std::isnan(t[10])) return;
    // well-posedness is a matter of simple shear
    const double g = cone::shear_share(t[11], std::sqrt(3.0) * t[0]);
    const double I_1 = lower_neutral_inertial_number(g * t[0], g * t[1], t[2]);
    if (!(I_1 > 0.0))
      throw InputError(
          "I_1",
          "no inertial number makes mu(I) with this mu_0, mu_d well-posed: mu_d - mu_0 "
          "is too small for a default of I_1");
    t[10] = I_1;
  }

  template <class T>
  static T high_branch(const Params<T>& P, const T& I) {
    return (P.mu_0 * P.I_0 + I * (P.mu_d + P.mu_inf * I)) / (P.I_0 + I);
  }

  template <class T>
  static T friction(const Params<T>& P, const T& I) {
    using std::sqrt;
    const auto low = I < P.I_1;
    // ln(A/I) = ln(I_1/I) + α/μ(I_1)²
    const T below = select(low, I, P.I_1);
    const T ln_ratio = ln(T(P.I_1 / below)) + P.alpha / square(high_branch(P, P.I_1));
    return select(low, T(sqrt(T(P.alpha / ln_ratio))), high_branch(P, I));
  }

  /// η = μ(I) p/γ̇ with √(γ̇² + r²) for γ̇, in I as well: finite at rest.
  template <class T>
  static T effective_viscosity(const Params<T>& P, const T& p, const T& gamma_dot) {
    using std::sqrt;
    const T loaded = select(p > T(0.0), p, T(1.0));
    const T rate = sqrt(T(gamma_dot * gamma_dot + P.r * P.r));
    const T eta = friction(P, mu_i::inertial_number(P, loaded, rate)) * loaded / rate;
    return select(p > T(0.0), eta, T(T(0.0) * p));
  }
};

static_assert(ConstitutiveLaw<MuIBarkerGray>);

}  // namespace repose

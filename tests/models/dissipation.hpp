#pragma once
/// \file
/// What a step dissipates by the second law's own bookkeeping, for the tests that demand that it is
/// never negative.

#include "tests/models/law_samples.hpp"

namespace repose {

/// Work of the end-of-step stress less the change of stored energy per unit of mass, with what the
/// hypoelastic shear of a law adds to or takes from its stored energy put aside, and the amount
/// below zero that the time step itself explains.
struct Dissipated {
  double energy;  ///< >= −slack − round-off
  double slack;
};

/// With V = 1/ρ: w = −p₁(V₁ − V₀) + V₁ s₁:Δe.
/// Where p is a function of V alone, −p₁(V₁ − V₀) >= the change of stored energy, because that is
/// convex in V. A viscous s₁ gives s₁:Δe = 2η Δe:Δe/Δt >= 0. An elastic-plastic return
/// s₁ = r(s₀ + 2GΔe) gives s₁:Δe − (|s₁|² − |s₀|²)/4G = [|s₁ − s₀|² + 2|s₁|²(1/r − 1)]/4G >= 0;
/// what is left is the change of V under |s|²/4G, (V₁ − V₀)|s₀|²/4G, a matter of definition: put
/// aside. A neo-Hookean energy per mass is convex along b(t) = e^{tΔε} b e^{tΔε}, its second
/// derivative being [λ(tr Δε)² + 4μ tr(Δε b Δε)]/ρ_0; −p₁(V₁ − V₀) >= −p₁V₁ tr Δε where p₁ > 0,
/// and where p₁ < 0 falls short by |p₁|V₁(t − 1 + e^{−t}), t = tr Δε: that is allowed for.
template <class L>
Dissipated dissipated(const typename L::template Params<double>& P, const LawPoint<L>& before,
                      const LawPoint<L>& after, const Sym<double, 6>& strain) {
  const double V0 = 1.0 / before.density;
  const double V1 = 1.0 / after.density;
  const auto energy = [&](const LawPoint<L>& at) {
    return L::stored_energy(P, at.stress, at.state, at.density) / at.density;
  };
  const double p0 = pressure(before.stress);
  const double p1 = pressure(after.stress);
  const Sym<double, 6> s0 = deviator(before.stress);
  const Sym<double, 6> s1 = deviator(after.stress);
  const double work = -p1 * (V1 - V0) + V1 * contract(s1, deviator(strain));
  double rest = work - (energy(after) - energy(before));
  double slack = 0.0;
  if constexpr (L::name == "neo_hookean")
    if (const double t = trace(strain); p1 < 0.0) slack = -p1 * V1 * (t + std::expm1(-t));
  if constexpr (L::name == "mu_i" && L::has_stress_memory) {
    rest += (V1 - V0) * contract(s0, s0) / (4.0 * P.G);
  } else if constexpr (L::state.size() > 0) {
    // the law at rest, whose elasticity a critical-state law shares
    constexpr bool is_at_rest = L::name == "modified_cam_clay";
    const auto at_rest = [&] {
      if constexpr (is_at_rest)
        return P;
      else
        return P.clay();
    }();
    const auto kappa_at = [&](double v) {
      if constexpr (is_at_rest)
        return L::kappa_star(P, v);
      else
        return P.kappa;
    };
    // Cam-Clay: G follows p, Ḡ is the mean of the step. The shear energy |s|²/4G is replaced by its
    // value with Ḡ at fixed V, for which the argument above holds. The volume first yields by
    // e^{−z} at p₀, then is strained elastically by a: convexity leaves V₀′(e^z − 1)(p₁ + ψ₀) with
    // V₀′ = V₁e^a. The flow rule makes V₁(2q²λ_p/M² + p₁z) = V₁λ_p p p_c >= 0, so that what may
    // fall below zero, for z < 0, is |z|(|V₀′ − V₁|p₁ + V₀′ψ₀): second order in the step.
    const double pt0 = p0 + at_rest.p_shift;
    const double pt1 = p1 + at_rest.p_shift;
    // (V0 − V1)/ln(V0/V1), without the difference of two that are nearly alike
    const double t = trace(strain);
    const double V_mean = t == 0.0 ? V1 : V1 * std::expm1(-t) / -t;
    const double kappa_step = kappa_at(P.rho_p * V_mean);
    const double x = std::log(pt1 / pt0);
    // (of the critical-state law, and of Cam-Clay on a cone: the mean of the elastic predictor, to
    // 30κ; the flow rule of the former makes the sum λ_p p[p_s + (M_I² − 1)(2p_s − p)] times 2V₁,
    // and 2p_s ≥ p)
    const bool held = !is_at_rest || !cone::is_circle(P.shape);
    const double x_mean = held ? std::min(-trace(strain) / kappa_step, 30.0) : x;
    const double G_mean = P.shear_ratio() * pt0 * expm1_over(x_mean) / kappa_step;
    const auto shear_energy = [&](const LawPoint<L>& at, const Sym<double, 6>& s) {
      const double G = P.shear_ratio() * (pressure(at.stress) + at_rest.p_shift) /
                       kappa_at(P.rho_p / at.density);
      return contract(s, s) / (4.0 * G * at.density);
    };
    const double with_G = shear_energy(after, s1) - shear_energy(before, s0);
    const double with_mean = V1 * (contract(s1, s1) - contract(s0, s0)) / (4.0 * G_mean);
    rest += with_G - with_mean;
    const double a = kappa_step * x;
    const double hardened =
        is_at_rest ? std::log(after.state[0] / before.state[0]) : after.state[0] - before.state[0];
    const double z = kappa_step * (P.lambda / P.kappa - 1.0) * hardened;
    const double psi0 = energy(before) / V0 - shear_energy(before, s0) / V0;
    if (z < 0.0) slack = -z * (V1 * std::abs(std::expm1(a)) * p1 + V1 * std::exp(a) * psi0);
  }
  return {rest, slack};
}

}  // namespace repose

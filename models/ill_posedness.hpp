#pragma once
/// \file
/// Where the equations of incompressible flow are ill-posed for a law whose steady shear stress
/// τ(p, γ̇) depends on pressure and rate alone: small waves then grow without bound as their length
/// shrinks (Barker, Schaeffer, Bohorquez & Gray 2015; physics.md, MUI-6). The one place of the
/// criterion.

#include <optional>

#include "models/material.hpp"

namespace repose {

/// Steady shear at a pressure and a rate, and how it answers a change of them.
struct ShearResponse {
  double tau = 0.0;    ///< [Pa]
  double chi = 0.0;    ///< χ = ∂ln τ/∂ln γ̇ at constant p; for τ = μ(I)p: Iμ′/μ [-]
  double slope = 0.0;  ///< m = ∂τ/∂p at constant γ̇; for τ = μ(I)p: μ(1 − χ/2) [-]
};

/// C = m² − 4χ(1 − χ), which is 4(χ² − χ) + μ²(1 − χ/2)² for τ = μ(I)p: ill-posed where it is > 0
/// (and χ < ½, as for every μ(I) in use).
double ill_posedness(const ShearResponse& response);

/// The growth rate of a short plane wave across which the strain rate is β = n·An, A =
/// D′/√(½D′:D′), n its direction (in simple shear β = sin 2θ, θ from the flow), in units of ηk²/ρ,
/// η = τ/γ̇:
///     g(β) = (1 − χ)(1 − β²)/(1 − mβ) − 1.
/// > 0: it grows, the faster the shorter.
double growth_of_direction(const ShearResponse& response, double beta);

/// The direction that grows fastest, β = (1 − √(1 − m²))/m; g there is > 0 exactly where C > 0.
double fastest_direction(const ShearResponse& response);

/// The inertial number above which μ = μ_0 + (μ_d − μ_0)I/(I_0 + I) (MUI-2) is well-posed; NaN if
/// it nowhere is.
double lower_neutral_inertial_number(double mu_0, double mu_d, double I_0);

/// Response of a material at p [Pa] and γ̇ [1/s]; absent for a law without such a stress and where
/// p or γ̇ is not > 0. Throws InputError for a law that is in no registry.
std::optional<ShearResponse> shear_response(const Material& material, double p, double gamma_dot);

}  // namespace repose

#pragma once
/// \file
/// What a coefficient of restitution makes of elastic waves (physics.md, DAMP).

namespace repose::mpm {

/// ζ = −ln e/√(π² + ln² e) of a spring with a dashpot that gives the restitution 0 < e <= 1.
double damping_ratio(double restitution);

/// ℓ = √2 ζ d [m], of a chain of grains of diameter d with such contacts: waves of number k and
/// speed c decay as e^{−ℓck²t/2}.
double damping_length(double restitution, double grain_diameter);

/// By how much the fastest signal grows, √(1 + ξ²) + ξ with ξ = ½ωℓ/c: an explicit step with a
/// viscous force of the velocity before is stable up to (2/ω)(√(1 + ξ²) − ξ), and ω = 2.44 c/h is
/// that of an isolated point (step_size.hpp).
double damped_signal(double damping_length, double h);

}  // namespace repose::mpm

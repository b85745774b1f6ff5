#pragma once
/// \file
/// What a small plane wave does in homogeneous plane shear, measured with the law's own update and
/// not from a formula.
///
/// In the flow U = (γ̇y, 0) at constant volume let u = U + û(t) cos(n k·x). Where the cosine falls
/// through zero the velocity gradient is ∇U + û⊗k, and there a material point is kept, beside one
/// in the undisturbed flow; with δσ the difference of their stresses, to first order in û,
///     ρ dû/dt = −δσ·k − ρ(û·∇)U .
/// The direction of k is held (Barker et al. 2015): shear turns it by γ̇t, which does not matter
/// where waves grow or decay much faster than γ̇.

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "models/material.hpp"

namespace repose::point {

/// Homogeneous shear.
struct ShearFlow {
  double p;           ///< [Pa]
  double shear_rate;  ///< γ̇ [1/s]
  /// Of a law whose volume depends on the rate: the specific volume of the flow at p and γ̇. It then
  /// starts at rest at this volume.
  std::optional<double> v{};
};

struct WaveGrowth {
  double angle;  ///< of k from the flow's direction, towards the velocity gradient [rad]
  double rate;   ///< d ln|û|/dt once the fastest growing motion prevails [1/s]
};

/// τ/γ̇ of the steady flow [Pa s], from the law's update.
double flow_viscosity(const Material& material, const ShearFlow& flow);

/// ηk²/ρ: the rate of a wave of wave number k, on which g of ill_posedness.hpp is measured [1/s].
double viscous_rate(const Material& material, const ShearFlow& flow, double wave_number);

/// The wave number at which the viscous rate is `share` of the frequency ck of sound, c from the
/// bulk modulus K. Incompressible for share ≪ 1; and where also share² K/τ ≫ 1, growth is much
/// faster than γ̇.
double wave_number_of_share(const Material& material, const ShearFlow& flow, double share);

/// Starts noise, the same velocity in all of `directions` directions spread evenly over half a
/// turn, and follows each until it has changed by a factor of 100, at most for 20(1 + share²)
/// viscous times. Rates are those of the second half of that time. Throws InputError if the law
/// cannot flow at such a pressure.
std::vector<WaveGrowth> wave_growth(const Material& material, const ShearFlow& flow,
                                    double wave_number, std::size_t directions);

/// Follows one wave whose vector k(t) [1/m] is given, such as one that the flow turns: ln|û| at
/// `samples` times `interval` [s] apart, the first of them the start, where û is across k and ln|û|
/// 0. Throws InputError as wave_growth().
std::vector<double> follow_wave(const Material& material, const ShearFlow& flow,
                                const std::function<std::array<double, 2>(double t)>& wave_vector,
                                double interval, std::size_t samples);

/// The wave of the highest rate.
WaveGrowth fastest(const std::vector<WaveGrowth>& waves);

}  // namespace repose::point

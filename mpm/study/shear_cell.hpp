#pragma once
/// \file
/// Growth of small disturbances in plane shear, measured with the Material Point Method: a strip,
/// periodic along the flow, between two rough walls that move apart from each other along
/// themselves. The volume stays and with it the pressure; uniform shear U = (γ̇y, 0) is an
/// equilibrium of the method to round-off.
///
/// The disturbance is a packet of waves in the middle of the strip, the plane wave cos k·x under a
/// bell over y (its stream function, so that it is free of divergence), too narrow to meet the
/// walls. A wave keeps its phase on points that move with U, so that its vector turns,
/// k = (k_x, k_y − γ̇tk_x), and waves of different vectors do not mix: the size that is measured,
/// |Σ m (v − U) e^{−ik·x}|, is that of one plane wave, whatever becomes of the packet. Or it is
/// noise, a velocity of its own for every point.

#include <array>
#include <span>
#include <vector>

#include "mpm/scene/scene.hpp"

namespace repose::mpm {

struct ShearCell {
  LawSpec law;              ///< whose pressure follows from density alone, as that of μ(I)
  double p = 0.0;           ///< [Pa]
  double shear_rate = 0.0;  ///< γ̇ [1/s]
  double wavelength = 0.0;  ///< across the flow at the start, 2π/k_y [m]
  int cells = 8;            ///< to a wavelength
  int slope = 10;           ///< k_y/k_x at the start; the strip is `slope` wavelengths long
  int height = 6;           ///< of the strip, in wavelengths; one is the bell's standard deviation
  bool noise = false;       ///< instead of the wave
  double size = 1e-5;       ///< of the disturbance's velocity gradient at the start, over γ̇
  Kernel kernel = Kernel::cubic;
  Transfer transfer = Transfer::relaxed;
  double relaxation_time = 0.0;  ///< of Transfer::relaxed [s]
  int points_per_cell = 4;
  double courant = 0.8;
};

/// k at time t [1/m].
std::array<double, 2> wave_vector(const ShearCell& cell, double t);

struct Growth {
  std::vector<double> time;      ///< [s]
  std::vector<double> log_size;  ///< ln of the size over that at the start; of noise, of the root
                                 ///< mean square of v − U
  double dt = 0.0;               ///< mean step [s]
  double pressure_error = 0.0;   ///< largest |p/p_0 − 1| of a point at the end
};

/// Follows the disturbance until `end` [s], or until ln of its size has changed by `most`, and
/// looks at it `samples` times. Throws InputError and NumericalFailure.
Growth follow_growth(const ShearCell& cell, double end, double most, std::size_t samples);

/// Slope of a line through the second half of a history, when what the start has of other motions
/// is gone [1/s].
double late_rate(std::span<const double> time, std::span<const double> log_size);

/// A plane wave as the method sees it. With w̃ the Fourier transform of the kernel and D its second
/// moment, points close together and transfers with an affine field, a passage from the grid to the
/// points and back leaves the share w̃² + |∇w̃|²/D of a velocity, and ∇w̃/D stands for −k in the
/// velocity gradient and in the divergence of stress.
struct SeenWave {
  /// The wave vector that gives the same rates to a continuum, −√share ∇w̃/D [1/m]
  std::array<double, 2> k{};
  /// 1 − share: what a step loses with apic, a relaxation time with relaxed
  double loss = 0.0;
};
SeenWave seen_wave(Kernel kernel, double h, const std::array<double, 2>& k);

}  // namespace repose::mpm

#pragma once
/// \file
/// What a frame carries of the points, by which people colour them.

#include "mpm/step/simulation.hpp"

namespace repose::mpm {

/// Turns snapshots of a run into frames. What a law or a scene does not have is left out; where
/// only some of the bodies have it, the points of the others get NaN, which ParaView draws in a
/// colour of its own.
class FrameFields {
 public:
  /// Remembers where the points are and how dense. `start` has made no step.
  explicit FrameFields(const Simulation& start);

  /// The snapshot's own fields (Snapshot::view()) and:
  ///   shear_rate_per_s    γ̇ = √(2D′:D′)
  ///   shear_strain        ∫γ̇ dt, of a scene that keeps it
  ///   volume_strain       ln(ρ/ρ_start), compression positive
  ///   specific_volume     v = ρ_p/ρ, of laws with grains (rho_p)
  ///   inertial_number     I = γ̇ d/√(p/ρ_p), of laws with grains (d, rho_p), under pressure
  ///   state variables of the laws by name and unit, p_c_Pa
  ///   displacement_m      from the start; a periodic edge that was crossed counts as a way back
  ///   point               the number of the point, the same in all frames
  /// Refers to `shot` and to this object, until the next call.
  io::FrameView view(const Simulation::Snapshot& shot, double time_s);

 private:
  struct Grains {
    double d, rho_p;  ///< [m], [kg/m³]; NaN if the law has none
  };
  std::vector<Grains> grains_;               ///< by body
  std::vector<double> x_, y_, z_, density_;  ///< at the start, by point
  std::vector<double> dx_, dy_, dz_;         ///< of the frame
  std::vector<double> volume_strain_, specific_volume_, inertial_number_;
  std::vector<std::int32_t> point_;
};

}  // namespace repose::mpm

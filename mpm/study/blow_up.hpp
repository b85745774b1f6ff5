#pragma once
/// \file
/// The largest stable step, measured: runs with a fixed step and noise of 1e-6 of the wave speed,
/// bisected between steps under which the noise stays and steps under which it grows a
/// thousandfold.

#include "mpm/scene/scene.hpp"

namespace repose::mpm {

/// Where the points are.
enum class Place : std::uint8_t {
  bulk,      ///< everywhere in the box
  surface,   ///< in its lower half
  isolated,  ///< one alone
};
constexpr std::array<std::string_view, 3> place_names{"bulk", "surface", "isolated"};

struct StepTrial {
  Kernel kernel = Kernel::cubic;
  Transfer transfer = Transfer::relaxed;
  int points_per_cell = 4;
  Place place = Place::bulk;
  double offset = 0.5;  ///< of an isolated point, or of the surface's outermost points' cells, in h
  bool solid = false;   ///< neo-Hookean with ν = 0.3; else a fluid that carries tension
};

/// Largest stable Δt c/h, c the wave speed of the material, to 1 %. `relaxed` takes a relaxation
/// time of 3 h/c.
double blow_up_courant(const StepTrial& trial);

/// What theory says: linear stability of the bulk in two directions (1.36 cubic, 1.15 quadratic)
/// and of one point that strains itself (step_size.hpp). NaN for a surface.
double courant_of_theory(const StepTrial& trial);

/// Largest stable Δt of a viscous fluid in the bulk, in units of ρh²/(4η), to 1 %.
double blow_up_viscous(const StepTrial& trial);

/// Whether the same fluid is stable at `times` that unit with implicit viscosity.
bool implicit_viscosity_is_stable(const StepTrial& trial, double times);

}  // namespace repose::mpm

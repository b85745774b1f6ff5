#pragma once
/// \file
/// Bodies of a scene → material points.

#include "mpm/grid/points.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::mpm {

/// The points of a body on a regular lattice (point_spacing()), each at rest in the body's initial
/// state. `first_id` numbers them. Throws InputError with keys relative to the body
/// ("law.kappa", "initial.p").
template <int dim>
PointsOf<dim> fill(const Body& body, const Scene& scene, std::int64_t first_id);

/// Vertical stress at depth z below a free surface under gravity g for a density that depends on
/// pressure, dσ_v/dz = ρ(p) g with p = σ_v(1 + 2K0)/3 [Pa]. `steps` classical Runge–Kutta steps.
double overburden(const Material& material, double ocr, double K0, double g, double z, int steps);

}  // namespace repose::mpm

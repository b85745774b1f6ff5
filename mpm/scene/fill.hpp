#pragma once
/// \file
/// Bodies of a scene → material points.

#include "mpm/grid/points.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::mpm {

/// The points of a body on a regular lattice (point_spacing()), each at rest in the body's initial
/// state. A lithostatic body carries the bodies that stand on it, column by column: what lies above
/// a point without a gap, up to where something rigid begins, each body with its own law, K0 and
/// density. `first_id` numbers them.
/// Throws InputError with keys relative to the body
/// ("law.kappa", "initial.p").
template <int dim>
PointsOf<dim> fill(const Body& body, const Scene& scene, std::int64_t first_id);

/// Adds a point to those of a body, without shear strain. `spin`: angular velocity about z of the
/// velocity gradient it has [rad/s].
template <int dim>
void add_point(PointsOf<dim>& points, const std::array<double, dim>& x,
               const std::array<double, dim>& velocity, double spin, const InitialPoint& at,
               double volume, std::int64_t id);

/// A body's points before there are any: its law, and the fields that its points have.
template <int dim>
PointsOf<dim> without_points(const Body& body, const Scene& scene);

/// Vertical stress at depth z below a free surface under gravity g for a density that depends on
/// pressure, dσ_v/dz = ρ(p) g with p = σ_v(1 + 2K0)/3 [Pa]. `steps` classical Runge–Kutta steps.
/// `above`: σ_v at z = 0, what rests on the surface [Pa].
double overburden(const Material& material, double ocr, double K0, double g, double z, int steps,
                  double above = 0.0);

/// What water takes of the weight of a body below the water table: ρ_w over the density ρ_p of its
/// grains, or over ρ_0 where the law knows none. Throws InputError (key law.name) where it knows
/// neither.
double buoyant_share(const Scene& scene, const Material& material);

}  // namespace repose::mpm

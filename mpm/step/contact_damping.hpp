#pragma once
/// \file
/// What the contacts of grains take from elastic waves (physics.md, DAMP): beside the law's stress
/// acts the viscous one
///     σ_v = (ℓ/c) dσ/dt,   ℓ = √2 ζ d,   ζ = −ln e/√(π² + ln² e)
/// of a chain of grains of diameter d whose contacts are springs with dashpots of restitution e
/// (mpm/scene/restitution.hpp); c is the speed of the law's elastic waves and dσ/dt the objective
/// rate of its stress, which is 0 in steady flow: the flow rule does not know it. After an idea of
/// Chandra, Dunatunga & Kamrin (2026), who derive their viscosity otherwise.

#include "mpm/grid/points.hpp"

namespace repose::mpm {

/// From the stress that the law has left, and what it was before the step: the stress of the
/// explicit forces, and the work ½(σ_v,n + σ_v,n+1):Δε of the damping [J/m³], which `batch.work` is
/// given too. Contacts do not pull: σ_v is cut where the pressure of both together were negative.
template <int dim>
void damp_contacts(PointsOf<dim>& points, const SlotRange& range,
                   const typename PointsOf<dim>::Batch& batch,
                   const std::array<double*, Layout<dim>::components>& before, double* work);

}  // namespace repose::mpm

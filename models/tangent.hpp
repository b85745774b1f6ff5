#pragma once
/// \file
/// The consistent tangent of a batch: how the stress after a step depends on the step's strain.

#include <array>

#include "models/material.hpp"

namespace repose {

/// ∂σ_a/∂Δε_b [a][b] in tensor components (sym.hpp) [Pa]: for b = xy the change with ε_xy and its
/// equal ε_yx together.
template <int N>
using Tangent =
    std::array<std::array<double, static_cast<std::size_t>(N)>, static_cast<std::size_t>(N)>;

/// tangent[(i·N + a)·N + b] = ∂σ_a/∂Δε_b of point i [Pa], with σ what Material::update() would
/// leave and Δε the batch's strain in tensor components (for b = xy it is the change with ε_xy and
/// its equal ε_yx together). The batch is read alone: stress, state and density are as before the
/// step. Laws of the library are differentiated exactly, in dual numbers; others by central
/// differences of their own update over ±1e-7, whose error is 1e-14 of the third derivative and
/// about 1e-9 of the stress by round-off. Reports the first point that cannot be advanced; its
/// tangent is not a number.
UpdateReport consistent_tangent(const Material& material, const Batch& batch, double* tangent);
UpdateReport consistent_tangent(const Material& material, const SpatialBatch& batch,
                                double* tangent);

}  // namespace repose

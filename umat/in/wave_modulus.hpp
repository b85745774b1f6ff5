#pragma once
/// \file
/// How stiff a tangent is to the fastest wave.

namespace repose::umat {

/// An upper bound of ρc² of any plane wave under the tangent DDSDDE (NTENS = N, column by column,
/// symmetric part):
///
///     n⊗n = I/3 + d, |d|² = 2/3:   n⊗n:D:n⊗n <= K + 2/3 √(2/3) |dev(D:I)| + 2/3 λ_max(dev D dev)
///
/// with K = I:D:I/9. Shear waves are slower: their polarisation m⊗n is a deviator of norm 1/√2 in
/// its symmetric part, so ½ λ_max bounds them. For an isotropic tangent it is K + 4/3 G exactly.
/// [Pa]; 0 where the bound is negative.
template <int N>
double wave_modulus(const double* ddsdde);

}  // namespace repose::umat

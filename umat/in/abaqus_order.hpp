#pragma once
/// \file
/// From tensors as repose has them to arrays as Abaqus has them and back. Stress is tension
/// positive on both sides; Abaqus' order is 11, 22, 33, 12, 13, 23, and its shear strains are γ =
/// 2ε.

#include <array>

#include "models/sym.hpp"

namespace repose::umat {

/// Where Abaqus has a component of Sym: yz is 23, zx is 13.
inline constexpr std::array<int, 6> abaqus_place{0, 1, 2, 3, 5, 4};

template <int N>
void put_stress(const Sym<double, N>& stress, double* array) {
  for (int i = 0; i < N; ++i) array[abaqus_place[static_cast<std::size_t>(i)]] = stress[i];
}

template <int N>
Sym<double, N> stress_from(const double* array) {
  Sym<double, N> stress;
  for (int i = 0; i < N; ++i) stress[i] = array[abaqus_place[static_cast<std::size_t>(i)]];
  return stress;
}

template <int N>
void put_strain(const Sym<double, N>& strain, double* array) {
  for (int i = 0; i < N; ++i)
    array[abaqus_place[static_cast<std::size_t>(i)]] = (i < 3 ? 1.0 : 2.0) * strain[i];
}

/// ∂σ_i/∂ε_j by tensor components (ε_xy and ε_yx together count as 2ε_xy = γ), in the order of Sym.
template <int N>
double tangent(const double* ddsdde, int i, int j) {
  const int row = abaqus_place[static_cast<std::size_t>(i)];
  const int column = abaqus_place[static_cast<std::size_t>(j)];
  return (j < 3 ? 1.0 : 2.0) * ddsdde[column * N + row];
}

}  // namespace repose::umat

#pragma once
/// \file
/// What the velocity gradient L of a step does to a point, in the plane and in space.
///
/// The step maps x to x + Δt v(x), whose gradient is I + A, A = Δt L: its logarithm is A − ½A², to
/// third order in Δt. (A alone would make density and strain first order in Δt.) A viscous law
/// takes only the volume from it, and the rest from D = sym L, which is what its stress follows.

#include "mpm/grid/lanes.hpp"
#include "mpm/grid/points.hpp"

namespace repose::mpm {

/// A step's strain (components as in Sym), its rotation vector (about z in the plane) and the
/// determinant of I + A.
template <int dim>
struct StepStrain {
  std::array<Pack, Layout<dim>::components> strain;
  std::array<Pack, dim == 2 ? 1 : 3> spin;
  Pack volume;
};

/// `A`: row by row.
inline StepStrain<2> step_strain(const std::array<Pack, 4>& A, bool follows_rate) {
  const auto& [xx, xy, yx, yy] = A;
  const Pack half(0.5), third(1.0 / 3.0), zero(0.0);
  // −½A²: xx, yy, and what the off-diagonal terms are multiplied by
  Pack c_xx = -half * (xx * xx + xy * yx);
  Pack c_yy = -half * (yy * yy + xy * yx);
  Pack c_zz = zero;  // plane strain: 0 but for shares of a volume strain
  Pack c = -half * (xx + yy);
  if (follows_rate) {  // its volume only, the same in all three directions
    c_xx = c_yy = c_zz = third * (c_xx + c_yy);
    c = zero;
  }
  const Pack share = half * (Pack(1.0) + c);
  return {{xx + c_xx, yy + c_yy, c_zz, share * (xy + yx)},
          {share * (yx - xy)},
          (Pack(1.0) + xx) * (Pack(1.0) + yy) - xy * yx};
}

inline StepStrain<3> step_strain(const std::array<Pack, 9>& A, bool follows_rate) {
  const Pack half(0.5), third(1.0 / 3.0), one(1.0);
  const auto a = [&](std::size_t i, std::size_t j) -> const Pack& { return A[3 * i + j]; };
  std::array<Pack, 9> log = A;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      log[3 * i + j] = a(i, j) - half * (a(i, 0) * a(0, j) + a(i, 1) * a(1, j) + a(i, 2) * a(2, j));
  if (follows_rate) {
    const Pack volume = third * ((log[0] - A[0]) + (log[4] - A[4]) + (log[8] - A[8]));
    log = A;
    for (const std::size_t i : {0U, 4U, 8U}) log[i] = log[i] + volume;
  }
  const auto l = [&](std::size_t i, std::size_t j) -> const Pack& { return log[3 * i + j]; };
  const Pack det = (one + a(0, 0)) * ((one + a(1, 1)) * (one + a(2, 2)) - a(1, 2) * a(2, 1)) -
                   a(0, 1) * (a(1, 0) * (one + a(2, 2)) - a(1, 2) * a(2, 0)) +
                   a(0, 2) * (a(1, 0) * a(2, 1) - (one + a(1, 1)) * a(2, 0));
  return {{l(0, 0), l(1, 1), l(2, 2), half * (l(0, 1) + l(1, 0)), half * (l(1, 2) + l(2, 1)),
           half * (l(2, 0) + l(0, 2))},
          {half * (l(2, 1) - l(1, 2)), half * (l(0, 2) - l(2, 0)), half * (l(1, 0) - l(0, 1))},
          det};
}

/// σ:L of a velocity gradient (row by row) as it is seen from where the step ends: the velocity
/// that moved the point has the gradient L(I + ΔtL)⁻¹ ≈ L − ΔtL² there, of which step_strain()
/// takes the volume alone for a law that follows the rate. T: double or Pack. `stress`: xx, yy, zz,
/// xy.
template <class T>
T stress_power(const std::array<T, 4>& L, const std::array<T, 4>& stress, const T& dt,
               bool follows_rate) {
  const auto& [xx, xy, yx, yy] = L;
  const T third(1.0 / 3.0);
  T c_xx = dt * (xx * xx + xy * yx);
  T c_yy = dt * (yy * yy + xy * yx);
  T c_zz(0.0);
  T c = dt * (xx + yy);
  if (follows_rate) {
    c_xx = c_yy = c_zz = third * (c_xx + c_yy);
    c = T(0.0);
  }
  return stress[0] * (xx - c_xx) + stress[1] * (yy - c_yy) - stress[2] * c_zz +
         stress[3] * (T(1.0) - c) * (xy + yx);
}

/// The same in space; `stress` as in Sym.
template <class T>
T stress_power(const std::array<T, 9>& L, const std::array<T, 6>& stress, const T& dt,
               bool follows_rate) {
  const auto l = [&](std::size_t i, std::size_t j) -> const T& { return L[3 * i + j]; };
  const auto squared = [&](std::size_t i, std::size_t j) {
    return T(l(i, 0) * l(0, j) + l(i, 1) * l(1, j) + l(i, 2) * l(2, j));
  };
  const T power = stress[0] * l(0, 0) + stress[1] * l(1, 1) + stress[2] * l(2, 2) +
                  stress[3] * (l(0, 1) + l(1, 0)) + stress[4] * (l(1, 2) + l(2, 1)) +
                  stress[5] * (l(2, 0) + l(0, 2));
  if (follows_rate) {
    const T third(1.0 / 3.0);
    return power - dt * third * (squared(0, 0) + squared(1, 1) + squared(2, 2)) *
                       (stress[0] + stress[1] + stress[2]);
  }
  return power - dt * (stress[0] * squared(0, 0) + stress[1] * squared(1, 1) +
                       stress[2] * squared(2, 2) + stress[3] * (squared(0, 1) + squared(1, 0)) +
                       stress[4] * (squared(1, 2) + squared(2, 1)) +
                       stress[5] * (squared(2, 0) + squared(0, 2)));
}

}  // namespace repose::mpm

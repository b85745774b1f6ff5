#pragma once
/// \file
/// From what a scene says at run time to what the transfers want to know when they are compiled.

#include <type_traits>

#include "mpm/grid/kernel.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::mpm {

/// Calls f with the interpolation functions of a scene, and with whether points hand on an affine
/// velocity and whether pressures are averaged (in the plane) as constants, all chosen at run time.
template <int dim, class F>
void choose(const Scene& scene, bool affine, bool averages, F&& f) {
  using Yes = std::true_type;
  using No = std::false_type;
  const auto with = [&](auto kernel, auto is_affine) {
    if constexpr (dim == 2) {
      if (averages) return f(kernel, is_affine, Yes{});
    }
    f(kernel, is_affine, No{});
  };
  const auto with_either = [&](auto kernel) { affine ? with(kernel, Yes{}) : with(kernel, No{}); };
  const bool cubic = scene.kernel == Kernel::cubic;
  if (scene.transfer == Transfer::tpic)  // always affine
    cubic ? with(SplineGradient<CubicKernel>{}, Yes{})
          : with(SplineGradient<QuadraticKernel>{}, Yes{});
  else
    cubic ? with_either(CubicKernel{}) : with_either(QuadraticKernel{});
}

}  // namespace repose::mpm

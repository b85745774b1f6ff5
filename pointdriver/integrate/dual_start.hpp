#pragma once
/// \file
/// An element's start with derivatives with respect to parameters.

#include "pointdriver/integrate/start.hpp"

namespace repose::point {

/// Everything that depends on the parameters before the first step, in one row: the completed
/// parameters, stress and state, density.
template <class L>
std::vector<double> flat_start(std::span<const double> theta, const PointTest& test) {
  std::vector<double> flat = completed<L>(theta);
  const ElementStart<L, double> start = plain_start<L>(theta, test);
  flat.insert(flat.end(), start.stress_and_state.begin(), start.stress_and_state.end());
  flat.push_back(start.density);
  return flat;
}

/// d flat_start/dθ_i by central differences with two steps, extrapolated (error O(h⁴), h = 1e-3 of
/// the value: about 1e-12 and 1e-13 of round-off). Throws InputError where the law cannot start
/// beside the given values.
template <class L>
std::vector<double> flat_derivative(std::span<const double> theta, int parameter,
                                    const PointTest& test) {
  std::vector<double> moved(theta.begin(), theta.end());
  double& x = moved[static_cast<std::size_t>(parameter)];
  const double at = x;
  const double h = at == 0.0 ? 1e-3 : 1e-3 * std::abs(at);
  const auto difference = [&](double step) {
    x = at + step;
    std::vector<double> up = flat_start<L>(moved, test);
    x = at - step;
    const std::vector<double> down = flat_start<L>(moved, test);
    for (std::size_t i = 0; i < up.size(); ++i)
      up[i] = up[i] == down[i] ? 0.0 : (up[i] - down[i]) / (2.0 * step);
    return up;
  };
  const std::vector<double> coarse = difference(h);
  std::vector<double> fine = difference(0.5 * h);
  for (std::size_t i = 0; i < fine.size(); ++i) fine[i] = (4.0 * fine[i] - coarse[i]) / 3.0;
  return fine;
}

/// The start with the derivatives of `which` in the dual parts. Throws InputError.
template <class L, class T>
ElementStart<L, T> dual_start(std::span<const double> theta, std::span<const int> which,
                              const PointTest& test) {
  const std::vector<double> flat = flat_start<L>(theta, test);
  std::vector<T> lifted(flat.begin(), flat.end());
  for (std::size_t j = 0; j < which.size(); ++j) {
    const std::vector<double> slope = flat_derivative<L>(theta, which[j], test);
    for (std::size_t i = 0; i < flat.size(); ++i) {
      double d = slope[i];
      // of the parameter itself the derivative is 1, not nearly 1; absent parameters have none
      if (i < theta.size() && static_cast<int>(i) == which[j]) d = 1.0;
      if (std::isnan(flat[i])) d = 0.0;
      lifted[i].v[static_cast<int>(j)] = d;
    }
  }
  ElementStart<L, T> start;
  const std::size_t n = theta.size();
  start.parameters = L::template Params<T>::from(std::span<const T>(lifted.data(), n));
  start.plain = L::template Params<double>::from(std::span<const double>(flat.data(), n));
  for (std::size_t i = 0; i < start.stress_and_state.size(); ++i)
    start.stress_and_state[i] = lifted[n + i];
  start.density = lifted.back();
  return start;
}

}  // namespace repose::point

#pragma once
/// \file
/// An element's start with derivatives with respect to parameters.

#include "pointdriver/integrate/start.hpp"

namespace repose::point {

/// d start(θ)/dθ_i, where start(θ) gives everything that a path starts from in one row
/// (flat_start), by central differences with two steps, extrapolated (error O(h⁴), h = 1e-3 of the
/// value: about 1e-12 and 1e-13 of round-off). Throws InputError where the law cannot start beside
/// the given values.
template <class Start>
std::vector<double> flat_derivative(const Start& start, std::span<const double> theta,
                                    int parameter) {
  std::vector<double> moved(theta.begin(), theta.end());
  double& x = moved[static_cast<std::size_t>(parameter)];
  const double at = x;
  const double h = at == 0.0 ? 1e-3 : 1e-3 * std::abs(at);
  const auto difference = [&](double step) {
    x = at + step;
    std::vector<double> up = start(moved);
    x = at - step;
    const std::vector<double> down = start(moved);
    for (std::size_t i = 0; i < up.size(); ++i)
      up[i] = up[i] == down[i] ? 0.0 : (up[i] - down[i]) / (2.0 * step);
    return up;
  };
  const std::vector<double> coarse = difference(h);
  std::vector<double> fine = difference(0.5 * h);
  for (std::size_t i = 0; i < fine.size(); ++i) fine[i] = (4.0 * fine[i] - coarse[i]) / 3.0;
  return fine;
}

/// The slopes of the numbers `flat` with respect to parameter `which`: of the parameter itself 1,
/// not nearly 1, and 0 of those that are absent.
template <class Start>
std::vector<double> flat_slope(const Start& start, std::span<const double> theta, int which,
                               std::span<const double> flat) {
  std::vector<double> slope = flat_derivative(start, theta, which);
  slope[static_cast<std::size_t>(which)] = 1.0;
  for (std::size_t i = 0; i < flat.size(); ++i)
    if (std::isnan(flat[i])) slope[i] = 0.0;
  return slope;
}

/// The start with the derivatives of `which` in the dual parts. Throws InputError.
template <class L, class T>
ElementStart<L, T> dual_start(std::span<const double> theta, std::span<const int> which,
                              const PointTest& test) {
  const auto start_at = [&](std::span<const double> at) { return flat_start<L>(at, test); };
  const std::vector<double> flat = start_at(theta);
  std::vector<T> lifted(flat.begin(), flat.end());
  for (std::size_t j = 0; j < which.size(); ++j) {
    const std::vector<double> slope = flat_slope(start_at, theta, which[j], flat);
    for (std::size_t i = 0; i < flat.size(); ++i) lifted[i].v[static_cast<int>(j)] = slope[i];
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

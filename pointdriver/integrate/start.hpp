#pragma once
/// \file
/// From a parameter vector and initial conditions to an element ready to be driven, in plain
/// numbers or with derivatives.

#include "models/dual.hpp"
#include "pointdriver/integrate/drive.hpp"
#include "pointdriver/integrate/simulate.hpp"

namespace repose::point {

/// Parameters with derived ones filled in. Throws InputError.
template <class L>
std::vector<double> completed(std::span<const double> theta) {
  std::vector<double> full(theta.begin(), theta.end());
  for (const double x : theta)
    if (std::isnan(x)) {
      L::complete(full);
      break;
    }
  return full;
}

/// Throws InputError where the law cannot start from the conditions.
template <class L>
ElementStart<L, double> plain_start(std::span<const double> theta, const PointTest& test) {
  ElementStart<L, double> start;
  bool complete = true;
  for (const double x : theta) complete = complete && !std::isnan(x);
  if (complete) {
    start.plain = L::template Params<double>::from(theta);
  } else {
    const std::vector<double> full = completed<L>(theta);
    start.plain = L::template Params<double>::from(std::span<const double>(full));
  }
  start.parameters = start.plain;
  const InitialPoint point = L::initial(start.plain, test.initial);
  for (std::size_t i = 0; i < 6; ++i) start.stress_and_state[i] = point.stress.c[i];
  for (std::size_t i = 0; i < L::state.size(); ++i) start.stress_and_state[6 + i] = point.state[i];
  start.density = point.density;
  return start;
}

/// What a claim says of a start under this stress (tension positive): Σ stress_i σ_i.
inline double claimed_quantity(const StartClaim& claim, std::span<const double> stress) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 6; ++i) sum += claim.of.stress[i] * (i < 3 ? -stress[i] : stress[i]);
  return sum;
}

/// The first claim about the start that this initial stress contradicts; nullptr if none.
inline const StartClaim* contradicted(const Path& path, std::span<const double> stress) {
  for (const StartClaim& claim : path.start_claims)
    if (!(std::abs(claimed_quantity(claim, stress) - claim.value) <= claim.tolerance))
      return &claim;
  return nullptr;
}

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

/// Does the initial stress suit the path?
inline bool suits(const Path& path, std::span<const double> stress) {
  if (contradicted(path, stress) != nullptr) return false;
  if (!path.needs_axisymmetry) return true;
  double size = 0.0;
  for (std::size_t i = 0; i < 6; ++i) size = std::max(size, std::abs(stress[i]));
  const double limit = 1e-9 * size;
  return std::abs(stress[0] - stress[2]) <= limit && std::abs(stress[3]) <= limit &&
         std::abs(stress[4]) <= limit && std::abs(stress[5]) <= limit;
}

}  // namespace repose::point

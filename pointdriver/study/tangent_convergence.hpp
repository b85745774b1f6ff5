#pragma once
/// \file
/// Is the tangent of a law's update the derivative of that update? Taylor's remainder says.

#include "models/registry.hpp"

namespace repose::point {

/// |σ(ε + h d) − σ(ε) − h C:d| over |C:d| times the size of the step: of second order in h as long
/// as C = ∂σ/∂ε is the derivative of the very update, of first order otherwise.
struct TangentPoint {
  double h;          ///< perturbation over the step itself [-]
  double remainder;  ///< [-]
};

struct TangentTest {
  std::string name;                  ///< of the law and its form
  std::vector<TangentPoint> points;  ///< h from 0.1 down to 1e-6, ten per two decades
  double order;  ///< slope between the largest h and the last where round-off is below 1 %
};

/// For every law, with the parameters of the shipped scenes or of London clay: one step from rest
/// well into yield (or flow), then Taylor's remainder in a direction that has all six components.
/// The tangent C is the one that the implicit integrator solves with, by dual numbers.
std::vector<TangentTest> tangent_convergence();

}  // namespace repose::point

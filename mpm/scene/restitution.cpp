#include "mpm/scene/restitution.hpp"

#include <cmath>
#include <numbers>

namespace repose::mpm {

double damping_ratio(double restitution) {
  const double ln_e = std::log(restitution);
  return -ln_e / std::hypot(std::numbers::pi, ln_e);
}

double damping_length(double restitution, double grain_diameter) {
  return std::numbers::sqrt2 * damping_ratio(restitution) * grain_diameter;
}

double damped_signal(double damping_length, double h) {
  constexpr double highest_frequency = 2.44;  // in c/h
  const double xi = 0.5 * highest_frequency * damping_length / h;
  return std::hypot(1.0, xi) + xi;
}

}  // namespace repose::mpm

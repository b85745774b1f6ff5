#pragma once

namespace repose::mpm {

/// The fastest signals among a set of points.
struct Signals {
  double speed = 0.0;         ///< max |v| [m/s]
  double signal = 0.0;        ///< max (c + |v|) [m/s]
  double viscous_rate = 0.0;  ///< max 4η/(ρh²) [1/s]; its inverse bounds an explicit viscosity

  /// A NaN stays one.
  void include(const Signals& other) {
    const auto larger = [](double x, double y) { return y > x || y != y ? y : x; };
    speed = larger(speed, other.speed);
    signal = larger(signal, other.signal);
    viscous_rate = larger(viscous_rate, other.viscous_rate);
  }
};

}  // namespace repose::mpm

#pragma once
/// \file
/// What a program may prescribe beyond a scene: initial velocities and a body acceleration as
/// functions of the place that a point had at the start, for problems with manufactured solutions,
/// and a law of its own.

#include <array>
#include <functional>
#include <memory>
#include <span>

namespace repose {
class Material;
}

namespace repose::mpm {

/// The motion of a point at t = 0.
struct PointMotion {
  std::array<double, 2> velocity{};  ///< [m/s]
  std::array<double, 4> gradient{};  ///< ∂v_x/∂x, ∂v_x/∂y, ∂v_y/∂x, ∂v_y/∂y [1/s]
};

/// Each may be empty. None is part of a checkpoint: a program that resumes a run
/// gives them again.
struct Prescribed {
  /// The motion of the point filled at (X, Y) [m], instead of its body's velocity and spin.
  std::function<PointMotion(double X, double Y)> start;
  /// Adds to (ax, ay) [m/s²] the acceleration, beside gravity, at time t [s] of the points that
  /// started at (X[k], Y[k]). Called once or twice per block and body in a step, from several
  /// threads at a time. Its work is not part of the energy ledger and appears in its residual.
  std::function<void(double t, std::span<const double> X, std::span<const double> Y,
                     std::span<double> ax, std::span<double> ay)>
      acceleration;
  /// Takes the place of every body's law after it has set up the points, whose state it must share:
  /// for a law that is in no scene file, such as one that shows how another fails.
  std::shared_ptr<const Material> material;
};

}  // namespace repose::mpm

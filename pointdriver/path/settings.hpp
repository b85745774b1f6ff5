#pragma once
/// \file
/// How a path is integrated.

#include <cstdint>
#include <string_view>

namespace repose::point {

enum class Method : std::uint8_t {
  automatic,  ///< adaptive; cvode (BDF) for rate-dependent laws, implicit without stress memory
  adaptive,   ///< Dormand-Prince 5(4) on the rate, yield located, drift removed
  implicit,   ///< the law's own stress update, Newton on the mixed control; first order
  cvode,      ///< SUNDIALS CVODE(S), root finding at yield and restart
  ida,        ///< SUNDIALS IDA, algebraic strain rates
  arkode,     ///< SUNDIALS ARKODE, diagonally implicit Runge-Kutta; its error estimate multiplies
              ///< round-off by stiffness × step, so very slow flow is for cvode
};

struct Settings {
  Method method = Method::automatic;
  double tolerance = 1e-8;     ///< relative, per step
  int substeps = 10;           ///< implicit: steps per row of output
  long max_steps = 1000000;    ///< per leg
  double max_strain = 10.0;    ///< a path beyond this has run away
  bool energy = true;          ///< integrate work and dissipation along
  bool check_tangent = false;  ///< of a foreign law: count the steps whose tangent is off (Counts)
};

}  // namespace repose::point

#include "models/cone.hpp"

#include <cmath>
#include <numbers>

namespace repose::cone {

double slope_of_angle(double phi_deg) {
  const double sine = std::sin(phi_deg * std::numbers::pi / 180.0);
  return 6.0 * sine / (3.0 - sine);
}

double friction_of_angle(double phi_deg) { return slope_of_angle(phi_deg) / std::sqrt(3.0); }

void check(double shape_given, double mu_0) {
  if (!is_circle(shape_given) && !(std::sqrt(3.0) * mu_0 < 3.0))
    throw InputError("mu_0",
                     "mu_0 must be < sqrt(3) with shape = \"matsuoka_nakai\", where it is the "
                     "friction of triaxial compression: no friction angle has more");
}

}  // namespace repose::cone

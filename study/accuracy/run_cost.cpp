#include "study/accuracy/run_cost.hpp"

#include <algorithm>
#include <cmath>

namespace repose::study {

double seconds_with(const EstimatedCost& estimated, double h, double courant) {
  const double finer = estimated.h / h;
  const double then = std::min(estimated.wave_dt_s, estimated.viscous_dt_s);
  const double now =
      std::min(courant * estimated.wave_dt_s / finer, estimated.viscous_dt_s / (finer * finer));
  return estimated.seconds * std::pow(finer, static_cast<double>(estimated.dimensions)) * then /
         now;
}

}  // namespace repose::study

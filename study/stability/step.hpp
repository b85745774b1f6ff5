#pragma once
/// \file
/// The largest stable step, measured, against theory.

#include "mpm/study/blow_up.hpp"
#include "study/stability/part.hpp"

namespace repose::study {

/// Largest stable Courant numbers of points in a box, over points per cell.
struct StepsInABox {
  mpm::Place place;
  mpm::Kernel kernel;
  std::vector<double> counts;
  struct Curve {
    mpm::Transfer transfer;
    std::vector<double> measured;
  };
  std::vector<Curve> curves;
  double theory;  ///< of the bulk
};
/// The same of an isolated point, over where in its cell it lies [h].
struct StepsAlone {
  mpm::Kernel kernel;
  bool solid;
  std::vector<double> offsets;
  std::vector<StepsInABox::Curve> curves;
  double theory;
};

struct StepMaps : PartMaps {
  std::vector<StepsInABox> in_a_box;
  std::vector<StepsAlone> alone;                  ///< of every kernel the fluid, then the solid
  double least_in_bulk = 0.0, least_alone = 0.0;  ///< Courant numbers, cubic
};

/// Table step_limits.
StepMaps map_step(const input::StabilityInput& input);

/// What is said of the maps, one line.
std::string words_of(const StepMaps& maps);

}  // namespace repose::study

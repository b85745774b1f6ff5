#pragma once
/// \file
/// Maps of modified Cam-Clay's update: single steps and paths, exact and linearised.

#include "pointdriver/study/clay_maps.hpp"
#include "study/stability/part.hpp"

namespace repose::study {

inline constexpr std::array clay_updates{point::ClayUpdate::exact, point::ClayUpdate::linearised};
/// "exact", "linearised".
std::string name_of(point::ClayUpdate update);

/// One step in compression and shear by each of several strains, from the yield surface.
struct ClaySweep {
  double kappa;
  point::ClayUpdate update;
  std::vector<double> strain;  ///< Δε_v/κ
  std::vector<double> error;   ///< relative, of the stress; NaN where the update has no result
};

/// A path in equal steps: outcome of every overconsolidation ratio and number of steps.
struct ClayPath {
  std::string title;
  point::ClayUpdate update;
  std::vector<double> ocr, steps;
  std::vector<point::ClayOutcome> outcomes;
};

struct ClayMaps : PartMaps {
  double kappa = 0.0;  ///< dε_v/d ln p of a swelling line at the maps' pressure
  std::vector<point::ClayStart> starts;
  std::size_t cells_across = 0;  ///< of the map of steps, which is square
  std::vector<point::ClayCell> steps;
  std::vector<ClaySweep> sweeps;
  std::vector<ClayPath> paths;
  double most_steps = 0.0;  ///< of a path
};

/// Tables clay_steps, clay_kappa, clay_paths. Throws InputError.
ClayMaps map_clay(const input::StabilityInput& input);

/// What is said of the maps, one line.
std::string words_of(const ClayMaps& maps);

}  // namespace repose::study

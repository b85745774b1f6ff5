#pragma once
/// \file
/// The failures that published runs show, on purpose, beside the runs that mend them.

#include <functional>

#include "mpm/output/history.hpp"
#include "study/stability/part.hpp"

namespace repose::study {

/// A run of Cam-Clay with one update; the linearised one loses points.
struct ClayCollapse {
  std::string key;  ///< "flat", "tilted"
  double tilt_deg, dt;
  bool linearised;
  mpm::History history;
};
/// A run of μ(I), which should come to rest.
struct GrainCollapse {
  std::string key, title;
  mpm::History history;
};

struct CollapseMaps : PartMaps {
  double h = 0.0;                  ///< [m]
  std::vector<ClayCollapse> clay;  ///< of every case the linearised update, then the exact one
  std::vector<GrainCollapse> grains;
};

/// Hears of every run when it has ended: they take a while.
struct CollapseObserver {
  std::function<void(const ClayCollapse&)> clay;
  std::function<void(const GrainCollapse&)> grains;
};

/// Table collapse.
CollapseMaps map_collapse(const input::StabilityInput& input, const CollapseObserver& observer);

/// What is said of a run, one line.
std::string words_of(const ClayCollapse& run);
std::string words_of(const GrainCollapse& run);

}  // namespace repose::study

#pragma once
/// \file
/// Cell crossing, numerical fracture, locking and ringing as numbers.

#include "study/stability/part.hpp"

namespace repose::study {

/// A figure of a discretisation over points per cell.
struct FailureCurve {
  mpm::Kernel kernel;
  mpm::Transfer transfer;
  std::vector<double> counts, values;
};
/// The bulge of a block under its weight over the cells across it.
struct LockingCurve {
  double nu;
  std::vector<double> cells, over_finest;
};
/// Noise of the pressure at rest over points per cell.
struct RingingCurve {
  double h;  ///< [m]
  std::vector<double> counts, percent;
};

struct FailureMaps : PartMaps {
  std::vector<FailureCurve> cell_crossing;  ///< rms error of the density, stretched by half
  std::vector<FailureCurve> fracture;       ///< stretch at which the density is off by 10 %
  std::vector<LockingCurve> locking;
  std::vector<RingingCurve> ringing;
};

/// Table mpm_failures.
FailureMaps map_mpm(const input::StabilityInput& input);

}  // namespace repose::study

#pragma once
/// \file
/// A whole run kept as a few columns, for comparing runs that are meant to differ or to fail.

#include <functional>

#include "mpm/step/simulation.hpp"

namespace repose::mpm {

struct History {
  std::vector<SeriesRow> rows;  ///< evenly spaced in time, the first and the last moment included
  std::string failure;          ///< what stopped the run before its end; "" if nothing did
};

/// Runs a scene on one thread. `at_row`, if given, sees the simulation at every row.
History record(const Scene& scene, const Prescribed& prescribed, int rows,
               const std::function<void(const Simulation&)>& at_row = {});

}  // namespace repose::mpm

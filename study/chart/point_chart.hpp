#pragma once
/// \file
/// The tables of `repose chart point`, and its maps of the error of one stress update.

#include <string>
#include <vector>

#include "pointdriver/study/tangent_convergence.hpp"
#include "pointdriver/study/work_precision.hpp"

namespace repose::study {

/// Errors of one update over (Δε_v, Δε_q) from one start.
struct ErrorMap {
  std::string name;
  std::vector<point::StepError> cells;
};
/// London clay from four starts, `cells` × `cells` increments each.
std::vector<ErrorMap> error_maps(int cells);

/// chart.csv: a row per path, method and setting.
std::string work_csv(const std::vector<point::WorkPoint>& points);
/// error_map.csv: a row per start and increment.
std::string error_map_csv(const std::vector<ErrorMap>& maps);
/// tangent.csv: a row per law and perturbation.
std::string tangent_csv(const std::vector<point::TangentTest>& tests);

}  // namespace repose::study

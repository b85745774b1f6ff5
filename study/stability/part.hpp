#pragma once
/// \file
/// The parts of `repose stability`: what every one of them gives, and what they share.

#include <string>
#include <vector>

#include "input/read_stability.hpp"
#include "io/json.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::study {

/// A table and the name that it has as a file, without ".csv"; its picture has the same.
struct MapTable {
  std::string name, csv;
};

/// What every part gives; each adds what its pictures need.
struct PartMaps {
  std::vector<MapTable> tables;
  io::Json figures;  ///< what summary.json gets under the part's name
};

/// n numbers from `low` to `high`, evenly spaced in the logarithm.
std::vector<double> decades(double low, double high, int n);

/// One of the paper's scenes, "flat_mcc" or "flat_mu_i", with overrides as --set takes them.
mpm::Scene paper_scene(std::string_view name, const std::vector<std::string>& sets);

}  // namespace repose::study

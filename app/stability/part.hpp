#pragma once
/// \file
/// The parts of `repose stability`: each calls the library, writes its tables and pictures, and
/// returns the figures that summary.json gets under its name.

#include <nlohmann/json_fwd.hpp>

#include "app/plot/figure.hpp"
#include "app/result_folder.hpp"
#include "app/stability/read_stability.hpp"
#include "mpm/scene.hpp"

namespace repose::app {

/// Where a part writes to, and what it has written.
class PartOutput {
 public:
  PartOutput(const ResultFolder& folder, bool quiet) : folder_(&folder), quiet_(quiet) {}
  void table(const std::string& name, const std::string& csv);
  /// A picture that cannot be drawn is a warning.
  void picture(const std::string& name, const Figure& figure);
  /// One line on the terminal.
  void tell(const std::string& line) const;
  const std::vector<std::string>& files() const { return files_; }

 private:
  const ResultFolder* folder_;
  bool quiet_;
  std::vector<std::string> files_;
};

nlohmann::ordered_json map_clay(const StabilityInput& input, PartOutput& out);
nlohmann::ordered_json map_mu_i(const StabilityInput& input, PartOutput& out);
/// Of map_mu_i: the same growth measured with the Material Point Method.
nlohmann::ordered_json shear_cell(const StabilityInput& input, PartOutput& out);
nlohmann::ordered_json map_step(const StabilityInput& input, PartOutput& out);
nlohmann::ordered_json map_mpm(const StabilityInput& input, PartOutput& out);
nlohmann::ordered_json map_collapse(const StabilityInput& input, PartOutput& out);

/// n numbers from `low` to `high`, evenly spaced in the logarithm.
std::vector<double> decades(double low, double high, int n);

/// One of the paper's scenes, "flat_mcc" or "flat_mu_i", with overrides as --set takes them.
mpm::Scene paper_scene(std::string_view name, const std::vector<std::string>& sets);

}  // namespace repose::app

#pragma once
/// \file
/// The parts of `repose stability`: each calls the library, writes its tables and pictures, and
/// returns the figures that summary.json gets under its name.

#include <nlohmann/json_fwd.hpp>

#include "input/read_stability.hpp"
#include "io/result_folder.hpp"
#include "mpm/scene/scene.hpp"
#include "report/plot/figure.hpp"

namespace repose::report {

/// Where a part writes to, and what it has written.
class PartOutput {
 public:
  PartOutput(const io::ResultFolder& folder, bool quiet, bool plot = true)
      : folder_(&folder),
        quiet_(quiet),
        plot_(plot) {}
  void table(const std::string& name, const std::string& csv);
  /// A picture that cannot be drawn is a warning.
  void picture(const std::string& name, const Figure& figure);
  /// One line on the terminal.
  void tell(const std::string& line) const;
  const std::vector<std::string>& files() const { return files_; }

 private:
  const io::ResultFolder* folder_;
  bool quiet_, plot_;
  std::vector<std::string> files_;
};

nlohmann::ordered_json map_clay(const input::StabilityInput& input, PartOutput& out);
nlohmann::ordered_json map_mu_i(const input::StabilityInput& input, PartOutput& out);
/// Of map_mu_i: the same growth measured with the Material Point Method.
nlohmann::ordered_json shear_cell(const input::StabilityInput& input, PartOutput& out);
nlohmann::ordered_json map_step(const input::StabilityInput& input, PartOutput& out);
nlohmann::ordered_json map_mpm(const input::StabilityInput& input, PartOutput& out);
nlohmann::ordered_json map_collapse(const input::StabilityInput& input, PartOutput& out);

/// n numbers from `low` to `high`, evenly spaced in the logarithm.
std::vector<double> decades(double low, double high, int n);

/// One of the paper's scenes, "flat_mcc" or "flat_mu_i", with overrides as --set takes them.
mpm::Scene paper_scene(std::string_view name, const std::vector<std::string>& sets);

}  // namespace repose::report

#include "input/doubts.hpp"

#include <cmath>

#include <fmt/core.h>

#include "pointdriver/path/curve.hpp"

namespace repose::input {

std::vector<std::string> doubts(const LawInfo& law, std::span<const double> theta,
                                const InitialConditions& initial) {
  std::vector<std::string> found;
  const auto parameter = [&](std::string_view name) {
    const int i = point::parameter_index(law.parameters, name);
    return i < 0 ? std::nan("") : theta[static_cast<std::size_t>(i)];
  };
  const double d = parameter("d"), rho_p = parameter("rho_p"), rho_0 = parameter("rho_0");
  if (d > 0.1)
    found.push_back(
        fmt::format("law.d = {:g} m: grains larger than 0.1 m are rare; if {:g} mm is "
                    "meant, write {:g}",
                    d, d, 1e-3 * d));
  if (rho_p < rho_0)
    found.push_back(
        fmt::format("law.rho_p = {:g} kg/m³ is less than rho_0 = {:g} kg/m³: grains are "
                    "denser than their packing",
                    rho_p, rho_0));
  // clays are tested from about 1 kPa; a deposit that collapses under its own weight starts lower
  std::optional<double> p = initial.p;
  const char* key = "p";
  if (initial.sigma_v) {
    p = initial.sigma_v;
    key = "sigma_v";
  } else if (initial.sigma) {
    p = ((*initial.sigma)[0] + (*initial.sigma)[1] + (*initial.sigma)[2]) / 3.0;
    key = "sigma: p";
  }
  if (law.name == "modified_cam_clay" && p && *p > 0.0 && *p < 1e3)
    found.push_back(
        fmt::format("initial.{} = {:g} Pa is {:g} kPa, and published tests start at 1 "
                    "kPa and more; if {:g} kPa is meant, write {:g}e3",
                    key, *p, 1e-3 * *p, *p, *p));
  return found;
}

}  // namespace repose::input

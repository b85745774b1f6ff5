#include "report/picture/fit_axes.hpp"

#include <array>

#include <fmt/core.h>

namespace repose::report {

std::pair<std::string, double> column_label(const std::string& column, const std::string& strain) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 12> symbols{
      std::pair{"eps_a", "ε_{a}"},
      {"eps_r", "ε_{r}"},
      {"eps_v", "ε_{v}"},
      {"eps_q", "ε_{q}"},
      {"gamma", "γ"},
      {"p", "p′"},
      {"q", "q"},
      {"sigma_a", "σ′_{a}"},
      {"sigma_r", "σ′_{r}"},
      {"tau", "τ"},
      {"mu", "μ"},
      {"shear_rate", "shear rate"}};
  std::string name = column, unit;
  double factor = 1.0;
  if (column.ends_with("_Pa")) {
    name.resize(name.size() - 3);
    unit = "kPa";
    factor = 1e-3;
  } else if (column.starts_with("eps_") || column == "gamma") {
    unit = column == "gamma" || strain.empty() ? "%" : strain + ", %";
    factor = 100.0;
  } else if (column.ends_with("_per_s")) {
    name.resize(name.size() - 6);
    unit = "1/s";
  } else if (const auto at = column.rfind('_'); at != std::string::npos && column != "rho_0") {
    name.resize(at);
    unit = column.substr(at + 1);
  }
  for (const auto& [plain, symbol] : symbols)
    if (name == plain) {
      name = symbol;
      break;
    }
  return {unit.empty() ? name : fmt::format("{} ({})", name, unit), factor};
}

AxisScale scale_over(const calibration::Target& target) {
  const std::string& x = target.x_name;
  const bool even = x.starts_with("eps_") || x == "time_s" || x == "x_m";
  const double low = target.x.minCoeff(), high = target.x.maxCoeff();
  return !even && low > 0.0 && high > 8.0 * low ? AxisScale::logarithmic : AxisScale::linear;
}

std::vector<double> scaled(const Eigen::VectorXd& v, double factor) {
  std::vector<double> out(v.begin(), v.end());
  for (double& x : out) x *= factor;
  return out;
}

}  // namespace repose::report

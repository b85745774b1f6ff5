#include "pointdriver/path/curve.hpp"

#include <algorithm>

namespace repose::point {
namespace {
constexpr std::array<std::string_view, quantity_count> names{"time_s",
                                                             "eps_a",
                                                             "eps_r",
                                                             "eps_v",
                                                             "eps_q",
                                                             "gamma",
                                                             "p_Pa",
                                                             "q_Pa",
                                                             "eta",
                                                             "sigma_a_Pa",
                                                             "sigma_r_Pa",
                                                             "tau_Pa",
                                                             "u_Pa",
                                                             "v",
                                                             "p_c_Pa",
                                                             "I",
                                                             "mu",
                                                             "density_kg_per_m3",
                                                             "shear_rate_per_s"};
}

std::string_view name_of(StrainMeasure measure) {
  return measure == StrainMeasure::logarithmic ? "logarithmic" : "engineering";
}

double logarithmic_strain(Quantity quantity, double engineering) {
  if (quantity != Quantity::eps_a && quantity != Quantity::eps_r && quantity != Quantity::eps_v)
    return engineering;
  return engineering < 1.0 ? -std::log1p(-engineering) : std::numeric_limits<double>::quiet_NaN();
}

std::string_view column_name(Quantity quantity) {
  return names[static_cast<std::size_t>(quantity)];
}

std::optional<Quantity> find_quantity(std::string_view column) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string_view full = names[i];
    if (column == full) return static_cast<Quantity>(i);
    for (const std::string_view unit : {"_Pa", "_kg_per_m3", "_per_s", "_s"})
      if (full.ends_with(unit) && column == full.substr(0, full.size() - unit.size()))
        return static_cast<Quantity>(i);
  }
  return std::nullopt;
}

int parameter_index(std::span<const ParamInfo> table, std::string_view name) {
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table[i].name == name) return static_cast<int>(i);
  return -1;
}

int variable_index(std::span<const StateField> state, std::span<const StateField> derived,
                   std::string_view name) {
  for (std::size_t i = 0; i < std::min(state.size(), max_state); ++i)
    if (state[i].name == name) return static_cast<int>(i);
  for (std::size_t i = 0; state.size() + i < max_state && i < derived.size(); ++i)
    if (derived[i].name == name) return static_cast<int>(state.size() + i);
  return -1;
}

}  // namespace repose::point

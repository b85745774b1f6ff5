#include "umat/out/constants.hpp"

#include "models/registry.hpp"
#include "umat/out/material_name.hpp"

namespace repose::umat {

std::span<const StartConstant> start_constants(const LawInfo& law) {
  static constexpr std::array<StartConstant, 2> constants{{
      {"ocr", "-", ">= 1",
       "p_c/p at the start (absent: from v, or of the yield surface through the stress)"},
      {"v", "-", "> 1", "specific volume at the start (absent: on the law's own lines)"},
  }};
  if (law.state.empty()) return {};
  return constants;
}

bool zero_is_absent(const ParamInfo& parameter) { return !parameter.range.contains(0.0); }

Constants read_constants(const LawInfo& law, std::span<const double> props) {
  const std::size_t count = law.parameters.size();
  const std::span<const StartConstant> after = start_constants(law);
  if (props.size() > count + after.size())
    throw InputError("PROPS", material_name(law) + " takes at most " +
                                  std::to_string(count + after.size()) + " constants, its " +
                                  std::to_string(count) + " parameters" +
                                  (after.empty() ? "" : ", ocr and v") + ", and has " +
                                  std::to_string(props.size()));
  LawSpec spec{std::string(law.name), {}, {}};
  if (!law.option_key.empty()) spec.options[std::string(law.option_key)] = law.option;
  for (std::size_t i = 0; i < std::min(count, props.size()); ++i) {
    const ParamInfo& parameter = law.parameters[i];
    if (props[i] == 0.0 && zero_is_absent(parameter)) continue;
    spec.values[std::string(parameter.name)] = props[i];
  }
  Constants constants{checked_parameters(spec), {}};
  const auto start = [&](std::size_t i) -> std::optional<double> {
    if (count + i >= props.size() || props[count + i] == 0.0) return {};
    return props[count + i];
  };
  constants.start.ocr = start(0);
  constants.start.v = start(1);
  return constants;
}

std::string place_of(const LawInfo& law, std::string_view key) {
  const auto place = [&](std::size_t i) {
    return "PROPS(" + std::to_string(i + 1) + "), " + std::string(key);
  };
  for (std::size_t i = 0; i < law.parameters.size(); ++i)
    if (law.parameters[i].name == key) return place(i);
  const std::span<const StartConstant> after = start_constants(law);
  for (std::size_t i = 0; i < after.size(); ++i)
    if (after[i].name == key) return place(law.parameters.size() + i);
  return "";
}

}  // namespace repose::umat

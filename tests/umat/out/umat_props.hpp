#pragma once
/// \file
/// A parameter set as a host gives it.

#include <string>
#include <vector>

#include "models/registry.hpp"

namespace repose::umat {

/// PROPS: what the set leaves out is 0 where that means so, else its default.
inline std::vector<double> props_of(const LawSpec& spec) {
  std::vector<double> props;
  for (const ParamInfo& parameter : find_law(spec).parameters) {
    const auto given = spec.values.find(std::string(parameter.name));
    const bool zero_is_a_value = parameter.need == Need::defaulted && parameter.range.contains(0.0);
    props.push_back(given != spec.values.end() ? given->second
                    : zero_is_a_value          ? parameter.value
                                               : 0.0);
  }
  return props;
}

}  // namespace repose::umat

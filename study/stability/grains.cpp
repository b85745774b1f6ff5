#include "study/stability/grains.hpp"

#include <algorithm>
#include <cmath>

namespace repose::study {

LawSpec grains_as(const LawSpec& law, const std::string& form,
                  const std::map<std::string, double>& values) {
  LawSpec spec = law;
  spec.options["form"] = form;
  const LawInfo& info = find_law({spec.name, spec.options, {}});
  std::erase_if(spec.values, [&](const auto& value) {
    return std::none_of(info.parameters.begin(), info.parameters.end(),
                        [&](const ParamInfo& p) { return p.name == value.first; });
  });
  spec.values.erase("G");  // 4K, which follows K
  for (const auto& [key, value] : values) spec.values[key] = value;
  return spec;
}

point::ShearFlow flow_of(const Material& material, double p, double I) {
  return {p, I / (material.parameter("d") * std::sqrt(material.parameter("rho_p") / p))};
}

}  // namespace repose::study

#include "models/registry.hpp"

#include <algorithm>

#include "models/all_laws.hpp"
#include "models/law_material.hpp"

namespace repose {
namespace {

template <class... L>
std::vector<LawInfo> collect(const std::tuple<L...>*) {
  return {LawMaterial<L>::info()...};
}

std::string quoted_list(const std::vector<std::string_view>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "\"" : ", \"") + std::string(names[i]) + "\"";
  return text;
}

std::string did_you_mean(std::string_view misspelt, const std::vector<std::string_view>& known) {
  const std::string near = nearest_name(misspelt, known);
  return near.empty() ? "" : "; did you mean \"" + near + "\"?";
}

}  // namespace

void complete_parameters(const LawInfo& law, std::vector<double>& theta) {
  visit_law(
      law, [&]<class L>(L) { L::complete(theta); }, [&] { find_outside(law)->complete(theta); });
}

std::span<const LawInfo> library_laws() {
  static const std::vector<LawInfo> table = collect(static_cast<const AllLaws*>(nullptr));
  return table;
}

const LawInfo* default_form(std::string_view name) {
  // The two compression lines read the same λ and κ differently, so a parameter set must say which.
  if (name == "modified_cam_clay") return nullptr;
  for (const LawInfo& info : all_laws())
    if (info.name == name) return &info;
  return nullptr;
}

const LawInfo& find_law(const LawSpec& spec) {
  std::vector<std::string_view> names;
  std::vector<std::string_view> forms;
  std::string_view key;
  for (const LawInfo& info : all_laws()) {
    if (std::find(names.begin(), names.end(), info.name) == names.end()) names.push_back(info.name);
    if (info.name != spec.name) continue;
    key = info.option_key;
    forms.push_back(info.option);
  }
  if (forms.empty())
    throw InputError("name", "unknown law \"" + spec.name + "\"" + did_you_mean(spec.name, names) +
                                 " (known: " + quoted_list(names) + ")");
  for (const auto& [option, text] : spec.options)
    if (option != key)
      throw InputError(option,
                       spec.name + " has no option '" + option + "'" +
                           (key.empty() ? "" : "; its option is '" + std::string(key) + "'"));
  const auto given = spec.options.find(std::string(key));
  if (given == spec.options.end()) {
    if (const LawInfo* info = default_form(spec.name)) return *info;
    throw InputError(std::string(key), spec.name + " needs " + std::string(key) + ", one of " +
                                           quoted_list(forms) +
                                           ": the same numbers mean different laws");
  }
  for (const LawInfo& info : all_laws())
    if (info.name == spec.name && info.option == given->second) return info;
  throw InputError(std::string(key), std::string(key) + " = \"" + given->second +
                                         "\" is not one of " + quoted_list(forms) +
                                         did_you_mean(given->second, forms));
}

std::vector<double> checked_parameters(const LawSpec& spec) {
  const LawInfo& info = find_law(spec);
  // a parameter of another form of the same law deserves a better answer than "unknown"
  for (const auto& [name, x] : spec.values) {
    const auto has = [&, key = std::string_view(name)](const LawInfo& form) {
      return std::any_of(form.parameters.begin(), form.parameters.end(),
                         [&](const ParamInfo& p) { return p.name == key; });
    };
    if (has(info)) continue;
    for (const LawInfo& other : all_laws())
      if (other.name == info.name && has(other))
        throw InputError(name, name + " belongs to " + std::string(other.option_key) + " = \"" +
                                   std::string(other.option) + "\" of " + spec.name +
                                   ", and this is \"" + std::string(info.option) + "\"");
  }
  std::vector<double> theta = parameter_vector(info.name, info.parameters, spec.values);
  complete_parameters(info, theta);
  return theta;
}

std::unique_ptr<Material> make_material(const LawSpec& spec) {
  std::vector<double> theta = checked_parameters(spec);
  const LawInfo& law = find_law(spec);
  return visit_law(
      law,
      [&]<class L>(L) -> std::unique_ptr<Material> {
        return std::make_unique<LawMaterial<L>>(std::move(theta));
      },
      [&]() -> std::unique_ptr<Material> { return find_outside(law)->make(std::move(theta)); });
}

Material::~Material() = default;

double Material::parameter(std::string_view parameter_name) const {
  const auto table = law().parameters;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table[i].name == parameter_name) return theta_[i];
  throw InputError(std::string(parameter_name), std::string(law().name) + " has no parameter '" +
                                                    std::string(parameter_name) + "'");
}

}  // namespace repose

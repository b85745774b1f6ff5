#include "input/read_law.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "input/key_info.hpp"
#include "input/read_umat.hpp"
#include "input/toml_text.hpp"
#include "input/write_keys.hpp"
#include "models/cone.hpp"
#include "pointdriver/study/laboratory_figures.hpp"
#include "umat/in/library_law.hpp"

namespace repose::input {
namespace {

using Form = const LawInfo*;

std::vector<Form> forms_of(std::string_view name) {
  std::vector<Form> forms;
  for (const LawInfo& info : all_laws())
    if (info.name == name) forms.push_back(&info);
  return forms;
}

std::string law_names() {
  std::vector<std::string> names;
  for (const LawInfo& info : all_laws()) {
    std::string quoted = fmt::format("\"{}\"", info.name);
    if (std::find(names.begin(), names.end(), quoted) == names.end())
      names.push_back(std::move(quoted));
  }
  if (const std::string umat = fmt::format("\"{}\"", umat::law_name);
      std::find(names.begin(), names.end(), umat) == names.end())
    names.push_back(umat);
  return fmt::format("{}", fmt::join(names, ", "));
}

const ParamInfo* find_parameter(const LawInfo& form, std::string_view name) {
  const auto found = std::find_if(form.parameters.begin(), form.parameters.end(),
                                  [&](const ParamInfo& p) { return p.name == name; });
  return found == form.parameters.end() ? nullptr : &*found;
}

/// The parameter that a friction angle of this name gives.
const ParamInfo* find_angle(const LawInfo& form, std::string_view name) {
  const auto found = std::find_if(form.parameters.begin(), form.parameters.end(),
                                  [&](const ParamInfo& p) { return p.angle.name == name; });
  return found == form.parameters.end() ? nullptr : &*found;
}

constexpr Range angle_range{0.0, 90.0, true, true};
std::string angle_doc(const ParamInfo& parameter) {
  return fmt::format("friction angle in triaxial compression, instead of {}", parameter.name);
}

/// The value of a parameter: a number, or the position of a word.
std::optional<double> read_parameter(TomlReader& law, const ParamInfo& parameter) {
  if (parameter.words.empty())
    return law.optional_number(
        {parameter.name, parameter.unit, parameter.doc, parameter.range, {}});
  const auto word =
      law.optional_choice(parameter.name, {parameter.words.begin(), parameter.words.end()});
  if (!word) return {};
  return static_cast<double>(*word);
}

/// The value of a parameter whose friction angle is given in its place.
std::optional<double> read_angle(TomlReader& law, const ParamInfo& parameter) {
  const std::string_view key = parameter.angle.name;
  const std::string doc = angle_doc(parameter);
  const auto degrees = law.optional_number({key, "°", doc, angle_range, {}});
  if (!degrees) return {};
  if (law.has(parameter.name)) {
    law.report(key, fmt::format("give either {} or {}: {} is {} of a friction angle of {:g}°",
                                law.path_of(parameter.name), law.path_of(key),
                                toml_number(parameter.angle.parameter_of(*degrees)), parameter.name,
                                *degrees));
    return {};
  }
  return parameter.angle.parameter_of(*degrees);
}

std::string value_text(const ParamInfo& parameter, double x) {
  return parameter.words.empty() ? toml_number(x) : toml_string(word_of(parameter, x));
}

/// The option as text: the registry writes tension_cutoff = true as "true".
std::optional<std::string> read_option(TomlReader& law, const std::vector<Form>& forms,
                                       std::string_view key) {
  const toml::node& node = *law.get(key);
  const bool boolean = forms.front()->option == "true" || forms.front()->option == "false";
  if (const auto* flag = node.as_boolean(); boolean && flag != nullptr)
    return flag->get() ? "true" : "false";
  if (const auto* word = node.as_string(); !boolean && word != nullptr) return word->get();
  std::vector<std::string> words;
  for (const Form form : forms)
    words.push_back(boolean ? std::string(form->option) : fmt::format("\"{}\"", form->option));
  law.report(key, fmt::format("{} must be one of {}; got {}", law.path_of(key),
                              fmt::join(words, ", "), describe(node)));
  return {};
}

}  // namespace

std::string word_of(const ParamInfo& parameter, double x) {
  return std::string(parameter.words[static_cast<std::size_t>(x)]);
}

LawSpec read_law(TomlReader law) {
  LawSpec spec;
  InputFile& file = law.file();
  if (const auto* name = law.get("name");
      name != nullptr && name->is_string() && name->as_string()->get() == umat::law_name)
    return read_umat(law);
  spec.name = law.text("name", fmt::format("one of {}", law_names()));
  law.expect_any();
  const std::vector<Form> forms = forms_of(spec.name);
  const auto attempt = [&](auto&& action) {
    try {
      action();
      return true;
    } catch (const InputError& error) {
      file.report(error, law.path());
      return false;
    }
  };
  if (forms.empty()) {
    const auto* name = law.get("name");
    if (name != nullptr && name->is_string()) {
      // a foreign law is known only once a file has named its library
      const std::array known{umat::law_name};
      if (!nearest_name(spec.name, known).empty())
        law.report("name", fmt::format("unknown law \"{}\"; did you mean \"{}\"?", spec.name,
                                       umat::law_name));
      else
        attempt([&] { find_law(spec); });
    }
    return spec;
  }

  bool good = true;
  std::vector<std::string> unknown;
  for (const std::string& key : law.keys()) {
    if (key == "name") continue;
    const ParamInfo *parameter = nullptr, *of_angle = nullptr;
    for (const Form form : forms) {
      if (parameter == nullptr) parameter = find_parameter(*form, key);
      if (of_angle == nullptr) of_angle = find_angle(*form, key);
    }
    if (key == forms.front()->option_key) {
      const std::optional<std::string> option = read_option(law, forms, key);
      if (option) spec.options[key] = *option;
      good = good && option;
    } else if (parameter != nullptr) {
      const std::optional<double> x = read_parameter(law, *parameter);
      if (x) spec.values[key] = *x;
      good = good && x;
    } else if (of_angle != nullptr) {
      const std::optional<double> x = read_angle(law, *of_angle);
      if (x) spec.values[std::string(of_angle->name)] = *x;
      good = good && x;
    } else {
      unknown.push_back(key);
    }
  }
  const LawInfo* form = nullptr;
  if (good) good = attempt([&] { form = &find_law(spec); });
  // With an unclear form, any of them can still tell what is not a key of the law at all.
  const LawInfo& table = form == nullptr ? *forms.front() : *form;
  for (const std::string& key : unknown) {
    good = false;
    attempt([&] {
      if (law.get(key)->is_string()) find_law({spec.name, {{key, ""}}, {}});
      parameter_vector(spec.name, table.parameters, {{key, 0.0}});
    });
  }
  if (form == nullptr) return spec;
  for (const ParamInfo& parameter : form->parameters)
    if (parameter.need == Need::required && !law.has(parameter.name) &&
        !(!parameter.angle.name.empty() && law.has(parameter.angle.name)))
      good = attempt([&] { parameter_vector(spec.name, {&parameter, 1}, {}); }) && good;
  if (good) attempt([&] { checked_parameters(spec); });

  if (!form->option_key.empty()) spec.options[std::string(form->option_key)] = form->option;
  for (const ParamInfo& parameter : form->parameters)
    if (parameter.need == Need::defaulted)
      spec.values.try_emplace(std::string(parameter.name), parameter.value);
  return spec;
}

namespace {

/// "; 17.3° in triaxial compression, 22.4° in plane flow": what a friction means as an angle, which
/// on a circle is another one in every direction of shear.
std::string as_angles(const LawInfo& info, std::span<const double> theta, std::size_t i) {
  const ParamInfo& parameter = info.parameters[i];
  if (parameter.angle.name.empty()) return "";
  // a parameter with an angle is proportional to q/p
  const auto slope = [&](std::size_t k) {
    return theta[k] * cone::slope_of_angle(30.0) / info.parameters[k].angle.parameter_of(30.0);
  };
  const auto at_rest = static_cast<std::size_t>(
      std::find_if(info.parameters.begin(), info.parameters.end(),
                   [](const ParamInfo& p) { return !p.angle.name.empty(); }) -
      info.parameters.begin());
  const int shape = point::parameter_index(info.parameters, cone::shape.name);
  const double share =
      shape < 0 ? 1.0 : cone::shear_share(theta[static_cast<std::size_t>(shape)], slope(at_rest));
  const double compression = point::critical_friction_angle(slope(i), 0.0);
  const double plane = point::critical_friction_angle(share * slope(i), 0.5);
  if (!std::isfinite(compression) || !std::isfinite(plane)) return "";
  return fmt::format("; {:.1f}° in triaxial compression, {:.1f}° in plane flow", compression,
                     plane);
}

}  // namespace

std::string own_option_lines(const LawSpec& spec) {
  return spec.name == umat::law_name ? umat_head(spec) : "";
}

std::string law_lines(const LawSpec& spec) {
  if (spec.name == umat::law_name) return umat_lines(spec);
  const LawInfo& info = find_law(spec);
  const std::vector<double> theta = checked_parameters(spec);
  std::string out = key_line("name", toml_string(spec.name), info.doc);
  if (!info.option_key.empty()) {
    const bool boolean = info.option == "true" || info.option == "false";
    out += key_line(info.option_key, boolean ? std::string(info.option) : toml_string(info.option));
  }
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const ParamInfo& parameter = info.parameters[i];
    if (std::isnan(theta[i])) continue;
    const bool derived =
        parameter.need == Need::optional && !spec.values.contains(std::string(parameter.name));
    out += key_line(
        fmt::format("{}{}", derived ? "# " : "", parameter.name), value_text(parameter, theta[i]),
        fmt::format("{}{}{}", derived ? "derived: " : "",
                    unit_and_doc(parameter.unit, parameter.doc), as_angles(info, theta, i)));
  }
  return out;
}

namespace {

KeyInfo parameter_info(const ParamInfo& parameter, std::string_view law) {
  KeyInfo info;
  info.name = parameter.name;
  info.unit = parameter.unit;
  info.doc = fmt::format("{} {}", law, parameter.doc);
  info.range = parameter.range;
  if (parameter.need == Need::defaulted) info.fallback = value_text(parameter, parameter.value);
  if (!parameter.words.empty()) {
    info.kind = ValueKind::word;
    info.words.assign(parameter.words.begin(), parameter.words.end());
  }
  return info;
}

KeyInfo angle_info(const ParamInfo& parameter) {
  KeyInfo info;
  info.name = parameter.angle.name;
  info.unit = "°";
  info.doc = angle_doc(parameter);
  info.range = angle_range;
  return info;
}

/// One form per law: its options and the parameters of all its forms.
std::vector<KeyInfo> law_forms() {
  std::vector<KeyInfo> laws;
  for (const LawInfo& form : all_laws()) {
    if (form.name == umat::law_name) continue;  // its keys are its own
    auto law = std::find_if(laws.begin(), laws.end(),
                            [&](const KeyInfo& l) { return l.name == form.name; });
    if (law == laws.end()) {
      law = laws.insert(laws.end(), KeyInfo{});
      law->name = form.name;
      law->kind = ValueKind::table;
      law->doc = form.doc;
    }
    const auto find = [&](std::string_view name) {
      const auto found = std::find_if(law->below.begin(), law->below.end(),
                                      [&](const KeyInfo& k) { return k.name == name; });
      return found == law->below.end() ? nullptr : &*found;
    };
    if (!form.option_key.empty()) {
      KeyInfo* option = find(form.option_key);
      if (option == nullptr) {
        option = &law->below.emplace_back();
        option->name = form.option_key;
        const bool flag = form.option == "true" || form.option == "false";
        option->kind = flag ? ValueKind::boolean : ValueKind::word;
        option->doc = "form of the law";
        option->required = default_form(form.name) == nullptr;
        if (const LawInfo* usual = default_form(form.name))
          option->fallback =
              flag ? std::string(usual->option) : toml_string(std::string(usual->option));
      }
      option->words.emplace_back(form.option);
    }
    for (const ParamInfo& parameter : form.parameters) {
      if (find(parameter.name) != nullptr) continue;
      law->below.push_back(parameter_info(parameter, ""));
      if (!parameter.angle.name.empty()) law->below.push_back(angle_info(parameter));
    }
  }
  KeyInfo& umat = laws.emplace_back();
  umat.name = umat::law_name;
  umat.kind = ValueKind::table;
  umat.doc = umat::law_doc;
  umat.below = umat_infos();
  umat.open = true;  // names are keys
  return laws;
}

}  // namespace

void law_keys(Keys& keys, LawSpec& spec) {
  static const std::vector<KeyInfo> info = [] {
    KeyInfo forms;
    forms.name = "";  // the table itself is one of these
    forms.kind = ValueKind::any_of;
    forms.below = law_forms();
    return std::vector<KeyInfo>{forms};
  }();
  keys.others([&](TomlReader& table) { spec = read_law(table); }, [&] { return law_lines(spec); },
              info);
}

}  // namespace repose::input

#include "input/read_law.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "input/key_info.hpp"
#include "input/toml_text.hpp"
#include "input/write_keys.hpp"

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
  return fmt::format("{}", fmt::join(names, ", "));
}

const ParamInfo* find_parameter(const LawInfo& form, std::string_view name) {
  const auto found = std::find_if(form.parameters.begin(), form.parameters.end(),
                                  [&](const ParamInfo& p) { return p.name == name; });
  return found == form.parameters.end() ? nullptr : &*found;
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

LawSpec read_law(TomlReader law) {
  LawSpec spec;
  InputFile& file = law.file();
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
    if (name != nullptr && name->is_string()) attempt([&] { find_law(spec); });
    return spec;
  }

  bool good = true;
  std::vector<std::string> unknown;
  for (const std::string& key : law.keys()) {
    if (key == "name") continue;
    const ParamInfo* parameter = nullptr;
    for (const Form form : forms)
      if (parameter == nullptr) parameter = find_parameter(*form, key);
    if (key == forms.front()->option_key) {
      const std::optional<std::string> option = read_option(law, forms, key);
      if (option) spec.options[key] = *option;
      good = good && option;
    } else if (parameter != nullptr) {
      const std::optional<double> x = law.optional_number(
          {parameter->name, parameter->unit, parameter->doc, parameter->range, {}});
      if (x) spec.values[key] = *x;
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
    if (parameter.need == Need::required && !law.has(parameter.name))
      good = attempt([&] { parameter_vector(spec.name, {&parameter, 1}, {}); }) && good;
  if (good) attempt([&] { checked_parameters(spec); });

  if (!form->option_key.empty()) spec.options[std::string(form->option_key)] = form->option;
  for (const ParamInfo& parameter : form->parameters)
    if (parameter.need == Need::defaulted)
      spec.values.try_emplace(std::string(parameter.name), parameter.value);
  return spec;
}

std::string law_lines(const LawSpec& spec) {
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
    out += key_line(fmt::format("{}{}", derived ? "# " : "", parameter.name), toml_number(theta[i]),
                    fmt::format("{}{}", derived ? "derived: " : "",
                                unit_and_doc(parameter.unit, parameter.doc)));
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
  if (parameter.need == Need::defaulted) info.fallback = toml_number(parameter.value);
  return info;
}

/// One form per law: its options and the parameters of all its forms.
std::vector<KeyInfo> law_forms() {
  std::vector<KeyInfo> laws;
  for (const LawInfo& form : all_laws()) {
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
    for (const ParamInfo& parameter : form.parameters)
      if (find(parameter.name) == nullptr) law->below.push_back(parameter_info(parameter, ""));
  }
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

#include "input/read_umat.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "input/read_keys.hpp"
#include "input/toml_text.hpp"
#include "input/write_keys.hpp"
#include "umat/in/library_law.hpp"

namespace repose::input {
namespace {

using umat::Description;

/// What the table says.
struct Table {
  std::string library;
  std::string content;
  std::string symbol = umat::Library{}.symbol;
  std::string cmname = umat::Library{}.cmname;
  std::vector<double> props;
  std::vector<std::string> names;
  std::int64_t statev = 0;
  std::vector<double> initial_statev;
  std::int64_t void_ratio_statev = 0;
  double time_limit = umat::Library{}.time_limit_s;
  std::optional<double> rho_0, rho_p;
};

void head_keys(Keys& keys, Table& t) {
  constexpr Limits statevs{0, static_cast<std::int64_t>(umat::most_statev)};
  keys.text(
      {"library",
       "-",
       "the shared library: a path seen from this file, or one of those that come with repose",
       {},
       required},
      t.library);
  keys.text({"content", "-",
             "fingerprint of the library's bytes, written by repose: another library is refused"},
            t.content);
  keys.text({"symbol", "-", "its function"}, t.symbol);
  keys.text({"cmname", "-", "the material's name that it is called with (CMNAME)"}, t.cmname);
  keys.text_list({"names", "-", "of PROPS, in their order: keys of this table and of [fit]"},
                 t.names);
  keys.integer({"statev", "-", "number of state variables (NSTATV)"}, statevs, t.statev);
  keys.number_list({"initial_statev", "-", "STATEV at the start (0 if absent)"}, t.initial_statev);
  keys.integer({"void_ratio_statev", "-",
                "the state variable (from 1) that is the void ratio: set from [initial] e or v"},
               statevs, t.void_ratio_statev);
  keys.number({"time_limit",
               "s",
               "a call that takes more CPU time, or ten times as long, has failed",
               {1e-3, 1e5, false, false}},
              t.time_limit);
}

void all_keys(Keys& keys, Table& t) {
  head_keys(keys, t);
  keys.number_list({"props", "-", "PROPS; a key of a name takes precedence"}, t.props);
  keys.number({umat::density_name, "kg/m³",
               "density at the start: a scene needs it, or rho_p with v or e", positive},
              t.rho_0);
  keys.number({umat::grain_density_name, "kg/m³",
               "density of the grains: then v is an output, and an initial condition", positive},
              t.rho_p);
}

/// Reports a name that cannot be a key beside the others.
void check_names(TomlReader& law, const Table& t) {
  std::vector<std::string> own{"name"};
  for (const KeyInfo& key : umat_infos()) own.emplace_back(key.name);
  const auto bare = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  for (std::size_t i = 0; i < t.names.size(); ++i) {
    const std::string& name = t.names[i];
    if (name.empty() || !std::all_of(name.begin(), name.end(), bare))
      law.report("names", fmt::format("names: {} for PROPS({}) is no key: letters, digits, _ and - "
                                      "are, at least one",
                                      toml_string(name), i + 1));
    else if (std::find(own.begin(), own.end(), name) != own.end())
      law.report("names", fmt::format("names: \"{}\" is a key of every umat: call PROPS({}) "
                                      "something else",
                                      name, i + 1));
  }
}

/// Values of PROPS from the list and the keys of their names; nothing where one is missing.
std::optional<std::vector<double>> read_props(TomlReader& law, const Table& t,
                                              const Description& d) {
  std::vector<double> props = t.props;
  props.resize(d.names.size(), std::nan(""));
  bool good = true;
  for (std::size_t i = 0; i < props.size(); ++i) {
    const std::string& name = d.names[i];
    if (law.has(name)) {
      const auto x = law.optional_number({name, "-", fmt::format("PROPS({})", i + 1), {}, {}});
      props[i] = x.value_or(std::nan(""));
      good = good && x;
    } else if (i >= t.props.size()) {
      law.report(name, fmt::format("{} needs {}, PROPS({}): give it as a key, or all of them as "
                                   "props = [...]",
                                   table_name(law.path()), name, i + 1));
      good = false;
    }
  }
  if (!good) return {};
  return props;
}

Table table_of(const LawSpec& spec) {
  const Description& d = *umat::description_of(find_law(spec));
  Table t;
  t.library = d.library.file.string();
  t.content = d.library.content;
  t.symbol = d.library.symbol;
  t.cmname = d.library.cmname;
  t.names = d.names;
  t.statev = static_cast<std::int64_t>(d.library.nstatv);
  t.initial_statev = d.initial_statev;
  t.void_ratio_statev = d.void_ratio_statev;
  t.time_limit = d.library.time_limit_s;
  return t;
}

}  // namespace

LawSpec read_umat(TomlReader law) {
  LawSpec spec;
  spec.name = umat::law_name;
  law.expect("name");
  InputFile& file = law.file();
  Table t;
  ReadKeys keys(law);
  all_keys(keys, t);
  // whatever the faults, the names that are given are keys
  for (const std::string& name : t.names) law.expect(name);
  check_names(law, t);
  if (!file.ok()) return spec;

  Description d;
  d.names = t.names;
  if (law.has("props") && law.has("names") && t.props.size() != t.names.size()) {
    law.report("names", fmt::format("{} has {} names for {} props: there must be as many",
                                    table_name(law.path()), t.names.size(), t.props.size()));
    return spec;
  }
  if (!law.has("names"))
    for (std::size_t i = 0; i < t.props.size(); ++i) {
      d.names.push_back(umat::prop_name(d, i));
      law.expect(d.names.back());
    }
  if (law.has("initial_statev") && t.initial_statev.size() != static_cast<std::size_t>(t.statev)) {
    law.report("initial_statev",
               fmt::format("{} has {} initial_statev for statev = {}: there must be as many",
                           table_name(law.path()), t.initial_statev.size(), t.statev));
    return spec;
  }
  d.initial_statev = t.initial_statev;
  d.initial_statev.resize(static_cast<std::size_t>(t.statev), 0.0);
  d.has_grain_density = t.rho_p.has_value();
  d.void_ratio_statev = static_cast<int>(t.void_ratio_statev);
  const std::optional<std::vector<double>> props = read_props(law, t, d);
  if (!props || !law.has("library") || !file.ok()) return spec;
  for (std::size_t i = 0; i < props->size(); ++i) spec.values[d.names[i]] = (*props)[i];
  if (t.rho_0) spec.values[std::string(umat::density_name)] = *t.rho_0;
  if (t.rho_p) spec.values[std::string(umat::grain_density_name)] = *t.rho_p;
  try {
    umat::Library& library = d.library;
    library.file = umat::find_library(t.library, std::filesystem::path(file.name()).parent_path());
    library.content = umat::content_of(library.file);
    library.symbol = t.symbol;
    library.cmname = t.cmname;
    library.nprops = props->size();
    library.nstatv = static_cast<std::size_t>(t.statev);
    library.time_limit_s = t.time_limit;
    if (!t.content.empty() && t.content != library.content)
      throw InputError(
          "content", fmt::format("{} is not the library that this input was made with: its "
                                 "content is {} and was {}. Leave content out to take it as it is",
                                 library.file.string(), library.content, t.content));
    umat::check_library(library);
    spec.options["library"] = umat::make_known(d);
  } catch (const InputError& error) {
    // a default that does not suit the library is the library's matter
    const std::string key = law.has(error.key()) ? error.key() : "library";
    file.report(InputError(key, error.what()), law.path());
  }
  return spec;
}

std::string umat_head(const LawSpec& spec) {
  Table t = table_of(spec);
  return write_keys([&](Keys& keys) { head_keys(keys, t); });
}

std::string umat_lines(const LawSpec& spec) {
  const LawInfo& info = find_law(spec);
  std::string out = key_line("name", toml_string(spec.name), info.doc) + umat_head(spec);
  for (const ParamInfo& parameter : info.parameters) {
    const auto value = spec.values.find(std::string(parameter.name));
    if (value != spec.values.end() && !std::isnan(value->second))
      out += key_line(
          parameter.name, toml_number(value->second),
          parameter.unit == "-" ? parameter.symbol : unit_and_doc(parameter.unit, parameter.doc));
  }
  return out;
}

std::vector<KeyInfo> umat_infos() {
  return describe_keys([](Keys& keys) {
    Table t;
    all_keys(keys, t);
  });
}

void anchor_umat(toml::table& law, const std::filesystem::path& folder) {
  if (law["name"].value<std::string>() != std::string(umat::law_name)) return;
  const auto text = law["library"].value<std::string>();
  if (!text) return;
  try {
    const std::filesystem::path file = umat::find_library(*text, folder);
    law.insert_or_assign("library", file.string());
    law.insert_or_assign("content", umat::content_of(file));
  } catch (const InputError&) {
    // the reader has reported it
  }
}

}  // namespace repose::input

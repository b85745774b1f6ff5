#include "input/law_tables.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "input/input_file.hpp"
#include "input/read_umat.hpp"
#include "io/json.hpp"
#include "models/registry.hpp"
#include "umat/in/library_law.hpp"

namespace repose::input {
namespace {

using Row = std::vector<std::string>;

/// Characters on a terminal: bytes that do not continue a UTF-8 sequence.
std::size_t width(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U;
  }));
}

/// Columns as wide as their widest cell, the last one ragged.
std::string aligned(const std::vector<Row>& rows, std::string_view indent) {
  std::vector<std::size_t> widths;
  for (const Row& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (k == widths.size()) widths.push_back(0);
      widths[k] = std::max(widths[k], width(row[k]));
    }
  std::string out;
  for (const Row& row : rows) {
    out += indent;
    for (std::size_t k = 0; k + 1 < row.size(); ++k)
      out += row[k] + std::string(widths[k] - width(row[k]) + 2, ' ');
    out += row.back() + '\n';
  }
  return out;
}

/// form = "regularised", tension_cutoff = true
std::string option_text(const LawInfo& info) {
  if (info.option_key.empty()) return "";
  const bool boolean = info.option == "true" || info.option == "false";
  return boolean ? fmt::format("{} = {}", info.option_key, info.option)
                 : fmt::format("{} = \"{}\"", info.option_key, info.option);
}

bool is_default(const LawInfo& info) {
  const LawInfo* form = default_form(info.name);
  return form != nullptr && form->option == info.option && !info.option_key.empty();
}

std::string default_text(const ParamInfo& parameter) {
  switch (parameter.need) {
    case Need::required:
      return "required";
    case Need::defaulted:
      return parameter.words.empty()
                 ? fmt::format("{}", parameter.value)
                 : std::string(parameter.words[static_cast<std::size_t>(parameter.value)]);
    case Need::optional:
      break;
  }
  return "optional";
}

std::vector<const LawInfo*> forms_of(std::string_view name) {
  std::vector<const LawInfo*> forms;
  for (const LawInfo& info : all_laws())
    if (name.empty() || info.name == name) forms.push_back(&info);
  if (!forms.empty()) return forms;
  try {
    find_law({std::string(name), {}, {}});
  } catch (const InputError& error) {
    throw BadInput({fmt::format("repose models: {}", error.what())});
  }
  return forms;
}

/// A foreign law has no table of parameters before a file names its library: its keys instead.
std::string umat_description() {
  std::vector<Row> rows{{"KEY", "UNIT", "DEFAULT", "MEANING"}};
  for (const KeyInfo& key : umat_infos())
    rows.push_back({key.name, key.unit,
                    key.required           ? "required"
                    : key.fallback.empty() ? "optional"
                                           : key.fallback,
                    key.doc});
  return fmt::format(
      "{}\n{}\n\n{}\nThe parameters are PROPS: what names calls them, else prop_1, "
      "prop_2, ...; docs/umat_in.md tells more.\n",
      umat::law_name, umat::law_doc, aligned(rows, "  "));
}

}  // namespace

std::string law_list() {
  std::vector<Row> rows{{"LAW", "FORM", "WHAT IT IS"}};
  std::string_view last;
  for (const LawInfo& info : all_laws()) {
    rows.push_back({info.name == last ? "" : std::string(info.name),
                    option_text(info) + (is_default(info) ? " (default)" : ""),
                    std::string(info.doc)});
    last = info.name;
  }
  rows.push_back({std::string(umat::law_name), "library = \"...\"", std::string(umat::law_doc)});
  return aligned(rows, "") + "\n`repose models LAW` lists the parameters of one.\n";
}

std::string law_description(std::string_view name) {
  if (name == umat::law_name) return umat_description();
  std::string out;
  for (const LawInfo* info : forms_of(name)) {
    if (!out.empty()) out += '\n';
    const std::string option = option_text(*info);
    out += fmt::format("{}{}{}\n{}\n\n", info->name, option.empty() ? "" : ", " + option,
                       is_default(*info) ? " (default)" : "", info->doc);
    std::vector<Row> rows{{"SYMBOL", "KEY", "UNIT", "DEFAULT", "RANGE", "MEANING"}};
    for (const ParamInfo& p : info->parameters) {
      rows.push_back(
          {std::string(p.symbol), std::string(p.name), std::string(p.unit), default_text(p),
           p.words.empty() ? to_string(p.range) : fmt::format("{}", fmt::join(p.words, ", ")),
           std::string(p.doc)});
      if (!p.angle.name.empty())
        rows.push_back(
            {"", std::string(p.angle.name), "°", fmt::format("or {}", p.name), "(0, 90)",
             fmt::format("friction angle in triaxial compression that gives {}", p.name)});
    }
    out += aligned(rows, "  ");
    const auto list = [&](const char* heading, std::span<const StateField> fields) {
      if (fields.empty()) return;
      std::vector<Row> table{{heading, "KEY", "UNIT", "MEANING"}};
      for (const StateField& s : fields)
        table.push_back(
            {std::string(s.symbol), std::string(s.name), std::string(s.unit), std::string(s.doc)});
      out += '\n' + aligned(table, "  ");
    };
    list("STATE", info->state);
    list("OUTPUT", info->derived);
  }
  return out;
}

std::string laws_as_json(std::string_view name) {
  using Json = io::Json;
  if (name == umat::law_name) {
    Json keys = Json::array();
    for (const KeyInfo& key : umat_infos())
      keys.push_back(
          {{"key", key.name}, {"unit", key.unit}, {"required", key.required}, {"doc", key.doc}});
    Json laws = Json::array();
    laws.push_back({{"name", name}, {"doc", umat::law_doc}, {"keys", keys}});
    return laws.dump(2) + "\n";
  }
  const auto finite = [](double x) { return std::isfinite(x) ? Json(x) : Json(); };
  Json laws = Json::array();
  for (const LawInfo* info : forms_of(name)) {
    Json law{{"name", info->name}, {"doc", info->doc}, {"default", is_default(*info)}};
    if (!info->option_key.empty()) law[std::string(info->option_key)] = info->option;
    law["parameters"] = Json::array();
    for (const ParamInfo& p : info->parameters) {
      Json parameter{{"key", p.name},
                     {"symbol", p.symbol},
                     {"unit", p.unit},
                     {"required", p.need == Need::required},
                     {"default", p.need == Need::defaulted ? Json(p.value) : Json()},
                     {"lower", finite(p.range.lower)},
                     {"upper", finite(p.range.upper)},
                     {"lower_open", p.range.lower_open},
                     {"upper_open", p.range.upper_open},
                     {"doc", p.doc}};
      if (!p.angle.name.empty()) parameter["angle"] = p.angle.name;
      if (!p.words.empty()) {
        parameter["words"] = std::vector<std::string>(p.words.begin(), p.words.end());
        parameter["default"] = default_text(p);
      }
      law["parameters"].push_back(std::move(parameter));
    }
    for (const auto& [key, fields] :
         {std::pair{"state", info->state}, std::pair{"output", info->derived}}) {
      law[key] = Json::array();
      for (const StateField& s : fields)
        law[key].push_back(
            {{"key", s.name}, {"symbol", s.symbol}, {"unit", s.unit}, {"doc", s.doc}});
    }
    laws.push_back(std::move(law));
  }
  return laws.dump(2) + "\n";
}

}  // namespace repose::input

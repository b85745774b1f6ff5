#include "umat/out/tables.hpp"

#include <cstdio>

#include "models/registry.hpp"
#include "umat/out/constants.hpp"
#include "umat/out/material_name.hpp"

namespace repose::umat {
namespace {

std::string number(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", x);
  return text.data();
}

/// What a 0, or nothing at all, stands for.
std::string without(const ParamInfo& parameter) {
  switch (parameter.need) {
    case Need::required:
      return zero_is_absent(parameter) ? "an error" : "0 is 0; nothing: an error";
    case Need::defaulted:
      if (zero_is_absent(parameter) || parameter.value == 0.0) return number(parameter.value);
      return "0 is 0; nothing: " + number(parameter.value);
    case Need::optional:
      return "absent";
  }
  return "";
}

std::string range(const ParamInfo& parameter) {
  if (parameter.words.empty()) return to_string(parameter.range);
  std::string text;
  for (std::size_t i = 0; i < parameter.words.size(); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(i) + ": " + std::string(parameter.words[i]);
  return text;
}

std::string row(std::size_t i, std::string_view name, std::string_view unit, std::string_view a,
                std::string_view b, std::string_view doc) {
  std::string text =
      "| " + std::to_string(i) + " | `" + std::string(name) + "` | " + std::string(unit) + " | ";
  for (const std::string_view cell : {a, b})
    if (!cell.empty()) text += std::string(cell) + " | ";
  return text + std::string(doc) + " |\n";
}

std::string section(const LawInfo& law) {
  std::string text = "### " + material_name(law) + "\n\n";
  text += std::string(law.doc);
  const LawInfo* const usual = default_form(law.name);
  if (usual != nullptr && !law.option.empty() && usual->option == law.option) {
    LawInfo bare = law;
    bare.option = "";
    text += " (also `" + material_name(bare) + "` alone)";
  }
  text +=
      "\n\n| PROPS | parameter | unit | range | 0 or nothing | meaning "
      "|\n|---|---|---|---|---|---|\n";
  std::size_t i = 0;
  for (const ParamInfo& parameter : law.parameters)
    text += row(++i, parameter.name, parameter.unit, range(parameter), without(parameter),
                parameter.doc);
  for (const StartConstant& constant : start_constants(law))
    text += row(++i, constant.name, constant.unit, constant.range, "absent", constant.doc);
  text += "\n| STATEV | variable | unit | meaning |\n|---|---|---|---|\n";
  i = 0;
  text += row(++i, "density", "kg/m³", "", "", "0 at the start: from the stress");
  for (const StateField& field : law.state)
    text += row(++i, field.name, field.unit, "", "", field.doc);
  for (const StateField& field : law.derived)
    text += row(++i, field.name, field.unit, "", "",
                std::string(field.doc) + " (for output, where *DEPVAR has room)");
  return text;
}

}  // namespace

std::string tables(std::string_view name) {
  std::string text;
  for (const LawInfo& law : library_laws())
    if (name.empty() || law.name == name) text += (text.empty() ? "" : "\n") + section(law);
  return text;
}

}  // namespace repose::umat

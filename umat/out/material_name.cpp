#include "umat/out/material_name.hpp"

#include <algorithm>
#include <cctype>

#include "models/registry.hpp"

namespace repose::umat {
namespace {

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// The name without its suffix and what pads it.
std::string law_part(std::string_view name) {
  const std::size_t end = name.find_last_not_of(std::string_view(" \0", 2));
  name = name.substr(0, end == std::string_view::npos ? 0 : end + 1);
  return upper(name.substr(0, name.find("__")));
}

}  // namespace

std::string material_name(const LawInfo& law) {
  std::string name = upper(law.name);
  if (law.option.empty()) return name;
  name += "-";
  if (law.option == "true") return name + upper(law.option_key);
  if (law.option == "false") return name + "NO_" + upper(law.option_key);
  return name + upper(law.option);
}

const LawInfo& find_form(std::string_view name) {
  const std::string wanted = law_part(name);
  std::vector<std::string> known, forms;
  for (const LawInfo& law : library_laws()) {
    known.push_back(material_name(law));
    if (known.back() == wanted) return law;
    if (upper(law.name) == wanted) forms.push_back(known.back());
  }
  if (!forms.empty()) {
    // a default is always the library's own: the name is
    for (const LawInfo& law : library_laws())
      if (upper(law.name) == wanted)
        if (const LawInfo* const form = default_form(law.name)) return *form;
    throw InputError("CMNAME", "a material named " + wanted + " must say its form: " +
                                   joined(forms) + ", each with or without __SUFFIX");
  }
  const std::vector<std::string_view> candidates(known.begin(), known.end());
  const std::string near = nearest_name(wanted, candidates);
  throw InputError("CMNAME", "no law is called \"" + wanted + "\"" +
                                 (near.empty() ? "" : "; did you mean " + near + "?") +
                                 " A material's name is one of " + joined(known) +
                                 ", with or without __SUFFIX");
}

}  // namespace repose::umat

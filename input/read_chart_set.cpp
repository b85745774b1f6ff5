#include "input/read_chart_set.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "input/key_info.hpp"
#include "input/read_chart.hpp"
#include "input/read_keys.hpp"

namespace repose::input {
namespace {

/// An entry with the keys of its quick table in place of its own, or without that table.
toml::table entry_as_asked(const toml::table& entry, bool quick) {
  toml::table asked = entry;
  const toml::table* replaced = entry["quick"].as_table();
  if (replaced == nullptr) return asked;
  asked.erase("quick");
  if (quick)
    for (const auto& [key, value] : *replaced)
      value.visit([&, &name = key](const auto& node) { asked.insert_or_assign(name, node); });
  return asked;
}

bool is_folder_name(const std::string& name) {
  return !name.empty() && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) || c == '_' || c == '-' || c == '.';
         });
}

/// A file lies beside the set; what has neither dot nor slash is the name of a shipped scene.
std::string found_input(const std::string& input, const std::filesystem::path& folder) {
  if (input.find_first_of("./") == std::string::npos) return input;
  return std::filesystem::absolute(folder / input).lexically_normal().string();
}

std::vector<std::string> sets_of(const toml::table& entry, PartKind kind) {
  std::vector<std::string> sets;
  for (const auto& [key, value] : entry) {
    const std::string_view name = key.str();
    if (name == "name" || name == "kind" || name == "input" || name == "set") continue;
    sets.push_back(fmt::format("{}.{}={}", kind == PartKind::stability ? "stability" : "chart",
                               name, value_text(value)));
  }
  const auto add = [&](const toml::node& one) {
    if (const auto text = one.value<std::string>()) sets.push_back(*text);
  };
  if (const toml::array* list = entry["set"].as_array())
    for (const toml::node& one : *list) add(one);
  else if (const toml::node* one = entry.get("set"))
    add(*one);
  return sets;
}

/// A --set option for a shell.
std::string quoted(const std::string& text) { return fmt::format("--set '{}'", text); }

}  // namespace

void chart_part_keys(Keys& keys, ChartPart& part) {
  keys.text({"name", "-", "of its sub-folder; the kind by default"}, part.name);
  keys.choice({"kind", "-", "which chart", {}, required}, part_kinds, part.kind);
  keys.text({"input", "-", "a file or a shipped scene"}, part.input);
  KeyInfo replaced;
  replaced.kind = ValueKind::table;
  replaced.open = true;
  keys.value(
      {"quick", "-", "keys that --quick puts in the place of this entry's"}, [](TomlReader&) {},
      [] { return std::string(); }, replaced);
  keys.text_list({"set", "-", "overrides, as in [\"scene.end_time=0.6\"]"}, part.set);
}

std::string ChartPart::command() const {
  std::string text =
      kind == PartKind::stability
          ? "repose stability"
          : fmt::format("repose chart {}", part_kinds[static_cast<std::size_t>(kind)]);
  if (!input.empty()) text += " " + input;
  for (const std::string& one : sets) text += " " + quoted(one);
  return text;
}

bool is_chart_set(const InputFile& file) {
  return file.root().contains("chart") && file.root()["chart"].is_array();
}

ChartSet read_chart_set(InputFile& file, const std::filesystem::path& folder, bool quick) {
  ChartSet set;
  TomlReader root(file);
  std::vector<TomlReader> entries = root.tables("chart", "a chart");
  file.throw_if_bad();  // from here on entry i is reader i
  for (std::size_t i = 0; i < entries.size(); ++i) {
    TomlReader& reader = entries[i];
    reader.expect_any();
    const toml::table* given = (*file.root()["chart"].as_array())[i].as_table();
    ChartPart part;
    ReadKeys keys(reader);
    chart_part_keys(keys, part);
    if (part.name.empty()) part.name = part_kinds[static_cast<std::size_t>(part.kind)];
    if (!is_folder_name(part.name))
      reader.report(
          "name",
          fmt::format("the name '{}' cannot be a folder's: letters, digits, _ - .", part.name));
    if (std::any_of(set.parts.begin(), set.parts.end(),
                    [&](const ChartPart& other) { return other.name == part.name; }))
      reader.report("name", fmt::format("there are two charts called '{}'", part.name));
    part.input = found_input(part.input, folder);
    if (given->contains("quick") && !(*given)["quick"].is_table())
      reader.report("quick", "quick is a table of the keys that --quick replaces");
    const toml::table entry = entry_as_asked(*given, quick);
    part.origin = file.origin(reader.path());
    set.text += "\n[[chart]]\n";
    for (const auto& [key, value] : entry)
      set.text += key.str() == "input" ? fmt::format("input = '{}'\n", part.input)
                                       : fmt::format("{} = {}\n", key.str(), value_text(value));
    if (file.ok()) part.sets = sets_of(entry, part.kind);
    set.parts.push_back(std::move(part));
  }
  file.throw_if_bad();
  return set;
}

}  // namespace repose::input

#include "input/resolved_scene.hpp"

#include <cmath>
#include <sstream>

#include <fmt/core.h>

#include "input/program_identity.hpp"
#include "input/read_law.hpp"
#include "input/write_keys.hpp"

namespace repose::input {
namespace {

void flatten(const toml::node& node, const std::string& path,
             std::map<std::string, std::string>& out) {
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, child] : *table) flatten(child, join_path(path, key.str()), out);
  } else if (const toml::array* list = node.as_array()) {
    for (std::size_t i = 0; i < list->size(); ++i)
      flatten(*list->get(i), fmt::format("{}[{}]", path, i), out);
  } else if (node.is_number()) {
    out[path] = fmt::format("{}", *node.value<double>());
  } else {
    std::ostringstream text;
    node.visit([&](const auto& value) { text << value; });
    out[path] = std::move(text).str();
  }
}

}  // namespace

std::string law_table(const LawSpec& spec, std::string_view table) {
  return fmt::format("\n[{}]\n{}", table, law_lines(spec));
}

std::string resolved_input(const SceneFile& file, const std::string& origin) {
  SceneFile copy = file;
  return fmt::format(
             "# The input of this result with every default written out, by repose {}.\n# {}\n",
             program_identity(), origin) +
         write_keys([&](Keys& keys) { scene_keys(keys, copy); });
}

std::vector<std::string> differences(const toml::table& there, const toml::table& here) {
  std::map<std::string, std::string> a, b;
  flatten(there, "", a);
  flatten(here, "", b);
  const auto value = [](const std::map<std::string, std::string>& values, const std::string& key) {
    const auto found = values.find(key);
    return found == values.end() ? std::string("nothing") : found->second;
  };
  std::map<std::string, std::string> keys = a;
  keys.insert(b.begin(), b.end());
  std::vector<std::string> lines;
  for (const auto& [key, unused] : keys)
    if (value(a, key) != value(b, key))
      lines.push_back(fmt::format("{}: {} there, {} here", key, value(a, key), value(b, key)));
  return lines;
}

}  // namespace repose::input

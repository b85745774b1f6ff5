#include "input/schema.hpp"

#include <cmath>

#include <fmt/format.h>

#include "input/read_benchmark.hpp"
#include "input/read_chart.hpp"
#include "input/read_chart_set.hpp"
#include "input/read_fit.hpp"
#include "input/read_point_test.hpp"
#include "input/read_scene.hpp"
#include "input/read_sensitivity.hpp"
#include "input/read_stability.hpp"
#include "input/read_sweep.hpp"
#include "input/write_keys.hpp"
#include "io/json.hpp"

namespace repose::input {
namespace {

using Json = io::Json;

std::vector<KeyInfo> scene_infos() {
  SceneFile scene;
  ChartTable chart;
  return describe_keys([&](Keys& keys) {
    scene_keys(keys, scene);
    keys.table({"chart", "-", "what `repose chart mpm` varies"},
               [&](Keys& below) { chart_keys(below, chart); });
    sweep_keys(keys);
    sensitivity_keys(keys);
  });
}

std::vector<KeyInfo> chart_infos() {
  ChartTable chart;
  ChartPart part;
  StabilityInput stability;
  LawSpec law;
  std::vector<KeyInfo> list = describe_keys([&](Keys& keys) {
    keys.table({"stability", "-", "maps of where laws and methods fail"},
               [&](Keys& below) { stability_keys(below, stability); });
    keys.table({"law", "-", "the law of the maps"}, [&](Keys& below) { law_keys(below, law); });
  });
  KeyInfo any, one, set;
  any.name = "chart";
  any.kind = ValueKind::any_of;
  any.doc = "one chart, or with [[chart]] several";
  one.kind = ValueKind::table;
  one.below = describe_keys([&](Keys& keys) { chart_keys(keys, chart); });
  set.kind = ValueKind::tables;
  set.below = describe_keys([&](Keys& keys) {
    chart_part_keys(keys, part);
    chart_keys(keys, chart);
    stability_keys(keys, stability);
  });
  any.below = {one, set};
  list.insert(list.begin(), any);
  return list;
}

std::vector<KeyInfo> case_infos() {
  Benchmark benchmark;
  return describe_keys([&](Keys& keys) { benchmark_keys(keys, benchmark); });
}

std::string description(const KeyInfo& key) {
  std::string text = unit_and_doc(key.unit, key.doc);
  if (!key.only.empty()) text += "; " + key.only;
  return text;
}

void add_range(Json& json, const Range& range) {
  if (std::isfinite(range.lower))
    json[range.lower_open ? "exclusiveMinimum" : "minimum"] = range.lower;
  if (std::isfinite(range.upper))
    json[range.upper_open ? "exclusiveMaximum" : "maximum"] = range.upper;
}

Json schema_of(const KeyInfo& key);

Json object(const std::vector<KeyInfo>& keys, bool open) {
  Json properties = Json::object(), needed = Json::array();
  for (const KeyInfo& key : keys) {
    properties[key.name] = schema_of(key);
    if (key.required) needed.push_back(key.name);
  }
  Json json{{"type", "object"}, {"properties", properties}, {"additionalProperties", open}};
  if (!needed.empty()) json["required"] = needed;
  return json;
}

/// The keys of a table that depend on what `name` says (a law's); null if there are none.
const KeyInfo* forms_of(const KeyInfo& table) {
  for (const KeyInfo& key : table.below)
    if (key.name.empty()) return &key;
  return nullptr;
}

/// A table, or where its keys depend on what `name` says, one of several, each with what stands
/// beside these keys, or a file that has one.
Json table_schema(const KeyInfo& table) {
  const KeyInfo* const laws = forms_of(table);
  if (laws == nullptr) return object(table.below, table.open);
  Json forms = Json::array();
  for (const KeyInfo& form : laws->below) {
    std::vector<KeyInfo> keys = form.below;
    std::vector<std::string> needed{"name"};
    for (const KeyInfo& key : table.below) {
      if (key.name.empty()) continue;
      keys.push_back(key);
      if (key.required) needed.push_back(key.name);
    }
    Json json = object(keys, false);
    json["properties"]["name"] = {{"const", form.name}, {"description", form.doc}};
    json["required"] = needed;
    forms.push_back(json);
  }
  if (table.below.size() == 1) forms.push_back({{"type", "string"}, {"pattern", "\\.toml$"}});
  return {{"anyOf", forms}};
}

Json list_schema(const KeyInfo& key, Json items) {
  Json json{{"type", "array"}, {"items", std::move(items)}, {"minItems", key.least}};
  if (key.most != 0) json["maxItems"] = key.most;
  return json;
}

Json value_schema(const KeyInfo& key) {
  Json number{{"type", "number"}};
  add_range(number, key.range);
  switch (key.kind) {
    case ValueKind::number:
      return number;
    case ValueKind::integer: {
      Json json{{"type", "integer"}};
      if (key.limits) {
        json["minimum"] = key.limits->lower;
        json["maximum"] = key.limits->upper;
      }
      return json;
    }
    case ValueKind::boolean:
      return {{"type", "boolean"}};
    case ValueKind::text:
      return {{"type", "string"}};
    case ValueKind::word:
      return {{"enum", key.words}};
    case ValueKind::number_list:
      return list_schema(key, number);
    case ValueKind::corner_list:
      return list_schema(
          key, Json{{"type", "array"}, {"items", number}, {"minItems", 2}, {"maxItems", 2}});
    case ValueKind::word_list:
      return list_schema(key, {{"enum", key.words}});
    case ValueKind::text_list:
      return {{"anyOf", {Json{{"type", "string"}}, list_schema(key, {{"type", "string"}})}}};
    case ValueKind::table:
      return table_schema(key);
    case ValueKind::tables:
      return {{"type", "array"}, {"items", table_schema(key)}, {"minItems", 1}};
    case ValueKind::any_of:
      break;
  }
  Json forms = Json::array();
  for (const KeyInfo& form : key.below) forms.push_back(schema_of(form));
  return {{"anyOf", forms}};
}

Json schema_of(const KeyInfo& key) {
  Json json;
  if (const std::string text = description(key); !text.empty()) json["description"] = text;
  if (!key.fallback.empty()) {
    if (const auto value = Json::try_parse(key.fallback)) json["default"] = *value;
  }
  json.update(value_schema(key));
  return json;
}

std::string allowed(const KeyInfo& key) {
  const auto quoted = [](const std::vector<std::string>& words) {
    return fmt::format("`\"{}\"`", fmt::join(words, "\"`, `\""));
  };
  const bool bounded = std::isfinite(key.range.lower) || std::isfinite(key.range.upper);
  const std::string range = bounded ? to_string(key.range) : "";
  switch (key.kind) {
    case ValueKind::number:
      return bounded ? range : "a number";
    case ValueKind::integer:
      if (key.limits && key.limits->upper < 1'000'000'000)
        return fmt::format("{} to {}", key.limits->lower, key.limits->upper);
      return fmt::format("an integer ≥ {}", key.limits ? key.limits->lower : 0);
    case ValueKind::boolean:
      return "`true`, `false`";
    case ValueKind::text:
      return "a text";
    case ValueKind::word:
      return quoted(key.words);
    case ValueKind::number_list: {
      const std::string count = key.most == 0 ? "a list of numbers"
                                : key.least == key.most
                                    ? fmt::format("{} numbers", key.least)
                                    : fmt::format("{} or {} numbers", key.least, key.most);
      return bounded ? fmt::format("{}, each {}", count, range) : count;
    }
    case ValueKind::corner_list:
      return fmt::format("`[[x, y], …]`, {} or more", key.least);
    case ValueKind::word_list:
      return "a list of " + quoted(key.words);
    case ValueKind::text_list:
      return "a text or a list of them";
    case ValueKind::table:
      return key.open ? "a table, keys of your own" : "a table";
    case ValueKind::tables:
      return "a list of tables";
    case ValueKind::any_of:
      break;
  }
  std::string text;
  for (const KeyInfo& form : key.below) {
    std::string one = allowed(form);
    if (form.kind == ValueKind::table && !form.below.empty()) {
      one = "`{ ";
      for (const KeyInfo& k : form.below)
        one += fmt::format("{}{} = …", &k == &form.below.front() ? "" : ", ", k.name);
      one += " }`";
    }
    text += (text.empty() ? "" : " or ") + one;
  }
  return text;
}

bool is_table(const KeyInfo& key) {
  return key.kind == ValueKind::table || key.kind == ValueKind::tables;
}

/// The name of a table's section, or several where it depends on the law's name: those are told by
/// `repose models`.
void add_tables(std::string& page, const std::string& path, const std::vector<KeyInfo>& keys) {
  std::string rows;
  for (const KeyInfo& key : keys) {
    if (key.name.empty()) continue;
    const std::string what = key.only.empty() ? key.doc : fmt::format("{} ({})", key.doc, key.only);
    rows += fmt::format("| `{}` | {} | {} | {} | {} |\n", key.name, key.unit == "-" ? "" : key.unit,
                        allowed(key),
                        key.required           ? "**required**"
                        : key.fallback.empty() ? ""
                                               : fmt::format("`{}`", key.fallback),
                        what);
  }
  if (!rows.empty())
    page += "\n| key | unit | value | default | meaning |\n|---|---|---|---|---|\n" + rows;
  int list_forms = 0;
  for (const KeyInfo& key : keys) {
    const std::vector<KeyInfo> forms =
        key.kind == ValueKind::any_of ? key.below : std::vector<KeyInfo>{key};
    for (const KeyInfo& form : forms) {
      if (!is_table(form) || form.below.empty() || key.name.empty()) continue;
      const bool short_form = key.kind == ValueKind::any_of && form.below.size() < 2;
      if (short_form) continue;
      const std::string below = path.empty() ? key.name : path + "." + key.name;
      std::string heading = form.kind == ValueKind::tables ? fmt::format("`[[{}]]`", below)
                                                           : fmt::format("`[{}]`", below);
      if (form.kind == ValueKind::tables && key.kind == ValueKind::any_of) {
        // the edges of a box: all of one form, which is told once
        if (list_forms++ > 0) continue;
        for (const KeyInfo& other : keys)
          if (&other != &key && other.kind == ValueKind::any_of &&
              other.below.back().kind == ValueKind::tables)
            heading +=
                fmt::format(", `[[{}]]`", path.empty() ? other.name : path + "." + other.name);
      }
      page += fmt::format("\n### {}\n", heading);
      if (forms_of(form) != nullptr)
        page +=
            "\n`name` is one of the laws of `repose models`; `repose models LAW` lists the other "
            "keys, its parameters.\n";
      add_tables(page, below, form.below);
    }
  }
}

}  // namespace

SchemaKind schema_kind(std::string_view name) {
  for (std::size_t k = 0; k < schema_names.size(); ++k)
    if (schema_names[k] == name) return static_cast<SchemaKind>(k);
  const std::string near = closest(name, {schema_names.begin(), schema_names.end()});
  throw BadInput({fmt::format("repose schema: {}one of {} is needed{}",
                              name.empty() ? "" : fmt::format("there is no '{}': ", name),
                              fmt::join(schema_names, ", "),
                              near.empty() ? "" : fmt::format("; did you mean '{}'?", near))});
}

std::vector<KeyInfo> keys_of(SchemaKind kind) {
  switch (kind) {
    case SchemaKind::scene:
      return scene_infos();
    case SchemaKind::test:
      return point_test_infos();
    case SchemaKind::fit:
      return fit_infos();
    case SchemaKind::chart:
      return chart_infos();
    case SchemaKind::benchmark:
      break;
  }
  return case_infos();
}

std::string json_schema(SchemaKind kind) {
  Json json{{"$schema", "http://json-schema.org/draft-07/schema#"},
            {"title", fmt::format("repose {}", schema_names[static_cast<std::size_t>(kind)])}};
  json.update(object(keys_of(kind), false));
  return json.dump(1) + "\n";
}

std::string key_page() {
  std::string page =
      "# Keys of the input files\n\n"
      "Made by `repose schema --page` from the tables that the readers use; a test compares the "
      "two.\nUnits are SI. `repose schema scene` (`test`, `fit`, `chart`, `case`) prints the "
      "same as a JSON "
      "Schema, which\neditors complete and check from: the shipped files name it in their first "
      "line (`#:schema …`).\n";
  constexpr std::array<std::string_view, 5> titles{
      "Scene: `repose run`", "Point test: `repose point`", "Fit: `repose fit`",
      "Charts and maps: `repose chart`, `repose stability`", "Validation case: `repose validate`"};
  for (std::size_t k = 0; k < schema_names.size(); ++k) {
    page += fmt::format("\n## {}\n", titles[k]);
    add_tables(page, "", keys_of(static_cast<SchemaKind>(k)));
  }
  return page;
}

}  // namespace repose::input

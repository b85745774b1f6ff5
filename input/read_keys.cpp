#include "input/read_keys.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace repose::input {
namespace {

std::vector<std::string_view> list_of(std::span<const std::string_view> words) {
  return {words.begin(), words.end()};
}

NumberKey number_key(const Key& key) { return {key.name, key.unit, key.doc, key.range, {}}; }

}  // namespace

bool ReadKeys::wanted(const Key& key) {
  table_.expect(key.name);
  if (key.applies) return true;
  if (table_.has(key.name)) table_.report(key.name, key.only);
  return false;
}

void ReadKeys::number(const Key& key, double& x) {
  if (!wanted(key)) return;
  NumberKey asked = number_key(key);
  if (key.presence != required) asked.fallback = x;
  x = table_.number(asked);
}

void ReadKeys::number(const Key& key, std::optional<double>& x) {
  if (!wanted(key)) return;
  if (const auto given = table_.optional_number(number_key(key))) x = given;
}

void ReadKeys::integer(const Key& key, Limits limits, std::int64_t& x) {
  if (!wanted(key)) return;
  x = table_.integer(key.name, key.doc, limits.lower, limits.upper,
                     key.presence == required ? std::nullopt : std::optional(x));
}

void ReadKeys::integer(const Key& key, Limits limits, std::optional<std::int64_t>& x) {
  if (wanted(key) && table_.has(key.name))
    x = table_.integer(key.name, key.doc, limits.lower, limits.upper);
}

void ReadKeys::boolean(const Key& key, bool& x) {
  if (wanted(key)) x = table_.boolean(key.name, x);
}

void ReadKeys::text(const Key& key, std::string& x) {
  if (!wanted(key)) return;
  x = table_.text(key.name, key.doc, key.presence == required ? std::nullopt : std::optional(x));
}

void ReadKeys::word(const Key& key, std::span<const std::string_view> words, std::size_t& x) {
  if (!wanted(key)) return;
  if (key.presence == required && !table_.has(key.name))
    table_.report(key.name,
                  fmt::format("{} needs {}, one of \"{}\" ({})", table_name(table_.path()),
                              key.name, fmt::join(words, "\", \""), key.doc));
  x = table_.choice(key.name, list_of(words), x);
}

void ReadKeys::word(const Key& key, std::span<const std::string_view> words,
                    std::optional<std::size_t>& x) {
  if (wanted(key) && table_.has(key.name)) x = table_.choice(key.name, list_of(words), 0);
}

void ReadKeys::vector(const Key& key, std::size_t axes, std::array<double, 3>& x) {
  if (!wanted(key)) return;
  x = table_.vector(number_key(key), axes,
                    key.presence == required ? std::nullopt : std::optional(x));
}

void ReadKeys::components(const Key& key, std::optional<std::array<double, 6>>& x) {
  if (!wanted(key)) return;
  if (const auto given = table_.numbers(number_key(key), 6)) {
    x.emplace();
    std::copy(given->begin(), given->end(), x->begin());
  }
}

void ReadKeys::number_list(const Key& key, std::vector<double>& x) {
  if (!wanted(key)) return;
  if (auto given = table_.number_list(number_key(key))) x = std::move(*given);
}

void ReadKeys::word_list(const Key& key, std::span<const std::string_view> words,
                         std::vector<std::size_t>& x) {
  if (!wanted(key)) return;
  if (auto given = table_.choices(key.name, list_of(words))) x = std::move(*given);
}

void ReadKeys::text_list(const Key& key, std::vector<std::string>& x) {
  if (!wanted(key)) return;
  if (!table_.has(key.name)) {
    if (key.presence == required)
      table_.report(key.name,
                    fmt::format("{} needs {} ({})", table_name(table_.path()), key.name, key.doc));
    return;
  }
  const toml::node& node = *table_.get(key.name);
  std::vector<std::string> texts;
  bool good = true;
  const auto add = [&](const toml::node& one) {
    const auto text = one.value<std::string>();
    good = good && text && one.is_string();
    if (text) texts.push_back(*text);
  };
  if (const toml::array* list = node.as_array())
    for (const toml::node& one : *list) add(one);
  else
    add(node);
  if (good && !texts.empty())
    x = std::move(texts);
  else
    table_.report(key.name, fmt::format("{} must be a text or a list of texts ({}); got {}",
                                        table_.path_of(key.name), key.doc, describe(node)));
}

void ReadKeys::table(const Key& key, const std::function<void(Keys&)>& below) {
  if (!wanted(key)) return;
  ReadKeys keys(table_.table(key.name));
  below(keys);
}

void ReadKeys::tables(const Key& key, std::size_t, const std::function<void(std::size_t)>& resize,
                      const std::function<void(Keys&, std::size_t)>& entry) {
  if (!wanted(key)) return;
  if (key.presence != required && !table_.has(key.name)) return;
  const std::vector<TomlReader> entries = table_.tables(key.name, key.doc);
  resize(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    ReadKeys keys(entries[i]);
    entry(keys, i);
  }
}

void ReadKeys::value(const Key& key, const std::function<void(TomlReader&)>& read,
                     const std::function<std::string()>&, const KeyInfo&) {
  if (!wanted(key)) return;
  if (table_.has(key.name))
    read(table_);
  else if (key.presence == required)
    table_.report(key.name,
                  fmt::format("{} needs {} ({})", table_name(table_.path()), key.name, key.doc));
}

void ReadKeys::others(const std::function<void(TomlReader&)>& read,
                      const std::function<std::string()>&, const std::vector<KeyInfo>&) {
  read(table_);
}

}  // namespace repose::input

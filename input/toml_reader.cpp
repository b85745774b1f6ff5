#include "input/toml_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "input/quantity_range.hpp"

namespace repose::input {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string with_unit(std::string_view text, std::string_view unit) {
  return unit == "-" || unit.empty() ? std::string(text) : fmt::format("{} {}", text, unit);
}

/// "a number > 0 m", "a number"
std::string expected_number(const NumberKey& key) {
  const bool any = std::isinf(key.range.lower) && std::isinf(key.range.upper);
  if (any) return key.unit == "-" ? "a number" : fmt::format("a number in {}", key.unit);
  const std::string range = with_unit(to_string(key.range), key.unit);
  const bool interval = range.front() == '[' || range.front() == '(';
  return fmt::format("a number {}{}", interval ? "in " : "", range);
}

std::string doc_of(std::string_view doc) { return doc.empty() ? "" : fmt::format(" ({})", doc); }

}  // namespace

std::string describe(const toml::node& node) {
  if (const auto* value = node.as_string()) return fmt::format("the string \"{}\"", value->get());
  if (const auto* value = node.as_integer()) return fmt::format("the integer {}", value->get());
  if (const auto* value = node.as_floating_point())
    return fmt::format("the number {}", value->get());
  if (const auto* value = node.as_boolean()) return value->get() ? "true" : "false";
  if (const auto* list = node.as_array()) return fmt::format("a list of {}", list->size());
  if (node.is_table()) return "a table";
  return "a date or time";
}

const toml::node* TomlReader::get(std::string_view key) const {
  return table_ == nullptr ? nullptr : table_->get(key);
}

bool TomlReader::has(std::string_view key) const { return get(key) != nullptr; }

void TomlReader::wrong_type(std::string_view key, std::string_view expected) {
  report(key, fmt::format("{} must be {}; got {}", path_of(key), expected, describe(*get(key))));
}

void TomlReader::missing(std::string_view key, std::string_view expected) {
  if (!broken_) report(key, fmt::format("{} needs {}, {}", table_name(path_), key, expected));
}

std::optional<double> TomlReader::checked(const toml::node& node, std::string_view at,
                                          const NumberKey& key) {
  const std::optional<double> x = node.is_number() ? node.value<double>() : std::nullopt;
  if (!x) {
    const auto* string = node.as_string();
    std::string hint;
    if (string != nullptr && !string->get().empty() &&
        string->get().find_first_not_of("0123456789.eE+-") == std::string::npos)
      hint = ": leave out the quotes";
    file_->report(at, fmt::format("{} must be {}{}; got {}{}", at, expected_number(key),
                                  doc_of(key.doc), describe(node), hint));
    return {};
  }
  if (!std::isfinite(*x) || !key.range.contains(*x)) {
    file_->report(at, fmt::format("{} = {} is out of range: {} must be {}", at,
                                  with_unit(fmt::format("{}", *x), key.unit),
                                  key.doc.empty() ? at : key.doc, expected_number(key)));
    return {};
  }
  if (const std::string why = why_senseless(*x, key.unit, key.range); !why.empty()) {
    file_->report(at,
                  fmt::format("{} = {} is out of range{}: {}", at,
                              with_unit(fmt::format("{}", *x), key.unit), doc_of(key.doc), why));
    return {};
  }
  return x;
}

std::optional<double> TomlReader::optional_number(const NumberKey& key) {
  expect(key.key);
  const toml::node* node = get(key.key);
  return node == nullptr ? std::nullopt : checked(*node, path_of(key.key), key);
}

double TomlReader::number(const NumberKey& key) {
  if (!has(key.key)) {
    expect(key.key);
    if (!key.fallback) missing(key.key, expected_number(key) + doc_of(key.doc));
    return key.fallback.value_or(nan);
  }
  return optional_number(key).value_or(nan);
}

std::int64_t TomlReader::integer(std::string_view key, std::string_view doc, std::int64_t lower,
                                 std::int64_t upper, std::optional<std::int64_t> fallback) {
  expect(key);
  const std::string expected = fmt::format("an integer from {} to {}{}", lower, upper, doc_of(doc));
  const toml::node* node = get(key);
  if (node == nullptr) {
    if (!fallback) missing(key, expected);
    return fallback.value_or(lower);
  }
  std::optional<std::int64_t> value;
  if (const auto* exact = node->as_integer()) value = exact->get();
  if (!value || *value < lower || *value > upper) {
    wrong_type(key, expected);
    return fallback.value_or(lower);
  }
  return *value;
}

bool TomlReader::boolean(std::string_view key, bool fallback) {
  expect(key);
  const toml::node* node = get(key);
  if (node == nullptr) return fallback;
  if (const auto* value = node->as_boolean()) return value->get();
  wrong_type(key, "true or false");
  return fallback;
}

std::string TomlReader::text(std::string_view key, std::string_view doc,
                             std::optional<std::string> fallback) {
  expect(key);
  const toml::node* node = get(key);
  const std::string expected = "a string" + doc_of(doc);
  if (node == nullptr) {
    if (!fallback) missing(key, expected);
    return fallback.value_or("");
  }
  if (const auto* value = node->as_string()) return value->get();
  wrong_type(key, expected);
  return fallback.value_or("");
}

std::size_t TomlReader::choice(std::string_view key, const std::vector<std::string_view>& words,
                               std::size_t fallback) {
  return optional_choice(key, words).value_or(fallback);
}

std::optional<std::size_t> TomlReader::optional_choice(std::string_view key,
                                                       const std::vector<std::string_view>& words) {
  expect(key);
  const toml::node* node = get(key);
  if (node == nullptr) return {};
  return position(*node, path_of(key), words);
}

std::optional<std::size_t> TomlReader::position(const toml::node& node, std::string_view at,
                                                const std::vector<std::string_view>& words) {
  const auto* value = node.as_string();
  if (value != nullptr) {
    const auto found = std::find(words.begin(), words.end(), value->get());
    if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  }
  const std::string near = value == nullptr ? "" : nearest_name(value->get(), words);
  file_->report(at,
                fmt::format("{} must be {}\"{}\"; got {}{}", at, words.size() == 1 ? "" : "one of ",
                            fmt::join(words, "\", \""), describe(node),
                            near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
  return {};
}

std::optional<std::vector<std::size_t>> TomlReader::choices(
    std::string_view key, const std::vector<std::string_view>& words) {
  expect(key);
  const toml::node* node = get(key);
  if (node == nullptr) return {};
  const toml::array* list = node->as_array();
  if (list == nullptr || list->empty()) {
    wrong_type(key, fmt::format("a list of \"{}\"", fmt::join(words, "\", \"")));
    return {};
  }
  std::vector<std::size_t> values;
  for (std::size_t i = 0; i < list->size(); ++i)
    values.push_back(
        position(*list->get(i), fmt::format("{}[{}]", path_of(key), i), words).value_or(0));
  return values;
}

std::vector<double> TomlReader::checked_list(const toml::array& list, const NumberKey& key) {
  std::vector<double> values;
  for (std::size_t i = 0; i < list.size(); ++i)
    values.push_back(
        checked(*list.get(i), fmt::format("{}[{}]", path_of(key.key), i), key).value_or(nan));
  return values;
}

std::optional<std::vector<double>> TomlReader::number_list(const NumberKey& key) {
  expect(key.key);
  const toml::node* node = get(key.key);
  if (node == nullptr) return {};
  const toml::array* list = node->as_array();
  if (list == nullptr || list->empty()) {
    wrong_type(key.key, fmt::format("a list of numbers{}{}",
                                    key.unit == "-" ? "" : fmt::format(" in {}", key.unit),
                                    doc_of(key.doc)));
    return {};
  }
  return checked_list(*list, key);
}

std::optional<std::vector<double>> TomlReader::numbers(const NumberKey& key, std::size_t count) {
  expect(key.key);
  const toml::node* node = get(key.key);
  if (node == nullptr) return {};
  const toml::array* list = node->as_array();
  if (list == nullptr || list->size() != count) {
    wrong_type(key.key, fmt::format("a list of {} numbers{}{}", count,
                                    key.unit == "-" ? "" : fmt::format(" in {}", key.unit),
                                    doc_of(key.doc)));
    return {};
  }
  return checked_list(*list, key);
}

std::array<double, 2> TomlReader::pair(const NumberKey& key,
                                       std::optional<std::array<double, 2>> fallback) {
  std::optional<std::array<double, 3>> there;
  if (fallback) there = {(*fallback)[0], (*fallback)[1], 0.0};
  const std::array<double, 3> read = vector(key, 2, there);
  return {read[0], read[1]};
}

std::array<double, 3> TomlReader::vector(const NumberKey& key, std::size_t axes,
                                         std::optional<std::array<double, 3>> fallback) {
  std::array<double, 3> read{nan, nan, axes == 2 ? 0.0 : nan};
  if (!has(key.key)) {
    expect(key.key);
    if (!fallback)
      missing(key.key,
              fmt::format("{}{}{}", axes == 2 ? "[x, y]" : "[x, y, z]",
                          key.unit == "-" ? "" : fmt::format(" in {}", key.unit), doc_of(key.doc)));
    return fallback.value_or(read);
  }
  if (const auto values = numbers(key, axes))
    std::copy(values->begin(), values->end(), read.begin());
  return read;
}

TomlReader TomlReader::table(std::string_view key) {
  expect(key);
  const toml::node* node = get(key);
  const toml::table* below = node == nullptr ? nullptr : node->as_table();
  const bool wrong = node != nullptr && below == nullptr;
  if (wrong) wrong_type(key, "a table");
  return {*file_, below, path_of(key), wrong || broken_};
}

std::vector<TomlReader> TomlReader::tables(std::string_view key, std::string_view doc) {
  expect(key);
  const toml::node* node = get(key);
  const std::string heading = fmt::format("[[{}]]", path_of(key));
  std::vector<TomlReader> entries;
  const toml::array* list = node == nullptr ? nullptr : node->as_array();
  if (node == nullptr || (list != nullptr && list->empty())) {
    report(key, fmt::format("{} needs at least one {}{}", table_name(path_), heading, doc_of(doc)));
    return entries;
  }
  if (list == nullptr) {
    wrong_type(key, fmt::format("a list of tables, each headed {}{}", heading, doc_of(doc)));
    // its keys are no news beyond that
    if (node->is_table()) file_->expect_any(path_of(key));
    return entries;
  }
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string at = fmt::format("{}[{}]", path_of(key), i);
    if (const toml::table* entry = list->get(i)->as_table())
      entries.push_back({*file_, entry, at});
    else
      file_->report(at, fmt::format("{} must be a table; got {}", at, describe(*list->get(i))));
  }
  return entries;
}

std::vector<std::string> TomlReader::keys() const {
  std::vector<std::string> names;
  if (table_ == nullptr) return names;
  for (const auto& [key, node] : *table_)
    if (std::find(left_out_.begin(), left_out_.end(), key.str()) == left_out_.end())
      names.emplace_back(key.str());
  return names;
}

}  // namespace repose::input

#include "tests/fuzz/input_mutator.hpp"

#include <array>
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "input/read_law.hpp"
#include "input/read_stability.hpp"
#include "input/schema.hpp"

namespace repose::fuzz {
namespace {

using input::KeyInfo;
using input::ValueKind;

std::size_t below(std::size_t n, Random& random) {
  return static_cast<std::size_t>(random() % static_cast<std::uint64_t>(n));
}
bool one_in(std::size_t n, Random& random) { return below(n, random) == 0; }

template <std::size_t n>
std::string_view pick(const std::array<std::string_view, n>& list, Random& random) {
  return list[below(n, random)];
}

/// Any number: the edges of doubles and of counts, and sizes between.
std::string wild_number(Random& random) {
  static constexpr std::array<std::string_view, 26> edges{"0",       "-1",
                                                          "1e-308",  "1e-20",
                                                          "1e17",    "1e308",
                                                          "5e-324",  "-0.0",
                                                          "inf",     "-inf",
                                                          "nan",     "1e-9",
                                                          "1e80",    "1e6",
                                                          "1e-6",    "1e12",
                                                          "1000000", "9223372036854775807",
                                                          "0.5",     "1e300",
                                                          "-1e300",  "1e-300",
                                                          "1e9",     "1e15",
                                                          "-1e-12",  "-9223372036854775808"};
  if (one_in(2, random)) return std::string(pick(edges, random));
  const double mantissa = 1.0 + 9.0 * static_cast<double>(below(1000, random)) / 1000.0;
  const int exponent = static_cast<int>(below(25, random)) - 12;
  return fmt::format("{}{:.3g}e{}", one_in(4, random) ? "-" : "", mantissa, exponent);
}

/// One in the key's range, and near what people give.
std::string tame_number(const KeyInfo& key, Random& random) {
  const double low = std::isfinite(key.range.lower) ? key.range.lower : -10.0;
  const double high = std::isfinite(key.range.upper) ? key.range.upper : std::max(10.0, 10.0 * low);
  static constexpr std::array<double, 12> usual{0.0, 0.0125, 0.025, 0.05, 0.1, 0.2,
                                                0.4, 0.5,    1.0,   2.0,  1e3, 1e5};
  const double x = usual[below(usual.size(), random)];
  if (x >= low && x <= high) return fmt::format("{}", x);
  return fmt::format("{}", low + (high - low) * static_cast<double>(below(100, random)) / 99.0);
}

std::string in_quotes(std::string_view word) { return fmt::format("\"{}\"", word); }

std::string any_text(Random& random) {
  static constexpr std::array<std::string_view, 30> words{"",           "a",
                                                          "flat_mu_i",  "t.csv",
                                                          "h.csv",      "law.toml",
                                                          "scene.toml", "missing.csv",
                                                          "..",         "/",
                                                          "/dev/zero",  "/dev/null",
                                                          "eps_a",      "q_Pa",
                                                          "sigma_a_Pa", "time_s",
                                                          "kPa",        "%",
                                                          "mu_i",       "modified_cam_clay",
                                                          "newtonian",  "levenberg_marquardt",
                                                          "LN_BOBYQA",  "none",
                                                          "p",          "ocr",
                                                          "front_m",    "depth_m",
                                                          "x_m",        "weald_clay_undrained"};
  return in_quotes(pick(words, random));
}

std::string value_text(const KeyInfo& key, Random& random, int depth = 0);

std::string table_text(const std::vector<KeyInfo>& keys, Random& random, int depth, bool open) {
  std::string text = "{ ";
  bool first = true;
  const auto add = [&](const std::string& name, const std::string& value) {
    text += fmt::format("{}\"{}\" = {}", first ? "" : ", ", name, value);
    first = false;
  };
  for (const KeyInfo& key : keys) {
    if (key.name.empty()) {  // one of several forms
      const KeyInfo& form = key.below[below(key.below.size(), random)];
      if (!form.name.empty()) add("name", in_quotes(form.name));
      for (const KeyInfo& parameter : form.below)
        if (!one_in(8, random)) add(parameter.name, value_text(parameter, random, depth + 1));
    } else if (key.required ? !one_in(16, random) : one_in(3, random)) {
      add(key.name, value_text(key, random, depth + 1));
    }
  }
  if (open && first) {
    static constexpr std::array<std::string_view, 14> names{"initial.ocr",
                                                            "grid.h",
                                                            "body[0].law.K",
                                                            "step.courant",
                                                            "scene.end_time",
                                                            "law.M",
                                                            "ocr",
                                                            "p",
                                                            "M",
                                                            "lambda",
                                                            "K",
                                                            "q_Pa",
                                                            "sweep",
                                                            "body[9].size[3]"};
    const std::size_t count = below(3, random);
    for (std::size_t i = 0; i < count; ++i) {
      std::string list = wild_number(random);
      for (std::size_t n = below(4, random); n > 0; --n) list += ", " + wild_number(random);
      add(std::string(pick(names, random)),
          one_in(2, random) ? "[" + list + "]" : wild_number(random));
    }
  }
  return text + " }";
}

std::string list_text(const KeyInfo& key, std::size_t length, Random& random, int depth) {
  KeyInfo one = key;
  one.kind = key.kind == ValueKind::word_list   ? ValueKind::word
             : key.kind == ValueKind::text_list ? ValueKind::text
             : key.kind == ValueKind::tables    ? ValueKind::table
                                                : ValueKind::number;
  std::string text = "[";
  for (std::size_t i = 0; i < length; ++i)
    text += (i == 0 ? "" : ", ") + value_text(one, random, depth + 1);
  return text + "]";
}

std::string of_any_kind(Random& random) {
  switch (below(9, random)) {
    case 0:
      return any_text(random);
    case 1:
      return one_in(2, random) ? "true" : "false";
    case 2:
      return "[]";
    case 3:
      return "{}";
    case 4:
      return "[[1, 2], [3]]";
    case 5:
      return "1979-05-27T07:32:00Z";
    case 6:
      return "[{ a = 1 }, 2, \"x\"]";
    default:
      return wild_number(random);
  }
}

std::string value_text(const KeyInfo& key, Random& random, int depth) {
  if (depth > 8 || one_in(40, random)) return of_any_kind(random);
  switch (key.kind) {
    case ValueKind::number:
      return one_in(6, random) ? wild_number(random) : tame_number(key, random);
    case ValueKind::integer: {
      if (one_in(6, random) || !key.limits) return wild_number(random);
      const auto span = static_cast<std::size_t>(std::min<double>(
          static_cast<double>(key.limits->upper) - static_cast<double>(key.limits->lower) + 1.0,
          one_in(8, random) ? 1e18 : 20.0));
      return fmt::format("{}", key.limits->lower + static_cast<std::int64_t>(below(span, random)));
    }
    case ValueKind::boolean:
      return one_in(2, random) ? "true" : "false";
    case ValueKind::text:
      return any_text(random);
    case ValueKind::word:
      return key.words.empty() ? any_text(random)
                               : in_quotes(key.words[below(key.words.size(), random)]);
    case ValueKind::number_list:
    case ValueKind::word_list:
    case ValueKind::text_list:
    case ValueKind::tables: {
      const std::size_t least = std::max<std::size_t>(key.least, 1);
      const std::size_t most = key.most > 0 ? key.most : least + 3;
      const std::size_t length =
          one_in(12, random) ? below(9, random) : least + below(most - least + 1, random);
      return list_text(key, length, random, depth);
    }
    case ValueKind::corner_list: {
      std::string text = "[";
      for (std::size_t k = 0, n = below(7, random); k < n; ++k) {
        text += k > 0 ? ", [" : "[";
        for (std::size_t i = 0, m = one_in(12, random) ? below(4, random) : 2; i < m; ++i)
          text += (i > 0 ? ", " : "") +
                  (one_in(12, random) ? wild_number(random) : tame_number(key, random));
        text += "]";
      }
      return text + "]";
    }
    case ValueKind::table:
      return table_text(key.below, random, depth, key.open);
    case ValueKind::any_of:
      break;
  }
  if (key.below.empty()) return of_any_kind(random);
  return value_text(key.below[below(key.below.size(), random)], random, depth + 1);
}

/// Where a known key may stand: "body.initial.p" as its steps.
struct Place {
  std::vector<const KeyInfo*> steps;
};

void collect(const std::vector<KeyInfo>& keys, std::vector<const KeyInfo*>& above,
             std::vector<Place>& places) {
  for (const KeyInfo& key : keys) {
    if (key.name.empty()) {
      for (const KeyInfo& form : key.below)
        if (!form.below.empty()) collect(form.below, above, places);
      continue;
    }
    above.push_back(&key);
    places.push_back({above});
    if (above.size() < 6) {
      if (key.kind == ValueKind::any_of)
        for (const KeyInfo& form : key.below) collect(form.below, above, places);
      else
        collect(key.below, above, places);
    }
    above.pop_back();
  }
}

/// The value as a node; null if the text is none.
std::unique_ptr<toml::node> node_of(const std::string& text) {
  try {
    toml::table one = toml::parse("v = " + text + "\n");
    std::unique_ptr<toml::node> node;
    one.get("v")->visit([&](auto& value) {
      node = std::make_unique<std::remove_cvref_t<decltype(value)>>(std::move(value));
    });
    return node;
  } catch (const toml::parse_error&) {
    return nullptr;
  }
}

void put(toml::table& table, std::string_view key, const toml::node& node) {
  node.visit([&](const auto& value) { table.insert_or_assign(key, value); });
}

/// Sets a known key, making the tables above it where they are missing.
void set_known(toml::table& root, const Place& place, Random& random) {
  toml::table* table = &root;
  for (std::size_t i = 0; i + 1 < place.steps.size(); ++i) {
    const KeyInfo& step = *place.steps[i];
    toml::node* next = table->get(step.name);
    if (next == nullptr) {
      if (step.kind == ValueKind::tables)
        table->insert(step.name, toml::array{toml::table{}});
      else
        table->insert(step.name, toml::table{});
      next = table->get(step.name);
    }
    if (toml::array* list = next->as_array(); list != nullptr && !list->empty())
      next = list->get(below(list->size(), random));
    table = next->as_table();
    if (table == nullptr) return;
  }
  const KeyInfo& key = *place.steps.back();
  if (const auto node = node_of(value_text(key, random))) put(*table, key.name, *node);
}

/// All tables and lists of a document.
struct Parts {
  std::vector<toml::table*> tables;
  std::vector<toml::array*> lists;
};
void collect(toml::node& node, Parts& parts) {
  if (toml::table* table = node.as_table()) {
    parts.tables.push_back(table);
    for (auto&& [key, child] : *table) collect(child, parts);
  } else if (toml::array* list = node.as_array()) {
    parts.lists.push_back(list);
    for (toml::node& child : *list) collect(child, parts);
  }
}

std::string some_key(const toml::table& table, Random& random) {
  if (table.empty()) return "";
  auto it = table.cbegin();
  std::advance(it, static_cast<std::ptrdiff_t>(below(table.size(), random)));
  return std::string(it->first.str());
}

/// Something that a file has, changed where it stands.
void change_found(toml::table& root, Random& random) {
  Parts parts;
  collect(root, parts);
  toml::table& table = *parts.tables[below(parts.tables.size(), random)];
  const std::string key = some_key(table, random);
  switch (below(6, random)) {
    case 0:
      if (!key.empty()) table.erase(key);
      break;
    case 1:
      if (!key.empty())
        if (const auto node = node_of(wild_number(random))) put(table, key, *node);
      break;
    case 2:
      if (!key.empty())
        if (const auto node = node_of(of_any_kind(random))) put(table, key, *node);
      break;
    case 3: {  // the same elsewhere
      if (key.empty()) break;
      std::unique_ptr<toml::node> copy;
      table.get(key)->visit([&](auto& value) {
        copy = std::make_unique<std::remove_cvref_t<decltype(value)>>(value);
      });
      put(*parts.tables[below(parts.tables.size(), random)], key, *copy);
      break;
    }
    case 4: {  // a letter of the key
      if (key.empty() || key.size() > 40) break;
      std::string other = key;
      other[below(other.size(), random)] = static_cast<char>('a' + below(26, random));
      std::unique_ptr<toml::node> copy;
      table.get(key)->visit([&](auto& value) {
        copy = std::make_unique<std::remove_cvref_t<decltype(value)>>(std::move(value));
      });
      table.erase(key);
      put(table, other, *copy);
      break;
    }
    default: {  // an entry of a list
      if (parts.lists.empty()) break;
      toml::array& list = *parts.lists[below(parts.lists.size(), random)];
      if (list.empty()) break;
      const std::size_t at = below(list.size(), random);
      if (one_in(2, random)) {
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(at));
      } else {
        std::unique_ptr<toml::node> copy;
        list.get(at)->visit([&](auto& value) {
          copy = std::make_unique<std::remove_cvref_t<decltype(value)>>(value);
        });
        copy->visit([&](const auto& value) { list.push_back(value); });
      }
    }
  }
}

std::string text_of(const toml::table& root) {
  std::ostringstream text;
  text << root << "\n";
  return std::move(text).str();
}

}  // namespace

InputMutator::InputMutator() {
  for (std::size_t k = 0; k < input::schema_names.size(); ++k)
    kinds_.push_back(
        {std::string(input::schema_names[k]), input::keys_of(static_cast<input::SchemaKind>(k))});
  input::StabilityInput maps;
  LawSpec law;
  kinds_.push_back({"stability", input::describe_keys([&](input::Keys& keys) {
                      keys.table({"stability"},
                                 [&](input::Keys& k) { input::stability_keys(k, maps); });
                      keys.table({"law"}, [&](input::Keys& k) { input::law_keys(k, law); });
                    })});
}

std::string InputMutator::made_up(std::size_t kind, Random& random) const {
  const auto node = node_of(table_text(kinds_[kind].keys, random, 0, false));
  return node == nullptr ? std::string() : text_of(*node->as_table());
}

std::string InputMutator::changed(const std::string& text, Random& random) const {
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error&) {
    return text;
  }
  // the kind is that whose tables the file has most of
  std::size_t kind = 0, most = 0;
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    std::size_t found = 0;
    for (const KeyInfo& key : kinds_[k].keys) found += root.contains(key.name) ? 1 : 0;
    if (found > most) {
      most = found;
      kind = k;
    }
  }
  static thread_local std::vector<std::vector<Place>> places(kinds_.size());
  if (places[kind].empty()) {
    std::vector<const KeyInfo*> above;
    collect(kinds_[kind].keys, above, places[kind]);
  }
  for (std::size_t n = 1 + below(3, random); n > 0; --n)
    if (one_in(3, random))
      change_found(root, random);
    else
      set_known(root, places[kind][below(places[kind].size(), random)], random);
  return text_of(root);
}

}  // namespace repose::fuzz

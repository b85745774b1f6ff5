#include "input/input_file.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include "io/atomic_file.hpp"
#include "io/seal.hpp"

namespace repose::input {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::is_directory(status)) throw io::IoError(file, "is a folder; give the .toml file in it");
  if (!fs::exists(status)) {
    const std::string near = similar_file(file);
    throw io::IoError(
        file, "there is no such file" + (near.empty() ? "" : "; did you mean " + near + "?"));
  }
  constexpr std::size_t most_bytes = 16'000'000;  // what is longer was not written by hand
  return io::read_bytes(file, most_bytes);
}

/// What nobody would take for a broken number, string, list or table.
bool is_bare_word(std::string_view text) {
  const auto fits = [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-' || c == '.' || c == '/';
  };
  return std::isdigit(static_cast<unsigned char>(text.front())) == 0 && text.front() != '-' &&
         std::all_of(text.begin(), text.end(), fits);
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())))
    text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())))
    text.remove_suffix(1);
  return text;
}

/// One step of a key path: a key, or a position in the list that the key before it names.
struct PathStep {
  std::string key;
  std::size_t index = 0;
  bool is_index = false;
};

/// "body[0].law.K"; throws std::invalid_argument with the reason.
std::vector<PathStep> split_path(std::string_view path) {
  std::vector<PathStep> steps;
  std::size_t at = 0;
  while (true) {
    const std::size_t end = std::min(path.find_first_of(".[", at), path.size());
    const std::string_view key = path.substr(at, end - at);
    const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
      return std::isalnum(c) || c == '_' || c == '-';
    });
    if (!bare) throw std::invalid_argument(fmt::format("'{}' is not a key", path));
    steps.push_back({std::string(key)});
    at = end;
    while (at < path.size() && path[at] == '[') {
      const std::size_t close = path.find(']', at);
      const std::string_view digits =
          close == std::string_view::npos ? "" : path.substr(at + 1, close - at - 1);
      const bool number = !digits.empty() && digits.size() < 7 &&
                          std::all_of(digits.begin(), digits.end(),
                                      [](unsigned char c) { return std::isdigit(c) != 0; });
      if (!number)
        throw std::invalid_argument("a position in a list is written as in body[0].size[1]");
      steps.push_back({"", static_cast<std::size_t>(std::stoul(std::string(digits))), true});
      at = close + 1;
    }
    if (at == path.size()) return steps;
    if (path[at] != '.') throw std::invalid_argument(fmt::format("'{}' is not a key", path));
    ++at;
  }
}

/// What is usually meant where TOML cannot be read: its parser tells what it did not expect.
std::string toml_advice(std::string_view text, unsigned line, std::string_view complaint) {
  const auto says = [&](std::string_view part) {
    return complaint.find(part) != std::string_view::npos;
  };
  for (unsigned k = 1; k < line && text.find('\n') != std::string_view::npos; ++k)
    text.remove_prefix(text.find('\n') + 1);
  const std::string_view row = text.substr(0, text.find('\n'));
  const std::size_t equals = row.find('=');
  const std::string_view after = equals == std::string_view::npos ? "" : row.substr(equals + 1);
  if (says("cannot redefine")) return "the key stands twice; leave one out";
  if (says("expected '='")) return "a line is written as key = value";
  if (std::count(row.begin(), row.end(), '"') % 2 == 1)
    return "a text that begins with a quote ends with one";
  const bool after_number = !trimmed(after).empty() &&
                            (std::isdigit(static_cast<unsigned char>(trimmed(after).front())) ||
                             trimmed(after).front() == '-' || trimmed(after).front() == '.');
  if (says("saw ','") && after_number) return "a number has a point, as in 0.95";
  if (says("expected a comment or whitespace") && after_number)
    return "a number stands alone: units are SI and belong into a comment, 207e3  # Pa";
  if (says("saw") && !after.empty() && after_number == false)
    return "texts stand in quotes, lists in [ ], tables in { }";
  return "";
}

/// What a parser says of a place in a text, and what to do about it.
BadInput broken_toml(const toml::parse_error& error, const std::string& name,
                     std::string_view text) {
  const toml::source_position at = error.source().begin;
  const std::string advice = toml_advice(text, at.line, error.description());
  return BadInput({fmt::format("{}: {}{}", to_string(Origin{name, at.line, at.column}),
                               error.description(), advice.empty() ? "" : ": " + advice)});
}

std::string kind_of(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return "a list";
  return "a value";
}

/// The value in `parent` that a step leads to; a missing key is begun as a table.
toml::node* descend(toml::node& parent, const PathStep& step, const std::string& so_far) {
  if (step.is_index) {
    toml::array* list = parent.as_array();
    if (list == nullptr)
      throw std::invalid_argument(fmt::format("{} is {}, not a list", so_far, kind_of(parent)));
    if (step.index >= list->size())
      throw std::invalid_argument(
          list->empty()       ? fmt::format("{} is empty", so_far)
          : list->size() == 1 ? fmt::format("there is only {}[0]", so_far)
                              : fmt::format("the last one is {}[{}]", so_far, list->size() - 1));
    return list->get(step.index);
  }
  toml::table* table = parent.as_table();
  if (table == nullptr)
    throw std::invalid_argument(
        fmt::format("{} is {}, not a table{}", so_far, kind_of(parent),
                    parent.is_array() ? fmt::format("; the first entry is {}[0]", so_far) : ""));
  return &table->insert(step.key, toml::table{}).first->second;
}

}  // namespace

std::string similar_file(const fs::path& file) {
  const std::string extension = file.has_extension() ? file.extension().string() : ".toml";
  std::vector<std::string> names;
  std::error_code error;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == extension) names.push_back(it->path().filename().string());
  std::sort(names.begin(), names.end());
  const std::string wanted = file.filename().string();
  for (const std::string& name : names)
    if (name == wanted + extension) return (file.parent_path() / name).string();
  for (const std::string& name : names)
    if (name.starts_with(file.stem().string())) return (file.parent_path() / name).string();
  const std::vector<std::string_view> views(names.begin(), names.end());
  const std::string near = nearest_name(wanted, views);
  return near.empty() ? "" : (file.parent_path() / near).string();
}

std::string to_string(const Origin& origin) {
  if (origin.is_override()) return origin.source;
  return fmt::format("{}:{}:{}", origin.source, origin.line, origin.column);
}

BadInput::BadInput(std::vector<std::string> problems)
    : std::runtime_error(fmt::format("{}", fmt::join(problems, "\n"))),
      problems_(std::move(problems)) {}

std::string closest(std::string_view misspelt, const std::vector<std::string_view>& known) {
  const std::string near = nearest_name(misspelt, known);
  if (!near.empty()) return near;
  const auto letters = [](std::string_view word) {
    std::string sorted(word);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  for (const std::string_view word : known)
    if (letters(word) == letters(misspelt)) return std::string(word);
  return "";
}

std::string join_path(std::string_view table, std::string_view key) {
  return table.empty() ? std::string(key) : fmt::format("{}.{}", table, key);
}

std::string table_name(std::string_view path) {
  if (path.empty()) return "the file";
  if (path.find_first_of(".[") == std::string_view::npos) return fmt::format("[{}]", path);
  return std::string(path);
}

InputFile InputFile::read(const fs::path& file, std::span<const std::string> overrides) {
  return parse(read_text(file), file.string(), overrides);
}

InputFile InputFile::parse(std::string_view text, std::string name,
                           std::span<const std::string> overrides) {
  InputFile input;
  input.name_ = std::move(name);
  try {
    input.root_ = toml::parse(text, input.name_);
  } catch (const toml::parse_error& error) {
    throw broken_toml(error, input.name_, text);
  }
  const Origin top{input.name_, 1, 1};
  input.origins_[""] = top;
  input.note_origins(input.root_, "", top);
  return input.with(overrides);
}

InputFile InputFile::from_table(std::string_view text, std::string name,
                                std::span<const std::string> overrides) {
  InputFile input = parse(text, std::move(name));
  for (auto& [path, origin] : input.origins_)
    origin = {path.empty() ? input.name_ : fmt::format("{}, {}", input.name_, path)};
  return input.with(overrides);
}

InputFile InputFile::with(std::span<const std::string> overrides) const {
  InputFile input = *this;
  for (const std::string& one : overrides) {
    // law.M changes the law of another file; law itself stands in for it
    if (one.find("law.") < one.find('=')) input.take_laws_over();
    input.override_with(one);
  }
  input.take_laws_over();
  return input;
}

void InputFile::take_laws_over() {
  take_law_over(root_, "law");
  if (toml::array* bodies = root_["body"].as_array())
    for (std::size_t i = 0; i < bodies->size(); ++i)
      if (toml::table* body = bodies->get(i)->as_table())
        take_law_over(*body, fmt::format("body[{}].law", i));
}

void InputFile::take_law_over(toml::table& parent, const std::string& path) {
  const std::optional<std::string> named = parent["law"].value<std::string>();
  if (!named || !named->ends_with(".toml")) return;
  const Origin here = origin(path);
  const auto refuse = [&](std::string_view why) {
    throw BadInput({fmt::format("{}: {}", to_string(here), why)});
  };
  const fs::path file =
      here.is_override() ? fs::path(*named) : fs::path(here.source).parent_path() / *named;
  toml::table other;
  std::string text;
  try {
    text = read_text(file);
    other = toml::parse(text, file.string());
  } catch (const toml::parse_error& error) {
    throw broken_toml(error, file.string(), text);
  } catch (const io::IoError& error) {
    refuse(error.what());
  }
  const toml::table* law = other["law"].as_table();
  if (law == nullptr)
    refuse(fmt::format("{} has no [law] table to take over; the fitted.toml of a fit has one",
                       file.string()));
  const toml::source_position at = law->source().begin;
  const Origin there{file.string(), at.line, at.column};
  origins_[path] = there;
  note_origins(*law, path, there);
  parent.insert_or_assign("law", *law);
}

void InputFile::note_origins(const toml::table& table, const std::string& path,
                             const Origin& around) {
  for (const auto& [key, node] : table) {
    const toml::source_position at = key.source().begin;
    const Origin here =
        around.is_override() || !at ? around : Origin{around.source, at.line, at.column};
    const std::string child = join_path(path, key.str());
    origins_[child] = here;
    note_origins(node, child, here);
  }
}

void InputFile::note_origins(const toml::node& node, const std::string& path,
                             const Origin& around) {
  if (const toml::table* table = node.as_table()) {
    note_origins(*table, path, around);
  } else if (const toml::array* list = node.as_array()) {
    for (std::size_t i = 0; i < list->size(); ++i) {
      const toml::node& entry = *list->get(i);
      const toml::source_position at = entry.source().begin;
      const Origin here =
          around.is_override() || !at ? around : Origin{around.source, at.line, at.column};
      const std::string child = fmt::format("{}[{}]", path, i);
      origins_[child] = here;
      note_origins(entry, child, here);
    }
  }
}

void InputFile::override_with(const std::string& text) {
  const Origin here{"--set " + text};
  const auto refuse = [&](std::string_view why) {
    throw BadInput({fmt::format("{}: {}", to_string(here), why)});
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) refuse("needs the form key=value, as in --set grid.h=0.0125");
  const std::string path(trimmed(std::string_view(text).substr(0, equals)));
  const std::string_view value = trimmed(std::string_view(text).substr(equals + 1));
  if (value.empty()) refuse(fmt::format("{} gets no value", path));
  if (value.find_first_of("\r\n") != std::string_view::npos) refuse("a value is one line");

  toml::table parsed;
  try {
    parsed = toml::parse(fmt::format("value = {}", value));
  } catch (const toml::parse_error& error) {
    if (!is_bare_word(value))
      refuse(fmt::format("{} is not a TOML value: {}", value, error.description()));
    parsed.insert_or_assign("value", std::string(value));
  }
  try {
    const std::vector<PathStep> steps = split_path(path);
    toml::node* parent = &root_;
    std::string so_far;
    for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
      parent = descend(*parent, steps[i], so_far);
      so_far = steps[i].is_index ? fmt::format("{}[{}]", so_far, steps[i].index)
                                 : join_path(so_far, steps[i].key);
      if (!origins_.contains(so_far)) origins_[so_far] = here;
    }
    const PathStep& last = steps.back();
    if (last.is_index) {
      descend(*parent, last, so_far);  // checks that the entry is there
      parsed.get("value")->visit([&](auto& node) {
        parent->as_array()->replace(
            parent->as_array()->cbegin() + static_cast<std::ptrdiff_t>(last.index),
            std::move(node));
      });
    } else {
      if (!parent->is_table()) descend(*parent, last, so_far);  // throws
      parsed.get("value")->visit(
          [&](auto& node) { parent->as_table()->insert_or_assign(last.key, std::move(node)); });
    }
  } catch (const std::invalid_argument& error) {
    refuse(error.what());
  }
  // whatever lay below the key is gone
  std::erase_if(origins_, [&](const auto& entry) {
    return entry.first.starts_with(path + ".") || entry.first.starts_with(path + "[");
  });
  origins_[path] = here;
}

Origin InputFile::origin(std::string_view key_path) const {
  while (true) {
    if (const auto found = origins_.find(key_path); found != origins_.end()) return found->second;
    const std::size_t cut = key_path.find_last_of(".[");
    key_path = cut == std::string_view::npos ? std::string_view() : key_path.substr(0, cut);
  }
}

void InputFile::report(std::string_view key_path, std::string_view message) {
  problems_.push_back({origin(key_path), std::string(message)});
}

void InputFile::report(const InputError& error, std::string_view prefix) {
  report(join_path(prefix, error.key()), error.what());
}

void InputFile::expect(std::string_view table_path, std::string_view key) {
  expected_[std::string(table_path)].emplace(key);
}

void InputFile::expect_any(std::string_view table_path) { any_key_.emplace(table_path); }

std::string InputFile::advice(std::string_view table_path, std::string_view key) const {
  const auto here = expected_.find(table_path);
  if (here == expected_.end()) return "";
  const std::vector<std::string_view> names(here->second.begin(), here->second.end());
  const std::string near = closest(key, names);
  if (!near.empty()) return fmt::format("; did you mean '{}'?", near);
  for (const auto& [path, keys] : expected_)
    if (keys.contains(key)) return fmt::format("; it belongs in {}", table_name(path));
  return fmt::format("; {} takes {}", table_name(table_path), fmt::join(names, ", "));
}

void InputFile::find_unknown(const toml::table& table, const std::string& path) {
  if (any_key_.contains(path)) {
    // its keys are checked elsewhere; what lies below them is not
    for (const auto& [key, node] : table) find_unknown(node, join_path(path, key.str()));
    return;
  }
  const auto known = expected_.find(path);
  // a table that no reader opened belongs to a key that has been reported, or was read as a whole
  if (known == expected_.end()) return;
  for (const auto& [key, node] : table) {
    const std::string child = join_path(path, key.str());
    if (known->second.contains(key.str()))
      find_unknown(node, child);
    else
      report(child, fmt::format("unknown {} '{}' in {}{}", node.is_table() ? "table" : "key",
                                key.str(), table_name(path), advice(path, key.str())));
  }
}

void InputFile::find_unknown(const toml::node& node, const std::string& path) {
  if (const toml::table* table = node.as_table()) find_unknown(*table, path);
  if (const toml::array* list = node.as_array())
    for (std::size_t i = 0; i < list->size(); ++i)
      find_unknown(*list->get(i), fmt::format("{}[{}]", path, i));
}

void InputFile::throw_if_bad() {
  find_unknown(root_, "");
  if (problems_.empty()) return;
  std::stable_sort(problems_.begin(), problems_.end(), [](const Problem& a, const Problem& b) {
    return std::tie(a.origin.line, a.origin.column) < std::tie(b.origin.line, b.origin.column);
  });
  std::vector<std::string> texts;
  for (const Problem& problem : problems_)
    texts.push_back(fmt::format("{}: {}", to_string(problem.origin), problem.message));
  problems_.clear();
  throw BadInput(std::move(texts));
}

}  // namespace repose::input

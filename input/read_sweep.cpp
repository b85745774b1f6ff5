#include "input/read_sweep.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "input/key_info.hpp"
#include "input/read_chart.hpp"
#include "input/toml_reader.hpp"
#include "input/toml_text.hpp"
#include "io/atomic_file.hpp"
#include "io/measured_table.hpp"
#include "io/number_text.hpp"

namespace repose::input {
namespace {

namespace fs = std::filesystem;

struct Entry {
  std::string key;
  const toml::node* value;
};

/// "initial.ocr" = …, or initial.ocr = … (a table in a table): the keys as --set writes them, in
/// the order of the file.
void flatten(const toml::table& table, const std::string& path, std::vector<Entry>& entries) {
  for (const auto& [key, node] : table) {
    const std::string name = join_path(path, key.str());
    if (const toml::table* below = node.as_table())
      flatten(*below, name, entries);
    else
      entries.push_back({name, &node});
  }
}

std::vector<Entry> entries_of(const toml::table& table) {
  std::vector<Entry> entries;
  flatten(table, "", entries);
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    const auto &left = a.value->source().begin, &right = b.value->source().begin;
    return std::pair(left.line, left.column) < std::pair(right.line, right.column);
  });
  return entries;
}

/// A sweep that sets keys of [sweep] would be read anew in each of its runs.
bool may_vary(TomlReader& table, std::string_view at, const std::string& key) {
  if (key != "sweep" && !key.starts_with("sweep.")) return true;
  table.report(at, fmt::format("{}: a sweep cannot change [sweep] itself", table.path_of(at)));
  return false;
}

void read_grid(TomlReader& table, ParameterSets& sets) {
  const toml::table* grid = table.get("grid")->as_table();
  if (grid == nullptr || grid->empty()) {
    table.report("grid", "sweep.grid must be a table of lists, { \"initial.ocr\" = [1, 2, 4] }");
    return;
  }
  sets.values = {{}};
  for (const Entry& entry : entries_of(*grid)) {
    const toml::array* list = entry.value->as_array();
    if (!may_vary(table, "grid", entry.key)) return;
    if (list == nullptr || list->empty()) {
      table.report("grid", fmt::format("sweep.grid: \"{}\" needs a list of at least one value, and "
                                       "{} was found",
                                       entry.key, describe(*entry.value)));
      return;
    }
    if (sets.values.size() * list->size() > most_sweep_runs) {
      table.report("grid", fmt::format("sweep.grid asks for more than {} runs", most_sweep_runs));
      return;
    }
    sets.keys.push_back(entry.key);
    std::vector<std::vector<std::string>> more;
    for (const std::vector<std::string>& values : sets.values)
      for (const toml::node& value : *list) {
        more.push_back(values);
        more.back().push_back(value_text(value));
      }
    sets.values = std::move(more);
  }
}

void read_list(TomlReader& table, ParameterSets& sets) {
  const toml::array* list = table.get("list")->as_array();
  const bool tables = list != nullptr && !list->empty() &&
                      std::all_of(list->begin(), list->end(), [](const toml::node& node) {
                        return node.is_table() && !node.as_table()->empty();
                      });
  if (!tables || list->size() > most_sweep_runs) {
    table.report("list",
                 fmt::format("sweep.list must be a list of 1 to {} tables with at least "
                             "one key each, [{{ \"initial.ocr\" = 1 }}, {{ \"initial.ocr\" = 2 }}]",
                             most_sweep_runs));
    return;
  }
  for (const toml::node& node : *list) {
    std::vector<std::string> values(sets.keys.size());
    for (const Entry& entry : entries_of(*node.as_table())) {
      if (!may_vary(table, "list", entry.key)) return;
      const auto found = std::find(sets.keys.begin(), sets.keys.end(), entry.key);
      const auto at = static_cast<std::size_t>(found - sets.keys.begin());
      if (found == sets.keys.end()) {
        sets.keys.push_back(entry.key);
        values.emplace_back();
        for (std::vector<std::string>& before : sets.values) before.emplace_back();
      }
      values[at] = value_text(*entry.value);
    }
    sets.values.push_back(std::move(values));
  }
}

/// A cell as TOML: a number in any spelling that measured tables have, true or false as it is,
/// anything else a string.
std::string cell_text(std::string_view cell, char decimal) {
  if (cell.empty() || cell == "true" || cell == "false") return std::string(cell);
  const io::CellShape shape = io::shape_of(cell);
  if (shape.kind == io::CellKind::blank) return "";
  if (shape.kind == io::CellKind::number && (shape.mark == 0 || shape.mark == decimal))
    if (const auto number = io::value_of(cell, decimal)) {
      const bool whole = shape.mark == 0 && cell.find_first_of("eEdD") == std::string_view::npos &&
                         std::abs(*number) < 1e15;
      return whole ? fmt::format("{:.0f}", *number) : toml_number(*number);
    }
  return toml_string(cell);
}

void read_table(TomlReader& table, ParameterSets& sets) {
  const std::string name = table.text("table", "a file with a run in each row");
  if (!table.file().ok()) return;
  const Origin origin = table.file().origin("sweep.table");
  const fs::path file =
      origin.is_override() ? fs::path(name) : fs::path(origin.source).parent_path() / name;
  try {
    const io::RawTable rows = io::load_table(file);
    for (const io::ColumnHeader& header : rows.headers()) {
      sets.keys.push_back(header.text);
      if (header.text.empty()) {
        table.report("table", fmt::format("{}: a column has no name; a name is a key, as in "
                                          "initial.ocr",
                                          file.string()));
        return;
      }
      if (!may_vary(table, "table", header.text)) return;
      if (std::count(sets.keys.begin(), sets.keys.end(), header.text) > 1) {
        table.report("table",
                     fmt::format("{}: two columns are called {}", file.string(), header.text));
        return;
      }
    }
    if (rows.rows() > most_sweep_runs)
      table.report("table", fmt::format("{}: more than {} runs", file.string(), most_sweep_runs));
    for (std::size_t row = 0; row < rows.rows() && table.file().ok(); ++row) {
      std::vector<std::string>& values = sets.values.emplace_back();
      for (std::size_t column = 0; column < rows.columns(); ++column)
        values.push_back(cell_text(rows.cell(row, column), rows.layout().decimal));
    }
  } catch (const io::TableError& error) {
    table.report("table", error.what());
  } catch (const io::IoError& error) {
    const std::string near = similar_file(file);
    table.report("table", near.empty() ? error.what()
                                       : fmt::format("{}; did you mean {}?", error.what(), near));
  }
}

}  // namespace

std::vector<std::string> ParameterSets::sets(std::size_t k) const {
  std::vector<std::string> list;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (!values[k][i].empty()) list.push_back(fmt::format("{}={}", keys[i], values[k][i]));
  return list;
}

std::vector<std::string> ParameterSets::shown(std::size_t k) const {
  std::vector<std::string> list = values[k];
  for (std::string& value : list)
    if (value.size() >= 2 && (value.front() == '"' || value.front() == '\'') &&
        value.back() == value.front() && value.find('\\') == std::string::npos)
      value = value.substr(1, value.size() - 2);
  return list;
}

std::optional<ParameterSets> read_sweep(InputFile& file) {
  TomlReader root(file);
  root.expect("sweep");
  if (!root.has("sweep")) return std::nullopt;
  root.expect_any();  // what else the file holds is read in each of the runs
  TomlReader table = root.table("sweep");
  for (const char* const key : {"grid", "list", "table"}) table.expect(key);
  const int given = static_cast<int>(table.has("grid")) + static_cast<int>(table.has("list")) +
                    static_cast<int>(table.has("table"));
  ParameterSets sets;
  if (given != 1)
    table.report("", fmt::format("[sweep] needs one of grid, list and table, and has {}",
                                 given == 0 ? "none" : "several"));
  else if (table.has("grid"))
    read_grid(table, sets);
  else if (table.has("list"))
    read_list(table, sets);
  else
    read_table(table, sets);
  return sets;
}

void sweep_keys(Keys& keys) {
  keys.table({"sweep", "-", "many runs in one process, by one of the three"}, [](Keys& below) {
    KeyInfo any, list;
    any.kind = ValueKind::table;
    list.kind = ValueKind::tables;
    any.open = list.open = true;
    const auto nothing = [](TomlReader&) {};
    const auto none = [] { return std::string(); };
    below.value({"grid", "-",
                 "every combination of lists of values, { \"initial.ocr\" = [1, 2], … }; the "
                 "first key changes slowest"},
                nothing, none, any);
    below.value({"list", "-", "run by run, [{ \"initial.ocr\" = 1 }, …]"}, nothing, none, list);
    std::string table;
    below.text({"table", "-", "a file with a run in each row, and keys as headers"}, table);
  });
}

}  // namespace repose::input

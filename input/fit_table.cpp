#include "input/fit_table.hpp"

#include <cmath>
#include <system_error>

#include <fmt/format.h>

#include "io/atomic_file.hpp"

namespace repose::input {
namespace {

struct Source {
  std::size_t column = 0;
  double factor = 1.0, offset = 0.0;
};

/// "q_Pa" → "q"
std::string base_of(const std::string& quantity) {
  for (const std::string_view unit : {"_Pa", "_kPa", "_MPa", "_percent"})
    if (quantity.ends_with(unit)) return quantity.substr(0, quantity.size() - unit.size());
  return quantity;
}

std::optional<Source> find_column(const point::Table& table, const std::string& quantity) {
  struct Spelling {
    std::string name;
    double factor, offset;
  };
  const std::string base = base_of(quantity);
  std::vector<Spelling> spellings{{quantity, 1.0, 0.0}};
  if (quantity.ends_with("_Pa"))
    spellings.insert(spellings.end(), {{base + "_kPa", 1e3, 0.0}, {base + "_MPa", 1e6, 0.0}});
  else if (base.starts_with("eps_") || base == "gamma")
    spellings.push_back({base + "_percent", 1e-2, 0.0});
  else if (base == "v")
    spellings.push_back({"e", 1.0, 1.0});
  for (const Spelling& s : spellings)
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      if (table.columns[i] == s.name) return Source{i, s.factor, s.offset};
  return {};
}

}  // namespace

FitTable read_fit_table(TomlReader& target, const TargetTable& given) {
  FitTable result;
  if (given.data.empty() || given.y.empty()) return result;
  std::filesystem::path file = given.data;
  if (file.is_relative()) file = std::filesystem::path(target.file().name()).parent_path() / file;
  point::Table table;
  try {
    table = point::read_table(file);
  } catch (const point::TableError& error) {
    target.report("data", error.what());
    return result;
  } catch (const std::system_error& error) {
    throw io::IoError(file, error.code().message());
  }
  std::vector<Source> sources;
  std::vector<std::string> wanted{given.x};
  wanted.insert(wanted.end(), given.y.begin(), given.y.end());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i].empty()) return result;
    const auto source = find_column(table, wanted[i]);
    if (!source) {
      const std::vector<std::string_view> known(table.columns.begin(), table.columns.end());
      const std::string near = closest(wanted[i], known);
      target.report(
          i == 0 ? "x" : "y",
          fmt::format("{} has no column for {}{}; its columns are {}", file.string(), wanted[i],
                      near.empty() ? "" : fmt::format("; did you mean '{}'?", near),
                      fmt::join(table.columns, ", ")));
      return result;
    }
    sources.push_back(*source);
  }
  result.y.resize(given.y.size());
  const auto value = [&](std::size_t i, std::size_t row) {
    return sources[i].offset + sources[i].factor * table.values[sources[i].column][row];
  };
  for (std::size_t row = 0; row < table.lines.size(); ++row) {
    const double at = value(0, row) + given.x_shift;
    if ((given.from && at < *given.from) || (given.to && at > *given.to)) continue;
    result.x.push_back(at);
    for (std::size_t c = 0; c < given.y.size(); ++c) result.y[c].push_back(value(c + 1, row));
    result.lines.push_back(table.lines[row]);
  }
  if (result.x.size() < 2) {
    target.report("data", fmt::format("{} has {} rows with {} in the range that is compared; at "
                                      "least two are needed",
                                      file.string(), result.x.size(), given.x));
    result = {};
  }
  return result;
}

}  // namespace repose::input

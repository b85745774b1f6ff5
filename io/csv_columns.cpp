#include "io/csv_columns.hpp"

#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "io/thin_evenly.hpp"

namespace repose::io {
namespace {

/// The cells of one line; a quote inside a quoted cell is written twice.
std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += c;
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

/// The whole text as a number, not-a-number and infinities included.
std::optional<double> number_of(std::string_view text) {
  double x = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return x;
}

Json json_number(double x) {
  if (std::isnan(x)) return "nan";
  if (std::isinf(x)) return x > 0.0 ? "inf" : "-inf";
  return number_of(fmt::format("{:.7g}", x)).value();
}

Json column(const std::string& name, const std::vector<std::string>& cells) {
  Json values = Json::array();
  for (const std::string& cell : cells) {
    const auto number = number_of(cell);
    if (!number && !cell.empty()) {
      Json words = Json::array(), of = Json::array();
      std::map<std::string, std::size_t> index;
      for (const std::string& word : cells) {
        const auto [place, fresh] = index.emplace(word, index.size());
        if (fresh) words.push_back(word);
        of.push_back(place->second);
      }
      return {{"name", name}, {"words", std::move(words)}, {"of", std::move(of)}};
    }
    values.push_back(number ? json_number(*number) : Json(nullptr));
  }
  return {{"name", name}, {"values", std::move(values)}};
}

}  // namespace

Json csv_columns(std::string_view csv, std::string_view file, std::size_t most_rows) {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  for (std::size_t from = 0, line = 1; from < csv.size(); ++line) {
    const std::size_t end = std::min(csv.find('\n', from), csv.size());
    const std::string_view text = csv.substr(from, end - from);
    from = end + 1;
    if (text.empty() || text == "\r" || text.front() == '#') continue;
    std::vector<std::string> cells = cells_of(text);
    if (header.empty()) {
      header = std::move(cells);
    } else if (cells.size() == header.size()) {
      rows.push_back(std::move(cells));
    } else if (end < csv.size()) {
      throw IoError(fmt::format("{}:{}", file, line),
                    fmt::format("has {} values, and the header names {} columns", cells.size(),
                                header.size()));
    }
  }
  const std::vector<std::size_t> chosen = thin_evenly(rows.size(), most_rows);
  Json columns = Json::array();
  for (std::size_t c = 0; c < header.size(); ++c) {
    std::vector<std::string> cells;
    for (const std::size_t i : chosen) cells.push_back(rows[i][c]);
    columns.push_back(column(header[c], cells));
  }
  return {{"rows", rows.size()}, {"shown", chosen.size()}, {"columns", std::move(columns)}};
}

}  // namespace repose::io

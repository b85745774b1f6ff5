#pragma once
/// \file
/// A CSV table as tests look at it.

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scratch_folder.hpp"

namespace repose::app {

using Table = std::vector<std::map<std::string, std::string>>;

/// The rows of a CSV table by column; quoted cells may hold commas.
inline Table table_of(const std::filesystem::path& path) {
  std::istringstream in(content_of(path));
  const auto cells_of = [](const std::string& line) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line)
      if (c == '"')
        quoted = !quoted;
      else if (c == ',' && !quoted)
        cells.emplace_back();
      else
        cells.back() += c;
    return cells;
  };
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = cells_of(line);
  Table table;
  while (std::getline(in, line)) {
    const std::vector<std::string> cells = cells_of(line);
    EXPECT_EQ(cells.size(), names.size()) << path << ": " << line;
    auto& row = table.emplace_back();
    for (std::size_t i = 0; i < std::min(cells.size(), names.size()); ++i) row[names[i]] = cells[i];
  }
  return table;
}

}  // namespace repose::app

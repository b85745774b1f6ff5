#include "io/raster.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "io/number_text.hpp"
#include "io/table_error.hpp"

namespace repose::io {
namespace {

constexpr double no_data = -9999.0;

/// The words of a text, with the row each stands in.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  std::optional<std::string_view> next() {
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
    while (place_ < text_.size() && blank(text_[place_])) {
      if (text_[place_] == '\n') ++row_;
      ++place_;
    }
    const std::size_t begin = place_;
    while (place_ < text_.size() && !blank(text_[place_])) ++place_;
    if (begin == place_) return {};
    return text_.substr(begin, place_ - begin);
  }
  int row() const { return row_; }
  std::size_t place() const { return place_; }
  void return_to(std::size_t place, int row) {
    place_ = place;
    row_ = row;
  }

 private:
  std::string_view text_;
  std::size_t place_ = 0;
  int row_ = 1;
};

std::optional<double> number_in(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double x = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
  if (error != std::errc() || end != word.data() + word.size()) return {};
  return x;
}

double require_number(const std::optional<std::string_view>& word, const std::string& file, int row,
                      std::string_view what) {
  if (!word) throw TableError(file, 0, "", fmt::format("the file ends before {}", what), "");
  if (const auto x = number_in(*word)) return *x;
  const bool comma = word->find(',') != std::string_view::npos;
  throw TableError(file, row, "", fmt::format("{} is {}, which is no number", what, shown(*word)),
                   comma ? "an ESRI ASCII grid has decimal points" : "");
}

struct Header {
  std::optional<double> columns, rows, cell, west, south, no_data;
  bool centres = false;  ///< west and south are of the first cell's centre
};

std::optional<double>* key_of(Header& header, std::string_view word) {
  std::string key(word);
  std::transform(key.begin(), key.end(), key.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (key == "ncols") return &header.columns;
  if (key == "nrows") return &header.rows;
  if (key == "cellsize") return &header.cell;
  if (key == "nodata_value") return &header.no_data;
  if (key == "xllcorner") return &header.west;
  if (key == "yllcorner") return &header.south;
  header.centres = header.centres || key == "xllcenter" || key == "yllcenter";
  if (key == "xllcenter") return &header.west;
  if (key == "yllcenter") return &header.south;
  return nullptr;
}

Header read_header(Words& words, const std::string& file) {
  Header header;
  for (;;) {
    const std::size_t word_begin = words.place();
    const int row_before = words.row();
    const std::optional<std::string_view> word = words.next();
    if (!word) break;
    if (number_in(*word)) {
      words.return_to(word_begin, row_before);
      break;
    }
    std::optional<double>* const value = key_of(header, *word);
    if (value == nullptr)
      throw TableError(file, words.row(), "",
                       fmt::format("{} is no key of an ESRI ASCII grid", shown(*word)),
                       "it begins with ncols, nrows, xllcorner, yllcorner, cellsize and, where "
                       "there are gaps, nodata_value; gdal_translate -of AAIGrid writes one");
    *value = require_number(words.next(), file, words.row(), *word);
  }
  for (const auto& [key, value] : {std::pair{"ncols", &header.columns},
                                   {"nrows", &header.rows},
                                   {"xllcorner", &header.west},
                                   {"yllcorner", &header.south},
                                   {"cellsize", &header.cell}})
    if (!*value)
      throw TableError(file, 0, "", fmt::format("the header has no {}", key),
                       "an ESRI ASCII grid with square cells is needed; gdal_translate -of AAIGrid "
                       "-co FORCE_CELLSIZE=YES writes one");
  for (const auto& [key, n] : {std::pair{"ncols", *header.columns}, {"nrows", *header.rows}})
    if (!(n >= 1.0 && n <= most_raster_cells) || n != std::floor(n))
      throw TableError(file, 0, "", fmt::format("{} = {} is no number of cells", key, n), "");
  if (*header.columns * *header.rows > most_raster_cells)
    throw TableError(file, 0, "",
                     fmt::format("{} cells are more than memory is likely to hold ({})",
                                 *header.columns * *header.rows, most_raster_cells),
                     "cut out what the scene needs: gdal_translate -projwin");
  if (!(*header.cell > 0.0) || !std::isfinite(*header.cell))
    throw TableError(file, 0, "", fmt::format("cellsize = {} must be > 0", *header.cell), "");
  if (!std::isfinite(*header.west) || !std::isfinite(*header.south))
    throw TableError(file, 0, "", "the map's corner is not finite", "");
  return header;
}

}  // namespace

Raster parse_esri_grid(std::string_view text, const std::string& name) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (text.starts_with("II*") || text.starts_with("MM"))
    throw TableError(name, 0, "",
                     "this is a TIFF file, which repose reads where it is built with GDAL",
                     "gdal_translate -of AAIGrid writes it as an ESRI ASCII grid");
  Words words(text);
  const Header header = read_header(words, name);
  Raster raster;
  raster.columns = static_cast<std::size_t>(*header.columns);
  raster.rows = static_cast<std::size_t>(*header.rows);
  raster.cell = *header.cell;
  const double shift = header.centres ? 0.5 * raster.cell : 0.0;
  raster.west = *header.west - shift;
  raster.south = *header.south - shift;
  const std::size_t count = raster.columns * raster.rows;
  // a number takes two characters at least: nothing is allocated for what cannot be there
  if (count > text.size())
    throw TableError(name, 0, "",
                     fmt::format("the header tells of {} rows of {} numbers, and the file is too "
                                 "short for them",
                                 raster.rows, raster.columns),
                     "");
  raster.values.reserve(count);
  while (const std::optional<std::string_view> word = words.next()) {
    if (raster.values.size() == count)
      throw TableError(name, words.row(), "",
                       fmt::format("more numbers than the {} rows of {} that the header tells of",
                                   raster.rows, raster.columns),
                       "");
    const double x = require_number(word, name, words.row(), "a value");
    const bool missing = (header.no_data && x == *header.no_data) || std::isnan(x);
    if (std::isinf(x)) throw TableError(name, words.row(), "", "a value is infinite", "");
    raster.values.push_back(missing ? std::nan("") : x);
  }
  if (raster.values.size() != count)
    throw TableError(name, 0, "",
                     fmt::format("{} numbers instead of {} rows of {}", raster.values.size(),
                                 raster.rows, raster.columns),
                     "");
  return raster;
}

std::string esri_grid_text(const Raster& raster, int digits) {
  std::string text =
      fmt::format("ncols {}\nnrows {}\nxllcorner {}\nyllcorner {}\ncellsize {}\nNODATA_value {}\n",
                  raster.columns, raster.rows, raster.west, raster.south, raster.cell, no_data);
  auto out = std::back_inserter(text);
  for (std::size_t row = 0; row < raster.rows; ++row)
    for (std::size_t column = 0; column < raster.columns; ++column) {
      const double x = raster.at(row, column);
      if (std::isnan(x))
        fmt::format_to(out, "{}", no_data);
      else
        fmt::format_to(out, "{:.{}f}", x, digits);
      text += column + 1 < raster.columns ? ' ' : '\n';
    }
  return text;
}

}  // namespace repose::io

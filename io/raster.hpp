#pragma once
/// \file
/// A map of numbers on square cells, and the file that every GIS reads and writes one as: the ESRI
/// ASCII grid (.asc), https://en.wikipedia.org/wiki/Esri_grid#ASCII.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace repose::io {

/// Values stand for their cells. Lengths and places in metres of the map's own coordinates.
struct Raster {
  std::size_t columns = 0, rows = 0;
  double west = 0.0, south = 0.0;  ///< the lower left corner of the map
  double cell = 0.0;               ///< length of a cell's edge
  std::vector<double> values;      ///< row by row from the north, west first; NaN: no data

  double width() const { return cell * static_cast<double>(columns); }
  double height() const { return cell * static_cast<double>(rows); }
  double east() const { return west + width(); }
  double north() const { return south + height(); }
  double& at(std::size_t row, std::size_t column) { return values[row * columns + column]; }
  double at(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

/// What memory is likely to hold.
constexpr double most_raster_cells = 1e8;

/// Errors: TableError with the row of the file, for a header that is not one, more or fewer numbers
/// than it says, cells that are not square, and more of them than most_raster_cells.
Raster parse_esri_grid(std::string_view text, const std::string& name);

/// `digits` after the point; where there is no data stands −9999.
std::string esri_grid_text(const Raster& raster, int digits);

}  // namespace repose::io

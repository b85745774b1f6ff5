// Any bytes as a map of a GIS: it is read or refused with a TableError, and what was read keeps its
// promises. The first byte chooses between an ESRI ASCII grid and GeoJSON; the rest is the file.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "io/level_lines.hpp"
#include "io/raster.hpp"
#include "io/table_error.hpp"

namespace {

using namespace repose::io;

void require(bool holds) {
  if (!holds) std::abort();
}

void read_grid(const std::string& bytes) {
  const Raster map = parse_esri_grid(bytes, "f");
  require(map.values.size() == map.columns * map.rows && !map.values.empty());
  require(map.cell > 0.0 && std::isfinite(map.west) && std::isfinite(map.south));
  for (const double x : map.values) require(!std::isinf(x));
  const Raster again = parse_esri_grid(esri_grid_text(map, 3), "g");
  require(again.columns == map.columns && again.rows == map.rows && again.cell == map.cell);
  for (const Region& region : regions_above(
           {map.columns, map.rows, map.west, map.north(), map.cell, -map.cell, map.values}, 1.0))
    require(region.outer.size() > 2);
}

void read_regions(const std::string& bytes) {
  const std::vector<Region> regions = parse_geojson(bytes, "f");
  require(!regions.empty());
  for (const Region& region : regions) {
    require(region.outer.size() > 2 && (!region.depth || *region.depth > 0.0));
    for (const auto& [x, y] : region.outer) require(std::isfinite(x) && std::isfinite(y));
  }
  require(parse_geojson(geojson_text({{"r", regions}}, ""), "g").size() == regions.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    if (data[0] % 2 == 0)
      read_grid(bytes);
    else
      read_regions(bytes);
  } catch (const TableError& error) {
    require(!error.cause().empty());
  }
  return 0;
}

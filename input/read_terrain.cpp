#include "input/read_terrain.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "input/key_info.hpp"
#include "input/read_surface.hpp"
#include "input/source_file.hpp"
#include "input/toml_reader.hpp"
#include "input/toml_text.hpp"
#include "io/atomic_file.hpp"
#include "io/coordinate_system.hpp"
#include "io/raster_file.hpp"
#include "io/seal.hpp"

namespace repose::input {
namespace {

namespace fs = std::filesystem;
using File = mpm::SourceFile;

/// A map of numbers, of whatever kind. Reported: a map that is not in metres, or counts from
/// elsewhere than the ground's.
std::optional<io::RasterFile> parsed_raster(TomlReader& table, std::string_view key, File& file,
                                            const std::string& ground_crs) {
  auto map = read_source(table, key, file, [&](const SourcePlace& place, std::string& content) {
    io::RasterFile read = place.shipped ? io::raster_of_esri_grid(*place.shipped, file.name)
                                        : io::read_raster(file.name);
    content = read.content;
    return read;
  });
  if (!map) return {};
  if (const std::string why = io::why_not_metres(map->crs); !why.empty()) {
    table.report(key, fmt::format("{}: {}; metres are needed: gdalwarp -t_srs EPSG:NUMBER, of a "
                                  "projection for the place, makes such a map",
                                  file.name, why));
    return {};
  }
  const std::string here = io::epsg_of(map->crs), there = io::epsg_of(ground_crs);
  if (!here.empty() && !there.empty() && here != there) {
    table.report(key, fmt::format("{}: its coordinate system is EPSG:{}, and that of the ground "
                                  "EPSG:{}; gdalwarp -t_srs EPSG:{} makes them one",
                                  file.name, here, there, there));
    return {};
  }
  return map;
}

/// Reports the first cell without data, or below `least`.
bool is_whole(TomlReader& table, std::string_view key, const File& file, const io::Raster& map,
              double least) {
  const auto gap =
      std::find_if(map.values.begin(), map.values.end(), [&](double x) { return !(x >= least); });
  if (gap == map.values.end()) return true;
  const auto place = static_cast<std::size_t>(gap - map.values.begin());
  const std::string where = fmt::format("{}: row {}, column {} of the map", file.name,
                                        place / map.columns + 1, place % map.columns + 1);
  table.report(key, std::isnan(*gap)
                        ? fmt::format("{} has no data; gdal_fillnodata.py closes gaps, "
                                      "gdal_translate -projwin cuts them off",
                                      where)
                        : fmt::format("{} is {}, and must be >= {}", where, *gap, least));
  return false;
}

void ground_keys(Keys& keys, mpm::Terrain& terrain) {
  File& file = terrain.ground_file;
  keys.text({"ground",
             "m",
             "elevations, a map: an ESRI ASCII grid or, where repose is built with GDAL, a GeoTIFF "
             "or any "
             "other raster of one band; a path seen from this file",
             {},
             required},
            file.name);
  keys.text({"ground_content", "-",
             "fingerprint of its content, written by repose: another map is refused"},
            file.content);
  TomlReader* const table = keys.reader();
  if (table == nullptr || file.name.empty()) return;
  auto map = parsed_raster(*table, "ground", file, "");
  if (!map || !is_whole(*table, "ground", file, map->raster, -HUGE_VAL)) return;
  terrain.ground_map = std::move(map->raster);
  terrain.crs = std::move(map->crs);
  terrain.geotiff = map->through_gdal;
}

void release_keys(Keys& keys, mpm::Terrain& terrain) {
  File& file = terrain.release_file;
  keys.text({"release", "m",
             "what a body with shape = \"release\" is: vertical depths, a map as of the ground, or "
             "regions, polygons in a .geojson file"},
            file.name);
  keys.text(Key{"release_content", "-", "fingerprint of its content, written by repose"}.only_if(
                !file.name.empty() || keys.describes(), "a content without a release"),
            file.content);
  const bool regions =
      fs::path(file.name).extension() == ".geojson" || fs::path(file.name).extension() == ".json";
  keys.number(Key{"release_depth", "m", "vertical depth of regions that have no property \"depth\"",
                  positive}
                  .only_if(regions || keys.describes(), "only a release of regions has one depth"),
              terrain.release_depth);
  TomlReader* const table = keys.reader();
  if (table == nullptr || file.name.empty()) return;
  if (regions) {
    auto read = parsed(*table, "release", file, io::parse_geojson);
    if (!read) return;
    const bool complete = terrain.release_depth ||
                          std::all_of(read->begin(), read->end(),
                                      [](const io::Region& r) { return r.depth.has_value(); });
    if (!complete)
      table->report("release_depth",
                    "a region has no property \"depth\": terrain.release_depth "
                    "gives that of all that have none");
    terrain.release_map = std::move(*read);
  } else if (auto map = parsed_raster(*table, "release", file, terrain.crs)) {
    std::vector<double>& depths = map->raster.values;
    for (double& depth : depths)
      if (std::isnan(depth)) depth = 0.0;
    if (!is_whole(*table, "release", file, map->raster, 0.0)) return;
    if (std::none_of(depths.begin(), depths.end(), [](double d) { return d > 0.0; }))
      table->report("release", fmt::format("{}: no cell of the map has a depth", file.name));
    else
      terrain.release_map = std::move(map->raster);
  }
}

/// A coefficient, or a map of it.
void read_friction(TomlReader& table, mpm::Terrain& terrain) {
  const toml::node& given = *table.get("friction");
  terrain.contact = mpm::Surface::Contact::friction;
  if (!given.is_string()) {
    terrain.friction =
        table.number({"friction", "-", "Coulomb coefficient", Range{0.0, 1e3, false, false}, {}});
    return;
  }
  File& file = terrain.friction_file;
  file.name = given.as_string()->get();
  auto read = parsed_raster(table, "friction", file, terrain.crs);
  if (!read || !is_whole(table, "friction", file, read->raster, 0.0)) return;
  const io::Raster &ground = terrain.ground_map, &map = read->raster;
  const double slack = map.cell;
  if (ground.columns > 0 &&
      (map.west > ground.west + slack || map.south > ground.south + slack ||
       map.east() < ground.east() - slack || map.north() < ground.north() - slack))
    table.report("friction",
                 fmt::format("{}: the map does not cover that of the ground", file.name));
  terrain.friction_raster = std::move(read->raster);
}

void contact_keys(Keys& keys, mpm::Terrain& terrain) {
  using Contact = mpm::Surface::Contact;
  static const KeyInfo info = [] {
    KeyInfo any, coefficient, map;
    any.kind = ValueKind::any_of;
    coefficient.kind = ValueKind::number;
    map.kind = ValueKind::text;
    any.below = {coefficient, map};
    return any;
  }();
  TomlReader* const table = keys.reader();
  const bool rubs = terrain.contact == Contact::friction;
  keys.text(
      Key{"friction_content", "-", "fingerprint of the map's content, written by repose"}.only_if(
          table != nullptr || keys.describes() || terrain.friction_raster.has_value(), ""),
      terrain.friction_file.content);
  keys.value(
      Key{"friction", "-",
          "Coulomb coefficient of a contact that may part, or a map of it; or a kind"}
          .only_if(table != nullptr || keys.describes() || rubs, ""),
      [&](TomlReader& reader) { read_friction(reader, terrain); },
      [&] {
        if (!rubs) return std::string();
        return terrain.friction_raster ? toml_string(terrain.friction_file.name)
                                       : toml_number(terrain.friction);
      },
      info);
  contact_kind_key(keys, terrain.contact == Contact::friction, "a ground", terrain.contact);
}

}  // namespace

void terrain_keys(Keys& keys, mpm::Terrain& terrain) {
  ground_keys(keys, terrain);
  release_keys(keys, terrain);
  contact_keys(keys, terrain);
  keys.number({"base", "m", "elevation of the box's floor; four cells below the lowest ground"},
              terrain.base);
  keys.number({"least_depth", "m",
               "from which on the maps of the result count a place as reached; a quarter of a cell",
               positive},
              terrain.least_depth);
}

}  // namespace repose::input

#pragma once
/// \file
/// Regions of a map as GeoJSON (RFC 7946): polygons in and out. Coordinates are the map's own, in
/// metres, as GIS programs keep them for a project; not longitude and latitude.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace repose::io {

using Ring = std::vector<std::array<double, 2>>;  ///< closed without repeating its first place

/// Within a ring, less the holes in it.
struct Region {
  Ring outer;
  std::vector<Ring> holes;
  std::optional<double> depth;  ///< the property "depth" of its feature [m]
};

/// The polygons and multipolygons of a file, be it a geometry, a feature or a collection of
/// features. Errors: TableError for what is no GeoJSON, holds no polygon, or a ring of less than
/// three places.
std::vector<Region> parse_geojson(std::string_view text, const std::string& name);

/// One feature, a multipolygon with a name.
struct NamedRegions {
  std::string name;
  std::vector<Region> regions;
};
/// A collection of features. Outer rings run counterclockwise, as RFC 7946 asks, if they are given
/// so. `crs`: the name of the coordinate system, empty if it is not known.
std::string geojson_text(const std::vector<NamedRegions>& features, const std::string& crs);

}  // namespace repose::io

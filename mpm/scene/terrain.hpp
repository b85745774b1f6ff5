#pragma once
/// \file
/// Ground and release of a scene in space from maps. Axes of the scene: x to the east, y upwards,
/// z to the south, from the map's north-western corner.

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "io/geojson.hpp"
#include "io/raster.hpp"
#include "mpm/scene/solid.hpp"

namespace repose::mpm {

/// How deep what is released lies on the ground, measured along y.
class Release {
 public:
  /// Depths on the cells of a map, each the same all over its cell; none where there is no data.
  /// `west`, `north`: of the scene's origin, in the map's coordinates [m].
  Release(const io::Raster& depths, double west, double north);
  /// The same depth all over each region: its own, or `depth` [m].
  Release(const std::vector<io::Region>& regions, double depth, double west, double north);

  double volume() const;  ///< [m³]
  /// Of what is released over the rectangle between two places (x, z) [m³].
  double volume_over(const std::array<double, 2>& low, const std::array<double, 2>& high) const;
  /// The rectangle (x, z) around all of it [m].
  const std::array<double, 2>& low() const { return low_; }
  const std::array<double, 2>& high() const { return high_; }
  double deepest() const { return deepest_; }  ///< [m]

 private:
  struct Part {
    Polygon outline;
    double depth;  ///< negative of a hole
  };
  io::Raster map_;  ///< in the scene's axes: west and north are x and z of its corner
  std::vector<Part> parts_;
  std::array<double, 2> low_{}, high_{};
  double deepest_ = 0.0;
};

struct Terrain {
  SourceFile ground_file, release_file, friction_file;

  io::Raster ground_map;  ///< elevations [m]
  std::string crs;        ///< coordinate system of the maps, as WKT
  bool geotiff = false;   ///< the ground was read through GDAL: maps of results are GeoTIFFs
  std::variant<std::monostate, io::Raster, std::vector<io::Region>> release_map;
  std::optional<double> release_depth;  ///< of regions without a depth of their own [m]
  Surface::Contact contact = Surface::Contact::no_slip;
  double friction = 0.0;                      ///< Coulomb coefficient, for Contact::friction
  std::optional<io::Raster> friction_raster;  ///< the same from place to place
  std::optional<double> base;                 ///< elevation of the scene's y = 0 [m]
  /// Depth from which on a place counts as reached, for the maps of results [m]; absent: h/4.
  std::optional<double> least_depth;

  // in the scene's axes, by place()
  std::shared_ptr<const HeightMap> ground;
  std::shared_ptr<const Release> release;
  std::shared_ptr<const HeightMap> friction_map;

  /// Makes of the maps what lies in the scene, with y = 0 at `base`.
  void place();
  Surface surface() const;
};

}  // namespace repose::mpm

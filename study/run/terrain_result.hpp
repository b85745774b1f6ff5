#pragma once
/// \file
/// What a run over a terrain leaves for a GIS: maps on the cells of the ground's own map, and the
/// outlines of what was reached.

#include "io/raster.hpp"
#include "io/result_folder.hpp"
#include "mpm/step/simulation.hpp"

namespace repose::study {

/// The maps of a run; no data outside of its box, and in arrival_s where nothing came.
struct TerrainMaps {
  io::Raster largest_depth_m;  ///< solid depth, measured vertically
  io::Raster largest_speed;    ///< of the mean velocity over the depth [m/s]
  io::Raster arrival_s;        ///< when it first was as deep as terrain.least_depth
  io::Raster deposit_m;        ///< solid depth as it is now
};

/// Means over the map's cells of what the nodes of the simulation tell, linear between them: the
/// volume of a map of depths is that of the points (but for what lies beyond the map).
TerrainMaps terrain_maps(const mpm::Simulation& simulation);

/// Writes the maps largest_depth, largest_speed, arrival_time and deposit, as GeoTIFFs (.tif) where
/// the ground was read through GDAL, else as ESRI ASCII grids (.asc) with a .prj beside each where
/// the ground's has one; and outlines.geojson. Errors: IoError, TableError.
void write_terrain_maps(const io::ResultFolder& folder, const mpm::Simulation& simulation);

/// "largest depth 7.8 m, largest speed 42 m/s, 1.002e+05 m² reached, run-out 863 m (99 %), 912 m
/// (farthest)".
std::string flow_extent(const mpm::Simulation& simulation);

}  // namespace repose::study

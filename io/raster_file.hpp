#pragma once
/// \file
/// Maps in files: ESRI ASCII grids, and whatever raster GDAL (https://gdal.org) opens. Its library
/// is loaded when the first file asks for it and never linked: with all that it brings along it
/// takes longer to load than repose to start.

#include <filesystem>
#include <string>
#include <string_view>

#include "io/raster.hpp"

namespace repose::io {

struct RasterFile {
  Raster raster;
  std::string crs;  ///< coordinate system as WKT; empty where it is not known
  /// Fingerprint of the file's bytes, or where GDAL has read it of the numbers that it gave.
  std::string content;
  bool through_gdal = false;
};

/// Is this for GDAL: no ESRI ASCII grid by name (.asc) or first word? False in a build that does
/// not know it. Errors: IoError.
bool is_for_gdal(const std::filesystem::path& path);

/// The bytes of an ESRI ASCII grid. Errors: TableError.
RasterFile raster_of_esri_grid(std::string_view bytes, const std::string& name);

/// A raster of either kind; the .prj of an ESRI ASCII grid is the file of its name beside it.
/// Errors: IoError; TableError as parse_esri_grid(), and for a raster of GDAL that has not exactly
/// one band, no georeference or one that is not north-up with square cells, complex or infinite
/// numbers, elevations in another unit than metres, or more cells than 1e8, and where GDAL's
/// library is not there.
RasterFile read_raster(const std::filesystem::path& path);

/// A GeoTIFF of single precision, compressed without loss (DEFLATE), no data −9999; `digits` after
/// the point are kept, as by esri_grid_text(). crs: WKT, may be empty. Errors: IoError where GDAL
/// refuses, TableError where its library is not there.
std::string geotiff_of(const Raster& raster, int digits, const std::string& crs);

/// "libgdal.so.32": what is loaded where it is needed; empty in a build that does not know GDAL.
std::string gdal_library();

}  // namespace repose::io

#pragma once
/// \file
/// The one door to GDAL's library (raster_file.hpp).

#include <filesystem>

#include "io/raster_file.hpp"

namespace repose::io {

/// Without `content`. Errors: TableError, as read_raster().
RasterFile read_through_gdal(const std::filesystem::path& path);

}  // namespace repose::io

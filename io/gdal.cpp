#include "io/gdal.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "io/atomic_file.hpp"
#include "io/table_error.hpp"

#ifdef REPOSE_GDAL_LIBRARY
#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_vsi.h>
#include <dlfcn.h>
#include <gdal.h>
#include <ogr_srs_api.h>
#endif

namespace repose::io {

#ifdef REPOSE_GDAL_LIBRARY

namespace {

constexpr const char* as_text_grid = "gdal_translate -of AAIGrid writes it as an ESRI ASCII grid";
constexpr double no_data = -9999.0;

/// The functions of GDAL that are used, as its headers declare them; each once here and once where
/// the library is asked for it.
#define REPOSE_GDAL_FUNCTIONS(F) \
  F(CPLErrorReset)               \
  F(CPLGetLastErrorMsg)          \
  F(CPLPopErrorHandler)          \
  F(CPLPushErrorHandler)         \
  F(CPLQuietErrorHandler)        \
  F(GDALAllRegister)             \
  F(GDALClose)                   \
  F(GDALCreate)                  \
  F(GDALDataTypeIsComplex)       \
  F(GDALGetDriverByName)         \
  F(GDALGetGeoTransform)         \
  F(GDALGetMaskBand)             \
  F(GDALGetRasterBand)           \
  F(GDALGetRasterCount)          \
  F(GDALGetRasterDataType)       \
  F(GDALGetRasterOffset)         \
  F(GDALGetRasterScale)          \
  F(GDALGetRasterUnitType)       \
  F(GDALGetRasterXSize)          \
  F(GDALGetRasterYSize)          \
  F(GDALGetSpatialRef)           \
  F(GDALOpenEx)                  \
  F(GDALRasterIO)                \
  F(GDALSetGeoTransform)         \
  F(GDALSetProjection)           \
  F(GDALSetRasterNoDataValue)    \
  F(OSRExportToWktEx)            \
  F(VSIFree)                     \
  F(VSIGetMemFileBuffer)         \
  F(VSIUnlink)

struct Gdal {
#define REPOSE_GDAL_MEMBER(name) decltype(&::name) name = nullptr;
  REPOSE_GDAL_FUNCTIONS(REPOSE_GDAL_MEMBER)
#undef REPOSE_GDAL_MEMBER
  std::string missing;  ///< why the library cannot be used; empty: it can

  Gdal() {
    void* const library = ::dlopen(REPOSE_GDAL_LIBRARY, RTLD_LAZY | RTLD_LOCAL);
    if (library == nullptr) {
      missing = ::dlerror();
      return;
    }
#define REPOSE_GDAL_ASK(function)                                               \
  function = reinterpret_cast<decltype(function)>(::dlsym(library, #function)); \
  if (function == nullptr && missing.empty()) missing = "it has no " #function;
    REPOSE_GDAL_FUNCTIONS(REPOSE_GDAL_ASK)
#undef REPOSE_GDAL_ASK
    if (missing.empty()) GDALAllRegister();
  }
};

/// Loaded with the first call. Errors: TableError about the map that it was for.
const Gdal& gdal_for(const std::string& name) {
  static const Gdal gdal;
  if (!gdal.missing.empty())
    throw TableError(name, 0, "",
                     fmt::format("GDAL is needed for this map, and {} cannot be loaded ({})",
                                 REPOSE_GDAL_LIBRARY, gdal.missing),
                     as_text_grid);
  return gdal;
}

/// What GDAL would say on the standard error output is kept for the message of an exception.
class Silence {
 public:
  explicit Silence(const Gdal& gdal) : gdal_(gdal) {
    gdal_.CPLPushErrorHandler(gdal_.CPLQuietErrorHandler);
    gdal_.CPLErrorReset();
  }
  ~Silence() { gdal_.CPLPopErrorHandler(); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

  std::string last() const {
    const std::string said = gdal_.CPLGetLastErrorMsg();
    return said.empty() ? "it does not say why" : said;
  }

 private:
  const Gdal& gdal_;
};

struct Closer {
  const Gdal* gdal;
  void operator()(void* dataset) const { gdal->GDALClose(dataset); }
};
using Dataset = std::unique_ptr<void, Closer>;

/// As WKT 2; empty where there is none.
std::string crs_of(const Gdal& gdal, GDALDatasetH dataset) {
  const OGRSpatialReferenceH system = gdal.GDALGetSpatialRef(dataset);
  if (system == nullptr) return "";
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  char* text = nullptr;
  std::string wkt;
  if (gdal.OSRExportToWktEx(system, &text, options) == OGRERR_NONE && text != nullptr) wkt = text;
  gdal.VSIFree(text);
  return wkt;
}

/// The map's frame, from x = t0 + t1 column + t2 row, y = t3 + t4 column + t5 row of a corner.
Raster frame_of(const Gdal& gdal, GDALDatasetH dataset, const std::string& name) {
  const auto refuse = [&](const std::string& cause, const std::string& cure) {
    throw TableError(name, 0, "", cause, cure);
  };
  Raster raster;
  const int columns = gdal.GDALGetRasterXSize(dataset), rows = gdal.GDALGetRasterYSize(dataset);
  if (static_cast<double>(columns) * rows > most_raster_cells)
    refuse(fmt::format("{} cells are more than memory is likely to hold ({})",
                       static_cast<double>(columns) * rows, most_raster_cells),
           "cut out what the scene needs: gdal_translate -projwin");
  raster.columns = static_cast<std::size_t>(columns);
  raster.rows = static_cast<std::size_t>(rows);
  double t[6] = {};
  if (gdal.GDALGetGeoTransform(dataset, t) != CE_None)
    refuse("it does not tell where it lies", "gdal_translate -a_ullr says so");
  for (const double x : t)
    if (!std::isfinite(x)) refuse("its corner or cells are not finite", "");
  const char* const warped = "gdalwarp -tr CELL CELL writes it north-up with square cells";
  if (t[2] != 0.0 || t[4] != 0.0) refuse("it is rotated or sheared", warped);
  if (!(t[1] > 0.0 && t[5] < 0.0)) refuse("it is not north-up", warped);
  // no cell is off by more than a thousandth of one
  if (std::abs(t[1] + t[5]) * std::max(columns, rows) > 1e-3 * t[1])
    refuse(fmt::format("its cells are {} m wide and {} m high, not square", t[1], -t[5]), warped);
  raster.cell = t[1];
  raster.west = t[0];
  raster.south = t[3] - raster.height();
  return raster;
}

void read_values(const Gdal& gdal, GDALRasterBandH band, const std::string& name, Raster& raster) {
  int has_scale = 0, has_offset = 0;
  double scale = gdal.GDALGetRasterScale(band, &has_scale);
  double offset = gdal.GDALGetRasterOffset(band, &has_offset);
  if (has_scale == 0) scale = 1.0;
  if (has_offset == 0) offset = 0.0;
  const GDALRasterBandH mask = gdal.GDALGetMaskBand(band);
  const int columns = static_cast<int>(raster.columns);
  std::vector<std::uint8_t> there(raster.columns);
  raster.values.resize(raster.columns * raster.rows);
  for (std::size_t row = 0; row < raster.rows; ++row) {
    double* const values = &raster.at(row, 0);
    const auto read = [&](GDALRasterBandH from, void* to, GDALDataType type) {
      return gdal.GDALRasterIO(from, GF_Read, 0, static_cast<int>(row), columns, 1, to, columns, 1,
                               type, 0, 0) == CE_None;
    };
    if (!read(band, values, GDT_Float64) || !read(mask, there.data(), GDT_Byte))
      throw TableError(
          name, 0, "",
          fmt::format("row {} of the map cannot be read: {}", row + 1, gdal.CPLGetLastErrorMsg()),
          "");
    for (std::size_t column = 0; column < raster.columns; ++column) {
      double& x = values[column];
      if (there[column] == 0 || std::isnan(x)) {
        x = std::nan("");
        continue;
      }
      x = x * scale + offset;
      if (std::isinf(x))
        throw TableError(
            name, 0, "",
            fmt::format("row {}, column {} of the map is infinite", row + 1, column + 1), "");
    }
  }
}

}  // namespace

std::string gdal_library() { return REPOSE_GDAL_LIBRARY; }

RasterFile read_through_gdal(const std::filesystem::path& path) {
  const std::string name = path.string();
  const Gdal& gdal = gdal_for(name);
  const Silence silence(gdal);
  const Dataset dataset(
      gdal.GDALOpenEx(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
                      nullptr, nullptr, nullptr),
      Closer{&gdal});
  if (!dataset)
    throw TableError(name, 0, "",
                     "neither an ESRI ASCII grid nor a raster that GDAL opens: " + silence.last(),
                     "");
  const int bands = gdal.GDALGetRasterCount(dataset.get());
  if (bands != 1)
    throw TableError(name, 0, "", fmt::format("it has {} bands, and one is needed", bands),
                     bands > 1 ? "gdal_translate -b 1 takes the first" : "");
  RasterFile file;
  file.through_gdal = true;
  file.crs = crs_of(gdal, dataset.get());
  file.raster = frame_of(gdal, dataset.get(), name);
  const GDALRasterBandH band = gdal.GDALGetRasterBand(dataset.get(), 1);
  if (gdal.GDALDataTypeIsComplex(gdal.GDALGetRasterDataType(band)) != 0)
    throw TableError(name, 0, "", "its numbers are complex", "");
  const std::string unit = gdal.GDALGetRasterUnitType(band);
  constexpr const char* metres[] = {"", "m", "metre", "meter", "metres", "meters"};
  if (std::none_of(std::begin(metres), std::end(metres), [&](const char* m) { return unit == m; }))
    throw TableError(name, 0, "", fmt::format("its numbers are in {}, not in metres", unit),
                     "gdal_calc.py makes metres of them");
  read_values(gdal, band, name, file.raster);
  return file;
}

std::string geotiff_of(const Raster& raster, int digits, const std::string& crs) {
  const std::string file = "GeoTIFF";
  const Gdal& gdal = gdal_for(file);
  const Silence silence(gdal);
  const auto refuse = [&] { throw IoError(file, "GDAL cannot write the map: " + silence.last()); };
  // in memory, so that the file itself appears whole or not at all, as all others do
  const std::string place = fmt::format("/vsimem/repose_{}", static_cast<const void*>(&raster));
  const GDALDriverH driver = gdal.GDALGetDriverByName("GTiff");
  const char* const options[] = {"COMPRESS=DEFLATE", "PREDICTOR=3", nullptr};
  const int columns = static_cast<int>(raster.columns), rows = static_cast<int>(raster.rows);
  if (driver == nullptr) refuse();
  Dataset dataset(gdal.GDALCreate(driver, place.c_str(), columns, rows, 1, GDT_Float32, options),
                  Closer{&gdal});
  if (!dataset) refuse();
  double t[6] = {raster.west, raster.cell, 0.0, raster.north(), 0.0, -raster.cell};
  bool good = gdal.GDALSetGeoTransform(dataset.get(), t) == CE_None;
  if (!crs.empty()) good = gdal.GDALSetProjection(dataset.get(), crs.c_str()) == CE_None && good;
  const GDALRasterBandH band = gdal.GDALGetRasterBand(dataset.get(), 1);
  good = gdal.GDALSetRasterNoDataValue(band, no_data) == CE_None && good;
  const double kept = std::pow(10.0, digits);
  std::vector<float> line(raster.columns);
  for (std::size_t row = 0; row < raster.rows; ++row) {
    for (std::size_t column = 0; column < raster.columns; ++column) {
      const double x = raster.at(row, column);
      line[column] = static_cast<float>(std::isnan(x) ? no_data : std::nearbyint(x * kept) / kept);
    }
    good = gdal.GDALRasterIO(band, GF_Write, 0, static_cast<int>(row), columns, 1, line.data(),
                             columns, 1, GDT_Float32, 0, 0) == CE_None &&
           good;
  }
  dataset.reset();
  vsi_l_offset length = 0;
  const GByte* const bytes = gdal.VSIGetMemFileBuffer(place.c_str(), &length, FALSE);
  std::string content;
  if (good && bytes != nullptr) content.assign(reinterpret_cast<const char*>(bytes), length);
  gdal.VSIUnlink(place.c_str());
  if (content.empty()) refuse();
  return content;
}

#else

std::string gdal_library() { return ""; }

RasterFile read_through_gdal(const std::filesystem::path& path) {
  throw TableError(path.string(), 0, "", "this repose was built without GDAL",
                   "gdal_translate -of AAIGrid writes an ESRI ASCII grid");
}

std::string geotiff_of(const Raster&, int, const std::string&) {
  throw IoError("GeoTIFF", "this repose was built without GDAL");
}

#endif

}  // namespace repose::io

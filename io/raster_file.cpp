#include "io/raster_file.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <iomanip>

#include <fmt/format.h>

#include "io/atomic_file.hpp"
#include "io/fingerprint.hpp"
#include "io/gdal.hpp"
#include "io/seal.hpp"

namespace repose::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_bytes = 1'000'000'000;  // as of a table (raw_table.cpp)

std::string in_small_letters(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

bool is_for_gdal(const fs::path& path) {
  std::error_code ignored;
  // a pipe can be read only once, a device may never end: read_bytes() knows how
  if (gdal_library().empty() || (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)))
    return false;
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  std::string head(4, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  if (in.bad() || !in.is_open()) throw IoError(path, "cannot read", errno);
  if (head.starts_with("II*") || head.starts_with("MM")) return true;  // TIFF, by whatever name
  if (in_small_letters(path.extension().string()) == ".asc") return false;
  in.clear();
  in.seekg(0);
  std::string word;
  in >> std::setw(16) >> word;
  word = in_small_letters(word);
  return word != "ncols" && word != "nrows";
}

RasterFile raster_of_esri_grid(std::string_view bytes, const std::string& name) {
  return {parse_esri_grid(bytes, name), "", fingerprint_of(bytes), false};
}

RasterFile read_raster(const fs::path& path) {
  RasterFile file;
  if (is_for_gdal(path)) {
    file = read_through_gdal(path);
    const std::vector<double>& values = file.raster.values;
    const std::string_view numbers(reinterpret_cast<const char*>(values.data()),
                                   values.size() * sizeof(double));
    file.content =
        fingerprint_of(fmt::format("{} {} {} {} {}", file.raster.columns, file.raster.west,
                                   file.raster.south, file.raster.cell, fingerprint_of(numbers)));
  } else {
    file = raster_of_esri_grid(read_bytes(path, most_bytes), path.string());
  }
  std::error_code ignored;
  const fs::path crs = fs::path(path).replace_extension(".prj");
  if (file.crs.empty() && fs::exists(crs, ignored)) file.crs = read_bytes(crs, most_bytes);
  return file;
}

}  // namespace repose::io

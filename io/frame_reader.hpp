#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace repose::io {

/// A frame as the series file names it.
struct FrameEntry {
  std::string file_name;  ///< beside the series file
  double time_s;
};

/// What FrameWriter wrote, read back.
struct Frame {
  struct Field {
    std::string name;            ///< with its unit, "pressure_Pa"
    std::size_t components;      ///< 1 scalar, 3 vector, 6 tensor in ParaView's order
    std::vector<double> values;  ///< point by point
  };
  double time_s = 0.0;
  std::size_t points = 0;
  std::vector<double> position_m;  ///< x, y, z of each point
  std::vector<Field> fields;       ///< by name
};

/// The base name of the series of a run's grid, beside that of its points, of the given one.
std::string grid_series_name(const std::string& base_name);

/// The BASE.hdf.series of a folder that is of points; empty if there is none.
std::filesystem::path point_series_in(const std::filesystem::path& folder);

/// The frames that a BASE.hdf.series names, in its order. Errors: IoError if the file cannot be
/// read, is no series of frames or names a file of another folder.
std::vector<FrameEntry> read_frame_series(const std::filesystem::path& series);

/// Reads one frame file. Errors: IoError with the reason.
Frame read_frame(const std::filesystem::path& file);

}  // namespace repose::io

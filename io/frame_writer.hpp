#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/atomic_file.hpp"

namespace repose::io {

/// One moment of a run, seen through spans over the solver's own arrays: n points, n > 0, every
/// span of length n, a finite time. Positions in m; each field in the unit that its name ends with.
/// Field names are distinct, not empty and hold no '/' and no control character.
struct FrameView {
  struct Scalar {
    std::string name;
    std::span<const double> values;
  };
  /// A vector. What is empty (z of the plane) is zero.
  struct Vector {
    std::string name;
    std::span<const double> x, y, z{};
  };
  /// A symmetric tensor; ParaView gets its six components in the order that it names itself: XX YY
  /// ZZ XY YZ XZ. What is empty (the last two in plane strain) is zero.
  struct Tensor {
    std::string name;
    std::span<const double> xx, yy, zz, xy, yz{}, zx{};
  };
  struct IntField {
    std::string name;
    std::span<const std::int32_t> values;
  };

  double time_s = 0.0;
  std::span<const double> x_m, y_m, z_m;  ///< no z_m in the plane
  std::vector<Scalar> scalars;
  std::vector<Vector> vectors;
  std::vector<Tensor> tensors;
  std::vector<IntField> integers;
};

/// One moment of a run on the nodes of its grid. Every span has a value for each node, x fastest,
/// then y, then z; node (i, j, k) lies at h (i, j, k). Rules for names and the time as at
/// FrameView.
struct GridView {
  double time_s = 0.0;
  double h_m = 0.0;                    ///< > 0
  std::array<std::size_t, 3> nodes{};  ///< along x, y and z; one along z in the plane
  std::vector<FrameView::Scalar> scalars;
  std::vector<FrameView::Vector> vectors;
};

/// Writes frames that ParaView 5.11 opens: FOLDER/BASE_00012.hdf, each a VTKHDF 1.0
/// UnstructuredGrid with one vertex cell per point, or the ImageData of a grid, and
/// FOLDER/BASE.hdf.series, which ties them to their times and is the file to open. A series is of
/// points or of a grid. Both are replaced as a whole, never in part, so a frame is
/// complete or absent and the series names only complete frames.
/// The same frame gives the same bytes (no time stamps).
/// Not for use from several threads at once (HDF5 itself is not).
/// Format: VTK file formats, "VTKHDF file format", version 1.0.
class FrameWriter {
 public:
  /// A new series, numbered from 0. Creates the folder and its parents. Frames of the same numbers
  /// are replaced; later ones of an older run stay on disk until somebody removes them.
  /// base_name: letters, digits, '.', '_' and '-' only, since it becomes part of file names.
  /// Errors: std::invalid_argument for the name, IoError for the folder.
  FrameWriter(std::filesystem::path folder, std::string base_name);

  /// Takes up a series after a restart at last_time_s: frames up to and including that time stay,
  /// later ones that the series file names are removed, and numbering goes on.
  /// A missing series file is the same as an empty one. Errors: as above; IoError if the series
  /// file cannot be read or is not one.
  static FrameWriter continued(std::filesystem::path folder, std::string base_name,
                               double last_time_s);

  /// Writes the next frame and the series file. Returns the frame's path.
  /// Errors: IoError if either cannot be written (an older complete file is then still there, and
  /// the same call may be tried again); std::invalid_argument for a view that breaks the rules
  /// given at FrameView or GridView.
  std::filesystem::path write(const FrameView& frame);
  std::filesystem::path write(const GridView& grid);

  /// Frames written so far, those taken over by continued() included.
  std::size_t count() const { return frames_.size(); }
  std::filesystem::path series_path() const;

 private:
  struct Entry {
    std::string file_name;
    double time_s;
  };
  template <class View>
  std::filesystem::path write_next(const View& view);
  void write_series(const std::vector<Entry>& frames) const;

  std::filesystem::path folder_;
  std::string base_name_;
  std::vector<Entry> frames_;
};

}  // namespace repose::io

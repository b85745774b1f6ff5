#pragma once
/// \file
/// Curves that are read off the points of a run: its first and its last frame.

#include <filesystem>

#include "io/frame_reader.hpp"
#include "study/validation/curve_distance.hpp"

namespace repose::study {

/// The first and the last frame of a run's folder. Errors: IoError; NoFigure if there are no two.
struct RunFrames {
  io::Frame first, last;
};
RunFrames read_run_frames(const std::filesystem::path& series);

/// Over columns of width h from 0 to `width`: the height at the end of the highest point that lies
/// there and has moved by less than `threshold` since the start; 0 where none has. Errors: NoFigure
/// where points have left.
PlainCurve rest_line(const RunFrames& frames, double h, double width, double threshold);

/// Means of a field (input::column_fields) over rows of height h, at the middle of the rows that
/// hold points.
PlainCurve column_means(const io::Frame& frame, double h, std::string_view field);

}  // namespace repose::study

#pragma once

#include <filesystem>
#include <functional>
#include <span>

#include "io/frame_reader.hpp"
#include "io/json.hpp"

namespace repose::report {

/// What a page may hold of one run: first the frames, then the points of each are thinned evenly.
struct PackLimits {
  std::size_t frames = 120;
  std::size_t points = 20000;             ///< of one frame
  std::size_t points_in_all = 1'500'000;  ///< of all frames together: some 16 MB of page
};

/// Frames for the animation, small: places as 16-bit and values as 8-bit integers, in base64.
///     {"times": [0, 0.05], "counts": [8192, 8192], "x": [lower, upper], "y": [...],
///      "xy": "…",                  frame after frame x, y, x, y, … little endian; the value is
///                                  lower + (upper - lower) code/65534, and 65535 is no finite
///                                  number
///      "fields": [{"name": "pressure_Pa", "lower": 0, "upper": 3e3, "least": -2, "largest": 5e3,
///                  "codes": "…"}],  lower + (upper - lower) code/254, and 255 is no finite number
///      "lost": 0,                  values that are no finite number, of places and fields
///      "depth": false,             whether the points had different z, which is left out where
///                                  they are seen along it
///      "all_frames": 25, "most_points": 8192}
/// A field's colours run from its 0.5th to its 99.5th percentile over all frames, so that a few
/// extreme points do not bleach the rest; least and largest are the true extremes. A vector is its
/// magnitude; tensors, and fields with one value throughout, are left out.
/// next(i): reads frame i of `count`; the limits apply to what it returns. plan_height: the points
/// are seen from above where it is positive, y being this height − z [m], else along z. Errors: as
/// next.
io::Json pack_frames(std::size_t count, const std::function<io::Frame(std::size_t)>& next,
                     const PackLimits& limits = {}, double plan_height = 0.0);

}  // namespace repose::report

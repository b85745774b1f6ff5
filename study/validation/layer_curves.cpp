#include "study/validation/layer_curves.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace repose::study {
namespace {

const io::Frame::Field& field_of(const io::Frame& frame, std::string_view name) {
  for (const io::Frame::Field& field : frame.fields)
    if (field.name == name) return field;
  throw NoFigure(fmt::format("the frames have no {}", name));
}

/// A field of the frames, a component of it and its sign: stresses are compression positive here,
/// tension positive there, but for the shear stress.
struct FieldPlace {
  std::string_view field;
  std::size_t component;
  double sign;
};

FieldPlace place_of(std::string_view name) {
  if (name == "p_Pa") return {"pressure_Pa", 0, 1.0};
  if (name == "sigma_h_Pa") return {"stress_Pa", 0, -1.0};
  if (name == "sigma_v_Pa") return {"stress_Pa", 1, -1.0};
  if (name == "sigma_z_Pa") return {"stress_Pa", 2, -1.0};
  if (name == "tau_xy_Pa") return {"stress_Pa", 3, 1.0};
  if (name == "v_x_m_per_s") return {"velocity_m_per_s", 0, 1.0};
  return {name, 0, 1.0};
}

}  // namespace

RunFrames read_run_frames(const std::filesystem::path& series) {
  const std::vector<io::FrameEntry> entries = io::read_frame_series(series);
  if (entries.size() < 2) throw NoFigure("the run has left no frame of its start or its end");
  const std::filesystem::path folder = series.parent_path();
  return {io::read_frame(folder / entries.front().file_name),
          io::read_frame(folder / entries.back().file_name)};
}

PlainCurve rest_line(const RunFrames& frames, double h, double width, double threshold) {
  const io::Frame &first = frames.first, &last = frames.last;
  if (first.points != last.points)
    throw NoFigure(fmt::format("of {} points {} are left, so none can be followed", first.points,
                               last.points));
  const auto columns = static_cast<std::size_t>(std::max(1L, std::lround(width / h)));
  PlainCurve line;
  for (std::size_t i = 0; i < columns; ++i) line.x.push_back((static_cast<double>(i) + 0.5) * h);
  line.y.assign(columns, 0.0);
  for (std::size_t i = 0; i < last.points; ++i) {
    const auto at = [&](const io::Frame& frame, std::size_t k) {
      return frame.position_m[3 * i + k];
    };
    const double moved = std::hypot(at(last, 0) - at(first, 0), at(last, 1) - at(first, 1),
                                    at(last, 2) - at(first, 2));
    if (!(moved < threshold)) continue;
    const double column =
        std::clamp(std::floor(at(last, 0) / h), 0.0, static_cast<double>(columns) - 1.0);
    double& highest = line.y[static_cast<std::size_t>(column)];
    highest = std::max(highest, at(last, 1));
  }
  return line;
}

PlainCurve column_means(const io::Frame& frame, double h, std::string_view name) {
  const FieldPlace place = place_of(name);
  const io::Frame::Field& field = field_of(frame, place.field);
  std::vector<double> sum;
  std::vector<std::size_t> count;
  for (std::size_t i = 0; i < frame.points; ++i) {
    const double y = frame.position_m[3 * i + 1];
    const auto row = static_cast<std::size_t>(std::max(0.0, std::floor(y / h)));
    if (row >= sum.size()) {
      sum.resize(row + 1);
      count.resize(row + 1);
    }
    sum[row] += place.sign * field.values[field.components * i + place.component];
    ++count[row];
  }
  PlainCurve curve;
  for (std::size_t row = 0; row < sum.size(); ++row) {
    if (count[row] == 0) continue;
    curve.x.push_back((static_cast<double>(row) + 0.5) * h);
    curve.y.push_back(sum[row] / static_cast<double>(count[row]));
  }
  return curve;
}

}  // namespace repose::study

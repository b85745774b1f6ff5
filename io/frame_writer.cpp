#include "io/frame_writer.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <string_view>

#include "io/frame_reader.hpp"
#include "io/json.hpp"
#include "io/seal.hpp"
#include "io/vtkhdf.hpp"

namespace repose::io {

namespace {

namespace fs = std::filesystem;

void check_base_name(const std::string& name) {
  const bool fit = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '.' || c == '_' || c == '-';
  });
  if (!fit || name.empty() || name.front() == '.')
    throw std::invalid_argument("frames: '" + name +
                                "' cannot be part of a file name; letters, digits, '.', '_' and "
                                "'-' can, with no '.' in front");
}

/// BASE_00012.hdf; five digits sort rightly up to 100 000 frames and grow beyond.
std::string frame_name(const std::string& base_name, std::size_t number) {
  std::string digits = std::to_string(number);
  if (digits.size() < 5) digits.insert(0, 5 - digits.size(), '0');
  return base_name + "_" + digits + ".hdf";
}

}  // namespace

FrameWriter::FrameWriter(fs::path folder, std::string base_name)
    : folder_(std::move(folder)),
      base_name_(std::move(base_name)) {
  check_base_name(base_name_);
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw IoError(folder_, "cannot create the folder", error.value());
}

FrameWriter FrameWriter::continued(fs::path folder, std::string base_name, double last_time_s) {
  FrameWriter writer(std::move(folder), std::move(base_name));
  const fs::path path = writer.series_path();
  if (!fs::exists(path)) return writer;
  std::vector<Entry> later;
  for (FrameEntry& entry : read_frame_series(path)) {
    Entry frame{std::move(entry.file_name), entry.time_s};
    const std::string expected =
        frame_name(writer.base_name_, writer.frames_.size() + later.size());
    if (frame.file_name != expected)
      throw IoError(path,
                    "frame '" + frame.file_name + "' stands where '" + expected + "' belongs");
    // Entries are numbered without gaps, so the first that is too late ends what can be kept.
    const bool keep = later.empty() && frame.time_s <= last_time_s;
    (keep ? writer.frames_ : later).push_back(std::move(frame));
  }
  writer.write_series(writer.frames_);
  for (const Entry& frame : later) {
    std::error_code ignored;  // a frame that stays behind is only a file that nothing names
    fs::remove(writer.folder_ / frame.file_name, ignored);
  }
  return writer;
}

fs::path FrameWriter::series_path() const { return folder_ / (base_name_ + ".hdf.series"); }

fs::path FrameWriter::write(const FrameView& frame) { return write_next(frame); }

fs::path FrameWriter::write(const GridView& grid) { return write_next(grid); }

template <class View>
fs::path FrameWriter::write_next(const View& frame) {
  const std::string name = frame_name(base_name_, frames_.size());
  const fs::path path = folder_ / name;
  std::string image;
  try {
    image = vtkhdf_image(frame);
  } catch (const std::invalid_argument&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw IoError(path, error.what());
  }
  write_atomically(path, {image, seal_of(image)});

  // The series is written before the frame counts, so that a failure leaves this writer as it was.
  std::vector<Entry> frames = frames_;
  frames.push_back({name, frame.time_s});
  write_series(frames);
  frames_ = std::move(frames);
  return path;
}

void FrameWriter::write_series(const std::vector<Entry>& frames) const {
  Json files = Json::array();
  for (const Entry& frame : frames)
    files.push_back({{"name", frame.file_name}, {"time", frame.time_s}});
  const Json series{{"file-series-version", "1.0"}, {"files", std::move(files)}};
  write_atomically(series_path(), series.dump(1) + "\n");
}

}  // namespace repose::io

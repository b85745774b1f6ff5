#include "io/frame_reader.hpp"

#include <cerrno>
#include <fstream>
#include <stdexcept>

#include "io/atomic_file.hpp"
#include "io/json.hpp"
#include "io/seal.hpp"
#include "io/vtkhdf.hpp"

namespace repose::io {

std::vector<FrameEntry> read_frame_series(const std::filesystem::path& series) {
  errno = 0;
  std::ifstream in(series);
  if (!in) throw IoError(series, "cannot read", errno);
  std::vector<FrameEntry> frames;
  try {
    const Json json = Json::parse(std::string(std::istreambuf_iterator<char>(in), {}));
    for (const auto& entry : json.at("files"))
      frames.push_back({entry.at("name").get<std::string>(), entry.at("time").get<double>()});
  } catch (const Json::Error& error) {
    throw IoError(series, std::string("not a series of frames: ") + error.what());
  }
  for (const FrameEntry& frame : frames)
    if (frame.file_name.empty() || frame.file_name.find('/') != std::string::npos)
      throw IoError(series, "names '" + frame.file_name + "', which is no file beside it");
  return frames;
}

Frame read_frame(const std::filesystem::path& file) {
  std::string image = read_sealed(file);
  try {
    return read_vtkhdf(image);
  } catch (const std::runtime_error& error) {
    throw IoError(file, std::string("not a frame: ") + error.what());
  }
}

}  // namespace repose::io

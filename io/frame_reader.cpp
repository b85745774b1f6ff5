#include "io/frame_reader.hpp"

#include <cerrno>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "io/atomic_file.hpp"
#include "io/json.hpp"
#include "io/seal.hpp"
#include "io/vtkhdf.hpp"

namespace repose::io {

std::string grid_series_name(const std::string& base_name) { return base_name + "_grid"; }

std::filesystem::path point_series_in(const std::filesystem::path& folder) {
  constexpr std::string_view suffix = ".hdf.series";
  std::set<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.ends_with(suffix) && !name.starts_with('.'))
      names.insert(name.substr(0, name.size() - suffix.size()));
  }
  // a scene may be called heap_grid; of a grid is what has a series of points beside it
  std::set<std::string> grids;
  for (const std::string& name : names) grids.insert(grid_series_name(name));
  for (const std::string& name : names)
    if (!grids.contains(name)) return folder / (name + std::string(suffix));
  return {};
}

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

#include "report/page/read_result.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <system_error>

#include <fmt/core.h>

#include "input/input_file.hpp"
#include "input/read_scene.hpp"
#include "io/csv_columns.hpp"
#include "io/frame_reader.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "report/page/pack_frames.hpp"
#include "report/page/scene_marks.hpp"

namespace repose::report {
namespace {

namespace fs = std::filesystem;
using Json = io::Json;

constexpr std::uintmax_t largest_picture =
    4'000'000;  ///< bytes; a larger one stays out of the page

std::string text_of(const fs::path& file) {
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw io::IoError(file, "cannot read", errno);
  return std::move(text).str();
}

Json json_of(const fs::path& file) {
  const auto json = Json::try_parse(text_of(file));
  if (!json || !json->is_object()) throw io::IoError(file, "is not a JSON object");
  return *json;
}

/// In the order of their names, so that the page does not depend on the file system.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    const bool hidden = it->path().filename().string().starts_with('.');
    if (!hidden && it->is_regular_file(ignored)) files.push_back(it->path());
  }
  if (error) throw io::IoError(folder, "cannot list the folder", error.value());
  std::sort(files.begin(), files.end());
  return files;
}

/// Says what the folder is instead, as far as it can be seen.
[[noreturn]] void refuse(const fs::path& folder) {
  std::string below;
  std::error_code error;
  std::set<fs::path> results;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (std::error_code ignored; fs::exists(it->path() / "summary.json", ignored))
      results.insert(it->path());
  if (!results.empty())
    below = fmt::format("; {} below it {}: try {}", results.size() == 1 ? "one" : "those",
                        results.size() == 1 ? "is" : "are",
                        results.size() == 1 ? results.begin()->string() : (folder / "*").string());
  throw input::BadInput({fmt::format("{}: is not a result folder: it has no summary.json{}",
                                     folder.string(), below)});
}

/// The page is sent by mail: it leaves to ParaView what frames carry beyond the usual colours.
bool is_for_the_page(const io::Frame::Field& field) {
  constexpr std::array<std::string_view, 6> usual{
      "body", "density_kg_per_m3", "mises_Pa", "pressure_Pa", "shear_strain", "velocity_m_per_s"};
  return std::find(usual.begin(), usual.end(), field.name) != usual.end();
}

Json frames_of(const fs::path& series, double plan_height) {
  const std::vector<io::FrameEntry> entries = io::read_frame_series(series);
  return pack_frames(
      entries.size(),
      [&](std::size_t i) {
        io::Frame frame = io::read_frame(series.parent_path() / entries[i].file_name);
        std::erase_if(frame.fields, [](const auto& field) { return !is_for_the_page(field); });
        return frame;
      },
      {}, plan_height);
}

/// The scene of a run; nothing, with a note, where its input is not to be read here: its maps may
/// be missing, or a law that a program brought along.
std::optional<mpm::Scene> scene_of(Json& result) {
  const Json* const input = result.find("input");
  if (input == nullptr) return {};
  try {
    input::InputFile file = input::InputFile::parse(input->get<std::string>(), "input.toml");
    return input::read_scene(file).scene;
  } catch (const std::runtime_error& error) {
    result["notes"].push_back(fmt::format(
        "the animation shows points alone, without edges, surfaces and probes: {}", error.what()));
  }
  return {};
}

void add_frames(Json& result, const fs::path& folder) {
  const fs::path series = io::point_series_in(folder);
  if (series.empty()) return;
  const std::optional<mpm::Scene> scene = scene_of(result);
  Json frames = frames_of(series, scene ? plan_height(*scene) : 0.0);
  if (frames["times"].empty()) return;
  if (scene) result["scene"] = scene_marks(*scene, frames["times"].get<std::vector<double>>());
  result["frames"] = std::move(frames);
}

}  // namespace

Json read_result(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) throw io::IoError(folder, "there is no such folder");
  if (!fs::exists(folder / "summary.json", error)) refuse(folder);
  Json result;
  result["path"] = folder.string();
  const fs::path clean = folder.lexically_normal();
  const fs::path name = clean.has_filename() ? clean.filename() : clean.parent_path().filename();
  result["label"] =
      name == "." ? fs::absolute(folder).parent_path().filename().string() : name.string();
  result["summary"] = json_of(folder / "summary.json");
  const Json* kind = result["summary"].find("kind");
  result["kind"] = kind && kind->is_string() ? *kind : Json("run");
  result["notes"] = Json::array();
  result["tables"] = Json::object();
  result["pictures"] = Json::array();
  result["texts"] = Json::array();
  for (const fs::path& file : files_in(folder)) {
    const std::string base = file.filename().string(), type = file.extension().string();
    if (type == ".csv") {
      Json table = io::csv_columns(text_of(file), file.string());
      if (table["shown"] != table["rows"])
        result["notes"].push_back(fmt::format("{}: {} of its {} rows are shown, evenly chosen",
                                              base, table["shown"].get<std::size_t>(),
                                              table["rows"].get<std::size_t>()));
      result["tables"][base] = std::move(table);
    } else if (type == ".svg") {
      if (fs::file_size(file) > largest_picture)
        result["notes"].push_back(fmt::format("{} is left out: it has {:.1f} MB", base,
                                              static_cast<double>(fs::file_size(file)) / 1e6));
      else
        result["pictures"].push_back({{"name", base}, {"svg", text_of(file)}});
    } else if (base == "input.toml") {
      result["input"] = text_of(file);
    } else if (type == ".toml") {
      result["texts"].push_back({{"name", base}, {"text", text_of(file)}});
    } else if (base == "fit.json") {
      result["fit"] = json_of(file);
    }
  }
  add_frames(result, folder / "frames");
  return result;
}

}  // namespace repose::report

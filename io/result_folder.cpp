#include "io/result_folder.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/compile.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/fingerprint.hpp"
#include "io/json.hpp"
#include "io/seal.hpp"

namespace repose::io {

namespace {

namespace fs = std::filesystem;

// manifest.json and summary.json come first: they declare a result complete.
constexpr std::array<std::string_view, 98> outputs{"manifest.json",
                                                   "largest_depth.asc",
                                                   "largest_depth.prj",
                                                   "largest_depth.tif",
                                                   "largest_speed.asc",
                                                   "largest_speed.prj",
                                                   "largest_speed.tif",
                                                   "arrival_time.asc",
                                                   "arrival_time.prj",
                                                   "arrival_time.tif",
                                                   "deposit.asc",
                                                   "deposit.prj",
                                                   "deposit.tif",
                                                   "outlines.geojson",
                                                   "summary.json",
                                                   "checkpoint_previous.h5",
                                                   "sweep.csv",
                                                   "samples.csv",
                                                   "sensitivity.csv",
                                                   "sensitivity.json",
                                                   "sensitivity.svg",
                                                   "sweep.svg",
                                                   "propagation.csv",
                                                   "propagation.json",
                                                   "propagation.svg",
                                                   "draws.csv",
                                                   "depth_bands.csv",
                                                   "curves.csv",
                                                   "finished.jsonl",
                                                   "checkpoint.h5",
                                                   "final_state.h5",
                                                   "series.csv",
                                                   "profile.csv",
                                                   "curve.csv",
                                                   "final.svg",
                                                   "curve.svg",
                                                   "fit.json",
                                                   "fitted.toml",
                                                   "fit.svg",
                                                   "chart.csv",
                                                   "chart.svg",
                                                   "table.csv",
                                                   "error_map.csv",
                                                   "error_map.svg",
                                                   "history.csv",
                                                   "history.svg",
                                                   "cost.svg",
                                                   "chart.json",
                                                   "predictions.csv",
                                                   "clay_steps.csv",
                                                   "clay_steps.svg",
                                                   "clay_kappa.csv",
                                                   "clay_kappa.svg",
                                                   "clay_paths.csv",
                                                   "clay_paths.svg",
                                                   "mu_i_boundary.csv",
                                                   "mu_i_boundary.svg",
                                                   "mu_i_refinement.csv",
                                                   "mu_i_refinement.svg",
                                                   "mu_i_curves.csv",
                                                   "mu_i_curves.svg",
                                                   "mu_i_shear_signs.csv",
                                                   "mu_i_shear_signs.svg",
                                                   "mu_i_shear_refinement.csv",
                                                   "mu_i_shear_refinement.svg",
                                                   "mu_i_collapse.csv",
                                                   "mu_i_collapse.svg",
                                                   "step_limits.csv",
                                                   "step_limits.svg",
                                                   "mpm_failures.csv",
                                                   "mpm_failures.svg",
                                                   "collapse.csv",
                                                   "collapse.svg",
                                                   "errors.csv",
                                                   "work_precision.svg",
                                                   "reference_profile.csv",
                                                   "reference_kinetic.csv",
                                                   "reference_momentum.csv",
                                                   "tangent.csv",
                                                   "tangent.svg",
                                                   "accuracy.csv",
                                                   "accuracy.svg",
                                                   "estimate.csv",
                                                   "advised.toml",
                                                   "fit_diagnostics.svg",
                                                   "comparison.json",
                                                   "comparison.csv",
                                                   "comparison.svg",
                                                   "unseen.csv",
                                                   "design.csv",
                                                   "posterior.json",
                                                   "posterior.csv",
                                                   "posterior_bands.csv",
                                                   "posterior_bands.svg",
                                                   "posterior_corner.svg",
                                                   "validation.md",
                                                   "result.csv",
                                                   "result.svg"};

/// NAME_00012.hdf or NAME.hdf.series, or a temporary of one of them.
bool is_frame_file(std::string name) {
  if (auto whole = name_of_part(name)) name = std::move(*whole);
  if (name.ends_with(".hdf.series")) return true;
  constexpr std::string_view suffix = ".hdf";
  if (!name.ends_with(suffix)) return false;
  name.resize(name.size() - suffix.size());
  const std::size_t bar = name.rfind('_');
  return bar != std::string::npos && bar > 0 && name.size() - bar - 1 >= 5 &&
         std::all_of(name.begin() + static_cast<std::ptrdiff_t>(bar) + 1, name.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// Removes a file or link if it is there; a folder of that name is not ours and stays.
void remove_file(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (!fs::exists(status) || fs::is_directory(status)) return;
  fs::remove(path, error);
  if (error) throw IoError(path, "cannot remove the older result", error.value());
}

void remove_frames(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(fs::symlink_status(folder, error))) return;
  std::vector<fs::path> ours;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (is_frame_file(it->path().filename().string())) ours.push_back(it->path());
  if (error) throw IoError(folder, "cannot list the older frames", error.value());
  for (const fs::path& path : ours) remove_file(path);
  ::rmdir(folder.c_str());  // goes only if it is empty now
}

std::string header_line(std::span<const std::string> columns) {
  if (columns.empty()) throw std::invalid_argument("table: it has no columns");
  for (const std::string& name : columns)
    if (name.empty() || name.find_first_of(",\"\r\n") != std::string::npos)
      throw std::invalid_argument("table: '" + name + "' cannot be the name of a column");
  return fmt::format("{}\n", fmt::join(columns, ","));
}

int open_table(const fs::path& path, int flags) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  if (fd < 0) throw IoError(path, "cannot open for writing", errno);
  return fd;
}

/// The number of bytes of `text` to keep: the header and every complete row whose first value is at
/// most `last`.
std::size_t bytes_to_keep(std::string_view text, std::size_t header, double last) {
  std::size_t kept = header;
  while (true) {
    const std::size_t end = text.find('\n', kept);
    if (end == std::string_view::npos) return kept;
    double first = 0.0;
    const auto parsed = std::from_chars(text.data() + kept, text.data() + end, first);
    if (parsed.ec != std::errc() || !(first <= last)) return kept;
    kept = end + 1;
  }
}

}  // namespace

ResultFolder::ResultFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  const fs::file_status status = fs::status(folder_, error);
  if (fs::exists(status) && !fs::is_directory(status))
    throw IoError(folder_, "cannot be a result folder: it is a file");
  fs::create_directories(folder_, error);
  if (error) throw IoError(folder_, "cannot create the result folder", error.value());
}

namespace {

/// A table of a probe or tracer, which a run names.
bool is_probe_table(const std::string& name) {
  return (name.starts_with("probe_") || name.starts_with("tracer_")) && name.ends_with(".csv");
}

std::vector<std::string> probe_tables(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (const std::string name = it->path().filename().string(); is_probe_table(name))
      names.push_back(name);
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

fs::path ResultFolder::default_path(std::string_view name) { return fs::path("results") / name; }

std::span<const std::string_view> ResultFolder::output_names() { return outputs; }

void ResultFolder::remove_old_outputs() const {
  for (const std::string_view name : outputs) remove_file(file(name));
  for (const std::string& name : probe_tables(folder_)) remove_file(file(name));
  remove_old_parts();
  remove_frames(frames());
}

void ResultFolder::remove_old_parts() const {
  io::remove_old_parts(folder_, [](std::string_view name) {
    return name == "input.toml" || name == "starts.jsonl" || name == "chains.jsonl" ||
           name == "left_out.jsonl" || name == "report.html" ||
           std::find(outputs.begin(), outputs.end(), name) != outputs.end();
  });
  io::remove_old_parts(frames(),
                       [](std::string_view name) { return is_frame_file(std::string(name)); });
}

void ResultFolder::remove_checkpoints() const {
  std::error_code ignored;  // a checkpoint too many harms nothing
  fs::remove(checkpoint(), ignored);
  fs::remove(previous_checkpoint(), ignored);
}

namespace {

constexpr const char* manifest_name = "manifest.json";

Json entry_of(const fs::path& file, bool with_checksum) {
  std::error_code error;
  if (!with_checksum) {
    const std::uintmax_t bytes = fs::file_size(file, error);
    return error ? Json() : Json{{"bytes", static_cast<std::int64_t>(bytes)}};
  }
  if (!fs::is_regular_file(file, error)) return {};
  const std::string text = read_bytes(file);
  return {{"bytes", static_cast<std::int64_t>(text.size())}, {"checksum", fingerprint_of(text)}};
}

}  // namespace

void ResultFolder::seal() const {
  Json files = Json::object();
  const auto add = [&](const std::string& name, bool with_checksum) {
    const Json entry = entry_of(file(name), with_checksum);
    if (!entry.is_null()) files[name] = entry;
  };
  add("input.toml", true);
  // what a result that is done has no longer
  constexpr std::array<std::string_view, 4> passing{manifest_name, "checkpoint.h5",
                                                    "checkpoint_previous.h5", "finished.jsonl"};
  for (const std::string_view name : outputs)
    if (std::find(passing.begin(), passing.end(), name) == passing.end())
      add(std::string(name), true);
  for (const std::string& name : probe_tables(folder_)) add(name, true);
  std::error_code error;
  std::vector<std::string> frame_files;
  for (fs::directory_iterator it(frames(), error), end; !error && it != end; it.increment(error))
    if (const std::string name = it->path().filename().string(); is_frame_file(name))
      frame_files.push_back("frames/" + name);
  std::sort(frame_files.begin(), frame_files.end());
  for (const std::string& name : frame_files) add(name, false);
  std::vector<std::string> runs;  // results of their own
  for (fs::directory_iterator it(file("runs"), error), end; !error && it != end;
       it.increment(error))
    if (fs::exists(it->path() / manifest_name)) runs.push_back(it->path().filename().string());
  std::sort(runs.begin(), runs.end());
  write_file(manifest_name, Json{{"files", files}, {"runs", runs}}.dump(1) + "\n");
}

std::string ResultFolder::damage() const {
  std::ifstream in(file(manifest_name), std::ios::binary);
  const auto manifest = Json::try_parse(std::string(std::istreambuf_iterator<char>(in), {}));
  const Json* const files = manifest ? manifest->find("files") : nullptr;
  if (files == nullptr || !files->is_object())
    return in.is_open() ? "manifest.json is damaged" : "there is no manifest.json";
  std::vector<std::string> names;
  for (const auto& [name, entry] : files->items()) names.push_back(name);
  if (std::string own = damage(names); !own.empty()) return own;
  for (const std::string& run : manifest->value("runs", std::vector<std::string>{})) {
    const fs::path there = file("runs") / run;
    const std::string why =
        fs::is_directory(there) ? ResultFolder(there).damage() : std::string("it is missing");
    if (!why.empty()) return fmt::format("runs/{}: {}", run, why);
  }
  return "";
}

std::string ResultFolder::damage(std::span<const std::string> names) const {
  std::ifstream in(file(manifest_name), std::ios::binary);
  const auto manifest = Json::try_parse(std::string(std::istreambuf_iterator<char>(in), {}));
  const Json* const files = manifest ? manifest->find("files") : nullptr;
  for (const std::string& name : names) {
    const Json* const entry = files != nullptr && files->is_object() ? files->find(name) : nullptr;
    if (entry == nullptr) return fmt::format("{} is not in manifest.json", name);
    const Json now = entry_of(file(name), entry->find("checksum") != nullptr);
    if (now.is_null()) return fmt::format("{} is missing", name);
    if (!(now == *entry)) return fmt::format("{} is not as it was written", name);
  }
  return "";
}

FolderClaim::FolderClaim(const ResultFolder& folder) : path_(folder.file(".repose-lock")) {
  for (;;) {
    fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (fd_ < 0) throw IoError(folder.path(), "cannot write into it", errno);
    if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      char process[32] = {};
      const ssize_t n = ::read(fd_, process, sizeof process - 1);
      ::close(std::exchange(fd_, -1));
      if (error == EWOULDBLOCK)
        throw IoError(
            folder.path(),
            fmt::format("{} is writing into it; wait for its end, or give another folder with -o",
                        n > 0 ? fmt::format("process {}", std::atol(process)) : "another process"));
      return;  // a file system without locks
    }
    // whoever had it may have removed the file since it was opened
    struct stat here {
    }, there{};
    if (::fstat(fd_, &here) == 0 && ::stat(path_.c_str(), &there) == 0 &&
        here.st_ino == there.st_ino)
      break;
    ::close(std::exchange(fd_, -1));
  }
  const std::string process = fmt::format("{}\n", ::getpid());
  if (::ftruncate(fd_, 0) != 0 || ::write(fd_, process.data(), process.size()) < 0) {
    // only its number is missing in the other's message
  }
}

FolderClaim::~FolderClaim() {
  if (fd_ < 0) return;
  ::unlink(path_.c_str());
  ::close(fd_);
}

void ResultFolder::write_file(std::string_view name, std::string_view content,
                              Outlives outlives) const {
  write_atomically(file(name), content, outlives);
}

RowWriter::RowWriter(fs::path path, std::size_t columns, int fd)
    : path_(std::move(path)),
      columns_(columns),
      fd_(fd) {}

RowWriter::RowWriter(RowWriter&& other) noexcept
    : path_(std::move(other.path_)),
      columns_(other.columns_),
      fd_(std::exchange(other.fd_, -1)) {}

RowWriter::~RowWriter() {
  if (fd_ >= 0) ::close(fd_);
}

RowWriter RowWriter::create(fs::path path, std::vector<std::string> columns) {
  const std::string header = header_line(columns);
  const int fd = open_table(path, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND);
  RowWriter writer(std::move(path), columns.size(), fd);
  writer.append(header);
  return writer;
}

RowWriter RowWriter::continued(fs::path path, std::vector<std::string> columns, double last) {
  if (!fs::exists(path)) return create(std::move(path), std::move(columns));
  const std::string header = header_line(columns);
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw IoError(path, "cannot read", errno);
  const std::string older = std::move(text).str();
  if (!older.starts_with(header)) {
    // A run that was killed at once may have left a part of the header.
    if (header.starts_with(older)) return create(std::move(path), std::move(columns));
    throw IoError(path, "cannot be continued: its first line is '" +
                            older.substr(0, older.find('\n')) + "', expected '" +
                            header.substr(0, header.size() - 1) + "'");
  }

  const int fd = open_table(path, O_WRONLY | O_APPEND);
  RowWriter writer(std::move(path), columns.size(), fd);
  const std::size_t kept = bytes_to_keep(older, header.size(), last);
  if (::ftruncate(fd, static_cast<off_t>(kept)) != 0)
    throw IoError(writer.path_, "cannot cut off the later rows", errno);
  return writer;
}

void RowWriter::row(std::span<const double> values) {
  if (values.size() != columns_)
    throw std::invalid_argument(
        fmt::format("table {}: {} values for {} columns", path_.string(), values.size(), columns_));
  append(fmt::format("{}\n", fmt::join(values, ",")));
}

std::string RowWriter::text_of(std::span<const double> values, std::size_t columns) {
  fmt::memory_buffer text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    fmt::format_to(fmt::appender(text), FMT_COMPILE("{}"), values[i]);
    text.push_back((i + 1) % columns == 0 ? '\n' : ',');
  }
  return {text.data(), text.size()};
}

void RowWriter::append(std::string_view line) {
  const off_t end_before = ::lseek(fd_, 0, SEEK_END);
  while (!line.empty()) {
    const ssize_t written = ::write(fd_, line.data(), line.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      const int error = errno;
      // Best effort: a device has nothing to take back.
      if (end_before < 0 || ::ftruncate(fd_, end_before) != 0) errno = error;
      throw IoError(path_, "cannot write", error);
    }
    line.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace repose::io

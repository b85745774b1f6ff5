#include "io/atomic_file.hpp"

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

namespace repose::io {

namespace {

/// An open file descriptor; closed at the end of the scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }
  /// Closes now and returns close()'s answer: network file systems report a full disk here.
  int close() { return ::close(std::exchange(fd_, -1)); }

 private:
  int fd_;
};

/// Writes everything or returns the error number; 0 for success.
int write_fully(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(fd, content.data(), content.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      return errno;
    }
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

/// fsync, but not an error where the file system has no such thing.
int flush_to_disk(int fd) {
  if (::fsync(fd) == 0 || errno == EINVAL || errno == ENOTSUP) return 0;
  return errno;
}

/// Makes the rename itself durable; a folder that cannot be opened for it is no error, since the
/// file is already in place.
void flush_folder(const std::filesystem::path& folder) {
  const Descriptor fd(
      ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0) ::fsync(fd.get());
}

/// A rename would replace a device or a pipe by a plain file.
void refuse_special_file(const std::filesystem::path& path) {
  std::error_code ignored;  // a path that cannot be looked at cannot be written either
  const std::filesystem::file_status status = std::filesystem::symlink_status(path, ignored);
  if (std::filesystem::is_directory(status)) throw IoError(path, "cannot write: it is a folder");
  if (std::filesystem::is_other(status) && !std::filesystem::is_symlink(status))
    throw IoError(path, "cannot write: it is a device or a pipe, not a file");
}

}  // namespace

IoError::IoError(std::filesystem::path path, std::string reason)
    : std::runtime_error(path.string() + ": " + reason),
      path_(std::move(path)),
      reason_(std::move(reason)) {}

IoError::IoError(std::filesystem::path path, std::string_view doing, int error_number)
    : IoError(std::move(path),
              std::string(doing) + ": " + std::generic_category().message(error_number)) {}

namespace {

constexpr std::string_view part_ending = ".repose-part";

/// ".series.csv.1234-5.repose-part" → "series.csv" and 1234; 0 where no number stands.
struct Part {
  std::string name;
  long process = 0;
};
std::optional<Part> part_of(std::string_view file) {
  if (!file.starts_with('.') || !file.ends_with(part_ending)) return std::nullopt;
  file = file.substr(1, file.size() - 1 - part_ending.size());
  Part part{std::string(file)};
  const std::size_t dot = file.rfind('.');
  if (dot == std::string_view::npos) return part;
  long process = 0;
  const char* const end = file.data() + file.size();
  const auto [dash, error] = std::from_chars(file.data() + dot + 1, end, process);
  if (error == std::errc() && dash != end && *dash == '-' && process > 0)
    part = {std::string(file.substr(0, dot)), process};
  return part;
}

/// A new file beside `path` under a name that nobody else has.
int open_part(const std::filesystem::path& path, std::filesystem::path& part) {
  static std::atomic<unsigned> count{0};
  for (int attempt = 0; attempt < 1000; ++attempt) {
    part = path.parent_path() / ("." + path.filename().string() + "." + std::to_string(::getpid()) +
                                 "-" + std::to_string(count++) + std::string(part_ending));
    // O_EXCL: what is planted under the name, a link say, must not lead the write elsewhere
    const int fd = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
  return -1;
}

}  // namespace

std::optional<std::string> name_of_part(std::string_view file_name) {
  if (auto part = part_of(file_name)) return std::move(part->name);
  return std::nullopt;
}

void remove_old_parts(const std::filesystem::path& folder,
                      const std::function<bool(std::string_view)>& ours) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<fs::path> old;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const auto part = part_of(it->path().filename().string());
    if (!part || !ours(part->name)) continue;
    const bool alive =
        part->process > 0 && (::kill(static_cast<pid_t>(part->process), 0) == 0 || errno != ESRCH);
    if (!alive) old.push_back(it->path());
  }
  for (const fs::path& one : old) fs::remove(one, error);
}

void write_atomically(const std::filesystem::path& path, std::string_view content,
                      Outlives outlives) {
  write_atomically(path, {content}, outlives);
}

void write_atomically(const std::filesystem::path& path,
                      std::initializer_list<std::string_view> parts, Outlives outlives) {
  refuse_special_file(path);
  std::filesystem::path part;
  Descriptor fd(open_part(path, part));
  if (fd.get() < 0) throw IoError(path, "cannot create the file", errno);

  int error = 0;
  for (const std::string_view content : parts)
    if (error == 0) error = write_fully(fd.get(), content);
  if (error == 0 && outlives == Outlives::power_cut) error = flush_to_disk(fd.get());
  if (fd.close() != 0 && error == 0) error = errno;
  if (error == 0 && ::rename(part.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(part.c_str());
    throw IoError(path, "cannot write", error);
  }
  if (outlives == Outlives::power_cut) flush_folder(path.parent_path());
}

}  // namespace repose::io

#include "io/atomic_file.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

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

std::filesystem::path temporary_name(const std::filesystem::path& path) {
  return path.parent_path() / ("." + path.filename().string() + ".repose-part");
}

void write_atomically(const std::filesystem::path& path, std::string_view content,
                      Outlives outlives) {
  refuse_special_file(path);
  const std::filesystem::path part = temporary_name(path);
  // O_NOFOLLOW: a link planted under the temporary name must not lead the write elsewhere.
  Descriptor fd(::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (fd.get() < 0) throw IoError(path, "cannot create the file", errno);

  int error = write_fully(fd.get(), content);
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

#include "io/seal.hpp"

#include <algorithm>
#include <cerrno>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/atomic_file.hpp"
#include "io/fingerprint.hpp"

namespace repose::io {
namespace {

constexpr std::string_view mark = "repose-seal ";
constexpr std::size_t most_of_a_stream = 32'000'000;
constexpr std::size_t seal_length = mark.size() + 20 + 1 + 16 + 1;

}  // namespace

std::string seal_of(std::string_view content) {
  return fmt::format("{}{:020} {}\n", mark, content.size(), fingerprint_of(content));
}

std::string read_bytes(const std::filesystem::path& file, std::size_t most) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) throw IoError(file, "cannot read", errno);
  std::string bytes;
  struct stat status {};
  const bool regular = ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
  const std::size_t length = regular ? static_cast<std::size_t>(status.st_size) : 0;
  // what does not say its length may never end
  if (!regular) most = std::min(most, most_of_a_stream);
  if (length <= most) bytes.reserve(length + 1);
  constexpr std::size_t part = 1 << 16;
  int error = 0;
  while (length <= most && bytes.size() <= most) {
    const std::size_t before = bytes.size();
    bytes.resize(before + part);
    const ssize_t n = ::read(fd, bytes.data() + before, part);
    bytes.resize(before + (n > 0 ? static_cast<std::size_t>(n) : 0));
    if (n == 0 || (n < 0 && errno != EINTR)) {
      error = n < 0 ? errno : 0;
      break;
    }
  }
  ::close(fd);
  if (error != 0) throw IoError(file, "cannot read", error);
  if (length > most || bytes.size() > most)
    throw IoError(file, fmt::format("is longer than {} MB, or never ends", most / 1'000'000));
  return bytes;
}

std::string read_sealed(const std::filesystem::path& file) {
  std::string bytes = read_bytes(file);
  const std::string_view all = bytes;
  if (all.size() < seal_length || !all.substr(all.size() - seal_length).starts_with(mark))
    throw IoError(file, "is cut short, or of another version of repose: its checksum is missing");
  const std::string_view content = all.substr(0, all.size() - seal_length);
  if (all.substr(content.size()) != seal_of(content))
    throw IoError(file, "is damaged: its checksum is that of another content");
  bytes.resize(content.size());
  return bytes;
}

}  // namespace repose::io

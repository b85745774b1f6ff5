#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace repose::io {

/// A file or folder that could not be read or written; `repose` exits with 4.
/// what() is "PATH: REASON", the reason being the operating system's own where there is one.
class IoError : public std::runtime_error {
 public:
  IoError(std::filesystem::path path, std::string reason);
  /// doing: what was tried ("cannot write"); the reason becomes "DOING: strerror(error_number)".
  IoError(std::filesystem::path path, std::string_view doing, int error_number);

  const std::filesystem::path& path() const { return path_; }
  const std::string& reason() const { return reason_; }

 private:
  std::filesystem::path path_;
  std::string reason_;
};

/// What a file that was written outlives. A power cut costs two fsyncs, some 10 ms: too much for
/// what can be made again in less.
enum class Outlives : std::uint8_t { power_cut, kill };

/// Writes a file that is whole or not there: the content goes to a hidden temporary name in the
/// same folder, to the disk (fsync) if it is to outlive a power cut, and is then renamed over
/// `path`. An older file of that name stays untouched until the rename and survives any failure;
/// the temporary never stays behind unless the process is killed (temporary_name() says which file
/// that would be). A link of that name is replaced, not followed. content: bytes, of any length.
/// Errors: IoError; a folder, device or pipe of that name is one.
void write_atomically(const std::filesystem::path& path, std::string_view content,
                      Outlives outlives = Outlives::power_cut);

/// The name under which write_atomically(path) writes: ".NAME.repose-part" beside path.
std::filesystem::path temporary_name(const std::filesystem::path& path);

}  // namespace repose::io

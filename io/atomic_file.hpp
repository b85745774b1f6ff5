#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
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

/// Writes a file that is whole or not there: the content goes to a hidden temporary name of its own
/// in the same folder, to the disk (fsync) if it is to outlive a power cut, and is then renamed
/// over `path`; of several writers at once, in threads or processes, one wins. An older file of
/// that name stays untouched until the rename and survives any failure; the temporary stays behind
/// only where the process is killed (remove_old_parts()). A link of that name is replaced, not
/// followed. content: bytes, of any length. Errors: IoError; a folder, device or pipe of that name
/// is one.
void write_atomically(const std::filesystem::path& path, std::string_view content,
                      Outlives outlives = Outlives::power_cut);
/// The same of parts that follow each other in the file, and need not in memory.
void write_atomically(const std::filesystem::path& path,
                      std::initializer_list<std::string_view> parts,
                      Outlives outlives = Outlives::power_cut);

/// Removes what killed processes have left in a folder (".NAME.PID-N.repose-part", or of older
/// versions without PID) of the files that `ours` knows by name; where a process of that number
/// lives, it stays. Errors are ignored: a leftover harms nobody.
void remove_old_parts(const std::filesystem::path& folder,
                      const std::function<bool(std::string_view)>& ours);

/// Is this the name of a temporary of write_atomically()? Then that of the file it was for.
std::optional<std::string> name_of_part(std::string_view file_name);

}  // namespace repose::io

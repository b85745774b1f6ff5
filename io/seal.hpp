#pragma once
/// \file
/// A seal at the end of a file that this program alone reads back: length and checksum of what
/// stands before it. A file that was cut short, or in which a byte has changed, is refused before
/// any library looks at it (HDF5 may crash on one).

#include <filesystem>
#include <string>
#include <string_view>

namespace repose::io {

/// What is written behind a content: write_atomically(file, {content, seal_of(content)}). Readers
/// that go by the length in the file itself, as HDF5 and ParaView do, do not see it.
std::string seal_of(std::string_view content);

/// The content of a sealed file. Errors: IoError if it cannot be read, has no seal or another one
/// than its content has.
std::string read_sealed(const std::filesystem::path& file);

/// The bytes of a file, at most `most` of them, and of a pipe or a device at most 32 MB. Errors:
/// IoError if it cannot be read, is a folder, or is longer (a device may never end).
std::string read_bytes(const std::filesystem::path& file, std::size_t most = std::size_t{1} << 40);

}  // namespace repose::io

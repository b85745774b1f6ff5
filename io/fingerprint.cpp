#include "io/fingerprint.hpp"

#include <cstdint>

#include <fmt/core.h>

namespace repose::io {

std::string fingerprint_of(std::string_view text) {
  std::uint64_t h = 0xcbf29ce484222325ULL;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return fmt::format("{:016x}", h);
}

}  // namespace repose::io

#include "input/program_identity.hpp"

#include <fmt/format.h>
#if defined(__GLIBC__)
#include <gnu/libc-version.h>
#endif

#include "repose_version.hpp"

namespace repose::input {
namespace {

std::string c_library() {
#if defined(__GLIBC__)
  return fmt::format("glibc {}", gnu_get_libc_version());
#else
  return "another C library";
#endif
}

const char* instruction_set() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return "avx512f";
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "avx2";
  return "x86-64";
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "another processor";
#endif
}

}  // namespace

const std::string& program_identity() {
  static const std::string identity = fmt::format("{}, build {} with {}, {}", version_string,
                                                  program_digest, c_library(), instruction_set());
  return identity;
}

}  // namespace repose::input

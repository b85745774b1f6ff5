#pragma once
/// \file
/// What decides the bits of a result beside its input.

#include <string>

namespace repose::input {

/// "0.2.0 (1a2b3c4-dirty), build 0123456789abcdef with glibc 2.36, avx512f": the version, the
/// digest of all sources that results come from and of what compiled them (program_digest of
/// repose_version.hpp: two changed trees of one commit differ in it), the C library, whose exp and
/// log have bits of their own, and the widest instruction set that it finds here. Kept results and
/// caches carry it in their keys.
const std::string& program_identity();

}  // namespace repose::input

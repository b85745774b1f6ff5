#pragma once
/// \file
/// The instruction set that the laws and the solver of this build are compiled for.

#include <string_view>

namespace repose {

/// "avx512" (eight doubles in a register), "avx2" (four) or, on 64-bit ARM, "neon" (two); "sse2"
/// (two) only where REPOSE_MARCH asks for it. Results of one set are the same bits on every machine
/// that has it and the same C library; between sets they differ by round-off and what grows from
/// it.
std::string_view instruction_set();

}  // namespace repose

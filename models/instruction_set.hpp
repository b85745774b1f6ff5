#pragma once
/// \file
/// The instruction set that the laws and the solver of this build are compiled for.

#include <string_view>

namespace repose {

/// "avx512" (eight doubles in a register) or "avx2" (four). Results of one set are the same bits on
/// every machine that has it; between sets they differ by round-off and what grows from it.
std::string_view instruction_set();

}  // namespace repose

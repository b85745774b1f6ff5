#include "models/instruction_set.hpp"

#include "models/scalar.hpp"

namespace repose {

std::string_view instruction_set() {
#if defined(__aarch64__)
  return "neon";
#else
  if constexpr (Pack::size == 8)
    return "avx512";
  else if constexpr (Pack::size == 4)
    return "avx2";
  else
    return "sse2";
#endif
}

}  // namespace repose
